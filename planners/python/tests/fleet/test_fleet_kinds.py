# SPDX-License-Identifier: BSD-3-Clause
"""Kinds of work beside states and edges, generators of scenes, reports."""
import json
import os
import sqlite3
import subprocess
import sys

import numpy
import pytest

import leeway
from conftest import FIRST

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow", "pandas", "matplotlib"):
        pytest.importorskip(name)
import pyarrow.parquet

from leeway.fleet import FleetError, run
from leeway.fleet.files import digest_of_file
from leeway.fleet.manifest import read_manifest, write_manifest
from leeway.fleet.paths import read_paths
from leeway.fleet.plan import parts_of
from leeway.fleet.reporting import frame_of, report

ROBOT = f"""
name = "kinds"
seed = 3
[robots.arm]
urdf = "{FIRST}/arm.urdf"
srdf = "{FIRST}/arm.srdf"
group = "arm"
spheres = "spheres.json"
[scenes.desk]
file = "{FIRST}/scene.yaml"
"""


@pytest.fixture
def campaign(tmp_path):
    """campaign(text) -> (frame of the first part, folder) of a run."""
    def make(text, **options):
        file = tmp_path / "kinds.toml"
        file.write_text(ROBOT + text)
        found = run(file, tmp_path / "out", workers=0, quiet=True, **options)
        assert found.complete, found
        return frame_of(tmp_path / "out", parts_of(read_manifest(tmp_path / "out")[0])[0]), tmp_path / "out"

    return make


@pytest.fixture
def spheres(robot, tmp_path):
    """Spheres of the arm's links that enclose them, but for one link."""
    links = {name: found.spheres.tolist() for name, found in robot.spheres(excess=0.02).items()}
    missing = next(name for name in links if len(links[name]) > 1)
    links[missing] = links[missing][1:]
    (tmp_path / "spheres.json").write_text(json.dumps(links))
    return missing


def test_plans_are_proved_and_looked_at(campaign, checker, spheres):
    frame, folder = campaign('[[work]]\nkind = "plans"\nscenes = ["desk"]\nrows = 6\nplanners = [{name = "a"}, {name = "b", smooth = false}]\n')
    assert len(frame) == 12 and set(frame["outcome"]) == {"SOLVED"} and not frame["contradiction"].any()
    for row in frame.itertuples():
        path = numpy.reshape(row.path, (-1, checker.dof))
        assert checker.path(path).all_free and (path[0] == row.start).all() and (path[-1] == row.goal).all()
        assert row.least > 0 and row.length <= row.raw_length + 1e-12
    lengths = frame.groupby("planner", observed=True)["length"].sum()
    assert len(pyarrow.parquet.read_table(folder / "00-plans-arm")) == 12  # without the files of times
    assert lengths["a"] <= lengths["b"] and frame_of(folder, parts_of(read_manifest(folder)[0])[0], times=True)["seconds"].gt(0).all()


OTHERS = """[[work]]
kind = "plans"
scenes = ["desk"]
rows = 5
most_nodes = 300
planners = [{name = "leeway"}, {name = "connect", algorithm = "RRTConnect"}, {name = "coarse", algorithm = "RRTConnect", motions = "sampled", resolution = 0.3},
    {name = "star", algorithm = "RRTstar", motions = "sampled"}, {name = "bit", algorithm = "BITstar", range = 0.0}]
"""


def test_planners_of_ompl_take_part(campaign, checker, spheres, tmp_path):
    if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
        pytest.importorskip("ompl")
    text = OTHERS.replace("\n    ", " ")
    frame, folder = campaign(text)
    by = frame.set_index(["planner", "problem"])
    assert not frame["contradiction"].any() and (frame["outcome"] == "SOLVED").mean() > 0.7
    for name in ("connect", "bit"):
        solved = by.loc[name][by.loc[name]["outcome"] == "SOLVED"]
        assert len(solved) and solved["proved"].all() and not solved["contact"].any() and (solved["edge_checks"] > 0).all()
    assert (by.loc["coarse"]["edge_checks"] == 0).all() and (by.loc["coarse"]["state_checks"] > 0).all() and (by.loc["star"]["samples"] == 301).all()
    for row in frame[frame["outcome"] == "SOLVED"].itertuples():
        path = numpy.reshape(row.path, (-1, checker.dof))
        assert abs(path[0] - row.start).max() < 1e-9 and abs(path[-1] - row.goal).max() < 1e-9
        assert row.proved == checker.path(path).all_free and row.contact == (row.least <= 0)
    assert read_manifest(folder)[0]["parts"][0]["extra"]["versions"]["ompl"]
    assert report(folder).tables["00 plans, arm"].set_index("planner")["proved"]["leeway"] == 5


