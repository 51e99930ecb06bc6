# SPDX-License-Identifier: BSD-3-Clause
"""Hostile files by class, for every reader (readers.py): each damages the reader's one good file in one way.

CLASSES names the classes. What has to come of a file is one of

    refused   exit status 2, and an error that names the file
    same      the answer of the good file, to the letter: the file says the same
    told      refused, or an answer or a notice that differs from those of the good file: nothing is taken silently
    harmless  refused, or the same answer: what was damaged has no meaning, or is read in full
"""
import gzip
import os
import pathlib
import socket
import sys

from cases import Case, SRDF, URDF
from readers import ARTICULATION, AUDIT, CHECK, TIMED_TABLE, gltf, gltf_buffer, readers, scene_of

REFUSED, SAME, TOLD, HARMLESS = "refused", "same", "told", "harmless"

NUMBERS = {
    "not a number": ("nan", "-nan", "NaN(1)", ".nan"), "infinite": ("inf", "-inf", "infinity", ".inf", "1e999", "-1e999"),
    "beyond measure": ("1e308", "-1e308", "99999999999999999999999999"), "hexadecimal": ("0x1p3", "0x10"),
    "decimal comma": ("1,5", "1.000,5"), "unit": ("1.5m", "90deg", "1.5 m"), "broken": ("--1", "+-1", "1e", "1e+", "1.2.3", ".", "-", "1_000", "1/2", "$1"),
    "other digits": ("\u0663", "\uff11"), "quoted": ("'", '"'), "no value": ("", "~", "null", "true"),
}


def number_files(reader):
    before, _, after = reader.number.split("|")
    text = reader.content.decode()
    whole = reader.number.replace("|", "")
    if whole not in text:
        raise ValueError(f"{reader.name} has no {whole!r}")
    for kind, values in NUMBERS.items():
        for value in values:
            if kind == "decimal comma" and reader.form == "table" or reader.form in ("yaml", "json") and "[" in before and "," in value:
                continue  # a comma parts cells there: another file, with one number more
            scanned = reader.name in ("PCD", "PLY cloud") and kind in ("not a number", "infinite")  # scanners write these where they see nothing
            # of a group state that this command does not use
            expect = HARMLESS if reader.name == "SRDF" and kind == "beyond measure" else TOLD if scanned or kind == "beyond measure" else REFUSED
            yield f"number {kind}", repr(value), text.replace(whole, before + value + after, 1).encode(), expect


