# SPDX-License-Identifier: BSD-3-Clause
"""Certificates that no writer made: random links, shapes, curves and words of a proof, and an obstacle brought so near that a checker
just accepts. Motions in one window go up to 2 rad and 1 m, so that each term of the bounds decides in some of them."""
import numpy

import judge
import mutations


def spin(rng):
    q = numpy.array([rng.gauss(0, 1) for _ in range(4)])
    return list(q / numpy.linalg.norm(q))


def facing(u):
    """A quaternion whose z axis is the unit vector u."""
    x, y, z = u
    return [-y, x, 0, 1 + z] if z > -0.9 else [z - 1 if abs(z - 1) > 0.5 else -1, 0, -x, y]


def unit(rng):
    v = numpy.array([rng.gauss(0, 1) for _ in range(3)])
    return v / numpy.linalg.norm(v)


def some_shape(rng, kinds):
    kind = rng.choice(kinds)
    shape = {"source": "", "kind": kind, "solid": False, "radius": 0.0, "height": 0.0, "numbers": [], "corners": []}
    size = 10 ** rng.uniform(-2, -0.3)
    if kind == judge.TRIANGLES:
        n, shape["solid"] = rng.choice([1, 2, 5, 12]), rng.random() < 0.2
        shape["numbers"] = [rng.uniform(-size, size) for _ in range(3 * (n + 2))]
        shape["corners"] = [i for k in range(n) for i in (k, k + 1, k + 2)]
        shape["radius"] = rng.choice([0.0, 0.3 * size])
        if shape["solid"]:  # a tetrahedron, outwards
            shape["numbers"] = [rng.uniform(0.3, 1) * size * s for signs in ((1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)) for s in signs]
            shape["corners"] = [0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2]
    elif kind == judge.BALLS:
        shape["numbers"] = [x for _ in range(rng.choice([1, 2, 4, 9])) for x in (*(rng.uniform(-size, size) for _ in range(3)), 10 ** rng.uniform(-2, 0) * size)]
    elif kind == judge.BOXES:
        for _ in range(rng.choice([1, 2, 3, 8])):
            low = [rng.uniform(-size, 0.5 * size) for _ in range(3)]
            shape["numbers"] += low + [x + rng.uniform(0.1, 1) * size for x in low]
    elif kind <= judge.CONE:
        shape["radius"], shape["height"] = rng.uniform(0.1, 0.6) * size, size
    return shape


def some_links(rng, branches):
    """A root, and chains of moved links; the first of the second chain is at number `second`."""
    links, variables, ends, second = [{"name": "root", "joint": "", "parent": 0, "origin": [0.0] * 6 + [1.0], "type": 0}], 0, [], 0
    resting = rng.choice([0, 1, None, None]) if branches == 2 else None
    for branch in range(branches):
        parent, second = 0, len(links)
        for _ in range(rng.choice([1, 1, 2, 3])):
            variable = None
            if branch != resting:
                variable = rng.randrange(variables) if variables > 0 and rng.random() < 0.3 else variables
                variables = max(variables, variable + 1)
            links.append({"name": f"l{len(links)}", "joint": f"j{len(links)}", "parent": parent,
                "origin": [rng.uniform(-0.5, 0.5) for _ in range(3)] + spin(rng), "type": 1 if rng.random() < 0.8 else 2, "axis": list(10 ** rng.uniform(-0.5, 0.5) * unit(rng)),
                "variable": variable, "multiplier": rng.choice([1.0, 1.0, rng.uniform(-2, 2)]), "offset": rng.choice([0.0, rng.uniform(-1, 1)])})
            parent = len(links) - 1
        ends.append(parent)
    return links, variables, ends, second


def curves(rng, variables, count, degree):
    """Start and pieces: straight lines, with control points beside them if the degree is above 1."""
    start = [rng.uniform(-1, 1) for _ in range(variables)]
    last, pieces = start, []
    for _ in range(count):
        way = [rng.choice([-1, 1]) * 10 ** rng.uniform(-1, 0.5) * (rng.random() < 0.85) for _ in range(variables)]
        beside = [0.0 if degree == 1 else abs(w) * 10 ** rng.uniform(-2, 0) for w in way]
        pieces.append([[x + (i + 1) / degree * w + rng.uniform(-1, 1) * b for x, w, b in zip(last, way, beside)] for i in range(degree)])
        last = pieces[-1][-1]
    return start, pieces


def clock(rng, timed):
    """Track, lag and spread of a variable."""
    if not timed:
        return {"track": 0, "lag": 0.0, "spread": 0.0, "since": 0.0}
    return {"track": rng.randrange(3), "lag": rng.choice([0.0, 10 ** rng.uniform(-2.5, 0)]), "spread": rng.choice([0.0, 0.0, 10 ** rng.uniform(-2, -0.5)]),
        "since": rng.uniform(-1, 1)}


