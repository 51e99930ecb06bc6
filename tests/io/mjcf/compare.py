#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Compares leeway's reading of MJCF models with MuJoCo's: poses of all bodies at random states, shapes, limits, pairs.

    compare.py --poses build/bin/mjcf_poses [--states 100] [--json rows.json] [--table rows.md] [--folder FOLDER]... [MODEL.xml...]

MuJoCo is the package of that name. A row for each model; exit status 1 if one of them differs, or is refused and not named by
--refused. Distances are metres; MuJoCo keeps vertices of meshes as floats, so hulls are compared to 1e-6 of their size.
"""
import argparse
import collections
import json
import pathlib
import subprocess
import sys

import mujoco
import numpy

POSE_LIMIT = 1e-9
TYPES = {"sphere": int(mujoco.mjtGeom.mjGEOM_SPHERE), "capsule": int(mujoco.mjtGeom.mjGEOM_CAPSULE), "cylinder": int(mujoco.mjtGeom.mjGEOM_CYLINDER),
         "box": int(mujoco.mjtGeom.mjGEOM_BOX)}


class Subject:
    """The output of mjcf_poses for a model."""

    def __init__(self, text):
        self.variables, self.links, self.mimics, self.allowed, self.states, self.notices = [], [], {}, {}, [], []
        self.shapes = collections.defaultdict(list)
        lines = iter(text.splitlines())
        for line in lines:
            words = line.split("\t")
            if words[0] == "end":
                break
            if words[0] == "variable":
                self.variables.append((words[1], float(words[2]), float(words[3]), int(words[4])))
            elif words[0] == "mimic":
                self.mimics[words[1]] = (words[2], float(words[3]), float(words[4]))
            elif words[0] == "link":
                self.links.append(words[1])
            elif words[0] == "allowed":
                self.allowed[frozenset(words[1:3])] = words[3]
            elif words[0] == "notice":
                self.notices.append(words[1])
            elif words[0] == "shape":
                kind, *numbers = words[2].split(" ")
                vertices = numpy.array([[float(w) for w in next(lines).split()] for _ in range(int(numbers[3]))])
                self.shapes[words[1]].append((kind, [float(w) for w in numbers[:3]], [float(w) for w in numbers[4:]], vertices))
        self.poses = [[float(w) for w in line.split()] for line in lines]


def run(program, path, states=""):
    result = subprocess.run([program, path], input=states, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        raise ValueError(result.stderr.strip() or f"exit status {result.returncode}")
    return Subject(result.stdout)


def name_of(model, kind, index, fallback):
    return mujoco.mj_id2name(model, kind, index) or fallback


def joint_name(model, joint):
    """Joints without a name have that of their body, those after the first also an underscore for each before."""
    name = name_of(model, mujoco.mjtObj.mjOBJ_JOINT, joint, None)
    if name:
        return name
    body = model.jnt_bodyid[joint]
    before = [j for j in range(model.body_jntadr[body], joint) if not name_of(model, mujoco.mjtObj.mjOBJ_JOINT, j, None)]
    return body_name(model, body) + "/joint" + "_" * len(before)


def body_name(model, body):
    return name_of(model, mujoco.mjtObj.mjOBJ_BODY, body, f"body{body}")


def quaternion_of(angles):
    """w, x, y, z of turns about x, then y, then z."""
    result = numpy.array([1.0, 0, 0, 0])
    for axis, angle in enumerate(angles):
        step = numpy.array([numpy.cos(angle / 2), 0, 0, 0])
        step[1 + axis] = numpy.sin(angle / 2)
        product = numpy.zeros(4)
        mujoco.mju_mulQuat(product, result, step)
        result = product
    return result


def random_states(model, subject, count, rng):
    """Values of leeway's variables, and the same as qpos."""
    names = [v[0] for v in subject.variables]
    index = {name: i for i, name in enumerate(names)}
    for _ in range(count):
        q = numpy.zeros(len(names))
        for i, (_, lower, upper, kind) in enumerate(subject.variables):
            free = kind == 3 or not numpy.isfinite(lower) or not numpy.isfinite(upper)
            q[i] = rng.uniform(-3, 3) if free else rng.uniform(lower, upper)
        qpos = model.qpos0.copy()
        values = {}
        for joint in range(model.njnt):
            name, at = joint_name(model, joint), model.jnt_qposadr[joint]
            if model.jnt_type[joint] == int(mujoco.mjtJoint.mjJNT_FREE):
                first = index[name + "/trans_x"]
                turn = rng.normal(size=4)
                q[first:first + 3] = rng.uniform(-2, 2, 3)
                q[first + 3:first + 7] = turn / numpy.linalg.norm(turn)
                qpos[at:at + 3] = q[first:first + 3]
                qpos[at + 3:at + 7] = q[[first + 6, first + 3, first + 4, first + 5]]
            elif model.jnt_type[joint] == int(mujoco.mjtJoint.mjJNT_BALL):
                qpos[at:at + 4] = quaternion_of([q[index[name + part]] for part in ("_x", "_y", "_z")])
            elif name in index:
                qpos[at] = values[name] = q[index[name]]
        for _ in range(len(subject.mimics) + 1):
            for follower, (driver, multiplier, offset) in subject.mimics.items():
                if driver in values:
                    values[follower] = multiplier * values[driver] + offset
        for joint in range(model.njnt):
            name = joint_name(model, joint)
            if name in subject.mimics:
                qpos[model.jnt_qposadr[joint]] = values[name]
        for row in range(model.neq):
            # a joint that an equality holds at a constant
            if model.eq_type[row] == int(mujoco.mjtEq.mjEQ_JOINT) and model.eq_active0[row]:
                joint = model.eq_obj1id[row]
                if joint_name(model, joint) not in index and joint_name(model, joint) not in subject.mimics:
                    at = model.jnt_qposadr[joint]
                    qpos[at] = model.qpos0[at] + model.eq_data[row, 0]
        yield q, qpos