def test_plans_of_ompl_do_not_depend_on_plans_before_them(checker, states):
    if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
        pytest.importorskip("ompl")
    from leeway.fleet.planners import OMPL, plan_by_ompl
    free = states[checker.is_free(states, min_d=0.01)]
    for algorithm in OMPL:
        first = [plan_by_ompl(checker, free[k], free[k + 1], 1 + k, algorithm=algorithm, iterations=200) for k in range(3)]
        again = [plan_by_ompl(checker, free[k], free[k + 1], 1 + k, algorithm=algorithm, iterations=200) for k in reversed(range(3))][::-1]
        for a, b in zip(first, again):
            assert (a.path is None) == (b.path is None) and a.samples == b.samples and a.state_checks == b.state_checks, algorithm
            assert a.path is None or (a.path.shape == b.path.shape and (a.path == b.path).all()), algorithm
    astray = plan_by_ompl(checker, free[0], free[1], 1, algorithm="AORRTC", iterations=200)  # OMPL 2.0.1 calls this solved
    assert astray.path is None or abs(astray.path[-1] - free[1]).max() < 1e-9


def test_planners_that_cannot_be_are_refused(campaign, spheres, monkeypatch):
    from leeway.fleet import planners
    for text, message in (('{name = "a", algorithm = "PRM"}', r"planners\[0\].algorithm: is 'PRM'; give one of leeway, RRTConnect"),
            ('{name = "a", motions = "sampled"}', "leeway's planner proves its motions; give an algorithm"),
            ('{name = "a", algorithm = "KPIECE1"}', r"cannot be 'proved' with KPIECE1.*give motions = .sampled"),
            ('{name = "a", algorithm = "FMT", range = 1}', "range: is no option of FMT"),
            ('{name = "a", algorithm = "RRT", optimize_samples = 9}', "is no option of RRT; leave it out"),
            ('{name = "a"}, {name = "a", smooth = false}', "'a' is there twice"), ('"RRTConnect"', r"planners\[0\]: is 'RRTConnect'; give a table")):
        with pytest.raises(FleetError, match=message):
            campaign(f'[[work]]\nkind = "plans"\nscenes = ["desk"]\nplanners = [{text}]\n')
    monkeypatch.setattr(planners, "_version", lambda: None)
    with pytest.raises(FleetError, match="RRT is OMPL's, and its Python package is not there; pip install ompl"):
        campaign('[[work]]\nkind = "plans"\nscenes = ["desk"]\nplanners = [{name = "a", algorithm = "RRT"}]\n')


def write_paths(folder, checker, path):
    """The same path in each format; joints in another order where they are named."""
    names = checker.variables
    order = names[::-1]
    rows = path[:, ::-1]
    times = numpy.arange(len(path), dtype=float)
    with open(folder / "a.csv", "w") as file:
        file.write("note,time," + ",".join(order) + "\n")
        for t, row in zip(times, rows):
            file.write(f"7,{t}," + ",".join(map(repr, row.tolist())) + "\n")
    numpy.save(folder / "b.npy", path)
    numpy.savez(folder / "c.npz", first=path, second=path[::-1])
    numpy.savetxt(folder / "d.txt", path, fmt="%.17g")
    points = [{"positions": row.tolist(), "time_from_start": {"sec": int(t), "nanosec": 500000000}} for t, row in zip(times, rows)]
    (folder / "e.json").write_text(json.dumps({"joint_trajectory": {"joint_names": order, "points": points}}))
    lines = [f"joint_names: [{', '.join(order)}]", "points:"] + [f"  - [{', '.join(map(repr, row.tolist()))}]" for row in rows]
    (folder / "f.yaml").write_text("\n".join(lines) + "\n")


