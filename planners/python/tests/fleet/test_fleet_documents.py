# SPDX-License-Identifier: BSD-3-Clause
"""Files of others: a key that is there twice is named by both places; a pipe, a device or a folder is refused and not waited for; nothing is dropped."""
import json
import os
import pathlib
import signal
import zipfile

import numpy
import pytest

import leeway
from conftest import FIRST

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow", "yaml"):
        pytest.importorskip(name)
from leeway.fleet import FleetError
from leeway.fleet.campaign import load_campaign
from leeway.fleet.plan import worlds_of
from leeway.fleet.paths import read_group, read_joints, read_paths, read_states
from leeway.fleet.registry import KINDS
from leeway.fleet.spheres import read_spheres

JOINTS = ["x", "y"]


def paths(file):
    return read_paths(file, JOINTS)


def campaign(file):
    return load_campaign(file, KINDS)


def joints(file):
    return read_joints(file, "request", JOINTS)


def worlds(file, what):
    """A campaign of which one file is this one."""
    entries = {"urdf": FIRST / "arm.urdf", "srdf": FIRST / "arm.srdf", "scene": FIRST / "scene.yaml", what: file}
    text = (f'name = "a"\n[robots.a]\nurdf = "{entries["urdf"]}"\nsrdf = "{entries["srdf"]}"\n[scenes.s]\nfile = "{entries["scene"]}"\n'
        '[[work]]\nkind = "states"\nscenes = ["s"]\n')
    (file.parent / "c.toml").write_text(text)
    return worlds_of(file.parent / "c.toml")


POINTS = '"points": [{"positions": [0, 1]}, {"positions": [1, 1]}]'
START = '"start_state": {"joint_state": {"name": ["x", "y"], "position": [0, 1]}}'
GOAL = '"goal_constraints": [{"joint_constraints": [{"joint_name": "x", "position": 1}]}]'
TWICE = {
    "JSON": (paths, "a.json", '{"joint_names": ["x", "y"],\n' + POINTS + ',\n' + POINTS + "}", "has the key 'points' in line 2 and again in line 3; keep one"),
    "JSON with an escape": (paths, "a.json", '{"joint_names": ["x", "y"],\n' + POINTS + ',\n"poi\\u006ets": []}', "key 'points' in line 2 and again in line 3"),
    "JSON in a list": (paths, "a.json", '[{"a": {"x": "}{",\n"x": 1}}]', "key 'x' in line 1 and again in line 2"),
    "YAML": (paths, "a.yaml", "joint_names: [x, y]\npoints:\n  - [0, 1]\n  - [1, 1]\n'points': []\n", "has the key 'points' in line 2 and again in line 5; keep one"),
    "YAML, deeper": (paths, "a.yaml", "joint_names: [x, y]\npoints:\n  - positions: [0, 1]\n    positions: [1, 1]\n", "'positions' in line 3 and again in line 4"),
    "YAML in braces": (paths, "a.yml", "{joint_names: [x, y], points: [[0, 1], [1, 1]], points: []}", "'points' in line 1 and again in line 1"),
    "joints of a trajectory": (paths, "a.json", '{"joint_names": ["x", "y", "x"], ' + POINTS.replace("1]", "1, 2]") + "}", "joint_names of trajectory 0: has 'x' as joint 1 and again as joint 3; keep one"),
    "columns of CSV": (paths, "a.csv", "x,y, x\n0,1,2\n1,1,1\n", "header: has 'x' as column 1 and again as column 3; keep one"),
    "joints of a start": (read_states, "a.json", "{" + START.replace('"y"', '"x"') + "}", "start_state.joint_state.name: has 'x' as joint 1 and again as joint 2"),
    "group of a request": (read_group, "a.yaml", "group_name: a\nstart_state: {joint_state: {name: [], position: []}}\ngroup_name: b\n",
        "'group_name' in line 1 and again in line 3"),
    "joints of a goal": (joints, "a.json", "{" + START + ", " + GOAL.replace("}]}]", '}, {"joint_name": "x", "position": 2}]}]') + "}", "joint_constraints: has 'x' as joint 1 and again as joint 2"),
    "links of spheres in JSON": (read_spheres, "a.json", '{"a": [[0, 0, 0, 1]],\n"a": []}', "'a' in line 1 and again in line 2"),
    "links of spheres in YAML": (read_spheres, "a.yaml", "a:\n  - [0, 0, 0, 1]\nb: []\na: []\n", "'a' in line 1 and again in line 4"),
    "TOML": (campaign, "a.toml", 'name = "a"\nseed = 1\nname = "b"', "has name in line 1 and again in line 3; keep one"),
    "tables of TOML": (campaign, "a.toml", '[robots.a]\nurdf = "x"\n[robots.b]\nurdf = "y"\n[robots.a]\n', "has robots.a in line 1 and again in line 5; keep one"),
}