def compare_poses(model, data, subject, states, worst):
    """Largest difference of a coordinate or matrix entry, over all bodies and states."""
    rows = len(subject.links)
    place = {name: i for i, name in enumerate(subject.links)}
    for k, (_, qpos) in enumerate(states):
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        for body in range(model.nbody):
            pose = subject.poses[k * rows + place[body_name(model, body)]]
            size = max(1, float(numpy.abs(data.xpos[body]).max()))
            worst["pose"] = max(worst["pose"], numpy.abs(data.xmat[body] - pose[:9]).max(),
                                numpy.abs(data.xpos[body] - pose[9:]).max() / size)


def collides(model, geom):
    paired = geom in model.pair_geom1 or geom in model.pair_geom2
    return (model.geom_contype[geom] or model.geom_conaffinity[geom] or paired) and model.geom_type[geom] != int(mujoco.mjtGeom.mjGEOM_PLANE)


def local_frame(model, geom):
    turn = numpy.zeros(9)
    mujoco.mju_quat2Mat(turn, model.geom_quat[geom])
    return turn.reshape(3, 3), model.geom_pos[geom]


DIRECTIONS = numpy.array([[x, y, z] for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z], dtype=float)


def supports(points):
    return (points @ DIRECTIONS.T).max(axis=0)


def compare_shapes(model, subject, worst):
    """Each body's geoms, in order, against the link's shapes. @return a problem, or nothing"""
    compared = 0
    for body in range(model.nbody):
        geoms = [g for g in range(model.ngeom) if model.geom_bodyid[g] == body and collides(model, g)]
        spheres = [g for g in geoms if model.geom_type[g] == int(mujoco.mjtGeom.mjGEOM_SPHERE)]
        shapes = list(subject.shapes[body_name(model, body)])
        if len(spheres) > 1:
            centres = sorted(tuple(model.geom_pos[g]) + (model.geom_size[g][0],) for g in spheres)
            found = [s for s in shapes if s[0] == "spheres"]
            if len(found) != 1 or len(found[0][3]) != len(centres):
                return f"body {body_name(model, body)}: {len(centres)} spheres are not one shape"
            worst["shape"] = max(worst["shape"], numpy.abs(numpy.array(sorted(map(tuple, found[0][3]))) - centres).max())
            shapes.remove(found[0])
            geoms = [g for g in geoms if g not in spheres]
            compared += len(spheres)
        if len(geoms) != len(shapes):
            return f"body {body_name(model, body)}: {len(geoms)} geoms, {len(shapes)} shapes"
        for geom, (kind, dimensions, pose, vertices) in zip(geoms, shapes):
            turn, centre = local_frame(model, geom)
            ours = numpy.array(pose[:9]).reshape(3, 3)
            if kind in TYPES:
                ellipsoid = model.geom_type[geom] == int(mujoco.mjtGeom.mjGEOM_ELLIPSOID) and kind == "sphere"
                if TYPES[kind] != model.geom_type[geom] and not ellipsoid:
                    return f"body {body_name(model, body)}: geom {geom} became a {kind}"
                size = model.geom_size[geom]
                wanted = {"box": 2 * size, "sphere": [size[0], 0, 0]}.get(kind, [size[0], 2 * size[1], 0])
                worst["shape"] = max(worst["shape"], numpy.abs(numpy.array(dimensions) - wanted).max(), numpy.abs(ours - turn).max(),
                                     numpy.abs(numpy.array(pose[9:]) - centre).max())
            else:
                points = vertices[:, :3] @ ours.T + pose[9:]
                compare_mesh(model, geom, points, turn, centre, worst)
            compared += 1
    worst["geoms"] = compared
    return None