def test_somebodys_paths_are_audited_in_every_format(campaign, checker, states, spheres, tmp_path):
    free = states[checker.is_free(states, min_d=0.01)]
    path = checker.plan(free[0], free[1], min_d=0.005).path
    write_paths(tmp_path, checker, path)
    blocked = numpy.array([free[0], states[~checker.is_free(states)][0], free[1]])
    numpy.save(tmp_path / "z.npy", blocked)
    frame, _ = campaign('[[work]]\nkind = "audit"\nscenes = ["desk"]\nfiles = ["?.csv", "?.np?", "?.txt", "e.json", "f.yaml"]\n')
    assert len(frame) == 8 and not frame["contradiction"].any() and not frame["outside"].any()
    good = frame[frame["file"] != "z.npy"]
    assert (good["verdict"] == int(leeway.Verdict.FREE)).all() and (good["least"] >= 0.004).all() and (good["states"] == len(path)).all()
    numpy.testing.assert_allclose(good["least"], good["least"].iloc[0], atol=1e-4)
    bad = frame[frame["file"] == "z.npy"].iloc[0]
    assert bad["verdict"] == int(leeway.Verdict.BLOCKED) and bad["least"] == 0 and 0 < bad["contact_share"] < 1 and bad["edge"] in (0, 1) and bad["first"]


def test_a_file_of_paths_that_changed_is_refused(checker, states, spheres, tmp_path):
    from leeway.fleet.plan import worlds_of
    from leeway.fleet.worlds import Worlds
    numpy.save(tmp_path / "a.npy", states[:2])
    (tmp_path / "kinds.toml").write_text(ROBOT + '[[work]]\nkind = "audit"\nscenes = ["desk"]\nfiles = ["a.npy"]\n')
    worlds = worlds_of(tmp_path / "kinds.toml")
    assert (worlds.paths("a.npy", checker.variables)[0].positions == states[:2]).all()
    numpy.save(tmp_path / "a.npy", states[2:4])
    with pytest.raises(FleetError, match="a.npy: is another file than the manifest's; put the old file back"):
        Worlds(worlds.plan, tmp_path).paths("a.npy", checker.variables)


def test_faulty_files_of_paths_are_located(checker, tmp_path):
    names = checker.variables
    cases = {"a.csv": ("x,y\n1,2\n", "has no joint"), "b.csv": (",".join(names) + "\n1,2,3,x\n", "is no table of numbers"), "c.txt": ("1 2\n3 4\n", "shape"),
        "d.json": ("{}", "no joint_names"), "e.npy": ("text", "is no array"), "f.bag": ("", "ends in '.bag'"), "g.txt": ("1 2 3 4\n", "fewer than two"),
        "h.txt": ("1 2 3 4\n1 2 nan 4\n", "not finite")}
    for name, (text, message) in cases.items():
        (tmp_path / name).write_text(text)
        with pytest.raises(FleetError, match=f"{name}.*{message}"):
            read_paths(tmp_path / name, names)
    with pytest.raises(FleetError, match="No such file"):
        read_paths(tmp_path / "none.csv", names)


def test_random_trajectories_hold_their_verdicts(campaign, checker, spheres):
    frame, _ = campaign('[[work]]\nkind = "trajectories"\nscenes = ["desk"]\nrows = 60\naudit = 1.0\nlength = 0.6\n')
    free = frame["verdict"] == int(leeway.Verdict.FREE)
    assert 5 < free.sum() < 58 and frame["audited"].all() and not frame["contradiction"].any()
    assert (frame["time"][free] == frame["duration"][free]).all() and (frame["least"][free] > 0).all()
    assert (frame["proved_until"] <= frame["duration"] + 1e-9).all()
    row = frame[~free].iloc[0]
    t = row["times"]
    assert 0 <= row["time"] <= t[-1] and len(row["positions"]) == len(t) * checker.dof


