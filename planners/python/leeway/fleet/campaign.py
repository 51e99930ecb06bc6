# SPDX-License-Identifier: BSD-3-Clause
"""Campaigns as TOML files: reading, defaults, and messages that name the place of a mistake.

    name = "labels"
    seed = 1
    [robots.panda]
    urdf = "panda.urdf"
    srdf = "panda.srdf"
    group = "panda_arm"
    [scenes.shelf]
    file = "shelf.yaml"
    [[work]]
    kind = "states"
    robots = ["panda"]
    scenes = ["shelf"]
    rows = 1000000
"""
from __future__ import annotations

import glob
import math
import pathlib
import re
from typing import Any, NamedTuple

from .documents import ONCE, parse_toml, read_text
from .errors import FleetError

__all__ = ["Campaign", "Option", "checked", "files_of", "load_campaign", "shown"]

SHARD_ROWS = 65536
MOST_BYTES = 1 << 24  # of a campaign file
ROBOT_NAME = re.compile(r"\w[\w.-]{0,99}")  # of robots and scenes: a part of files' names


class Option(NamedTuple):
    """An entry of a table: its type, default (REQUIRED: none), least value, choices, greatest value, type of a list's or a table's entries."""
    type: type
    default: Any
    least: float | None = None
    choices: tuple = ()
    most: float | None = None
    of: type = str


REQUIRED = object()
KINDS_OF_VALUES = {str: "text in quotes", int: "a whole number", float: "a number", bool: "true or false", list: "a list", dict: "a table"}
TOP = {"name": Option(str, REQUIRED), "seed": Option(int, 1, 0), "shard_rows": Option(int, SHARD_ROWS, 1), "robots": Option(dict, {}, of=dict),
    "scenes": Option(dict, {}, of=dict), "work": Option(list, REQUIRED, of=dict)}
ROBOT = {"urdf": Option(str, REQUIRED), "srdf": Option(str, ""), "group": Option(str, ""), "packages": Option(list, []),
    "reference": Option(dict, {}, of=float), "spheres": Option(str, "")}
SCENE = {"file": Option(str, ""), "generator": Option(str, ""), "count": Option(int, 1, 1), "seed": Option(int, 1, 0),
    "parameters": Option(dict, {}, of=object), "packages": Option(list, [])}
WORK = {"kind": Option(str, REQUIRED), "robots": Option(list, []), "scenes": Option(list, [])}


class Campaign(NamedTuple):
    file: pathlib.Path
    folder: pathlib.Path  #: paths are relative to it
    values: dict[str, Any]  #: of the file, with all defaults


def _fits(value: Any, wanted: type, infinite: bool = False) -> bool:
    if wanted is float:
        return isinstance(value, (int, float)) and not isinstance(value, bool) and (math.isfinite(value) or (infinite and value == math.inf))
    return isinstance(value, wanted) and not (wanted is int and isinstance(value, bool))


def shown(value: Any) -> str:
    """A value for a message, cut to a line."""
    text = repr(value)
    return text if len(text) < 60 else f"{text[:56]} ..."


def _check_value(file, place: str, value: Any, option: Option) -> None:
    if not _fits(value, option.type, option.default == math.inf):
        raise FleetError(file, place, f"is {shown(value)}", f"give {KINDS_OF_VALUES[option.type]}")
    if option.least is not None and value < option.least:
        raise FleetError(file, place, f"is {value}", f"give at least {option.least}")
    if option.most is not None and value > option.most:
        raise FleetError(file, place, f"is {value}", f"give at most {option.most}")
    if option.choices and value not in option.choices:
        raise FleetError(file, place, f"is {shown(value)}", f"give one of {', '.join(map(str, option.choices))}")
    inside = [(f"{place}[{i}]", entry) for i, entry in enumerate(value)] if option.type is list else []
    inside = [(f"{place}.{name}", entry) for name, entry in value.items()] if option.type is dict else inside
    for where, entry in inside:
        if not _fits(entry, option.of):
            raise FleetError(file, where, f"is {shown(entry)}", f"give {KINDS_OF_VALUES[option.of]}")


