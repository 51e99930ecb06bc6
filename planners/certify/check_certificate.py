#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks a certificate of free motions. No code of leeway, nothing but Python's standard library.

    check_certificate.py [--file robot.urdf] [--pairs] [--json] certificate.lwc

Exit status 0: accepted. 1: rejected; the line names the piece, the pair, the window and the reason. 2: the file is damaged.

Accepted means: at every time of the motion, and for every deviation within the stated tolerances, the distance of every pair of
shapes that is not listed as allowed exceeds min_d plus the pair's margin. FORMAT.md has the format and the proof of each test.
Trusted: this program, Python and its sines and cosines (to 1e-14); that the numbers in the file describe the robot and its
surroundings; that allowed pairs may touch. --pairs lists the latter. --json prints the content for people and other programs;
a file of that form is checked like the binary one.
"""
import argparse
import hashlib
import json
import math
import struct
import sys

TRIANGLES, BALLS, BOXES, CYLINDER, CAPSULE, CONE, HALFSPACE, PLANE = range(1, 9)
HALVE_TIME, SPHERES, PLANE8, PLANE16, PLANE32, HALVE_A, HALVE_B = range(7)
FIXED, TURN, SHIFT = range(3)
INFINITE = math.inf

class Damaged(Exception):
    """The file is not of the form that FORMAT.md describes."""
class Rejected(Exception):
    """A claim does not follow."""
def need(good, why):
    if not good:
        raise Damaged(why)

# ---- vectors are tuples of three numbers; a pose is (columns of its rotation, shift)

def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])
def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])
def scaled(s, a):
    return (s * a[0], s * a[1], s * a[2])
def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])
def norm(a):
    return math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
def turned(pose, v):
    (a, b, c), (x, y, z) = pose[0], v
    return (a[0] * x + b[0] * y + c[0] * z, a[1] * x + b[1] * y + c[1] * z, a[2] * x + b[2] * y + c[2] * z)
def turned_back(pose, v):
    return (dot(pose[0][0], v), dot(pose[0][1], v), dot(pose[0][2], v))
def placed(pose, v):
    return add(turned(pose, v), pose[1])
def product(a, b):
    return ((turned(a, b[0][0]), turned(a, b[0][1]), turned(a, b[0][2])), placed(a, b[1]))
def pose_of(numbers):
    """From x, y, z and a quaternion x, y, z, w of any length."""
    size = math.sqrt(sum(v * v for v in numbers[3:]))
    need(0.1 <= size <= 4, "a quaternion is too short or too long")
    x, y, z, w = (v / size for v in numbers[3:])
    columns = ((1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
        (2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
        (2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)))
    return (columns, tuple(numbers[:3]))

# ---- from bytes to the content, which is also the JSON form

class Reader:
    def __init__(self, data):
        self.data, self.at = data, 0
    def take(self, size):
        need(self.at + size <= len(self.data), "it ends too early")
        self.at += size
        return self.data[self.at - size:self.at]
    def byte(self):
        return self.take(1)[0]
    def count(self):
        value = 0
        for shift in range(0, 35, 7):
            b = self.byte()
            value |= (b & 127) << shift
            if b < 128:
                need(value <= 0x7fffffff, "a count is too large")
                return value
        raise Damaged("a count is too large")
    def count_of(self, least_bytes):
        n = self.count()
        need(n <= (len(self.data) - self.at) // least_bytes, "it ends too early")
        return n
    def words(self):
        return self.take(self.count()).decode("utf-8", "replace")
    def reals(self, n, form="d"):
        return list(struct.unpack(f"<{n}{form}", self.take(n * (8 if form == "d" else 4))))
    def real(self):
        return self.reals(1)[0]
    def digest(self):
        wanted = hashlib.sha256(self.data[:self.at]).hexdigest()
        need(self.take(32).hex() == wanted, "a SHA-256 does not fit")
        return wanted
    def link(self):
        link = {"name": self.words(), "joint": self.words(), "parent": self.count(), "origin": self.reals(7), "type": self.byte()}
        if link["type"] != FIXED:
            link["axis"] = self.reals(3)
            variable = self.count()
            link["variable"] = variable - 1 if variable else None
            link["multiplier"], link["offset"] = self.reals(2)
        return link
    def shape(self):
        shape = {"source": self.words(), "kind": self.byte()}
        flags = self.byte()
        need(flags <= 3, "unknown flags of a shape")
        shape["solid"] = bool(flags & 2)
        shape["radius"], shape["height"] = self.reals(2)
        shape["numbers"] = self.reals(self.count_of(4 if flags & 1 else 8), "f" if flags & 1 else "d")
        shape["corners"] = [self.count() for _ in range(self.count_of(1))]
        return shape
    def placed(self):
        return [{"owner": self.count(), "shape": self.count(), "pose": self.reals(7)} for _ in range(self.count_of(58))]
    def rules(self, with_value):
        return [{"object": self.byte(), "a": self.count(), "b": self.count(),
            ("margin" if with_value else "reason"): self.real() if with_value else self.words()} for _ in range(self.count_of(4))]
    def model(self):
        need(self.take(8) == b"LWCERT2\n", "it is no certificate of version 2")
        model = {"version": 2, "claims": self.byte()}
        model["variables"] = [dict(zip(("name", "lower", "upper"), [self.words()] + self.reals(2))) for _ in range(self.count_of(17))]
        model["links"] = [self.link() for _ in range(self.count_of(60))]
        model["shapes"] = [self.shape() for _ in range(self.count_of(20))]
        model["bodies"] = self.placed()
        model["objects"] = [self.words() for _ in range(self.count_of(1))]
        model["obstacles"] = self.placed()
        model["allowed"] = self.rules(False)
        model["margins"] = self.rules(True)
        model["model_sha256"] = self.digest()
        return model
    def content(self):
        """All of it; the proof stays as bytes."""
        model = self.model()
        variables = len(model["variables"])
        model["min_d"] = self.real()
        model["sources"] = [{"name": self.words(), "sha256": self.take(32).hex()} for _ in range(self.count_of(33))]
        for variable in model["variables"]:
            variable.update(zip(("track", "tolerance", "lag", "spread", "since"), [self.count()] + self.reals(4)))
        model["begin"] = self.real()
        pieces = self.count_of(17)
        model["start"], model["seconds"], model["pieces"] = self.reals(variables), [], []
        for _ in range(pieces):
            degree = self.byte()
            need(1 <= degree <= 7, "a degree is not 1 to 7")
            model["seconds"].append(self.real())
            model["pieces"].append([self.reals(variables) for _ in range(degree)])
        need(len(self.data) - self.at >= 32, "it ends too early")
        model["proof"] = self.take(len(self.data) - self.at - 32).hex()
        self.digest()
        return model

# ---- shapes: convex elements, and a tree of halves of their index range

class Shape:
    def __init__(self, given):
        self.kind, self.solid, self.radius, self.height = given["kind"], given["solid"], given["radius"], given["height"]
        numbers, corners = given["numbers"], given["corners"]
        need(TRIANGLES <= self.kind <= PLANE, "an unknown kind of shape")
        need(0 <= self.radius <= 1e6 and 0 <= self.height <= 1e6 and all(abs(v) <= 1e6 for v in numbers), "a number is out of its range")
        wide = {BALLS: 4, BOXES: 6}.get(self.kind, 3)
        need(len(numbers) % wide == 0 and len(corners) % 3 == 0 and (not corners or self.kind == TRIANGLES) and (not numbers or self.kind <= BOXES),
            "a shape is not as its kind demands")
        self.unbounded = self.kind in (HALFSPACE, PLANE)
        rows = [tuple(numbers[i:i + wide]) for i in range(0, len(numbers), wide)]
        if self.kind == TRIANGLES:
            need(all(0 <= c < len(rows) for c in corners), "an index is too large")
            self.elements = [(rows[corners[i]], rows[corners[i + 1]], rows[corners[i + 2]]) for i in range(0, len(corners), 3)]
        else:
            self.elements = rows if self.kind <= BOXES else [()]
        need(len(self.elements) > 0, "a shape has no elements")
        need(self.kind != BALLS or all(e[3] >= 0 for e in rows), "a negative radius")
        need(self.kind != BOXES or all(e[k] <= e[k + 3] for e in rows for k in range(3)), "a box is inside out")
        if not self.unbounded:
            self.ranges = []  # (begin, end, middle, half, radius, index of the second half)
            self.divide(0, len(self.elements))
            first = self.ranges[0]
            whole = max(self.element_radius(e, first[2]) for e in self.elements)
            self.ranges[0] = first[:4] + (min(first[4], whole), first[5])

    def element_support(self, e, n, size):
        """Height of the farthest point of an element in direction n, whose length is `size`."""
        if self.kind == TRIANGLES:
            return max(dot(e[0], n), dot(e[1], n), dot(e[2], n)) + self.radius * size
        if self.kind == BALLS:
            return dot(e, n) + e[3] * size
        if self.kind == BOXES:
            return sum(max(e[k] * n[k], e[k + 3] * n[k]) for k in range(3))
        up, flat = abs(n[2]) * self.height / 2, math.hypot(n[0], n[1])
        if self.kind == CYLINDER:
            return up + self.radius * flat
        if self.kind == CAPSULE:
            return up + self.radius * size
        return max(n[2] * self.height / 2, -n[2] * self.height / 2 + self.radius * flat)

    def element_radius(self, e, middle):
        """Radius of a sphere around `middle` that contains an element."""
        if self.kind == TRIANGLES:
            return self.radius + max(norm(sub(v, middle)) for v in e)
        if self.kind == BALLS:
            return norm(sub(e, middle)) + e[3]
        if self.kind == BOXES:
            return norm(sub(scaled(0.5, add(e[:3], e[3:])), middle)) + norm(scaled(0.5, sub(e[3:], e[:3])))
        return norm(middle) + (self.height / 2 + self.radius if self.kind == CAPSULE else math.hypot(self.radius, self.height / 2))

    def divide(self, begin, end):
        place = len(self.ranges)
        self.ranges.append(None)
        if end - begin == 1:
            e = self.elements[begin]
            high = tuple(self.element_support(e, n, 1) for n in ((1, 0, 0), (0, 1, 0), (0, 0, 1)))
            low = tuple(-self.element_support(e, n, 1) for n in ((-1, 0, 0), (0, -1, 0), (0, 0, -1)))
            middle = scaled(0.5, add(low, high))
            self.ranges[place] = (begin, end, middle, scaled(0.5, sub(high, low)), self.element_radius(e, middle), None)
            return
        cut = begin + (end - begin) // 2
        self.divide(begin, cut)
        second = len(self.ranges)
        self.divide(cut, end)
        a, b = self.ranges[place + 1], self.ranges[second]
        low = tuple(min(a[2][k] - a[3][k], b[2][k] - b[3][k]) for k in range(3))
        high = tuple(max(a[2][k] + a[3][k], b[2][k] + b[3][k]) for k in range(3))
        middle, half = scaled(0.5, add(low, high)), scaled(0.5, sub(high, low))
        radius = min(norm(half), max(norm(sub(a[2], middle)) + a[4], norm(sub(b[2], middle)) + b[4]))
        self.ranges[place] = (begin, end, middle, half, radius, second)

    def support(self, place, n):
        """The greatest height of a range's points in direction n: branch and bound over the boxes."""
        x, y, z = n
        ax, ay, az, size = abs(x), abs(y), abs(z), norm(n)
        ranges, best, todo = self.ranges, -INFINITE, [(INFINITE, place)]
        while todo:
            bound, i = todo.pop()
            if bound <= best:
                continue
            r = ranges[i]
            if r[5] is None:
                best = max(best, self.element_support(self.elements[r[0]], n, size))
                continue
            sides = []
            for j in (i + 1, r[5]):
                m, h = ranges[j][2], ranges[j][3]
                sides.append((m[0] * x + m[1] * y + m[2] * z + ax * h[0] + ay * h[1] + az * h[2], j))
            sides.sort()
            todo += sides  # the higher box is opened first
        return best

