#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""An arm works while a person comes to its desk. A depth camera feeds a live cloud, and in each millisecond of simulated time a guard says
how fast the arm may go. Camera, person and controller are simulated here; the clocks that are printed are real.

    python 07_live.py [OUT.png]

Each cycle asks two questions. Is the rest of the motion proved, beside the desk and everything in the camera's map? And how fast may the arm go beside
somebody who moves at up to 1.6 m/s? At the end dense points of the links are compared with the true person and the true desk: the arm touches nothing, and
comes nearer than PROMISED to the person only while it stands. The same drive without guard runs into the hand.
"""
import pathlib
import sys
import time

import matplotlib.pyplot as plt
import numpy

import leeway

CYCLE, FRAME, LATENCY = 0.001, 0.033, 0.030  # seconds: of the controller, between frames, from a frame to the map
WALKING, PROMISED = 1.6, 0.10  # m/s of people at most; metres that a moving arm keeps
REACTION, BRAKING, SPEEDING = 0.02, 4.0, 1.0  # seconds; scale of the speed per second, down and up
FOCAL, WIDTH, HEIGHT = 100.0, 240, 140  # pixels
CAMERA = numpy.eye(4)  # behind the arm, 1.2 m above the desk; x right, y down, z forward
CAMERA[:3, :3] = numpy.array([[0, -1, 0], [-0.6, 0, -0.8], [0.8, 0, -0.6]]).T
CAMERA[:3, 3] = -0.35, 0, 1.2

first = pathlib.Path(__file__).resolve().parents[1] / "first"
robot = leeway.Robot(first / "arm.urdf", first / "arm.srdf")
DESK = [("desk", leeway.Shape.box(1.2, 1.6, 0.04), [0.3, 0, -0.02]), ("mug", leeway.Shape.cylinder(0.04, 0.1), [0.35, -0.44, 0.05])]


# ---- the person: a body, a head and an arm, as (end, end, radius)

# at the desk, over the mug, on towards the arm, back, on along the desk
TIMES = [0.0, 0.8, 1.6, 2.2, 3.4, 4.0, 6.0, 99]
BODY_Y = [-1.9, -1.1, -0.4, -0.4, -0.4, -0.4, 1.6, 1.6]
HAND = [[1.0, -1.9, -0.2], [1.0, -1.1, -0.2], [0.45, -0.38, 0.24], [0.45, -0.38, 0.24], [0.45, -0.15, 0.24], [1.0, -0.4, -0.2], [1.0, 1.6, -0.2],
        [1.0, 1.6, -0.2]]


def person(now):
    y = numpy.interp(now, TIMES, BODY_Y)
    hand = numpy.array([numpy.interp(now, TIMES, row) for row in zip(*HAND)])
    return [(numpy.array([1.15, y, -0.7]), numpy.array([1.15, y, 0.5]), 0.17), (numpy.array([1.15, y, 0.7]), numpy.array([1.15, y, 0.75]), 0.12),
            (numpy.array([1.08, y + 0.1, 0.45]), hand, 0.05)]


# ---- the camera: rays against boxes, cylinders and capsules

def roots(a, b, c):
    """Where a t^2 + 2 b t + c <= 0 begins and ends; NaN: nowhere."""
    root = numpy.sqrt(b * b - a * c)
    return (-b - root) / a, (-b + root) / a


def depth_of_shape(shape, pose, rays):
    half, inside = shape.bounds[1], pose[:3, :3].T
    o, d = inside @ (CAMERA[:3, 3] - pose[:3, 3]), rays @ inside.T
    middle, width = -o / d, abs(half / d)  # between the two planes of each axis
    sides = [(middle[:, k] - width[:, k], middle[:, k] + width[:, k]) for k in range(3)]
    if shape.type == "cylinder":
        sides[:2] = [roots(d[:, 0]**2 + d[:, 1]**2, d[:, :2] @ o[:2], o[:2] @ o[:2] - half[0]**2)]
    enter, leave = sides[0]
    for begin, end in sides[1:]:
        enter, leave = numpy.maximum(enter, begin), numpy.minimum(leave, end)
    return numpy.where((enter <= leave) & (enter > 0), enter, numpy.inf)


def depth_of_capsule(p, q, radius, rays):
    axis, best = q - p, numpy.full(len(rays), numpy.inf)
    squares, along = (rays**2).sum(1), rays @ axis
    for end in (p, q):
        o = CAMERA[:3, 3] - end
        t = roots(squares, rays @ o, o @ o - radius**2)[0]
        best = numpy.where(t > 0, numpy.fmin(best, t), best)
    o, length = CAMERA[:3, 3] - p, axis @ axis
    t = roots(length * squares - along**2, length * (rays @ o) - (axis @ o) * along, length * (o @ o - radius**2) - (axis @ o)**2)[0]
    at = axis @ o + t * along
    return numpy.where((t > 0) & (at > 0) & (at < length), numpy.fmin(best, t), best)


v, u = numpy.mgrid[:HEIGHT, :WIDTH]
RAYS = numpy.stack([(u - (WIDTH - 1) / 2) / FOCAL, (v - (HEIGHT - 1) / 2) / FOCAL, numpy.ones(u.shape)], axis=-1).reshape(-1, 3) @ CAMERA[:3, :3].T


def place(at):
    pose = numpy.eye(4)
    pose[:3, 3] = at
    return pose


def image(people, links, noise):
    """Depths in metres, float32; infinite where nothing is."""
    with numpy.errstate(invalid="ignore", divide="ignore"):
        depths = [depth_of_shape(shape, place(at), RAYS) for _, shape, at in DESK]
        depths += [depth_of_shape(shape, links[i] @ pose, RAYS) for i, link in enumerate(robot.links) for shape, pose in robot.collision.get(link, [])]
        depths += [depth_of_capsule(*capsule, RAYS) for capsule in people]
        z = numpy.min(depths, axis=0)
    return (z + noise.normal(0, 0.002, z.shape)).astype(numpy.float32).reshape(HEIGHT, WIDTH)


# ---- the motion: left and right over the desk, twice, with cubic pieces as a ROS controller drives them

ends = [numpy.array([robot.group_states["arm", name][joint][0] for joint in ("yaw", "shoulder", "elbow", "wrist")]) for name in ("left", "right")]
ends[0][1:] = ends[1][1:] = 1.0, 0.7, 0.3
x = numpy.linspace(0, 1, 41)
s, ds = x**3 * (10 - 15 * x + 6 * x * x), 30 * x**2 * (1 - x)**2 / 2.0  # 2 s each way, without a jerk
ways = [(ends[i % 2], ends[(i + 1) % 2]) for i in range(4)]
times = numpy.concatenate([[0]] + [2.0 * (i + x[1:]) for i in range(4)])
positions = numpy.vstack([ends[0]] + [a + s[1:, None] * (b - a) for a, b in ways])
velocities = numpy.vstack([0 * ends[0]] + [ds[1:, None] * (b - a) for a, b in ways])


def state(at):
    i = min(max(int(numpy.searchsorted(times, at, "right")) - 1, 0), len(times) - 2)
    h = times[i + 1] - times[i]
    t = (at - times[i]) / h
    return ((2 * t**3 - 3 * t**2 + 1) * positions[i] + (t**3 - 2 * t**2 + t) * h * velocities[i]
            + (3 * t**2 - 2 * t**3) * positions[i + 1] + (t**3 - t**2) * h * velocities[i + 1])


# ---- the guards

class Guarded:
    """The map of the camera, and its guards of the motion."""

    def __init__(self):
        self.world = leeway.World(robot, None, group="arm")
        for name, shape, at in DESK:
            self.world.add(name, shape, at)
        self.world.allow("foot", "desk")
        self.people = leeway.World(robot, None, group="arm")
        # above the mug: desk and mug are known. Within the view, and so near that each voxel has a pixel: people are cleared as they leave.
        # 2 cm cover the noise, and gaps between the pixels
        self.cloud = leeway.Cloud(resolution=0.03, box=[[-0.3, -1.3, 0.12], [1.4, 1.3, 1.2]], sensor_error=0.02, shadow=0.04)
        self.guard = leeway.Guard(self.world.checker, times, positions, velocities, min_d=0.005, spare_shapes=256)
        self.beside = leeway.Guard(self.people.checker, times, positions, velocities, spare_shapes=256)
        self.seen, self.answers, self.took, self.mapping = -numpy.inf, [], [], []

    def see(self, stamp, depths, q):
        begin = time.process_time()
        self.cloud.insert_depth(depths, (FOCAL, FOCAL, (WIDTH - 1) / 2, (HEIGHT - 1) / 2), stamp, pose=CAMERA, far=6.0, trust_far=True,
                                robot=self.world.checker, state=q)
        for world, guard in ((self.world, self.guard), (self.people, self.beside)):
            guard.publish(world.see("cloud", self.cloud), round(stamp * 1e9) + 1)
        self.seen = stamp
        self.mapping.append(time.process_time() - begin)

    def allowed(self, now, at):
        """The largest scale of the speed from which a stop is proved. None before the camera has seen anything."""
        if self.seen < 0:
            return 0.0
        begin = time.process_time()
        rest = self.guard.ask(at, budget=500)
        beside = self.beside.speed(at, now - self.seen, speed=WALKING, intrusion=PROMISED, reaction=REACTION, deceleration=BRAKING, budget=2000)
        self.took.append(time.process_time() - begin)
        self.answers.append(rest.verdict)
        if rest.verdict == leeway.Verdict.FREE:
            return beside.scale
        # scale * REACTION + scale^2 / (2 BRAKING) seconds of the motion pass until the arm stands
        room = max(0.0, rest.proved_until - at)
        return min(beside.scale, BRAKING * (numpy.sqrt(REACTION**2 + 2 * room / BRAKING) - REACTION))


def drive(guarded, seed=1):
    """Rows of time, time on the motion, scale of the speed."""
    noise, rows, flying, picture = numpy.random.default_rng(seed), [], [], None
    now, at, scale = 0.0, 0.0, 0.0
    while at < times[-1] and now < 20:
        if guarded and len(rows) % round(FRAME / CYCLE) == 0:
            q = state(at)
            depths = image(person(now), robot.fk(guarded.world.checker.full_state(q)), noise)
            flying.append((now, depths, q))
            picture = depths if scale < 0.05 and now > 1 and picture is None else picture
        if flying and now >= flying[0][0] + LATENCY:
            guarded.see(*flying.pop(0))
        allowed = guarded.allowed(now, at) if guarded else 1.0
        scale = min(allowed, 1.0, scale + SPEEDING * CYCLE) if scale <= allowed else max(0.0, scale - BRAKING * CYCLE)
        rows.append((now, at, scale))
        now, at = now + CYCLE, at + scale * CYCLE
    return numpy.array(rows), picture


# ---- the judge: points on the moving links, the true person, the true desk

def surface(shape, count=9):
    half, grid = shape.bounds[1], numpy.stack(numpy.meshgrid(*[numpy.linspace(-1, 1, count)] * 3, indexing="ij"), -1).reshape(-1, 3)
    if shape.type == "box":
        return half * grid[abs(grid).max(1) == 1]
    angle, z = numpy.meshgrid(numpy.linspace(0, 2 * numpy.pi, 24), numpy.linspace(-1, 1, 24))
    rim = half * numpy.stack([numpy.cos(angle), numpy.sin(angle), z], -1).reshape(-1, 3)
    return numpy.vstack([rim, rim[abs(rim[:, 2]) == half[2]] * [0.5, 0.5, 1]])


def to_segment(points, p, q):
    along = numpy.clip((points - p) @ (q - p) / ((q - p) @ (q - p)), 0, 1)
    return numpy.linalg.norm(points - p - along[:, None] * (q - p), axis=1)


def to_desk(points):
    """A box and an upright cylinder: distance of points outside, negative inside."""
    best = numpy.inf
    for _, shape, at in DESK:
        p, half = points - at, shape.bounds[1]
        over = (abs(p) - half).T if shape.type == "box" else numpy.stack([numpy.hypot(p[:, 0], p[:, 1]) - half[0], abs(p[:, 2]) - half[2]])
        best = min(best, float((numpy.sqrt((numpy.maximum(over, 0)**2).sum(0)) + numpy.minimum(over.max(0), 0)).min()))
    return best


def distances(rows, full_state):
    """To the person and to the desk, metres, in each row; rounded up by the distance between the sampled points."""
    still = {"foot", "turret"}
    bodies = [(robot.links.index(link), surface(shape) @ pose[:3, :3].T + pose[:3, 3])
              for link in robot.links if link not in still for shape, pose in robot.collision.get(link, [])]
    out = []
    for now, at, _ in rows:
        links = robot.fk(full_state(state(at)))
        points = numpy.vstack([p @ links[i, :3, :3].T + links[i, :3, 3] for i, p in bodies])
        out.append((min(float(to_segment(points, p, q).min()) - r for p, q, r in person(now)), to_desk(points)))
    return numpy.array(out)


guarded = Guarded()
full_state = guarded.world.checker.full_state
rows, picture = drive(guarded)
cycles, stood = len(rows), (rows[:, 2] == 0).sum() * CYCLE
rows, blind_rows = rows[::2], drive(None)[0][::5]  # every 2 and 5 ms
near = distances(rows, full_state)
blind = distances(blind_rows, full_state)
moving = rows[:, 2] > 0
free = sum(verdict == leeway.Verdict.FREE for verdict in guarded.answers)
took, mapping = numpy.array(guarded.took) * 1e6, numpy.array(guarded.mapping) * 1e3
print(f"cycles    {cycles} at 1 kHz: {free} FREE; the motion of {times[-1]:.1f} s took {rows[-1, 0]:.2f} s, of which it stood {stood:.2f} s")
print(f"answers   {numpy.median(took):.0f} us median, {numpy.percentile(took, 99):.0f} us 99 %, both questions")
print(f"frames    {len(mapping)} of {WIDTH * HEIGHT} pixels, {numpy.median(mapping):.1f} ms median into both worlds; {guarded.cloud.info['occupied']} voxels at the end")
print(f"guarded   person {near[moving, 0].min() * 1000:.0f} mm while it moved, {near[:, 0].min() * 1000:.0f} mm at all times; desk {near[:, 1].min() * 1000:.0f} mm")
print(f"unguarded person {blind[:, 0].min() * 1000:.0f} mm at {blind_rows[blind[:, 0].argmin(), 0]:.2f} s")
if rows[-1, 1] < times[-1] - 0.01 or not near[moving, 0].min() >= PROMISED or not near.min() > 0:
    sys.exit("the arm came too near, or never arrived")

out = sys.argv[1] if len(sys.argv) > 1 else "live.png"
figure, plots = plt.subplots(1, 3, figsize=(9, 4), constrained_layout=True)
plots[0].imshow(numpy.clip(picture, 0, 3), cmap="viridis_r")
plots[0].set(title="what the camera sees", xticks=[], yticks=[])
plots[1].plot(rows[:, 0], rows[:, 2], color="steelblue")
plots[1].set(title="speed scale", xlabel="seconds", ylim=(0, 1.05))
plots[2].plot(rows[:, 0], near[:, 0], color="steelblue", label="guarded")
plots[2].plot(blind_rows[:, 0], blind[:, 0], color="firebrick", label="unguarded")
plots[2].axhline(PROMISED, color="gray", linestyle=":")
plots[2].set(title="arm to person, metres", xlabel="seconds", ylim=(-0.2, 1.5))
plots[2].legend()
figure.savefig(out, dpi=64)
print(f"picture: {out}")