def test_states_of_looks_are_those_that_proofs_mean(checker, states):
    """Hermite's formulas against control points: a piece that is proved apart from its neighbours touches both its ends."""
    from leeway.fleet.paths import PathData
    from leeway.fleet.trajectories import states_at
    q, v, a, t = states[:3], 0.3 * states[3:6], 0.2 * states[6:9], numpy.array([0.0, 0.7, 1.9])
    for path in (PathData("", q, t), PathData("", q, t, v), PathData("", q, t, v, a)):
        assert (abs(states_at(path, t) - q) < 1e-12).all()
        step = 1e-6
        for i, time in enumerate(t[:-1]):
            near = states_at(path, numpy.array([time, time + step, time + 2 * step]))
            if path.velocities is not None:
                numpy.testing.assert_allclose((near[1] - near[0]) / step, v[i], atol=1e-4)
            if path.accelerations is not None:
                numpy.testing.assert_allclose((near[2] - 2 * near[1] + near[0]) / step**2, a[i], atol=1e-2)


def test_timed_files_are_driven(campaign, checker, states, spheres, tmp_path):
    free = states[checker.is_free(states, min_d=0.01)]
    path = checker.plan(free[0], free[1], min_d=0.005).path
    numpy.savez(tmp_path / "night.npz", times=numpy.arange(len(path)), positions=path)
    frame, _ = campaign('[[work]]\nkind = "trajectories"\nscenes = ["desk"]\nfiles = ["night.npz"]\naudit = 1.0\n')
    assert len(frame) == 1 and frame["verdict"][0] == int(leeway.Verdict.FREE) and frame["duration"][0] == len(path) - 1 and frame["least"][0] > 0.004
    numpy.save(tmp_path / "untimed.npy", path)
    with pytest.raises(FleetError, match="no rising times"):
        campaign('[[work]]\nkind = "trajectories"\nscenes = ["desk"]\nfiles = ["untimed.npy"]\n')


def test_spheres_that_miss_a_part_are_named(campaign, spheres):
    frame, _ = campaign('[[work]]\nkind = "spheres"\n')
    bad = frame[~frame["encloses"]]
    assert list(bad["link"]) == [spheres] and bad["uncovered"].iloc[0] > 0
    assert (frame["uncovered"][frame["encloses"]] == 0).all() and (frame["excess"][frame["encloses"]] <= 0.02 + 1e-9).all()


GENERATED = """
[scenes.s]
generator = "shelves"
count = 3
parameters = {distance = [0.2, 0.3]}
[scenes.k]
generator = "kitchen"
count = 3
parameters = {items = 5, distance = [0.3, 0.4]}
[[work]]
kind = "states"
scenes = ["s", "k"]
rows = 300
check = "environment"
"""


def test_generated_scenes_differ_and_repeat(campaign, spheres, tmp_path):
    from leeway.fleet.plan import worlds_of
    from leeway.fleet.worlds import Worlds, scene_digest
    frame, _ = campaign(GENERATED)
    assert frame.groupby("scene")["lower"].apply(lambda x: (x > 0).mean()).between(0.02, 0.998).all()
    plan, base = worlds_of(tmp_path / "kinds.toml").plan, tmp_path
    digests = [[scene_digest(Worlds(plan, base).problem(name, k)[0]) for name in "sk" for k in range(3)] for _ in range(2)]
    assert digests[0] == digests[1] and len(set(digests[0])) == 6
    names = Worlds(plan, base).problem("k", 1)[0].objects
    assert sum(name.startswith("item") for name in names) == 5 and "cupboard board" in names
    assert len(set(frame["second"])) > 8


def test_a_file_names_only_its_own_scenes(spheres, tmp_path):
    """A hundred thousand scenes would fill each file's metadata, and the manifest."""
    (tmp_path / "kinds.toml").write_text(ROBOT.replace('seed = 3', 'seed = 3\nshard_rows = 256') + """[scenes.s]
generator = "shelves"
count = 3
[[work]]
kind = "states"
scenes = ["desk", "s"]
rows = 300
""")
    assert run(tmp_path / "kinds.toml", tmp_path / "out", workers=0, quiet=True).complete
    plan, records = read_manifest(tmp_path / "out")
    assert plan["parts"][0]["scenes"] == [["desk", 1], ["s", 3]] and len(records) == 8
    for record in records.values():
        table = pyarrow.parquet.read_table(tmp_path / "out" / record["file"])
        metadata = json.loads(table.schema.metadata[b"leeway"])
        scenes = [[["desk", 0], ["s", 0], ["s", 1], ["s", 2]][i] for i in table.column("scene").unique().to_pylist()]
        assert metadata["scenes"] == scenes and metadata["first_scene"] == table.column("scene")[0].as_py()


