# SPDX-License-Identifier: BSD-3-Clause
"""Why was no plan found? Evidence, and where one joint decides, a proof.

`separated`: pairs of links that only one joint moves, one of them in contact at a value of it between start and goal, whatever the other
joints do: a proof that no path exists. The same for two or three joints on a grid is evidence. `grow`: two trees of
certified motions, from start and goal; how far each comes, and which pairs stop it.
"""
import collections
import itertools
import random
import xml.etree.ElementTree as ElementTree

ROUNDS = 12
MOTIONS = 80  # of one round, for each tree
GRID = {1: 2000, 2: 200, 3: 44}  # values of a variable, by the number of variables


class Movers:
    """The variables that move two links against each other."""

    def __init__(self, robot):
        self.parent = {joint.child: joint for joint in robot.description.all_joints}
        self.joints = {joint.name: joint for joint in robot.description.all_joints}
        self.known = {variable.name for variable in robot.variables}
        self.links = sorted({joint.parent for joint in self.joints.values()} | set(self.parent))
        self.chains = {link: self.chain(link) for link in self.links}

    def chain(self, link):
        names = []
        while link in self.parent and len(names) < 1000:
            names.append(self.parent[link].name)
            link = self.parent[link].parent
        return frozenset(names)

    def variable(self, name):
        """The variable behind a joint, "" of a fixed one, None if it has several."""
        joint = self.joints[name]
        for _ in range(10):
            if not joint.mimic or joint.mimic not in self.joints:
                break
            joint = self.joints[joint.mimic]
        return "" if joint.type == "fixed" else joint.name if joint.name in self.known else None

    def between(self, link1, link2):
        """A set of names; None if a joint between them has several variables."""
        names = {self.variable(name) for name in self.chains[link1] ^ self.chains[link2]}
        return None if None in names else frozenset(names - {""})


def disabled_in(srdf):
    root = ElementTree.parse(srdf).getroot()
    return {frozenset((e.get("link1"), e.get("link2"))) for e in root.findall("disable_collisions")}


def contacts(robot, names, pairs, movers, states):
    """For each state the pair in contact, if only these pairs count; "" where none is."""
    from stages import read_table, write_srdf, write_table
    wanted = {frozenset(pair) for pair in pairs}
    others = [pair for pair in itertools.combinations(movers.links, 2) if frozenset(pair) not in wanted]
    srdf, answers, table = robot.folder / "pair.srdf", robot.folder / "pair.csv", robot.folder / "pair_states.csv"
    write_srdf(srdf, robot.robot_name, others)
    write_table(table, names, states)
    outcome = robot.leeway("check", "--what", "self", "--states", table, "--out", answers, srdf=srdf)
    if outcome.status not in (0, 1) or outcome.timed_out:
        return None
    return [f"{row['self_link1']} - {row['self_link2']}" if row["verdict"] == "BLOCKED" else "" for row in read_table(answers.read_text())]


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


def separated(robot, movers, names, disabled, start, goal):
    """A sentence if the pairs that only these variables move separate start from goal, else None."""
    names = sorted(names)
    places = [next(i for i, variable in enumerate(robot.variables) if variable.name == name) for name in names]
    variables = [robot.variables[i] for i in places]
    circles = [variable.joint.type == "continuous" for variable in variables]
    if any(variable.unbounded and not circle for variable, circle in zip(variables, circles)):
        return None
    pairs = [pair for pair in itertools.combinations(movers.links, 2) if frozenset(pair) not in disabled]
    pairs = [pair for pair in pairs if (movers.between(*pair) or {"none of them"}) <= set(names)]
    size = GRID[len(names)]
    grid = list(itertools.product(range(size), repeat=len(names)))
    found = contacts(robot, names, pairs, movers, [[v.at(k / (size - 1)) for v, k in zip(variables, cell)] for cell in grid])
    if found is None:
        return None
    closed = {cell: pair for cell, pair in zip(grid, found) if pair}
    cell_of = lambda state: tuple(round((state[p] - v.low) / (v.high - v.low) * (size - 1)) if v.high > v.low else 0
                                  for p, v in zip(places, variables))
    first, last = cell_of(start), cell_of(goal)
    walls = set(closed) - {first, last}
    if last in flood(walls, size, circles, first):
        return None
    if len(names) == 1 and not circles[0]:
        cell = next(c for c in sorted(walls) if min(first, last) < c < max(first, last))
        return (f"proved disconnected: {closed[cell]} are in contact at {names[0]} = {variables[0].at(cell[0] / (size - 1)):.6g}, whatever "
                f"the other joints do, and it is {start[places[0]]:.6g} at the start, {goal[places[0]]:.6g} at the goal")
    most = collections.Counter(closed.values()).most_common(2)
    return (f"disconnected on a grid of {size} values of each of {', '.join(names)} (evidence, no proof), most of it by "
            f"{' and '.join(pair for pair, _ in most)}")


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
    verdict, movers, disabled, sets = "open", Movers(robot), disabled_in(srdf), collections.Counter()
    for pair, n in candidates.items():
        links = split_pair(robot, pair)
        between = movers.between(*links) if links else None
        if between and len(between) <= 3:
            sets[between] += n
    for names, _ in sets.most_common(8):
        sentence = separated(robot, movers, names, disabled, start, goal)
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
