# SPDX-License-Identifier: BSD-3-Clause
"""Why was no plan found? Evidence, and where one joint decides, a proof.

`separated`: a pair of links that only one joint moves, in contact at a value of it between start and goal, whatever the other joints do: a
proof that no path exists. `grid`: the same for two or three joints, on a grid, which is evidence. `trees`: two trees of
certified motions, grown from start and goal; how far each comes, and which pairs stop it.
"""
import collections
import itertools
import random

ROUNDS = 12
MOTIONS = 80  # of one round, for each tree


def joints_between(robot, link1, link2):
    """Names of the variables that move one link against the other; None if a joint between them has several variables."""
    parent = {joint.child: joint for joint in robot.description.all_joints}
    joints = {joint.name: joint for joint in robot.description.all_joints}

    def chain(link):
        way = []
        while link in parent and len(way) < 1000:
            way.append(parent[link])
            link = parent[link].parent
        return way

    first, second = chain(link1), chain(link2)
    names1, names2 = {j.name for j in first}, {j.name for j in second}
    between = [j for j in first if j.name not in names2] + [j for j in second if j.name not in names1]
    known, moving = {variable.name for variable in robot.variables}, set()
    for joint in between:
        for _ in range(10):
            if not joint.mimic or joint.mimic not in joints:
                break
            joint = joints[joint.mimic]
        if joint.type == "fixed":
            continue
        if joint.name not in known:
            return None
        moving.add(joint.name)
    return sorted(moving)


def blocked(robot, pair, states):
    """For each state whether this pair alone, with every other one disabled, is in contact."""
    from stages import read_table, write_srdf
    links = sorted({joint.parent for joint in robot.description.all_joints} | {joint.child for joint in robot.description.all_joints})
    others = [other for other in itertools.combinations(links, 2) if set(other) != set(pair)]
    srdf, answers = robot.folder / "pair.srdf", robot.folder / "pair.csv"
    write_srdf(srdf, robot.robot_name, others)
    outcome = robot.leeway("check", "--what", "self", "--states", robot.table(states), "--out", answers, srdf=srdf)
    if outcome.status not in (0, 1) or outcome.timed_out:
        return None
    return [row["verdict"] == "BLOCKED" for row in read_table(answers.read_text())]


def flood(closed, size, closes, start):
    """Cells that are reached from `start` by steps along one axis; an axis that `closes` is a circle."""
    reached, border = {start}, [start]
    while border:
        cell = border.pop()
        for axis, circle in enumerate(closes):
            for step in (-1, 1):
                at = (cell[axis] + step) % size if circle else cell[axis] + step
                near = cell[:axis] + (at,) + cell[axis + 1:]
                if 0 <= at < size and near not in reached and near not in closed:
                    reached.add(near)
                    border.append(near)
    return reached


def separated(robot, pair, start, goal):
    """A sentence if this pair separates start from goal, else None."""
    names = joints_between(robot, *pair)
    if not names or len(names) > 3:
        return None
    places = [next(i for i, variable in enumerate(robot.variables) if variable.name == name) for name in names]
    variables = [robot.variables[i] for i in places]
    circles = [variable.joint.type == "continuous" for variable in variables]
    if any(variable.unbounded and not circle for variable, circle in zip(variables, circles)):
        return None
    size = {1: 2000, 2: 200, 3: 36}[len(names)]
    grid = list(itertools.product(range(size), repeat=len(names)))
    states = []
    for cell in grid:
        state = list(start)
        for place, variable, k in zip(places, variables, cell):
            state[place] = variable.at(k / (size - 1))
        states.append(state)
    contacts = blocked(robot, pair, states)
    if contacts is None:
        return None
    closed = {cell for cell, contact in zip(grid, contacts) if contact}
    cell_of = lambda state: tuple(round((state[p] - v.low) / (v.high - v.low) * (size - 1)) if v.high > v.low else 0
                                  for p, v in zip(places, variables))
    first, last = cell_of(start), cell_of(goal)
    closed -= {first, last}
    if last in flood(closed, size, circles, first):
        return None
    told = f"{pair[0]} - {pair[1]}"
    if names == [variables[0].name] and not circles[0]:
        value = next(variables[0].at(c[0] / (size - 1)) for c in sorted(closed) if min(first, last) < c < max(first, last))
        return (f"proved disconnected: {told} are in contact at {names[0]} = {value:.6g}, whatever the other joints do, and it is "
                f"{start[places[0]]:.6g} at the start, {goal[places[0]]:.6g} at the goal")
    return f"disconnected by {told} on a grid of {size} values of each of {', '.join(names)} (evidence, no proof)"