def test_contradictions_are_counted_in_all_rows(campaign, spheres, monkeypatch):
    from leeway.fleet import reporting, tables
    _, folder = campaign('[[work]]\nkind = "edges"\nscenes = ["desk"]\nrows = 64\naudit = 1.0\naudit_step = 0.1\n')
    path = next(folder.rglob("*.parquet"))
    table = pyarrow.parquet.read_table(path)
    lies = pyarrow.array([i == 63 for i in range(64)])
    path.write_bytes(tables.file_of(table.set_column(table.schema.get_field_index("contradiction"), table.schema.field("contradiction"), lies)))
    assert report(folder).faults == {"00-edges-arm/000000.parquet": "its bytes are not the recorded ones"} and report(folder).contradictions == 0
    plan, records = read_manifest(folder)
    records[0]["sha256"] = digest_of_file(path)
    write_manifest(folder, plan, records)
    honest = reporting._frame
    monkeypatch.setattr(reporting, "_frame", lambda *a, most=None, **k: honest(*a, **k).head(most and 10))
    assert report(folder).contradictions == 1


def test_generators_refuse_other_parameters(campaign, spheres):
    for text, message in (("generator = 'cellar'", "give one of shelves"), ("generator = 'shelves'\nparameters = {boards = 'many'}", "give a number or"),
            ("generator = 'kitchen'\nparameters = {wine = 3}", "wine: is no known parameter; known are"),
            ("generator = 'kitchen'\nparameters = {items = [9, 2]}", "give a number or"), ("generator = 'variations'", "variations need scene")):
        with pytest.raises(FleetError, match=message):
            campaign(f"[scenes.x]\n{text}\n[[work]]\nkind = 'states'\nscenes = ['x']\nrows = 5\n")


def test_variations_of_a_problem_are_feasible(campaign, robot, checker, states, spheres, tmp_path):
    free = states[checker.is_free(states, min_d=0.03)]
    start, goal = free[0], free[1]
    joints = [{"joint_name": name, "position": float(value)} for name, value in zip(checker.variables, goal)]
    request = {"start_state": {"joint_state": {"name": checker.variables, "position": start.tolist()}}, "goal_constraints": [{"joint_constraints": joints}]}
    (tmp_path / "request.json").write_text(json.dumps(request))
    frame, folder = campaign(f"""
[scenes.v]
generator = "variations"
count = 4
parameters = {{scene = "{FIRST}/scene.yaml", request = "request.json", robot = "arm", min_d = 0.002}}
[[work]]
kind = "plans"
scenes = ["v"]
rows = 1
""")
    assert len(frame) == 4 and set(frame["outcome"]) == {"SOLVED"}
    assert all((row == start).all() for row in frame["start"]) and all((row == goal).all() for row in frame["goal"])
    from leeway.fleet.plan import worlds_of
    from leeway.fleet.worlds import Worlds
    plan, base = worlds_of(tmp_path / "kinds.toml").plan, tmp_path
    nominal, varied = leeway.Scene(FIRST / "scene.yaml"), Worlds(plan, base).problem("v", 2)[0]
    assert sorted(varied.objects) == sorted(nominal.objects)
    name = nominal.objects[0]
    shift = numpy.abs(varied.shapes(name)[0][1] - nominal.shapes(name)[0][1]).max()
    assert 1e-4 < shift < 0.5 and varied.shapes(name)[0][0].digest == nominal.shapes(name)[0][0].digest
    (folder / "manifest.json").unlink()
    with pytest.raises(AssertionError, match="no feasible variation in 2 tries"):
        campaign((tmp_path / "kinds.toml").read_text().replace(ROBOT, "").replace("min_d = 0.002", "min_d = 3.0, tries = 2"))