def checked(file, element: str, values: dict[str, Any], options: dict[str, Option]) -> dict[str, Any]:
    """The values with their defaults. Raises FleetError for an entry that is missing, unknown, or of another type."""
    for name in values:
        if name not in options:
            raise FleetError(file, f"{element}.{name}".lstrip("."), "is no known entry", f"known are {', '.join(options)}")
    out = {}
    for name, option in options.items():
        place = f"{element}.{name}".lstrip(".")
        if name not in values:
            if option.default is REQUIRED:
                raise FleetError(file, place, "is missing", f"add it: {KINDS_OF_VALUES[option.type]}")
            out[name] = option.default
            continue
        _check_value(file, place, values[name], option)
        out[name] = float(values[name]) if option.type is float else values[name]
    return out


def _named(file, element: str, names: list[str], known: dict[str, Any]) -> None:
    for name in names:
        if name not in known:
            raise FleetError(file, element, f"names {name!r}, which the campaign does not have", f"it has {', '.join(known) or 'none'}")
        if names.count(name) > 1:
            raise FleetError(file, element, f"names {name!r} twice: the same rows", "name it once")


def load_campaign(file, kinds: dict[str, Any]) -> Campaign:
    """Reads a campaign. kinds: name to kind; each has `options`."""
    path = pathlib.Path(file)
    try:
        values = parse_toml(read_text(path, MOST_BYTES, "give the path of a campaign's TOML file"))
    except FleetError:
        raise
    except ValueError as error:
        raise FleetError(path, "", str(error), ONCE if "again in line" in str(error) else "correct the TOML") from None
    top = checked(path, "", values, TOP)
    top["robots"] = {name: checked(path, f"robots.{name}", robot, ROBOT) for name, robot in top["robots"].items()}
    top["scenes"] = {name: checked(path, f"scenes.{name}", scene, SCENE) for name, scene in top["scenes"].items()}
    for name in [*top["robots"], *top["scenes"]]:
        if not ROBOT_NAME.fullmatch(name):
            raise FleetError(path, name, "is no name of a robot or scene: it is a part of files' names", "give at most 100 letters, digits, -, _ and .")
    for name, scene in top["scenes"].items():
        if bool(scene["file"]) == bool(scene["generator"]):
            raise FleetError(path, f"scenes.{name}", "has both or none of file and generator", "give one of them")
    work = []
    for i, given in enumerate(top["work"]):
        element = f"work[{i}]"
        kind = given.get("kind")
        if kind not in kinds:
            raise FleetError(path, f"{element}.kind", f"is {kind!r}", f"give one of {', '.join(kinds)}")
        entry = checked(path, element, given, {**WORK, **kinds[kind].options})
        if "scenes" not in given and top["scenes"] and kinds[kind].in_scenes and not entry.get("table"):
            raise FleetError(path, f"{element}.scenes", f"is missing, and the campaign has {', '.join(top['scenes'])}: the rows would be of a world without obstacles",
                "name the scenes, or write scenes = [] for no obstacles")
        if kinds[kind].of_robots and not top["robots"]:
            raise FleetError(path, "robots", "is missing", f"add a table [robots.NAME], which {kind} are about")
        if not kinds[kind].of_robots and (entry["robots"] or entry["scenes"]):
            raise FleetError(path, element, f"has robots or scenes, which {kind} have in their files", "leave them out")
        entry["robots"] = entry["robots"] or list(top["robots"])
        _named(path, f"{element}.robots", entry["robots"], top["robots"])
        _named(path, f"{element}.scenes", entry["scenes"], top["scenes"])
        work.append(entry)
    if not work:
        raise FleetError(path, "work", "is empty", "add a [[work]] table")
    top["work"] = work
    return Campaign(path, path.resolve().parent, top)


def files_of(campaign: Campaign, element: str, patterns: list[str]) -> list[str]:
    """Files that patterns such as "paths/*.csv" name, relative to the campaign, each pattern's in order of their names."""
    found = []
    for pattern in patterns:
        some = sorted(glob.glob(pattern, root_dir=campaign.folder, recursive=True)) if not pathlib.Path(pattern).is_absolute() else sorted(glob.glob(pattern))
        if not some:
            raise FleetError(campaign.file, element, f"{pattern!r} names no file", f"paths are relative to {campaign.folder}")
        found += some
    return found
