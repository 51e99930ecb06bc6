# SPDX-License-Identifier: BSD-3-Clause
"""Samples the claim of a certificate: is a pair nearer than it says, at any of many times and deviations? Kinematics by 4 x 4 matrices;
distances by leeway's Python package, which shares no code with the checkers."""
import numpy

import leeway

TIMES, DEVIATIONS, ROUNDING = 60, 4, 1e-9
TOUCH = 1e-12  # metres: bodies that overlap are 0 apart, and no claim of a distance above 0 allows that
TRIANGLES, BALLS, BOXES, CYLINDER, CAPSULE, CONE, HALFSPACE, PLANE = range(1, 9)


def matrix_of(pose):
    x, y, z, w = numpy.array(pose[3:]) / numpy.linalg.norm(pose[3:])
    out = numpy.eye(4)
    skew = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    out[:3, :3] += 2 * w * skew + 2 * skew @ skew
    out[:3, 3] = pose[:3]
    return out


def joint_matrices(link, values):
    """[values] matrices."""
    out = numpy.tile(numpy.eye(4), (len(values), 1, 1))
    if link["type"] == 0:
        return out
    x, y, z = axis = numpy.array(link["axis"]) / numpy.linalg.norm(link["axis"])
    if link["type"] == 2:
        out[:, :3, 3] = numpy.outer(values, axis)
        return out
    skew, values = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]), values[:, None, None]
    out[:, :3, :3] += numpy.sin(values) * skew + (1 - numpy.cos(values)) * (skew @ skew)
    return out


def poses_of(content, states):
    """[links][states] world from link."""
    poses = []
    for number, link in enumerate(content["links"]):
        values = numpy.zeros(len(states))
        if link["type"]:
            values = link["offset"] + (link["multiplier"] * states[:, link["variable"]] if link["variable"] is not None else values)
        local = matrix_of(link["origin"]) @ joint_matrices(link, values)
        poses.append(poses[link["parent"]] @ local if number else local)
    return poses


def shape_of(shape):
    """Of leeway; with the radius that its distances are to be lessened by."""
    kind, numbers = shape["kind"], numpy.array(shape["numbers"])
    if kind == TRIANGLES:
        return leeway.Shape.mesh(numbers.reshape(-1, 3), numpy.array(shape["corners"], numpy.uint32).reshape(-1, 3), solid=shape["solid"]), shape["radius"]
    if kind == BALLS:
        return leeway.Shape.spheres(numbers.reshape(-1, 4)), 0
    if kind == BOXES:
        return leeway.Shape.boxes(numbers.reshape(-1, 6)), 0
    if kind == HALFSPACE:
        return leeway.Shape.halfspace(), 0
    if kind == PLANE:
        return leeway.Shape.plane(), 0
    make = {CYLINDER: leeway.Shape.cylinder, CAPSULE: leeway.Shape.capsule, CONE: leeway.Shape.cone}[kind]
    return make(max(shape["radius"], 1e-9), max(shape["height"], 1e-9)), 0


def above(content, link):
    """Joints with a variable between a link and the root."""
    found = set()
    while link:
        if content["links"][link]["type"] and content["links"][link]["variable"] is not None:
            found.add(link)
        link = content["links"][link]["parent"]
    return found


def pairs_of(content):
    listed = {(r["object"], *((r["a"], r["b"]) if r["object"] else sorted((r["a"], r["b"])))) for r in content["allowed"]}
    margins = {}
    for r in content["margins"]:
        key = (r["object"], *((r["a"], r["b"]) if r["object"] else sorted((r["a"], r["b"]))))
        margins[key] = max(margins.get(key, 0), r["margin"])
    bodies = content["bodies"]
    for i, a in enumerate(bodies):
        for b in content["obstacles"] if content["claims"] & 1 else []:
            key = (1, a["owner"], b["owner"])
            if key not in listed:
                yield a, b, True, margins.get(key, 0)
        for b in bodies[i + 1:] if content["claims"] & 2 else []:
            key = (0, *sorted((a["owner"], b["owner"])))
            if key not in listed and above(content, a["owner"]) != above(content, b["owner"]):
                yield a, b, False, margins.get(key, 0)


def bezier(points, t):
    """[times][variables] on a curve."""
    points = [numpy.array(p)[None, :] for p in points]
    while len(points) > 1:
        points = [(1 - t) * a + t * b for a, b in zip(points, points[1:])]
    return points[0]


def spread_of(content, times):
    """[times][variables]: how far an unknown motion may have gone."""
    speed, since = (numpy.array([v[name] for v in content["variables"]]) for name in ("spread", "since"))
    return speed * numpy.maximum(0, times[:, None] - since)


def places(content, times, rng):
    """Piece and place on it at each time. Of pieces without duration any place is taken."""
    ends = content["begin"] + numpy.concatenate([[0], numpy.cumsum(content["seconds"])])
    piece, s = numpy.zeros(len(times), int), numpy.zeros(len(times))
    for k, seconds in enumerate(content["seconds"]):
        here = (times > ends[k]) | ((times == ends[k]) & (rng.random(len(times)) < 0.5)) | (k == 0)
        place = numpy.clip((times - ends[k]) / seconds, 0, 1) if seconds > 0 else numpy.where(times > ends[k + 1], 1, rng.random(len(times)))
        piece, s = numpy.where(here, k, piece), numpy.where(here, place, s)
    return piece, s


