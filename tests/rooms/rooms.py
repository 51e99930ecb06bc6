#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks the rooms of a source folder: includes and calls only point down, and files of a room do not call each other in a circle.

    rooms.py --build build            # all houses; exit status 1 if a rule is broken
    rooms.py --build build --write    # and puts the picture of core/src into core/docs/README.md

A house is a folder whose subfolders are rooms, listed below from the ground floor up. A file may include headers of its own room
and of the rooms before it in the list. In the core, whose objects are in the build folder, the same holds for calls; and the calls
between files of one room have no circle.
"""
import argparse
import dataclasses
import pathlib
import re
import subprocess
import sys

LARGEST_ROOM = 22  # sources (.c, .cpp)
PICTURE_BEGIN, PICTURE_END = "<!-- rooms: written by tests/rooms/rooms.py -->\n", "<!-- rooms end -->\n"


@dataclasses.dataclass
class House:
    folder: str
    rooms: list  # (name, contents), ground floor first
    objects: str = ""  # folder of its objects below the build folder
    public: dict = dataclasses.field(default_factory=dict)  # room of the installed headers leeway/KEY/*, where the names differ


HOUSES = [
    House("core/src", [
        ("base", "status, allocation, arenas, arrays, heap, digest of bytes, vectors, rounding, exact signs"),
        ("simd", "CPU detection, float kernels at each level, wide nodes, lanes"),
        ("shape", "meshes, primitives, point clouds; sphere fits; tree build and validation; support points"),
        ("distance", "distances of triangles and convex pieces, the search over two trees, separating planes"),
        ("robot", "joints, kinematics, bounds of motion"),
        ("scene", "obstacles, snapshots, edits"),
        ("query", "the memory of one thread"),
        ("depth", "how deep two bodies are in each other"),
        ("reachability", "motion hulls, proofs and tables of pairs, clearance grids"),
        ("checker", "one group of one robot in one scene: states"),
        ("motion", "are all states of an edge free?"),
        ("constraint", "is a frame where it should be, all along a motion?"),
        ("near", "all near pairs of a state, directions and derivatives"),
        ("guard", "a motion that runs while scenes change"),
        ("cloud", "voxels of depth cameras and scanners: frames in, scenes out"),
        ("approximate", "simplification, enclosing spheres: offline, no room includes it"),
        ("blob", "shapes and reachability as bytes"),
    ], "core/CMakeFiles/leeway_core.dir/src"),
    House("ompl_bridge/src/io", [
        ("base", "errors, limits, names, paths of packages; bytes, XML and YAML"),
        ("cache", "the cache folder and the format of its files"),
        ("cloud", "point clouds, octrees, height maps"),
        ("mesh", "triangles from mesh files, one reader for each format"),
        ("shape", "shapes of the core from meshes, clouds and numbers"),
        ("mjcf", "MJCF: its elements, bodies, geoms, pairs and keyframes"),
        ("sdf", "SDF of Gazebo by libsdformat: its frames, joints and shapes"),
        ("robot", "URDF, SRDF, pair tables, spheres of links; notices of implausible numbers"),
        ("scene", "scenes, requests, margins; a problem, which joins a robot with a scene"),
        ("world", "world files: several robots and moving objects as one robot"),
    ]),
    House("planners", [
        ("search", "the libraries leeway::plan and leeway::planners: search trees of joint space, samples, smoothing, OMPL's planners"),
        ("ik", "the library leeway::ik: goal states from poses of links"),
        ("certify", "the library leeway::certify: certificates of free motions; two checkers that share no code with it"),
        ("motions", "the library leeway::motions: files of paths and trajectories, roundings, audits with limits"),
        ("lines", "the library leeway::lines: lines and arcs of a frame as trajectories that are proved to stay on them"),
        ("manifold", "the library leeway::manifold: plans that keep constraints along the path, proved at all times"),
        ("sequence", "the library leeway::sequence: motions to goals and lines one after the other, planned together"),
        ("referee", "verdicts on paths, trajectories and regions of other planners; their files"),
        ("replay", "recorded drives before the guard: their files, answers and reports"),
        ("pairs", "the library leeway::pairs: tables of link pairs, the SRDF made from them; reports on links and obstacles"),
        ("tune", "the library leeway::tune: states and motions that are measured, the settings, the choice"),
        ("tools", "programs of others: run without a shell, within limits; xacro files expanded"),
        ("view", "one HTML page of robot, scene, motion and clearances; pictures of it"),
        ("python", "the package leeway of Python: arrays in and out"),
        ("program", "command line, its options and their help; files in and out; robots, scenes and states for all subcommands"),
        ("commands", "one file for each subcommand"),
    ], public={"planners": "search"}),
    House("benchmarks", [
        ("support", "command lines, files of results and their comparison, states, edges and worlds, interleaved timing"),
        ("report", "experiments and their rounds, their page and pictures"),
        ("peers", "engines of other libraries, judges of answers, workloads for all engines"),
        ("planning", "ways to plan, modules of other planners, their results as tables and a page"),
        ("experiments", "figures of the paper, parts switched off, speed against accuracy"),
        ("programs", "the main function, and one file for each subcommand"),
    ]),
]


def files_of(root, house):
    """(room, path) of each source and header; room '' for files outside of every room."""
    base = root / house.folder
    for path in sorted(base.rglob("*")):
        if path.suffix in (".c", ".h", ".cpp", ".hpp"):
            parts = path.relative_to(base).parts
            yield (parts[0] if len(parts) > 1 else ""), path


def includes(root, house):
    """(room, file, room, header) for each include of a header of the house."""
    rooms = {name for name, _ in house.rooms}
    for room, path in files_of(root, house):
        for header in re.findall(r'^\s*#\s*include\s+"([^"]+)"', path.read_text(), re.MULTILINE):
            parts = header.split("/")
            if parts[0] == "leeway" and len(parts) > 2:  # an installed header
                parts = parts[1:]
                parts[0] = house.public.get(parts[0], parts[0])
            other = parts[0] if len(parts) > 1 else room
            if other in rooms:
                yield room, path.name, other, header


def symbols(listing):
    """Defined and needed symbols of one object, from the output of nm."""
    defined, needed = set(), set()
    for line in listing.splitlines():
        words = line.split()
        if len(words) >= 2 and words[-2] == "U":
            needed.add(words[-1])
        elif len(words) == 3 and words[1] in "TDRBVW":
            defined.add(words[2])
    return defined, needed


def calls(listings):
    """(room, file, room, symbol) for each use of a symbol that another object defines; listings: {(room, file): nm output}."""
    read = {place: symbols(text) for place, text in listings.items()}
    owner = {name: place for place, (defined, _) in read.items() for name in defined}
    for (room, name), (_, needed) in sorted(read.items()):
        for symbol in sorted(needed):
            if symbol in owner:
                yield room, name, owner[symbol][0], f"{symbol} ({owner[symbol][1]})"


def circles(listings):
    """(room, files) for each largest set of files of a room that call each other in a circle: strong components (Tarjan 1972)."""
    files = {place: set() for place in listings}
    read = {place: symbols(text) for place, text in listings.items()}
    owner = {name: place for place, (defined, _) in read.items() for name in defined}
    for place, (_, needed) in read.items():
        files[place] = {owner[symbol] for symbol in needed if symbol in owner and owner[symbol][0] == place[0]} - {place}
    number, lowest, stack, found = {}, {}, [], []

    def visit(place):
        number[place] = lowest[place] = len(number)
        stack.append(place)
        for other in sorted(files[place]):
            if other not in number:
                visit(other)
            if other in stack:
                lowest[place] = min(lowest[place], lowest[other])
        if lowest[place] == number[place]:
            at = stack.index(place)
            component = sorted(name for _, name in stack[at:])
            del stack[at:]
            if len(component) > 1:
                found.append((place[0], component))

    for place in sorted(files):
        if place not in number:
            visit(place)
    return found


def circle_problems(house, listings):
    return [f"{house.folder}/{room}: {', '.join(names)} call each other in a circle; move a function or a file, so that calls go one way"
            for room, names in circles(listings)]


def listings_of(root, build, house):
    base = build / house.objects
    listings = {}
    for path in sorted(base.rglob("*.o")):
        place = path.relative_to(base)
        if (root / house.folder / place.with_suffix("")).exists():  # else it was left by an earlier build
            listings[place.parts[0], place.name.removesuffix(".o")] = subprocess.run(["nm", str(path)], capture_output=True, text=True,
                check=True).stdout
    return listings


def problems_of(house, placed, arrows):
    """placed: (room, path) of files; arrows: (kind, room, file, room, name)."""
    floor = {name: i for i, (name, _) in enumerate(house.rooms)}
    found = []
    for room, path in placed:
        if room not in floor:
            found.append(f"{path}: is in none of the rooms {', '.join(floor)}")
    for room in floor:
        count = sum(1 for r, path in placed if r == room and path.suffix in (".c", ".cpp"))
        if count > LARGEST_ROOM:
            found.append(f"{house.folder}/{room}: {count} sources; a room has at most {LARGEST_ROOM}")
        if not any(r == room for r, _ in placed):
            found.append(f"{house.folder}/{room}: is empty")
    for kind, room, name, other, what in arrows:
        if room in floor and floor[other] > floor[room]:
            found.append(f"{house.folder}/{room}/{name}: {kind} {what} of {other}, which is above {room}")
    return found


def picture(house, placed, arrows):
    """The rooms from the top down, each with its size and the rooms that it uses."""
    uses = {}
    for _, room, _, other, _ in arrows:
        if other != room:
            uses.setdefault(room, set()).add(other)
    order = [name for name, _ in house.rooms]
    lines = ["| room | holds | files | lines | includes or calls |", "|---|---|---|---|---|"]
    for room, contents in reversed(house.rooms):
        paths = [path for r, path in placed if r == room]
        lengths = sum(len(path.read_text().splitlines()) for path in paths)
        below = ", ".join(name for name in order if name in uses.get(room, ()))
        # sizes are rounded, so that not each commit changes the picture
        lines.append(f"| `{room}/` | {contents} | {len(paths)} | {round(lengths, -2):,} | {below or 'none'} |")
    return "\n".join(lines) + "\n"


def survey(root, build, house):
    """Files and arrows of a house, and what is wrong with calls between files of a room."""
    placed = list(files_of(root, house))
    arrows = [("includes", *arrow) for arrow in includes(root, house)]
    wrong = []
    if house.objects:
        listings = listings_of(root, build, house)
        if not listings:
            sys.exit(f"{build / house.objects}: there are no objects; build leeway_core first")
        arrows += [("calls", *arrow) for arrow in calls(listings)]
        wrong = circle_problems(house, listings)
    return placed, arrows, wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", required=True, type=pathlib.Path, help="a build folder in which leeway_core is up to date")
    parser.add_argument("--write", action="store_true", help="put the picture into core/docs/README.md")
    arguments = parser.parse_args()
    root = pathlib.Path(__file__).resolve().parents[2]
    found = []
    for house in HOUSES:
        placed, arrows, wrong = survey(root, arguments.build, house)
        found += problems_of(house, placed, arrows) + wrong
        if house.objects:
            page = root / "core/docs/README.md"
            text = page.read_text()
            begin, end = text.index(PICTURE_BEGIN) + len(PICTURE_BEGIN), text.index(PICTURE_END)
            drawn = "\n" + picture(house, placed, arrows) + "\n"
            if arguments.write:
                page.write_text(text[:begin] + drawn + text[end:])
            elif shape_of(text[begin:end]) != shape_of(drawn):
                found.append("core/docs/README.md: its picture of the rooms is not today's; run tests/rooms/rooms.py --build ... --write")
    print("\n".join(found) if found else f"{len(HOUSES)} houses, every arrow points down, no circles")
    return 1 if found else 0


def shape_of(drawn):
    """The picture without numbers of files and lines, which change with every other commit."""
    return re.sub(r"\| [\d,]+ \| [\d,]+ \|", "|", drawn)


if __name__ == "__main__":
    sys.exit(main())