@pytest.mark.parametrize("name", TWICE)
def test_a_key_that_is_there_twice_is_named_by_both_places(tmp_path, name):
    read, file, text, message = TWICE[name]
    (tmp_path / file).write_text(text)
    with pytest.raises(FleetError) as caught:
        read(tmp_path / file)
    assert message in str(caught.value) and file in str(caught.value)


def test_an_array_that_is_there_twice_is_named_by_both_places(tmp_path):
    numpy.save(tmp_path / "p.npy", [[0.0, 1], [1, 1]])
    with pytest.warns(UserWarning, match="Duplicate"), zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.write(tmp_path / "p.npy", "p.npy")
        archive.write(tmp_path / "p.npy", "q.npy")
        archive.write(tmp_path / "p.npy", "p.npy")
    with pytest.raises(FleetError, match="has 'p.npy' as array 1 and again as array 3"):
        paths(tmp_path / "a.npz")


def test_merged_keys_of_yaml_are_no_duplicates(tmp_path):
    (tmp_path / "a.yaml").write_text("base: &b {joint_names: [x, y], points: [[0, 1], [1, 1]]}\nother:\n  <<: *b\n  joint_names: [y, x]\n")
    found = paths(tmp_path / "a.yaml")
    assert [path.positions.tolist() for path in found] == [[[0, 1], [1, 1]], [[1, 0], [1, 1]]]


def test_messages_after_the_first_are_not_dropped(tmp_path):
    """As `ros2 topic echo` writes them."""
    (tmp_path / "a.yaml").write_text("".join(f"joint_names: [x, y]\npoints: [[{k}, 1], [1, 1]]\n---\n" for k in range(3)))
    assert [path.positions[0, 0] for path in paths(tmp_path / "a.yaml")] == [0, 1, 2]


PLACES = {"a pipe": os.mkfifo, "a device": lambda path: path.symlink_to("/dev/zero"), "a folder": pathlib.Path.mkdir, "a terminal": lambda path: path.symlink_to("/dev/tty"),
    "a pipe behind a link": lambda path: (os.mkfifo(path.with_name("real")), path.symlink_to("real"))}
READERS = {**{f"paths in {ending}": (paths, f"a.{ending}") for ending in ("csv", "npy", "npz", "txt", "yaml", "yml", "json")},
    "a start": (read_states, "a.yaml"), "a group": (read_group, "a.json"), "joints": (joints, "a.yaml"), "a campaign": (campaign, "a.toml"),
    **{f"spheres in {ending}": (read_spheres, f"a.{ending}") for ending in ("yaml", "json", "urdf")},
    **{f"{what} of a campaign": (lambda file, what=what: worlds(file, what), f"a.{what}") for what in ("urdf", "srdf", "scene")}}


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("reader", READERS)
def test_what_is_no_regular_file_is_refused_and_not_waited_for(tmp_path, reader, place):
    def late(number, frame):
        raise TimeoutError

    read, name = READERS[reader]
    PLACES[place](tmp_path / name)
    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(20)  # a sign of life
    try:
        with pytest.raises(leeway.Error) as caught:
            read(tmp_path / name)
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
    assert name in str(caught.value) and "; " in str(caught.value)


def bomb(levels):
    lines = ["a0: &a0 [0, 0, 0, 0, 0, 0, 0, 0, 0]"] + [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]" for k in range(1, levels)]
    return "\n".join(lines) + f"\njoint_names: [x, y]\npoints: *a{levels - 1}\n"