# ---- the model

class Link:
    def __init__(self, given, number, links, variables):
        self.name, self.parent, self.type = given["name"], given["parent"], given["type"]
        need(0 <= self.parent < max(number, 1), "a parent is not before its link")
        need(FIXED <= self.type <= (SHIFT if number else FIXED), "an unknown type of joint")
        self.depth = links[self.parent].depth + 1 if number else 0
        need(self.depth <= 100, "a chain of more than 100 joints")
        self.origin = pose_of(finite(given["origin"], 1e6))
        self.variable, self.multiplier, self.offset, self.axis = None, 0.0, 0.0, (0.0, 0.0, 1.0)
        if self.type != FIXED:
            size = norm(finite(given["axis"], 1e6))
            need(size >= 1e-6, "an axis has no length")
            self.axis = scaled(1 / size, given["axis"])
            self.variable = given["variable"]
            self.multiplier, self.offset = finite([given["multiplier"], given["offset"]], 1000)
            need(self.variable is None or 0 <= self.variable < variables, "an index is too large")

    def motion(self, value):
        if self.type == SHIFT:
            return (((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), scaled(value, self.axis))
        c, s, (x, y, z) = math.cos(value), math.sin(value), self.axis
        d = 1 - c
        columns = ((c + d * x * x, d * x * y + s * z, d * x * z - s * y), (d * x * y - s * z, c + d * y * y, d * y * z + s * x),
            (d * x * z + s * y, d * y * z - s * x, c + d * z * z))
        return (columns, (0.0, 0.0, 0.0))

def finite(values, most):
    need(all(abs(v) <= most for v in values), "a number is out of its range")
    return values

class Placed:
    def __init__(self, given, owners, shapes, bounded):
        self.owner, self.pose = given["owner"], pose_of(finite(given["pose"], 1e6))
        need(0 <= self.owner < owners and 0 <= given["shape"] < len(shapes), "an index is too large")
        self.shape = shapes[given["shape"]]
        need(not (bounded and self.shape.unbounded), "a body of the robot is unbounded")

    def extent(self):
        return norm(self.pose[1]) + (0 if self.shape.unbounded else norm(self.shape.ranges[0][2]) + norm(self.shape.ranges[0][3]))

class Pair:
    def __init__(self, a, b, is_object, ancestor, between, distance):
        self.a, self.b, self.is_object, self.ancestor, self.between, self.need = a, b, is_object, ancestor, between, distance
        self.moves, self.late = bool(between), False  # late: variables of several tracks move between them

class Model:
    def __init__(self, content):
        need(content["version"] == 2 and content["claims"] in (1, 2, 3), "an unknown version or claim")
        self.min_d, self.claims = content["min_d"], content["claims"]
        need(0 <= self.min_d <= 1e6, "a number is out of its range")
        self.variables = content["variables"]
        need(len(self.variables) >= 1, "there are no variables")
        for v in self.variables:
            need(0 <= v["tolerance"] <= 1000 and 0 <= v["lag"] <= 1e6 and 0 <= v["spread"] <= 1e6 and abs(v["since"]) <= 1e9, "a tolerance is out of its range")
        self.links = []
        for number, given in enumerate(content["links"]):
            self.links.append(Link(given, number, self.links, len(self.variables)))
        need(self.links, "there are no links")
        shapes = [Shape(given) for given in content["shapes"]]
        self.bodies = [Placed(given, len(self.links), shapes, True) for given in content["bodies"]]
        self.objects = content["objects"]
        self.obstacles = [Placed(given, len(self.objects), shapes, False) for given in content["obstacles"]]
        self.allowed, self.margins = content["allowed"], {}
        for rule in self.allowed + content["margins"]:
            need(rule["object"] in (0, 1) and 0 <= rule["a"] < len(self.links) and
                 0 <= rule["b"] < len(self.objects if rule["object"] else self.links), "an index is too large")
        for rule in content["margins"]:
            need(0 <= rule["margin"] <= 1e6, "a number is out of its range")
            key = self.key(rule["object"], rule["a"], rule["b"])
            self.margins[key] = max(self.margins.get(key, 0), rule["margin"])
        self.free_of_proof = {self.key(rule["object"], rule["a"], rule["b"]) for rule in self.allowed}

    @staticmethod
    def key(is_object, a, b):
        return (1, a, b) if is_object else (0, min(a, b), max(a, b))

    def pairs(self):
        """All that must be proved: bodies with obstacles, then bodies with bodies."""
        if self.claims & 1:
            for a in self.bodies:
                for b in self.obstacles:
                    yield from self.pair(a, b, True)
        if self.claims & 2:
            for i, a in enumerate(self.bodies):
                for b in self.bodies[i + 1:]:
                    yield from self.pair(a, b, False)

    def pair(self, a, b, is_object):
        key = self.key(is_object, a.owner, b.owner)
        if key in self.free_of_proof:
            return
        x, y, between = a.owner, 0 if is_object else b.owner, set()
        while x != y:  # up to the lowest link above both
            x, y = (x, y) if self.links[x].depth >= self.links[y].depth else (y, x)
            between.add(self.links[x].variable)
            x = self.links[x].parent
        between.discard(None)
        if is_object or between:
            yield Pair(a, b, is_object, x, between, self.min_d + self.margins.get(key, 0))

    def rounding(self, points):
        """Metres that cover the rounding of every test: 1e-10 of all lengths. FORMAT.md, "Rounding"."""
        total = 0
        for link in self.links:
            total += norm(link.origin[1])
            if link.type == SHIFT:
                most = 0 if link.variable is None else max(abs(p[link.variable]) for p in points)
                total += abs(link.offset) + abs(link.multiplier) * most
        return 1e-10 * (total + max((b.extent() for b in self.bodies), default=0) + max((b.extent() for b in self.obstacles), default=0))

# ---- windows

def halves(points):
    """De Casteljau at one half."""
    first, second = [points[0]], [points[-1]]
    while len(points) > 1:
        points = [[0.5 * (x + y) for x, y in zip(p, q)] for p, q in zip(points, points[1:])]
        first.append(points[0])
        second.append(points[-1])
    return first, second[::-1]

class Window:
    def __init__(self, model, points, begin, end, tubes):
        self.model, self.points, self.begin, self.end, self.tubes = model, points, begin, end, tubes
        self.parts, self.poses, self.sides = None, [], {}
        middle = halves(points)[0][-1]
        degree = len(points) - 1
        self.speed = [0.5 * (b - a) for a, b in zip(points[0], points[-1])]
        # |value - middle - s speed| <= rest for an s in [-1, 1]
        self.rest = [max(abs(p[j] - middle[j] - (2 * i / degree - 1) * self.speed[j]) for i, p in enumerate(points)) + tubes[0][j]
            for j in range(len(middle))]
        for number, link in enumerate(model.links):
            pose = link.origin
            if link.type != FIXED:
                value = link.offset + (0 if link.variable is None else link.multiplier * middle[link.variable])
                need(abs(value) <= 1000, "a number is out of its range")
                pose = product(pose, link.motion(value))
            self.poses.append(product(self.poses[link.parent], pose) if number else pose)

    def halve(self):
        if self.parts is None:
            middle = 0.5 * (self.begin + self.end)
            need(self.end - self.begin > 1e-15, "a window is too short")
            first, second = halves(self.points)
            self.parts = (Window(self.model, first, self.begin, middle, self.tubes), Window(self.model, second, middle, self.end, self.tubes))
        return self.parts

    def side(self, body, place, on_link, ancestor, late):
        """One side of a pair, and how it moves: pose, middle, radius, turn, shift, rest, path. FORMAT.md, "Motion in a window"."""
        key = (id(body), place, ancestor, late)
        if key in self.sides:
            return self.sides[key]
        pose = product(self.poses[body.owner], body.pose) if on_link else body.pose
        middle, radius = (0, 0, 0), 0
        if not body.shape.unbounded:
            middle, radius = placed(pose, body.shape.ranges[place][2]), body.shape.ranges[place][4]
        turn, shift, rest, path, below, turns = (0, 0, 0), (0, 0, 0), 0, 0, 0, 0
        at = body.owner
        while on_link and at != ancestor:
            link = self.model.links[at]
            if link.variable is not None:
                tube = self.rest[link.variable] + (self.tubes[1][link.variable] if late else 0)
                speed, free = link.multiplier * self.speed[link.variable], abs(link.multiplier) * tube
                e, axis, origin = abs(speed) + free, turned(self.poses[at], link.axis), self.poses[at][1]
                if link.type == SHIFT:
                    shift, rest, path, below = add(shift, scaled(speed, axis)), rest + free, path + e, below + e
                else:
                    centre = norm(cross(axis, sub(middle, origin)))
                    rho = centre + radius
                    turn, shift = add(turn, scaled(speed, axis)), add(shift, scaled(speed, cross(origin, axis)))
                    rest += rho * (free + e * e / 2) + e * below
                    path, below, turns = path + centre * e, below + rho * e, turns + e
            at = link.parent
        if turns > 50:
            rest = path = INFINITE  # the rounding does not cover that
        self.sides[key] = (pose, middle, radius, turn, shift, rest, path)
        return self.sides[key]

class Proof:
    """Reads the words of the proof and repeats their tests."""

    def __init__(self, model, content):
        self.model, self.read, self.windows = model, Reader(bytes.fromhex(content["proof"])), 0
        start = finite(content["start"], 1000)
        self.pieces, last = [], start
        for points in content["pieces"]:
            need(1 <= len(points) <= 7 and all(len(p) == len(start) for p in points), "a piece is not of degree 1 to 7")
            self.pieces.append([last] + [finite(p, 1000) for p in points])
            last = points[-1]
        need(self.pieces and len(start) == len(model.variables) and len(content["seconds"]) == len(self.pieces), "there is no motion")
        self.times = [content["begin"]]
        for seconds in content["seconds"]:
            need(0 <= seconds <= 1e9, "a time is out of its range")
            self.times.append(self.times[-1] + seconds)
        finite(self.times[:1], 1e9)
        self.points = [start] + [p for piece in self.pieces for p in piece[1:]]
        self.rounding = model.rounding(self.points)
        self.number, self.pair = 0, None

    def tubes(self, k):
        """How far each variable may be from piece k, and how much farther beside another track. FORMAT.md, "One clock"."""
        timely, late, times = [], [], self.times
        most = max(v["lag"] for v in self.model.variables)
        for j, v in enumerate(self.model.variables):
            timely.append(v["tolerance"] + v["spread"] * max(0, min(times[k + 1] + most, times[-1]) - v["since"]))
            values, speed = [0], 0
            if v["lag"] > 0:
                near = [i for i in range(len(self.pieces)) if times[i] <= times[k + 1] + v["lag"] + 1e-6 and times[i + 1] >= times[k] - v["lag"] - 1e-6]
                values = [p[j] for i in near for p in self.pieces[i]]
                for i in near:
                    step = max(abs(q[j] - p[j]) for p, q in zip(self.pieces[i], self.pieces[i][1:])) * (len(self.pieces[i]) - 1)
                    if step > 0:
                        speed = max(speed, step / (times[i + 1] - times[i]) if times[i + 1] > times[i] else INFINITE)
            late.append(min(max(values) - min(values), v["lag"] * speed))
        return timely, late

    def demand(self, room, window, test):
        self.windows += 1
        if not room > 0:
            pair, model = self.pair, self.model
            other = (model.objects if pair.is_object else [link.name for link in model.links])[pair.b.owner]
            raise Rejected(f"piece {self.number + 1}, {model.links[pair.a.owner].name} - {other}, t in [{window.begin:g}, {window.end:g}]: "
                f"{test} leaves {room:.3g} m")

    def spheres(self, a, b, window):
        p = self.pair
        pose_a, middle_a, radius_a, _, _, _, path_a = window.side(p.a, a, True, p.ancestor, p.late)
        pose_b, middle_b, radius_b, _, _, _, path_b = window.side(p.b, b, not p.is_object, p.ancestor, p.late)
        gap = norm(sub(middle_b, middle_a))
        if p.b.shape.unbounded:
            gap = dot(pose_b[0][2], sub(middle_a, pose_b[1]))
            gap = abs(gap) if p.b.shape.kind == PLANE else gap
        self.demand(gap - radius_a - radius_b - path_a - path_b - p.need - self.rounding, window, "the distance of two spheres")

    def plane(self, a, b, window, n):
        p = self.pair
        pose_a, _, _, turn_a, shift_a, rest_a, _ = window.side(p.a, a, True, p.ancestor, p.late)
        pose_b, _, _, turn_b, shift_b, rest_b, _ = window.side(p.b, b, not p.is_object, p.ancestor, p.late)
        if p.b.shape.unbounded:  # its own plane, from the side that it may be seen from
            up = pose_b[0][2]
            n = up if p.b.shape.kind == PLANE and dot(n, up) > 0 else scaled(-1, up)
        room = INFINITE
        for s in (-1, 1):
            up = add(n, scaled(s, cross(n, turn_a)))
            down = scaled(-1, add(n, scaled(s, cross(n, turn_b))))
            top = p.a.shape.support(a, turned_back(pose_a, up)) + dot(up, pose_a[1]) + s * dot(n, shift_a)
            bottom = dot(n, pose_b[1])
            if not p.b.shape.unbounded:
                bottom = s * dot(n, shift_b) - p.b.shape.support(b, turned_back(pose_b, down)) - dot(down, pose_b[1])
            room = min(room, bottom - top)
        self.demand(room - rest_a - rest_b - p.need - self.rounding, window, "a separating plane")

    def check(self, a, b, window):
        """The proof of ranges a and b of the pair in a window."""
        word = self.read.byte()
        if word == HALVE_TIME:
            for half in window.halve():
                self.check(a, b, half)
        elif word == SPHERES:
            self.spheres(a, b, window)
        elif word in (PLANE8, PLANE16, PLANE32):
            form, size = {PLANE8: ("<3b", 3), PLANE16: ("<3h", 6), PLANE32: ("<3i", 12)}[word]
            n = struct.unpack(form, self.read.take(size))
            need(any(n), "a direction has no length")
            self.plane(a, b, window, scaled(1 / norm(n), n))
        elif word in (HALVE_A, HALVE_B):
            shape, place = (self.pair.a.shape, a) if word == HALVE_A else (self.pair.b.shape, b)
            need(not shape.unbounded and not shape.solid and shape.ranges[place][5] is not None, "a part is divided that has no parts")
            for half in (place + 1, shape.ranges[place][5]):
                self.check(half if word == HALVE_A else a, half if word == HALVE_B else b, window)
        else:
            raise Damaged("an unknown word")

    def run(self):
        pairs, variables = list(self.model.pairs()), self.model.variables
        moving = {j for j in range(len(variables)) if any(p[j] != self.points[0][j] for p in self.points)}
        for pair in pairs:
            pair.late = len({variables[j]["track"] for j in pair.between & moving}) > 1
        for self.number, points in enumerate(self.pieces):
            window, by_spheres = Window(self.model, points, 0, 1, self.tubes(self.number)), self.read.count()
            for self.pair in pairs:
                if self.number > 0 and not self.pair.moves:
                    continue  # at rest: proved on the first piece
                if by_spheres > 0:
                    by_spheres -= 1
                    self.spheres(0, 0, window)
                    continue
                self.check(0, 0, window)
                by_spheres = self.read.count()
            need(by_spheres == 0, "it counts more pairs than there are")
        need(self.read.at == len(self.read.data), "bytes follow the proof")
        limits = [(v["lower"] - 1e-5, v["upper"] + 1e-5) for v in self.model.variables]
        kept = all(low <= x <= high for p in self.points for x, (low, high) in zip(p, limits))
        claim = {1: "obstacles", 2: "links", 3: "obstacles and links"}[self.model.claims]
        return (f"accepted: {len(self.pieces)} pieces from {self.times[0]:g} to {self.times[-1]:g} s, {len(pairs)} pairs ({claim}), {self.windows} windows; distances > {self.model.min_d:.9g} m; "
            f"joint limits {'kept' if kept else 'exceeded'}; {len(self.model.allowed)} pairs may touch and are not proved")

def content_of(data):
    if data[:1] != b"{":
        return Reader(data).content()
    try:
        return json.loads(data)
    except ValueError as error:
        raise Damaged(f"it is no JSON: {error}") from error

def main():
    parser = argparse.ArgumentParser(description="Checks a certificate of free motions.")
    parser.add_argument("--file", action="append", default=[], help="robot, SRDF, scene or motion: the certificate must have been made from it")
    parser.add_argument("--pairs", action="store_true", help="list the pairs that may touch and are not proved")
    parser.add_argument("--json", action="store_true", help="print the content as JSON, and check nothing but its form")
    parser.add_argument("certificate")
    options = parser.parse_args()
    sys.setrecursionlimit(10000)
    try:
        with open(options.certificate, "rb") as file:
            content = content_of(file.read())
        if options.json:
            json.dump(content, sys.stdout, indent=1)
            return 0
        for name in options.file:
            with open(name, "rb") as file:
                digest = hashlib.sha256(file.read()).hexdigest()
            if digest not in [source["sha256"] for source in content["sources"]]:
                raise Rejected(f"the certificate was not made from {name}")
        model = Model(content)
        print(Proof(model, content).run())
        if options.pairs:
            for rule in model.allowed:
                other = model.objects[rule["b"]] if rule["object"] else model.links[rule["b"]].name
                print(f"not proved: {model.links[rule['a']].name} - {other} ({rule['reason']})")
        return 0
    except Rejected as error:
        print(f"rejected: {error}")
        return 1
    except Damaged as error:
        print(f"damaged: {error}")
    except (OSError, KeyError, TypeError, ValueError, IndexError, OverflowError, RecursionError) as error:
        print(f"damaged: {type(error).__name__}: {error}")
    return 2


if __name__ == "__main__":
    sys.exit(main())