def test_goals_of_variations_follow_their_object(campaign, robot, checker, states, spheres, tmp_path):
    free = states[checker.is_free(states, min_d=0.03)]
    joints = [{"joint_name": name, "position": float(value)} for name, value in zip(checker.variables, free[1])]
    request = {"start_state": {"joint_state": {"name": checker.variables, "position": free[0].tolist()}}, "goal_constraints": [{"joint_constraints": joints}]}
    (tmp_path / "request.json").write_text(json.dumps(request))
    frame, _ = campaign(f"""
[scenes.v]
generator = "variations"
count = 3
parameters = {{scene = "{FIRST}/scene.yaml", request = "request.json", robot = "arm", goal_link = "hand", goal_object = "mug", base_turn = 0.3, object_turn = 0.0,
    object_shift = 0.0, base_shift = 0.0}}
[[work]]
kind = "plans"
scenes = ["v"]
rows = 1
""".replace(",\n   ", ","))
    from leeway.fleet.plan import worlds_of
    from leeway.fleet.worlds import Worlds
    plan, base = worlds_of(tmp_path / "kinds.toml").plan, tmp_path
    nominal, place = leeway.Scene(FIRST / "scene.yaml"), robot.links.index("hand")
    before = numpy.linalg.inv(nominal.shapes("mug")[0][1]) @ robot.fk(checker.full_state(free[1]))[place]
    for k in range(3):
        goal = frame["goal"][k]
        after = numpy.linalg.inv(Worlds(plan, base).problem("v", k)[0].shapes("mug")[0][1]) @ robot.fk(checker.full_state(goal))[place]
        numpy.testing.assert_allclose(after, before, atol=2e-3)
        assert abs(goal - free[1]).max() > 1e-3 and frame["outcome"][k] == "SOLVED"


def test_a_scene_that_cannot_be_made_stops_no_other_work(spheres, tmp_path):
    request = {"start_state": {"joint_state": {"name": ["yaw", "shoulder", "elbow", "wrist"], "position": [0.0] * 4}}, "goal_constraints": [{"joint_constraints": []}]}
    (tmp_path / "request.json").write_text(json.dumps(request))
    file = tmp_path / "kinds.toml"
    file.write_text(ROBOT + f"""
[scenes.v]
generator = "variations"
parameters = {{scene = "{FIRST}/scene.yaml", request = "request.json", robot = "arm", min_d = 3.0, tries = 2}}
[[work]]
kind = "states"
scenes = ["v"]
rows = 10
[[work]]
kind = "states"
scenes = []
rows = 10
""")
    found = run(file, tmp_path / "out", workers=0, quiet=True)
    assert found.done == 1 and found.shards == 2 and len(found.failures) == 1 and "no feasible variation" in found.failures[0]


def test_reports_hold_every_part(campaign, spheres, tmp_path):
    _, folder = campaign(GENERATED + """
[[work]]
kind = "edges"
scenes = ["desk"]
rows = 50
audit = 0.5
[[work]]
kind = "plans"
scenes = ["desk"]
rows = 3
[[work]]
kind = "trajectories"
scenes = []
rows = 8
[[work]]
kind = "spheres"
""")
    found = report(folder)
    text = found.page.read_text()
    assert found.contradictions == 0 and len(found.tables) == 5 and text.count("<h2>") == 6 and "data:image/png" in text
    assert found.tables["00 states, arm"]["states"].sum() == 1800 and "content" in text and "p95_ms" in repr(found)


WORLD = """leeway_world: 1
robots:
  - {name: a, robot: arm.urdf, srdf: arm.srdf, motion: swing.yaml}
  - {name: b, robot: arm.urdf, srdf: arm.srdf, base: {position: [AWAY, 0, 0], orientation: [0, 0, 1, 0]}}
objects:
  - {name: crate, shapes: [{type: box, dimensions: [0.1, 0.1, 0.1]}], pose: {position: [0, 3, 0.5]}, motion: [{start: 0, end: 3, position: [0, -3, 3]}]}
"""