HOSTILE = {"aliases that grow": ("a.yaml", bomb(12), "more than 67108864 entries"), "an alias in itself": ("a.yaml", "joint_names: [x, y]\npoints: &a [*a, *a]", "more than 64 tables"),
    "lists in lists, YAML": ("a.yaml", "[" * 3000, "more than 64"), "lists in lists, JSON": ("a.json", "[" * 100000, "more than 64"), "70 lists": ("a.json", "[" * 70 + "]" * 70, "more than 64"),
    "objects of Python": ("a.yaml", "!!python/object/apply:os.system [ls]", "could not determine"), "NaN": ("a.json", '{"joint_names": ["x", "y"], "points": [[NaN, 1], [1, 1]]}', "NaN"),
    "text in place of points": ("a.json", '{"joint_names": ["x", "y"], "points": "abc"}', "no list of points"), "a number of 5000 digits": ("a.json", "9" * 5000, "digits"),
    "joints that are numbers": ("a.json", '{"joint_names": [1, 2], ' + POINTS + "}", "no list of points, or no list of joint_names"),
    "points of two forms": ("a.json", '{"joint_names": ["x", "y"], "points": [[0, 1], {"positions": [1, 1]}]}', "are tables and lists"),
    "positions of text": ("a.json", '{"joint_names": ["x", "y"], "points": [{"positions": ["a", 1]}, {"positions": [1, 1]}]}', "no table of numbers"),
    "a time of a list": ("a.json", '{"joint_names": ["x", "y"], "points": [{"positions": [0, 1], "time_from_start": [1]}, {"positions": [1, 1]}]}', "no table of numbers"),
    "a huge integer": ("a.json", '{"joint_names": ["x", "y"], "points": [[1' + "0" * 400 + ', 1], [1, 1]]}', "no table of numbers"),
    "Latin 1": ("a.csv", "x,y,\xe9\n0,1,2\n1,1,2\n".encode("latin1"), "no text of UTF-8"), "UTF-16": ("a.json", "{}".encode("utf-16"), "no text of UTF-8"),
    "half of the velocities": ("a.csv", "x,y,velocity:x\n0,1,2\n1,1,2\n", "has velocity: columns, but none of y"), "a NUL in CSV": ("a.csv", "x,y\n0,\0\n1,1\n", "no table of numbers"),
    "pickles": ("a.npy", b"\x93NUMPY\x01\x00v\x00{'descr': '|O', 'fortran_order': False, 'shape': (2, 2), }".ljust(128) + b"x", "no array"),
    "a header that promises all memory": ("a.npy", b"\x93NUMPY\x01\x00v\x00" + b"{'descr': '<f8', 'fortran_order': False, 'shape': (4611686018427387904, 2), }".ljust(117) + b"\n", "no array"),
    "no archive": ("a.npz", b"PK\x03\x04" + bytes(200), "no array"), "an empty file": ("a.npy", b"", "no array"), "an empty document": ("a.yaml", "", "has no joint_names"),
    "one state": ("a.csv", "x,y\n0,1\n", "fewer than two states"), "an infinite state": ("a.csv", "x,y\n0,1\ninf,1\n", "not finite")}


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_files_of_paths_are_refused_with_a_message(tmp_path, name):
    file, text, message = HOSTILE[name]
    (tmp_path / file).write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(FleetError) as caught:
        paths(tmp_path / file)
    assert message in str(caught.value) and "; " in str(caught.value) and "\n" not in str(caught.value)


def test_an_archive_that_unpacks_to_all_memory_is_refused(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.npz", "w", zipfile.ZIP_DEFLATED) as archive, archive.open("p.npy", "w", force_zip64=True) as file:
        file.write(b"\x93NUMPY\x01\x00v\x00" + b"{'descr': '<f8', 'fortran_order': False, 'shape': (67108865, 2), }".ljust(117) + b"\n")
        for _ in range(1025):
            file.write(bytes(1 << 20))
    with pytest.raises(FleetError, match="unpacked it has more than 1073741824 bytes"):
        paths(tmp_path / "a.npz")


REQUESTS = [("{}", "start_state"), ("[]", "no request"), ("{" + START + "}\n---\n{}", "no request"), ("{" + START.replace("[0, 1]", "[0]") + "}", "no list of 2 finite numbers"),
    ("{" + START.replace("[0, 1]", "[0, .nan]") + "}", "no list of 2 finite numbers"), ("{" + START.replace('["x", "y"]', '"xy"') + "}", "no list of names"), ("", "no request")]


@pytest.mark.parametrize(("text", "message"), REQUESTS)
def test_requests_without_a_whole_start_are_refused(tmp_path, text, message):
    (tmp_path / "a.yaml").write_text(text)
    with pytest.raises(FleetError, match=message):
        read_states(tmp_path / "a.yaml")


def test_a_campaign_of_deep_tables_is_refused(tmp_path):
    for text in ("x = " + "[" * 50000, "a." * 3000 + "b = 1", "x = " + "{a=" * 100 + "1" + "}" * 100):
        (tmp_path / "a.toml").write_text(text)
        with pytest.raises(FleetError, match="a.toml: has more than 64 tables and lists in each other; correct the TOML"):
            campaign(tmp_path / "a.toml")


def test_spheres_of_several_documents_are_refused(tmp_path):
    (tmp_path / "a.yaml").write_text("a: []\n---\nb: []\n")
    with pytest.raises(FleetError, match="holds 2 documents"):
        read_spheres(tmp_path / "a.yaml")
    (tmp_path / "a.json").write_text(json.dumps({"a": [[0, 0, 0]]}))
    with pytest.raises(FleetError, match="no table of spheres"):
        read_spheres(tmp_path / "a.json")