class Tree:
    def __init__(self, robot, root):
        self.robot = robot
        self.nodes = [root]
        self.scale = [max(v.high - v.low, 1e-9) for v in robot.variables]

    def near(self, target):
        return min(self.nodes, key=lambda node: sum(((a - b) / s) ** 2 for a, b, s in zip(node, target, self.scale)))

    def motions(self, generator):
        """A third goes to uniform states, a third a little way from any node, a third along one joint from any node."""
        variables = self.robot.variables
        for k in range(MOTIONS):
            if k % 3 == 0:
                target = [v.at(generator.random()) for v in variables]
                yield self.near(target), target
                continue
            node = generator.choice(self.nodes)
            reach = 10 ** generator.uniform(-3, 0)
            one = generator.randrange(len(variables))
            yield node, [min(max(x + reach * s * generator.uniform(-1, 1), v.low), v.high) if k % 3 == 1 or i == one else x
                         for i, (x, s, v) in enumerate(zip(node, self.scale, variables))]

    def spans(self):
        """For each joint, the share of its range that the tree covers."""
        columns = list(zip(*self.nodes))
        return [(max(c) - min(c)) / s for c, s in zip(columns, self.scale)]


def grow(robot, srdf, root, seed):
    from stages import read_table, write_table
    generator = random.Random(f"why {seed}")
    tree, pairs = Tree(robot, root), collections.Counter()
    names = [variable.name for variable in robot.variables]
    edges, answers = robot.folder / "edges.csv", robot.folder / "edge_answers.csv"
    for _ in range(ROUNDS):
        motions = list(tree.motions(generator))
        write_table(edges, ["from:" + n for n in names] + ["to:" + n for n in names], [[*a, *b] for a, b in motions])
        outcome = robot.leeway("edge", "--what", "self", "--edges", edges, "--out", answers, srdf=srdf)
        if outcome.status not in (0, 1) or outcome.timed_out:
            break
        for (a, b), row in zip(motions, read_table(answers.read_text())):
            if row["verdict"] != "FREE":
                pairs[(row["pair"], row["verdict"])] += 1
            proved = float(row["proved_until"]) * (1 if row["verdict"] == "FREE" else 0.9)
            if proved > 1e-4:
                tree.nodes.append([x + proved * (y - x) for x, y in zip(a, b)])
    return tree, pairs


def tell_tree(robot, name, tree, pairs):
    spans = sorted(zip(tree.spans(), (v.name for v in robot.variables)))
    total = sum(pairs.values())
    stuck = [f"{joint} {100 * span:.2g} %" for span, joint in spans[:3]]
    blockers = [f"{pair} ({verdict}, {100 * n / total:.0f} %)" for (pair, verdict), n in pairs.most_common(3)]
    middle = spans[len(spans) // 2][0]
    kind = "an island" if middle < 0.05 else "a region"
    return (f"{name}: {kind}: {len(tree.nodes)} nodes after {ROUNDS * MOTIONS} motions, the median joint covers {100 * middle:.2g} % of its range, "
            f"least {', '.join(stuck)}; {total} motions stopped" + (f" by {', '.join(blockers)}" if blockers else ""))


def explain(robot, srdf, start, goal):
    told, candidates = [], collections.Counter()
    evidence = {}
    for name, root in (("start", start), ("goal", goal)):
        tree, pairs = grow(robot, srdf, root, f"{robot.settings.seed} {robot.description.name} {name}")
        told.append(tell_tree(robot, name, tree, pairs))
        evidence[name] = {"nodes": len(tree.nodes), "spans": [round(span, 4) for span in tree.spans()],
                          "stopped_by": [[pair, verdict, n] for (pair, verdict), n in pairs.most_common(6)]}
        for (pair, _), n in pairs.items():
            candidates[pair] += n
    verdict = "open"
    for pair, _ in candidates.most_common(8):
        links = split_pair(robot, pair)
        sentence = separated(robot, links, start, goal) if links else None
        if sentence:
            told.insert(0, sentence)
            verdict = "proved disconnected" if sentence.startswith("proved") else "disconnected on a grid"
            break
    return {"verdict": verdict, "text": "; ".join(told), **evidence}


def split_pair(robot, pair):
    """`link:link` of the edge table; names may hold colons of their own."""
    links = {joint.parent for joint in robot.description.all_joints} | {joint.child for joint in robot.description.all_joints}
    for i, letter in enumerate(pair):
        if letter == ":" and pair[:i] in links and pair[i + 1:] in links:
            return pair[:i], pair[i + 1:]
    return None