def cut_files(reader):
    for tenth in range(1, 10):
        content = reader.content[:len(reader.content) * tenth // 10]
        if not reader.ends and (content.endswith(b"\n") or reader.content[len(content):].startswith((b"\n", b" "))):
            continue  # whole lines: another file
        yield "cut", f"after {tenth} tenths", content, REFUSED if reader.ends else TOLD


def byte_files(reader):
    content = reader.content
    half = len(content) // 2
    yield "empty", "no byte", b"", REFUSED
    yield "empty", "blanks", b" \n\n \n", REFUSED
    yield "another format", "git-LFS pointer", b"version https://git-lfs.github.com/spec/v1\noid sha256:" + b"0" * 64 + b"\nsize 12\n", REFUSED
    yield "another format", "page of a web server", b"<!DOCTYPE html>\n<html><head><title>404</title></head><body>Not found</body></html>\n", REFUSED
    yield "another format", "compressed", gzip.compress(content, mtime=0), REFUSED
    yield "another format", "every byte", bytes(range(256)) * 4, REFUSED
    if not reader.is_text:
        yield "bytes", "more at the end", content + b"\0" * 7, HARMLESS if reader.name != "binary STL" else TOLD
        yield "bytes", "twice", content * 2, HARMLESS if reader.name == "PNG height map" else TOLD if reader.name in ("binary PCD", "octomap") else REFUSED
        return
    text = content.decode()
    yield "encoding", "byte order mark", text.encode("utf-8-sig"), SAME if reader.form in ("xml", "yaml", "table") or reader.name == "STL" else HARMLESS
    for other in ("utf-16", "utf-16-be", "utf-32"):  # YAML may be in any of them
        yield "encoding", other, text.encode(other), HARMLESS if reader.form in ("yaml", "json") else REFUSED
    yield "line ends", "CR LF", text.replace("\n", "\r\n").encode(), SAME
    yield "line ends", "none at the end", text.rstrip("\n").encode(), SAME
    yield "line ends", "a million blank lines at the end", content + b"\n" * 1000000, SAME
    yield "zero byte", "in the middle", content[:half] + b"\0" + content[half:], REFUSED
    for many in (1, 5000):
        yield "zero byte", f"{many} at the end", content + b"\0" * many, HARMLESS if reader.form == "list" or reader.name == "glTF" else REFUSED


def place_link(target):
    def place(path):
        path.symlink_to(target)
    return place


def place_socket(path):
    here = os.getcwd()
    with socket.socket(socket.AF_UNIX) as made:
        try:
            os.chdir(path.parent)  # names of sockets are short
            made.bind(path.name)
        finally:
            os.chdir(here)


def place_good_link(content):
    def place(path):
        other = path.with_name("real-" + path.name)
        other.write_bytes(content)
        path.symlink_to(other.name)
    return place


SPECIAL = {
    "a pipe": lambda path: os.mkfifo(path), "a folder": lambda path: path.mkdir(), "a socket": place_socket,
    "a link to itself": lambda path: path.symlink_to(path.name), "a link to nothing": place_link("nowhere"),
    "an endless device": place_link("/dev/zero"), "an empty device": place_link("/dev/null"), "a link to a folder": place_link("."),
}


def special_files(reader):
    for name, place in SPECIAL.items():
        yield "no file", name, place, REFUSED
    yield "no file", "a link to the file", place_good_link(reader.content), SAME


COUNTS = ("-1", "0", "1", "1000000", "4294967295", "9223372036854775807", "18446744073709551616", "1e6", "nan", "3.5", "x", "")


def count_files(reader):
    for piece in reader.counts:
        before, _, after = piece.split("|")
        whole = piece.replace("|", "").encode()
        if whole not in reader.content:
            raise ValueError(f"{reader.name} has no {whole!r}")
        for value in COUNTS:
            index = piece in ("\n|3| 1 2 3", "3 1 2 |3|", "1 2 |3|</p>") and value in ("0", "1")  # another corner, or none
            known = piece == 'count="|12|"' and value in ("0", "1")  # fewer than there are: all are read
            if index or known or (before + value + after).encode() == whole:
                continue
            yield "count", f"{whole.decode().strip()!r} is {value!r}", reader.content.replace(whole, (before + value + after).encode(), 1), TOLD


def xml_files(reader):
    text = reader.content.decode()
    body = text.split("?>", 1)[1].lstrip()
    name = body[1:].split(maxsplit=1)[0]
    end = f"</{name}>"
    yield "deep nesting", "100,000 elements", (text.replace(end, "<a>" * 100000 + "</a>" * 100000 + end)).encode(), REFUSED
    yield "deep nesting", "never closed", text.replace(end, "<a>" * 100000).encode(), REFUSED
    yield "several roots", "twice the same", (text + body).encode(), REFUSED
    yield "several roots", "text behind", (text + "x").encode(), REFUSED
    yield "several roots", "closed once more", (text + end).encode(), REFUSED
    yield "entities", "that grow", ('<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;&a;">]>' + body.replace(">", ">&b;", 1)).encode(), TOLD
    yield "entities", "of another file", ('<!DOCTYPE r [<!ENTITY a SYSTEM "file:///usr/lib/os-release">]>' + body.replace(">", ">&a;", 1)).encode(), TOLD
    yield "entities", "comment that never ends", text.replace(end, "<!--" + end).encode(), REFUSED
    yield "duplicate", "attribute", text.replace(' name="', ' name="twin" name="', 1).replace(' id="', ' id="twin" id="', 1).encode(), REFUSED
    yield "very long name", "a million letters", text.replace(end, f"<{'a' * 1000000}/>" + end).encode(), TOLD if reader.name == "SRDF" else HARMLESS  # elements of other tools


def yaml_files(reader):
    text = reader.content.decode()
    lines = text.splitlines()
    for at, line in enumerate(lines):
        key, colon, value = line.partition(":")
        if not colon or " #" in line or "{" in key:
            continue
        bare = key.strip().lstrip("- ")
        column = len(key) - len(bare)
        twin = " " * column + f"{bare}: 1"
        yield "duplicate", f"key {bare}, line {at + 1}", "\n".join(lines[:at + 1] + [twin] + lines[at + 1:] if value.strip() else lines[:at] + [key + ": 1", " " * column + line[column:]] + lines[at + 1:]).encode(), REFUSED
        if value.strip():
            labels = {"name": {"a word", "nothing"}, "header": {"nothing"}, "allowed_planning_time": {"nothing"}}.get(bare if column == 0 or bare == "header" else "", ())  # nothing: not given
            for label, other in (("a map", "{a: {b: 1}}"), ("a list of lists", "[[[1]]]"), ("a word", "wrong"), ("nothing", ""), ("a list of null", "[~]")):
                if label in labels:
                    continue
                yield "wrong type", f"{bare} is {label}, line {at + 1}", "\n".join(lines[:at] + [f"{key}: {other}"] + lines[at + 1:] + [""]).encode(), TOLD
    yield "deep nesting", "100,000 lists", (text + "x: " + "[" * 100000 + "\n").encode(), REFUSED
    yield "deep nesting", "1,000 maps", (text + "x: " + "{a: " * 1000 + "1" + "}" * 1000 + "\n").encode(), REFUSED
    yield "aliases", "that grow", (text + "a0: &a0 [1, 1]\n" + "".join(f"a{i}: &a{i} [*a{i - 1}, *a{i - 1}]\n" for i in range(1, 40))).encode(), REFUSED
    yield "aliases", "of itself", (text + "x: &x [*x]\n").encode(), REFUSED
    yield "aliases", "of nobody", (text + "x: *y\n").encode(), REFUSED
    # trajectories of several documents are driven one after the other
    yield "several roots", "two documents", (text + "---\n" + text).encode(), TOLD if reader.name.startswith("trajectory") else REFUSED
    if "\n " in text or "\n- " in text:
        yield "line ends", "tabs before keys", text.replace("\n  ", "\n\t").replace("\n- ", "\n\t- ").encode(), REFUSED
    other = HARMLESS if reader.name == "padding" else TOLD  # parameters of MoveIt, of which most are not about padding
    yield "unknown key", "at the top", (text + "zebra: 1\n").encode(), other
    yield "very long name", "key of a million letters", (text + "a" * 1000000 + ": 1\n").encode(), other
    yield "unknown key", "with a tag", (text + "zebra: !!python/object/apply:os.system ['touch owned']\n").encode(), other


def json_files(reader):
    text = reader.content.decode()
    for line in dict.fromkeys(line.strip() for line in text.splitlines() if '": ' in line and line.rstrip().endswith(",")):
        yield "duplicate", f"key {line}", text.replace(line, line + " " + line, 1).encode(), REFUSED
    yield "deep nesting", "100,000 lists", (text.rstrip()[:-1] + ', "x": ' + "[" * 100000 + "]" * 100000 + "}").encode(), REFUSED
    yield "several roots", "twice the same", (text + text).encode(), REFUSED
    yield "several roots", "text behind", (text + "x").encode(), REFUSED


def reader_cases():
    all_cases = []
    for reader in readers():
        makers = [cut_files, byte_files, special_files, count_files]
        makers += [number_files] if reader.number else []
        makers += {"xml": [xml_files], "yaml": [yaml_files], "json": [json_files]}.get(reader.form, [])
        clean = {**reader.edits, reader.file: reader.content}
        for maker in makers:
            for kind, label, content, expect in maker(reader):
                edits = {**clean, reader.file: None if callable(content) else content}
                place = (reader.file, content) if callable(content) else None
                all_cases.append(Case(f"{kind}: {reader.name}: {label}", reader.command, edits, expect=expect, clean=clean, place=place,
                                      words=(reader.file,) if expect == REFUSED else ()))
    return all_cases


# ---- files that name files ------------------------------------------------------------------------------------------------------

NAMES = {
    "out of a package": "package://arm/../../../../usr/lib/os-release", "absolute": "file:///usr/lib/os-release", "upwards": "../../../../../../../usr/lib/os-release",
    "a device": "/dev/zero", "its standard input": "/dev/stdin", "a descriptor": "/proc/self/fd/0", "a pipe": "pipe", "a folder": "folder",
    "very long": "a" * 5000, "a long way": "a/" * 2000 + "b", "of a web server": "http://localhost:1/x", "a blank": " ", "itself": "ITSELF", "a variable": "$HOME/${HOME}/`touch owned`",
}


def named_cases():
    """For each place where a file names another one."""
    places = {
        "mesh of a robot": ("arm.urdf", lambda name: {"arm.urdf": URDF.replace("fore.stl", name)}, CHECK),
        "mesh of a scene": ("scene.yaml", lambda name: {"scene.yaml": f"""name: room
world:
  collision_objects:
    - id: pot
      meshes: [{{resource: "{name}"}}]
      mesh_poses: [{{position: [2, 0, 0]}}]
"""}, CHECK),
        "articulation": ("scene.yaml", lambda name: {"scene.yaml": f'name: room\nworld:\n  leeway_articulations: [{{id: kitchen, resource: "{name}"}}]\n'}, CHECK),
        "buffer of glTF": ("fore.gltf", lambda name: {"arm.urdf": URDF.replace("fore.stl", "fore.gltf"), "fore.gltf": gltf(name)}, CHECK),
        "steps": ("steps.yaml", lambda name: {"steps.yaml": f'steps:\n- trajectory: "{name}"\n'}, f"{AUDIT} --steps steps.yaml"),
    }
    for kind, more in (("point_cloud", "radius: 0.05"), ("octomap", "unknown: free"), ("height_map", "resolution: 0.1, z_scale: 1")):
        places[kind] = ("scene.yaml", lambda name, k=kind, m=more: {"scene.yaml": scene_of(f'type: {k}, {m}, resource: "{name}"')}, CHECK)

    def place(path):
        os.mkfifo(path)
        path.with_name("folder").mkdir()

    all_cases = []
    for where, (file, edits, command) in places.items():
        for label, name in NAMES.items():
            name = file if name == "ITSELF" else name  # the error may be about the other file
            all_cases.append(Case(f"name of a file: {where}: {label}", command, edits(name), expect=REFUSED, place=("pipe", place)))
    obj = b"mtllib NAME\nv 0 0 0\nv 0.4 0 0\nv 0 0.05 0\nv 0 0 0.05\nusemtl a\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    clean = {"arm.urdf": ("fore.stl", "fore.obj"), "fore.obj": obj.replace(b"mtllib NAME\n", b"")}
    for label, name in NAMES.items():
        all_cases.append(Case(f"name of a file: material of an OBJ: {label}", CHECK, {**clean, "fore.obj": obj.replace(b"NAME", name.encode())},
                              expect=HARMLESS, clean=clean, place=("pipe", place)))
    return all_cases


# ---- circles ---------------------------------------------------------------------------------------------------------------------

def circle_cases():
    def mimic(a, b):
        return URDF.replace('<axis xyz="1 0 0"/>', f'<axis xyz="1 0 0"/><mimic joint="{a}"/>').replace(
            '<origin xyz="0.4 0 0"/><axis xyz="0 0 1"/>', f'<origin xyz="0.4 0 0"/><axis xyz="0 0 1"/><mimic joint="{b}"/>')

    group = SRDF.replace('<group name="two"><chain base_link="base" tip_link="fore"/></group>', '<group name="two"><group name="three"/></group><group name="three"><group name="two"/></group>')
    tree = URDF.replace('<parent link="base"/><child link="upper"/>', '<parent link="tool"/><child link="upper"/>')
    nodes = gltf().replace(b'"mesh": 0,', b'"mesh": 0, "children": [0],')
    self_steps = {"steps.yaml": "steps:\n- trajectory: steps.yaml\n"}
    scene = "name: room\nworld:\n  leeway_articulations: [{id: kitchen, resource: kitchen.urdf}]\n"
    return [
        Case("circle: mimic joints", CHECK, {"arm.urdf": mimic("elbow", "slide")}, words=("arm.urdf", "mimic")),
        Case("circle: a joint that mimics itself", CHECK, {"arm.urdf": mimic("slide", "shoulder")}, words=("arm.urdf",)),
        Case("circle: links", CHECK, {"arm.urdf": tree}, words=("arm.urdf",)),
        Case("circle: groups", CHECK.replace("--group arm", "--group two"), {"arm.srdf": group}, words=("arm.srdf",)),
        Case("circle: nodes of glTF", CHECK, {"arm.urdf": ("fore.stl", "fore.gltf"), "fore.gltf": nodes}, words=("fore.gltf",)),
        Case("circle: steps of steps", f"{AUDIT} --steps steps.yaml", self_steps, words=("steps.yaml",)),
        Case("circle: an articulation of one link twice", CHECK, {"scene.yaml": scene, "kitchen.urdf": ARTICULATION.replace('link name="door"', 'link name="box"')}, words=("kitchen.urdf",)),
    ]


def cache_cases():
    """A cache folder with files of others, and links, pipes and folders under names of its own: their targets stay."""
    def place(path):
        path.mkdir()
        (path / "notes.txt").write_text("mine")
        os.mkfifo(path / f"a-{'1' * 32}.tree")
        (path / f"b-{'2' * 32}.reach").symlink_to("../states.csv")
        (path / f"c-{'3' * 32}.tree").mkdir()
        (path / f"d-{'4' * 32}.tree.partial-abcdef").symlink_to("../edges.csv")
        (path / "leeway.tree").symlink_to("/dev/zero")

    commands = {"list": "cache --cache cache --json cache.json", "clean": "cache --cache cache --clean", "limit": "cache --cache cache --limit 0",
                "use": CHECK.replace("--no-cache", "--cache cache")}
    return [Case(f"cache: {name}", command, {}, (0,), place=("cache", place)) for name, command in commands.items()]


def hostile_cases():
    return reader_cases() + named_cases() + circle_cases() + cache_cases()


# ---- seeds of the fuzzers (tests/fuzz) --------------------------------------------------------------------------------------------

TARGETS = {"arm.urdf": "urdf", "kitchen.urdf": "urdf", "arm.srdf": "srdf", "scene.yaml": "scene", "states.csv": "csv", "edges.csv": "csv", "request.yaml": "request",
           "path.yaml": "path", "motion.yaml": "path", "motion.json": "path", "motion.csv": "path", "limits.yaml": "path", "steps.yaml": "steps", "margins.yaml": "settings",
           "padding.yaml": "settings", "fore.stl": "mesh_stl", "fore.obj": "mesh_obj", "fore.ply": "mesh_ply", "fore.dae": "mesh_dae",
           "fore.gltf": "mesh_gltf", "fore.glb": "mesh_gltf", "cloud.pcd": "cloud_pcd", "cloud.ply": "cloud_ply", "map.bt": "octomap", "ground.txt": "height_map",
           "ground.png": "height_map"}


def write_seeds(folder, longest=4096):
    """Every hostile file that fits, by its target: FOLDER/TARGET/hostile-NUMBER."""
    known = set()
    for number, case in enumerate(hostile_cases()):
        for name, content in case.edits.items():
            if name in TARGETS and isinstance(content, (str, bytes)) and len(content) <= longest and (name, content) not in known:
                known.add((name, content))
                target = pathlib.Path(folder) / TARGETS[name]
                target.mkdir(parents=True, exist_ok=True)
                (target / f"hostile-{number}").write_bytes(content if isinstance(content, bytes) else content.encode())


if __name__ == "__main__":
    write_seeds(sys.argv[1])