def late_states(content, random):
    """[states][variables] and their times: each track early or late by itself, those without a lag at one time."""
    whole = sum(content["seconds"])
    times = content["begin"] + whole * random.random(TIMES * len(content["pieces"]) * DEVIATIONS)
    lags, q = {}, numpy.empty((len(times), len(content["variables"])))
    for v in content["variables"]:
        lags[v["track"]] = min(lags.get(v["track"], numpy.inf), v["lag"])
    punctual = places(content, times, random)
    starts = [content["start"], *(p[-1] for p in content["pieces"])]
    for track, lag in lags.items():
        off = lag * numpy.where(random.random(len(times)) < 0.7, random.choice([-1, 1], len(times)), random.uniform(-1, 1, len(times)))
        piece, s = places(content, times + off, random) if lag > 0 else punctual
        columns = [j for j, v in enumerate(content["variables"]) if v["track"] == track]
        for k in numpy.unique(piece):
            rows = numpy.flatnonzero(piece == k)
            q[numpy.ix_(rows, columns)] = bezier([[p[j] for j in columns] for p in (starts[k], *content["pieces"][k])], s[rows][:, None])
    return q, times


def states_of(content, rng):
    """[states][variables]: times of all pieces, and at each some deviations, most of them at a corner of the tolerances."""
    last, found = content["start"], []
    random = numpy.random.default_rng(rng.randrange(1 << 30))
    tolerance = numpy.array([v["tolerance"] for v in content["variables"]])
    deviates = tolerance.any() or any(v["spread"] for v in content["variables"])

    def deviated(q, times):
        off = random.uniform(-1, 1, q.shape)
        return q + (tolerance + spread_of(content, times)) * numpy.where(random.random(q.shape) < 0.7, numpy.sign(off), off)

    begin = content["begin"]
    for seconds, piece in zip(content["seconds"], content["pieces"]):
        s = numpy.linspace(0, 1, TIMES)
        q = bezier([last, *piece], s[:, None])
        last = piece[-1]
        found += [q] + [deviated(q, begin + s * seconds) for _ in range(DEVIATIONS if deviates else 0)]
        begin += seconds
    if any(v["lag"] for v in content["variables"]):
        q, times = late_states(content, random)
        found += [q, deviated(q, times)]
    return numpy.concatenate(found)


class Side:
    """A body or an obstacle: its shape, and a sphere around it."""

    def __init__(self, shape, placed):
        self.shape, self.less = shape
        self.owner, self.pose = placed["owner"], matrix_of(placed["pose"])
        low, high = numpy.clip(self.shape.bounds, -1e9, 1e9)
        self.middle, self.half = numpy.append((low + high) / 2, 1), (high - low) / 2 + self.less
        self.radius = float(numpy.linalg.norm(high - low) / 2) + self.less

    def at(self, poses):
        """[states] poses and middles."""
        world = (poses[self.owner] if poses else numpy.eye(4)[None]) @ self.pose
        return world, world @ self.middle


def near_states(a, b, need):
    """States in which two sides may be nearer: by the spheres around them, and then along the axes of the boxes around them."""
    (side_a, world_a, middle_a), (side_b, world_b, middle_b) = a, b
    way = (middle_b - middle_a)[:, :3]
    near = numpy.flatnonzero((way * way).sum(axis=1) < (side_a.radius + side_b.radius + need) ** 2)
    if len(near) == 0:
        return near
    way, turn_a, turn_b = way[near], *((w[near] if len(w) > 1 else w)[:, :3, :3] for w in (world_a, world_b))
    turn = numpy.abs(numpy.swapaxes(turn_a, 1, 2) @ turn_b)
    along_a, along_b = (numpy.abs((way[:, :, None] * t).sum(axis=1)) for t in (turn_a, turn_b))
    gaps = numpy.maximum((along_a - side_a.half - turn @ side_b.half).max(axis=1), (along_b - side_b.half - side_a.half @ turn).max(axis=1))
    return near[gaps < need + ROUNDING]


def contradiction(content, rng):
    """A sentence about a pair that is nearer than the certificate claims; None if the samples know none."""
    shapes = [shape_of(s) for s in content["shapes"]]
    states = states_of(content, rng)
    poses = poses_of(content, states)
    places = {}
    for placed, moves in [(p, True) for p in content["bodies"]] + [(p, False) for p in content["obstacles"]]:
        side = Side(shapes[placed["shape"]], placed)
        places[id(placed)] = (side, *side.at(poses if moves else None))
    for a, b, _, margin in pairs_of(content):
        (side_a, world_a, _), (side_b, world_b, _), need = places[id(a)], places[id(b)], max(TOUCH, content["min_d"] + margin - ROUNDING)
        for i in near_states(places[id(a)], places[id(b)], need):
            found = leeway.distance(side_a.shape, world_a[i], side_b.shape, world_b[i if len(world_b) > 1 else 0])
            if found.upper - side_a.less - side_b.less < need:
                return f"body of link {a['owner']} and that of {b['owner']} are {found.upper:.9g} apart at {states[i].tolist()}"
    return None