class Words:
    """A random proof of one pair."""

    def __init__(self, content, rng, a, b, toward, by_spheres):
        self.content, self.rng, self.bodies, self.toward, self.by_spheres = content, rng, (a, b), toward, by_spheres

    def elements(self, side):
        shape = self.content["shapes"][self.bodies[side]["shape"]]
        wide = {judge.BALLS: 4, judge.BOXES: 6}
        n = len(shape["corners"]) // 3 if shape["kind"] == judge.TRIANGLES else len(shape["numbers"]) // wide.get(shape["kind"], 1)
        return max(1, n) if not shape["solid"] and shape["kind"] <= judge.BOXES else 1

    def leaf(self):
        if self.by_spheres:
            return b"\1"
        n = self.toward + (0.2 * unit(self.rng) if self.rng.random() < 0.3 else 0)
        return b"\4" + b"".join(int(x / numpy.abs(n).max() * 0x7fffffff).to_bytes(4, "little", signed=True) for x in n)

    def tree(self, counts, levels):
        """Halves of the window or of a part, at most `levels` of the window above each other. @param counts elements of both parts"""
        if self.rng.random() < 0.5:
            return self.leaf()
        if levels and self.rng.random() < 0.5:
            return b"\0" + self.tree(counts, levels - 1) + self.tree(counts, levels - 1)
        sides = [s for s in (0, 1) if counts[s] > 1]
        if not sides:
            return self.leaf()
        s = self.rng.choice(sides)
        first, second = counts[:], counts[:]
        first[s] //= 2
        second[s] -= first[s]
        return bytes([5 + s]) + self.tree(first, levels) + self.tree(second, levels)


def forged(rng, accepts, steps=18):
    """Content of a certificate that is accepted; None if none was found. Something stands as near as that allows."""
    timed = rng.random() < 0.4
    late = timed and rng.random() < 0.6  # two chains of two tracks, over several pieces
    with_object = rng.random() < 0.6 and not late
    links, variables, ends, second = some_links(rng, 1 if with_object else 2)
    bounded = range(judge.TRIANGLES, judge.CONE + 1)
    shapes = [some_shape(rng, bounded), some_shape(rng, [*bounded, *[judge.BOXES, judge.HALFSPACE] * 4, judge.PLANE] if with_object else bounded)]
    toward, by_spheres = unit(rng), rng.random() < 0.35
    if by_spheres and rng.random() < 0.3:
        shapes = [some_shape(rng, [judge.BALLS]) if shape["kind"] <= judge.CONE else shape for shape in shapes]
    elif by_spheres and rng.random() < 0.7:  # nothing is lost around a ball
        ball = {"kind": judge.BALLS, "numbers": [0.0, 0.0, 0.0, 0.02], "corners": [], "solid": False}
        shapes = [{**shape, **ball} if shape["kind"] <= judge.CONE else shape for shape in shapes]
    if with_object and shapes[1]["kind"] == judge.BOXES and rng.random() < 0.8:  # a wall
        shapes[1]["numbers"] = [-2, -2, -0.01, 2, 2, 0]
    start, pieces = curves(rng, variables, rng.choice([2, 3, 4] if late else [1, 1, 1, 2]), rng.choice([1, 1, 1, 1, 2, 3, 5, 7]))
    tolerated = rng.random() < 0.25
    body = {"owner": ends[0], "shape": 0, "pose": [rng.uniform(-0.4, 0.4) for _ in range(3)] + spin(rng)}
    turn = spin(rng) if rng.random() < 0.2 else facing(-toward if rng.random() < 0.9 else toward)
    other = {"owner": 0 if with_object else ends[-1], "shape": 1, "pose": [0.0 if with_object else rng.uniform(-0.4, 0.4) for _ in range(3)] + turn}
    content = {"version": 2, "min_d": 0.0, "claims": 3, "sources": [], "variables": [{"name": f"v{i}", "lower": -100.0, "upper": 100.0,
        "tolerance": 10 ** rng.uniform(-3, -0.5) if tolerated else 0.0, **clock(rng, timed)} for i in range(variables)], "links": links, "shapes": shapes,
        "bodies": [body] if with_object else [body, other], "objects": ["o"] if with_object else [], "obstacles": [other] if with_object else [],
        "allowed": [], "margins": [], "start": start, "pieces": pieces, "begin": rng.choice([0.0, rng.uniform(-1, 1)]),
        "seconds": [rng.choice([0.0, 1.0, 10 ** rng.uniform(-1, 1)]) if timed else 0.0 for _ in pieces]}
    if late:
        lag = 10 ** rng.uniform(-1.5, 0)
        for number, one in enumerate(content["links"]):
            if one["type"] and one["variable"] is not None:
                content["variables"][one["variable"]].update(track=int(number >= second), lag=lag if number < second else rng.choice([0.0, lag]))
    words = Words(content, rng, body, other, toward, by_spheres)
    content["proof"] = b"".join(b"\0" + words.tree([words.elements(0), words.elements(1)], 2) + b"\0" for _ in pieces).hex()
    middle = numpy.array([judge.bezier([start, *pieces[0]], numpy.array([[0.5]]))[0]])
    places = [(judge.poses_of(content, middle)[one["owner"]] @ judge.matrix_of(one["pose"]))[0][:3, 3] for one in (body, other)]
    before = numpy.zeros(3) if with_object else numpy.array(links[second]["origin"][:3])
    far = 8.0

    def placed(nearer):
        """Moves the second body or the obstacle to `far` less so many metres from the first one, along `toward`."""
        where = before + places[0] - places[1] + (far - nearer) * toward
        if with_object:
            other["pose"][:3] = where.tolist()
        else:
            links[second]["origin"][:3] = where.tolist()
        return mutations.binary(content)

    if not accepts(placed(0)):
        return None
    mutations.boldest(placed, accepts, steps, far if rng.random() < 0.9 else far + 2)
    return content