def test_schedules_of_world_files_need_no_robots(tmp_path):
    for name in ("arm.urdf", "arm.srdf"):
        (tmp_path / name).write_text((FIRST / name).read_text())
    (tmp_path / "swing.yaml").write_text("joint_names: [shoulder, elbow]\npoints:\n  - {positions: [0, 0.4], time_from_start: 0}\n"
        "  - {positions: [0.9, 0.4], time_from_start: 2}\n")
    for k, away in enumerate((3.0, 0.45)):
        (tmp_path / f"cell{k}.yaml").write_text(WORLD.replace("AWAY", str(away)))
    text = 'name = "worlds"\n[[work]]\nkind = "schedules"\nfiles = ["cell*.yaml"]\ncontact_resolution = 1e-3\n'
    (tmp_path / "c.toml").write_text(text)
    for workers in (0, 2):
        found = run(tmp_path / "c.toml", tmp_path / f"out{workers}", workers=workers, quiet=True)
        assert found.complete, found
    folder = tmp_path / "out0"
    assert read_manifest(folder)[0]["id"] == read_manifest(tmp_path / "out2")[0]["id"]
    frame = frame_of(folder, parts_of(read_manifest(folder)[0])[0])
    for k, row in enumerate(frame.itertuples()):
        world = leeway.TimedWorld(str(tmp_path / f"cell{k}.yaml"))
        expected = world.prove(contact_resolution=1e-3)
        assert row.file == f"cell{k}.yaml" and leeway.Verdict(row.verdict).name == expected["verdict"] and row.end == 3
        assert row.lower == expected["lower_bound"] or row.verdict != 1
    assert list(frame["verdict"]) == [1, 2] and frame["digest"].nunique() == 2
    assert 0 <= frame["time"][1] <= 3 and frame["first"][1].split("/")[0] != frame["second"][1].split("/")[0]
    assert report(folder).tables["00 schedules, worlds"]["FREE"].sum() == 1
    # a motion of another world, by its digest; a world of another plan
    (tmp_path / "swing.yaml").write_text((tmp_path / "swing.yaml").read_text().replace("0.9", "0.8"))
    assert run(tmp_path / "c.toml", tmp_path / "again", workers=0, quiet=True).complete
    other = frame_of(tmp_path / "again", parts_of(read_manifest(tmp_path / "again")[0])[0])
    assert not set(other["digest"]) & set(frame["digest"])
    (tmp_path / "cell1.yaml").write_text(WORLD.replace("AWAY", "0.5"))
    with pytest.raises(FleetError, match="another"):
        run(tmp_path / "c.toml", folder, workers=0, quiet=True)
    for wrong, message in (('[[work]]\nkind = "schedules"\n', "files: is missing; name world files"),
            ('[[work]]\nkind = "schedules"\nfiles = ["cell0.yaml"]\nstart = 2\nend = 1\n', "end: is before start"),
            ('[[work]]\nkind = "states"\n', r"robots: is missing; add a table \[robots.NAME\]"),
            ('[robots.arm]\nurdf = "arm.urdf"\n[[work]]\nkind = "schedules"\nfiles = ["cell0.yaml"]\nrobots = ["arm"]\n', "has robots or scenes, which schedules have in their files")):
        (tmp_path / "c.toml").write_text('name = "worlds"\n' + wrong)
        with pytest.raises(FleetError, match=message):
            run(tmp_path / "c.toml", tmp_path / "wrong", workers=0, quiet=True)


def test_databases_of_planner_arena_hold_the_plans(campaign, spheres, tmp_path):
    from leeway.fleet.arena import write_logs
    frame, folder = campaign('[[work]]\nkind = "plans"\nscenes = ["desk"]\nrows = 5\nplanners = [{name = "a"}, {name = "b"}]\n')
    logs = write_logs(folder, tmp_path / "logs")
    script = os.path.join(os.path.dirname(sys.executable), "ompl_benchmark_statistics")
    if not os.path.exists(script):
        assert os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required"
        pytest.skip("the package ompl is not there")
    subprocess.run([sys.executable, script, *logs, "-d", tmp_path / "plans.db"], check=True, capture_output=True)
    with sqlite3.connect(tmp_path / "plans.db") as database:
        rows = database.execute("select solved, solution_length from runs order by solution_length").fetchall()
    assert len(rows) == 10 and all(solved for solved, _ in rows)
    numpy.testing.assert_allclose([length for _, length in rows], sorted(frame["length"]), rtol=1e-6)
