#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Regions of Drake's IrisZo and IrisNp2 with their default options, judged by leeway referee.

    regions.py make OUT --robot panda.urdf --package panda=FOLDER --problems N FOLDER...     # needs the drake wheel
    regions.py judge OUT --leeway build/bin/leeway --robot panda.urdf --srdf panda.srdf --package panda=FOLDER [--samples 20000]

FOLDER has sceneNNNN.yaml and requestNNNN.yaml of MotionBenchMaker, of boxes, cylinders and spheres. A region is grown around each request's goal, against
obstacles alone. `judge` compares with many random states of each region: the share of regions in which the referee finds a collision of those in which
the states find one."""
import argparse
import csv
import json
import pathlib
import subprocess
import time

import numpy
import yaml


def goal_of(request):
    joints = yaml.safe_load(request.read_text())["goal_constraints"][0]["joint_constraints"]
    return {j["joint_name"]: j["position"] for j in joints}


def checker_of(robot, package, scene):
    from pydrake.common.eigen_geometry import Quaternion
    from pydrake.geometry import Box, CollisionFilterDeclaration, Cylinder, GeometrySet, Sphere
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import CoulombFriction
    from pydrake.planning import RobotDiagramBuilder, SceneGraphCollisionChecker
    builder = RobotDiagramBuilder(time_step=0.0)
    name, folder = package.split("=")
    builder.parser().package_map().Add(name, folder)
    model = builder.parser().AddModels(str(robot))[0]
    plant = builder.plant()
    plant.WeldFrames(plant.world_frame(), plant.GetBodyByName("panda_link0").body_frame())
    for one in yaml.safe_load(scene.read_text())["world"]["collision_objects"]:
        for number, (shape, pose) in enumerate(zip(one["primitives"], one["primitive_poses"])):
            d = shape["dimensions"]
            made = {"box": lambda: Box(*d), "cylinder": lambda: Cylinder(d[1], d[0]), "sphere": lambda: Sphere(d[0])}[shape["type"]]()
            x, y, z, w = pose["orientation"]
            q = numpy.array([w, x, y, z]) / numpy.linalg.norm([w, x, y, z])
            plant.RegisterCollisionGeometry(plant.world_body(), RigidTransform(Quaternion(q), pose["position"]), made, f"{one['id']}{number}", CoulombFriction())
    bodies = [plant.get_body(i) for i in plant.GetBodyIndices(model)]
    geometries = GeometrySet([g for b in bodies for g in plant.GetCollisionGeometriesForBody(b)])
    builder.scene_graph().collision_filter_manager().Apply(CollisionFilterDeclaration().ExcludeWithin(geometries))
    plant.Finalize()
    names = [plant.get_joint(i).name() for i in plant.GetJointIndices(model) if plant.get_joint(i).num_positions() == 1]
    limits = plant.GetPositionLowerLimits(), plant.GetPositionUpperLimits()
    diagram = builder.Build()
    return SceneGraphCollisionChecker(model=diagram, robot_model_instances=[model], edge_step_size=0.05), names, limits


def make(given):
    from pydrake.geometry.optimization import HPolyhedron, Hyperellipsoid
    from pydrake.planning import IrisNp2, IrisZo
    given.out.mkdir(exist_ok=True)
    for folder in given.folders:
        for request in sorted(folder.glob("request*.yaml"))[:given.problems]:
            scene = request.with_name(request.name.replace("request", "scene"))
            checker, names, limits = checker_of(given.robot, given.package, scene)
            goal = goal_of(request)
            center = numpy.array([goal[name] for name in names])
            for kind, grow in (("zo", IrisZo), ("np2", IrisNp2)):
                begin = time.perf_counter()
                try:
                    region = grow(checker, Hyperellipsoid.MakeHypersphere(0.01, center), HPolyhedron.MakeBox(*limits))
                except (RuntimeError, ValueError) as error:
                    print(f"{folder.name} {request.name} {kind}: {str(error)[:120]}", flush=True)
                    continue
                file = given.out / f"{folder.name}_{request.stem}_{kind}.json"
                file.write_text(json.dumps({"joint_names": names, "A": region.A().tolist(), "b": region.b().tolist(), "scene": str(scene.resolve())}))
                print(f"{file.name}: {len(region.b())} faces, {time.perf_counter() - begin:.1f} s", flush=True)


def random_states(a, b, inside, count, rng):
    """Hit and run, every fifth state."""
    x, out = inside.copy(), []
    while len(out) < count:
        for _ in range(5):
            d = rng.normal(size=len(x))
            speed, room = a @ d, b - a @ x
            with numpy.errstate(divide="ignore"):
                t = room / speed
            x = x + rng.uniform(t[speed < 0].max(), t[speed > 0].min()) * d
        out.append(x)
    return out


def judge(given):
    rng, rows = numpy.random.default_rng(1), []
    model = ["--robot", given.robot, "--srdf", given.srdf, "--package-path", given.package, "--what", "env"]
    for file in sorted(given.out.glob("*.json")):
        data = json.loads(file.read_text())
        region = given.out / "region.item"
        region.write_text(json.dumps({k: data[k] for k in ("joint_names", "A", "b")}))
        result = given.out / "result.ruling"
        run = subprocess.run([given.leeway, "referee", *model, "--scene", data["scene"], "--item", region, "--json", result, "--search", str(given.search),
            "--prove", str(given.search)], capture_output=True, text=True, check=False)
        if run.returncode == 2:
            raise SystemExit(run.stderr)
        ruling = json.loads(result.read_text())["items"][0]
        request = pathlib.Path(data["scene"].replace("scene0", "request0"))
        inside = numpy.array([goal_of(request)[name] for name in data["joint_names"]])
        table = given.out / "states.table"
        with open(table, "w", newline="", encoding="utf-8") as out:
            writer = csv.writer(out)
            writer.writerow(data["joint_names"])
            writer.writerows(random_states(numpy.array(data["A"]), numpy.array(data["b"]), inside, given.samples, rng))
        answers = given.out / "answers.table"
        subprocess.run([given.leeway, "check", *model, "--scene", data["scene"], "--states", table, "--out", answers, "--max-d", "0.001"], capture_output=True, check=False)
        with open(answers, encoding="utf-8") as text:
            colliding = sum(row["verdict"] == "BLOCKED" for row in csv.DictReader(text))
        rows.append((colliding, ruling["verdict"]))
        depth = [1e3 * d for d in ruling["worst"]["depth"]] if "worst" in ruling else [0, 0]
        print(f"{file.stem}: {colliding} of {given.samples} states collide; referee {ruling['verdict']} after {ruling['seconds']:.3f} s, "
            f"{ruling['region']['states']} states, {depth[0]:.2f} to {depth[1]:.2f} mm deep, proved {100 * ruling['region']['proved_share']:.1f} %", flush=True)
    sampled = [verdict for colliding, verdict in rows if colliding > 0]
    print(f"{len(rows)} regions; random states find a collision in {len(sampled)}, the referee in {sampled.count('BLOCKED')} of these and in "
        f"{sum(v == 'BLOCKED' for _, v in rows)} of all")


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("task", choices=["make", "judge"])
    options.add_argument("out", type=pathlib.Path)
    options.add_argument("--robot", required=True)
    options.add_argument("--srdf")
    options.add_argument("--package", required=True)
    options.add_argument("--leeway")
    options.add_argument("--samples", type=int, default=20000)
    options.add_argument("--search", type=float, default=1)
    options.add_argument("--problems", type=int, default=2)
    options.add_argument("folders", nargs="*", type=pathlib.Path)
    given = options.parse_intermixed_args()
    make(given) if given.task == "make" else judge(given)


if __name__ == "__main__":
    main()