def compare_mesh(model, geom, points, turn, centre, worst):
    """Farthest points along 26 directions."""
    kind = model.geom_type[geom]
    if kind == int(mujoco.mjtGeom.mjGEOM_MESH):
        mesh = model.geom_dataid[geom]
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        theirs = model.mesh_vert[first:first + count].astype(float) @ turn.T + centre
        size = max(numpy.abs(theirs).max(), 1e-3)
        worst["hull"] = max(worst["hull"], numpy.abs(supports(points) - supports(theirs)).max() / size)
    elif kind == int(mujoco.mjtGeom.mjGEOM_HFIELD):
        field = model.geom_dataid[geom]
        rows, columns, size = model.hfield_nrow[field], model.hfield_ncol[field], model.hfield_size[field]
        first = model.hfield_adr[field]
        heights = model.hfield_data[first:first + rows * columns].reshape(rows, columns) * size[2]
        x, y = numpy.meshgrid(numpy.linspace(-size[0], size[0], columns), numpy.linspace(-size[1], size[1], rows))
        theirs = numpy.stack([x.ravel(), y.ravel(), heights.ravel()], axis=1) @ turn.T + centre
        farthest = max(numpy.abs(points - p).max(axis=1).min() for p in theirs[::max(1, len(theirs) // 200)])
        worst["hull"] = max(worst["hull"], farthest / numpy.abs(size).max())
    else:
        size = model.geom_size[geom]
        # an ellipsoid reaches |size * d| along d: ours contains it, and exceeds it by less than a hundredth
        wanted = numpy.linalg.norm((DIRECTIONS @ turn) * size, axis=1) + DIRECTIONS @ centre
        excess = (supports(points) - wanted) / size.max()
        worst["inside"] = min(worst["inside"], excess.min())
        worst["excess"] = max(worst["excess"], excess.max())


def pairs_of(model):
    """Pairs of bodies of which MuJoCo checks a pair of geoms in some state."""
    weld = model.body_weldid
    excluded = {(s >> 16, s & 0xffff) for s in model.exclude_signature}
    listed = {frozenset((model.geom_bodyid[a], model.geom_bodyid[b])) for a, b in zip(model.pair_geom1, model.pair_geom2)}
    checked = set()
    by_body = collections.defaultdict(list)
    for geom in range(model.ngeom):
        if collides(model, geom):
            by_body[model.geom_bodyid[geom]].append(geom)
    family = not model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)
    for a in by_body:
        for b in by_body:
            if a >= b or weld[a] == weld[b]:
                continue
            if frozenset((a, b)) in listed:
                checked.add(frozenset((a, b)))
                continue
            above = [weld[model.body_parentid[weld[x]]] for x in (a, b)]
            if family and weld[a] and weld[b] and (above[0] == weld[b] or above[1] == weld[a]):
                continue
            if (a, b) in excluded or (b, a) in excluded:
                continue
            if any(model.geom_contype[g] & model.geom_conaffinity[h] or model.geom_contype[h] & model.geom_conaffinity[g]
                   for g in by_body[a] for h in by_body[b]):
                checked.add(frozenset((a, b)))
    return checked, by_body


def compare_pairs(model, subject):
    checked, by_body = pairs_of(model)
    for a in by_body:
        for b in by_body:
            if a >= b or model.body_weldid[a] == model.body_weldid[b]:
                continue
            names = frozenset((body_name(model, a), body_name(model, b)))
            if (names not in subject.allowed) != (frozenset((a, b)) in checked):
                return f"pair {sorted(names)}: {subject.allowed.get(names, 'checked')}, MuJoCo {'checks' if frozenset((a, b)) in checked else 'does not'}"
    return None


def compare(program, path, count):
    row = {"model": path}
    try:
        model = mujoco.MjModel.from_xml_path(path)
    except ValueError as error:
        row["mujoco"] = str(error).replace("\n", " ")[:200]
        try:
            run(program, path)
            row["result"] = "read by leeway only"
        except ValueError as ours:
            row.update(result="refused by both", reason=str(ours))
        return row
    try:
        subject = run(program, path)
    except ValueError as error:
        row.update(result="refused", reason=str(error))
        return row
    rng = numpy.random.default_rng(1)
    states = list(random_states(model, subject, count, rng))
    subject = run(program, path, "\n".join(" ".join(repr(float(v)) for v in q) for q, _ in states) + "\n")
    worst = {"pose": 0.0, "shape": 0.0, "hull": 0.0, "inside": 0.0, "excess": 0.0, "geoms": 0}
    compare_poses(model, mujoco.MjData(model), subject, states, worst)
    problem = compare_shapes(model, subject, worst) or compare_pairs(model, subject)
    row.update({k: (float(v) if k != "geoms" else v) for k, v in worst.items()}, bodies=model.nbody, joints=model.njnt, notices=len(subject.notices))
    if problem:
        row.update(result="differs", reason=problem)
    elif worst["pose"] > POSE_LIMIT or worst["shape"] > POSE_LIMIT or worst["hull"] > 1e-6 or worst["inside"] < 0 or worst["excess"] > 0.01:
        row.update(result="differs", reason="numbers")
    else:
        row["result"] = "equal"
    return row


def models_in(folder):
    """MJCF files below a folder, by name; parts that only others include are among them."""
    return [str(path) for path in sorted(folder.rglob("*.xml")) if b"<mujoco" in path.read_bytes()]


def as_table(rows):
    """Markdown: a line for each package (the first folder of a name), then one for each model that MuJoCo loads."""
    text = "| package | models | equal | refused | differ | MuJoCo refuses | greatest difference of a pose |\n|---|---|---|---|---|---|---|\n"
    packages = collections.defaultdict(list)
    for row in rows:
        packages[row["model"].split("/")[0]].append(row)
    for package, own in sorted(packages.items()):
        count = collections.Counter(row["result"] for row in own)
        poses = [row["pose"] for row in own if "pose" in row]
        text += f"| {package} | {len(own)} | {count['equal']} | {count['refused']} | {count['differs']} | " \
                f"{count['refused by both'] + count['read by leeway only']} | {f'{max(poses):.1e}' if poses else ''} |\n"
    text += "\n| model | result | bodies | pose | reason |\n|---|---|---|---|---|\n"
    for row in rows:
        if "mujoco" in row:
            continue
        reason = row.get("reason", "").replace(row["model"] + ": ", "").replace("|", "/").replace("\n", " ")
        pose = f"{row['pose']:.1e}" if "pose" in row else ""
        text += f"| {row['model']} | {row['result']} | {row.get('bodies', '')} | {pose} | {reason} |\n"
    return text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poses", required=True, help="the program mjcf_poses")
    parser.add_argument("--states", type=int, default=100)
    parser.add_argument("--json", type=pathlib.Path)
    parser.add_argument("--table", type=pathlib.Path, help="the rows as Markdown")
    parser.add_argument("--folder", type=pathlib.Path, action="append", default=[], help="all models below it; names begin with its own")
    parser.add_argument("--refused", action="append", default=[], help="end of the name of a model that may be refused")
    parser.add_argument("models", nargs="*")
    options = parser.parse_args()
    rows, bad = [], 0
    for folder, path in [(None, path) for path in options.models] + [(folder, path) for folder in options.folder for path in models_in(folder)]:
        row = compare(options.poses, path, options.states)
        for key in ("model", "reason", "mujoco"):
            if folder and key in row:
                row[key] = row[key].replace(f"{folder.parent}/", "")
        rows.append(row)
        expected = row["result"] in ("equal", "refused by both", "read by leeway only") or \
            row["result"] == "refused" and path.endswith(tuple(options.refused))
        bad += not expected
        print(row["result"], row["model"], row.get("reason", row.get("mujoco", "")), f"pose {row['pose']:.1e}" if "pose" in row else "", flush=True)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
    if options.table:
        options.table.write_text(as_table(rows))
    print(collections.Counter(row["result"] for row in rows))
    return 1 if bad or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
