# SPDX-License-Identifier: BSD-3-Clause
"""The plan of a campaign: all that its rows are a function of, and how they are cut into shards."""
from __future__ import annotations

import hashlib
import json
import math
from typing import Any, Iterator, NamedTuple

from .campaign import ROBOT_NAME, Campaign, checked, files_of, load_campaign
from .errors import FleetError, named
from .files import digest_of_file
from .kinds import Kind, Part
from .maker import maker
from .registry import KINDS
from .scenes import check_generator
from .worlds import Worlds, scene_digest

__all__ = ["FORMAT", "Segment", "Shard", "check_plan", "identity_of", "parts_of", "segments_of", "shards_of", "worlds_of"]

MOST_SHARDS, MOST_SCENES = 500_000, 2_000_000  # of a campaign: listing them takes seconds
FORMAT = 3  # of manifests and of rows; a change of either's meaning is a new number


class Shard(NamedTuple):
    index: int
    part: Part
    begin: int  #: block
    end: int
    name: str  #: file below the results


class Segment(NamedTuple):
    """Rows of one scene in a shard."""
    scene: int
    begin: int
    end: int
    block: int  #: number in the part of the block that `begin` is the first row of


def _canonical(values: Any) -> str:
    return json.dumps(values, sort_keys=True, separators=(",", ":"))


def _plain(values: Any) -> Any:
    """JSON has no infinity: "inf" stands for it."""
    if isinstance(values, dict):
        return {name: _plain(value) for name, value in values.items()}
    if isinstance(values, list):
        return [_plain(value) for value in values]
    return "inf" if values == math.inf else values


def _inputs(campaign: Campaign, worlds: Worlds) -> dict[str, Any]:
    """Digests of the files."""
    values, folder = campaign.values, campaign.folder
    robots, scenes, files = {}, {}, {}
    for name, entry in values["robots"].items():
        with named(campaign.file, f"robots.{name}"):
            robots[name] = worlds.robot(name).digest
        for variable in entry["reference"]:
            if variable not in worlds.robot(name).variables:
                raise FleetError(campaign.file, f"robots.{name}.reference.{variable}", "is no variable of the robot",
                    f"give some of {', '.join(worlds.robot(name).variables)}")
        groups = worlds.robot(name).groups
        for group in entry["group"].split("+") if entry["group"] else []:
            if group not in groups:
                raise FleetError(campaign.file, f"robots.{name}.group", f"is {entry['group']!r}; the SRDF has {', '.join(groups) or 'no groups'}",
                    "give one of its groups, or leave the entry out for all variables")
        with named(campaign.file, f"robots.{name}.group"):
            worlds.checker(name, "", 0)
    for name, entry in values["scenes"].items():
        if entry["file"]:
            with named(campaign.file, f"scenes.{name}"):
                scenes[name] = scene_digest(worlds.problem(name, 0)[0])
    for name, entry in values["scenes"].items():
        for parameter in ("scene", "request"):
            if isinstance(entry["parameters"].get(parameter), str):
                files[entry["parameters"][parameter]] = ""
    for i, work in enumerate(values["work"]):
        for found in files_of(campaign, f"work[{i}].files", work.get("files", [])):
            files[found] = ""
    for robot in values["robots"].values():
        if robot["spheres"]:
            files[robot["spheres"]] = ""
    for name in files:
        try:
            files[name] = digest_of_file(folder / name)
        except OSError as error:
            raise FleetError(folder / name, "", error.strerror or str(error), f"correct its path in {campaign.file}") from None
    return {"robots": robots, "scenes": scenes, "files": files}


def worlds_of(file) -> Worlds:
    """The worlds of a campaign: their plan is plain JSON, and paths in it are relative to their folder."""
    campaign = load_campaign(file, KINDS)
    for name, scene in campaign.values["scenes"].items():
        if scene["generator"]:
            check_generator(campaign.file, name, scene)
    plan: dict[str, Any] = {"format": FORMAT, **maker(), "campaign": _plain(campaign.values), "inputs": {"robots": {}, "scenes": {}},
        "parts": [], "id": ""}
    worlds = Worlds(plan, campaign.folder)
    plan["inputs"] = _inputs(campaign, worlds)
    for i, entry in enumerate(campaign.values["work"]):
        kind = KINDS[entry["kind"]]
        scenes = [[name, campaign.values["scenes"][name]["count"]] for name in entry["scenes"]] or [["", 1]]
        options = _plain({name: entry[name] for name in kind.options})
        for robot in entry["robots"] if kind.of_robots else ["worlds"]:
            extra = kind.prepare(campaign, f"work[{i}]", entry)
            rows = kind.count(entry, extra, worlds, robot)
            part = Part(len(plan["parts"]), i, entry["kind"], robot, scenes, rows, options, extra)
            with named(campaign.file, f"work[{i}]"):
                kind.columns(part, worlds)  # refuses robots that it cannot work on
            plan["parts"].append(part._asdict())
    plan["id"] = identity_of(plan)
    check_plan(campaign.file, plan)
    return worlds


def identity_of(plan: dict[str, Any]) -> str:
    """The digest of a plan, its entry `id`."""
    return hashlib.sha256(_canonical({**plan, "id": ""}).encode()).hexdigest()


def check_plan(file, plan: Any) -> None:
    """Raises FleetError for a plan that was damaged or forged, or that is too large to list: names of files and numbers of rows follow from it."""
    def is_count(value: Any, least: int) -> bool:
        return isinstance(value, int) and not isinstance(value, bool) and value >= least

    def require(holds: bool, element: str, problem: str, remedy: str = "move the folder away and run the campaign again") -> None:
        if not holds:
            raise FleetError(file, element, problem, remedy)

    try:
        require(plan["id"] == identity_of(plan), "plan.id", "is not the digest of the plan: the file was changed")
        per_shard, shards, scenes = plan["campaign"]["shard_rows"], 0, 0
        require(is_count(per_shard, 1) and isinstance(plan["campaign"]["name"], str) and isinstance(plan["leeway"], str)
            and isinstance(plan["module"], str), "plan.campaign", "is none")
        for i, part in enumerate(plan["parts"]):
            element = f"plan.parts[{i}]"
            require(set(part) == set(Part._fields) and part["index"] == i and is_count(part["work"], 0), element, "is no part")
            require(part["kind"] in KINDS, f"{element}.kind", f"is {part['kind']!r}, which this version of leeway does not know")
            require(isinstance(part["robot"], str) and ROBOT_NAME.fullmatch(part["robot"]) is not None, f"{element}.robot", "is no name of a robot")
            require(is_count(part["rows"], 0) and all(is_count(count, 1) and (name == "" or ROBOT_NAME.fullmatch(name)) for name, count in part["scenes"]), element, "has no counts")
            require(isinstance(part["options"], dict) and isinstance(part["extra"], dict), element, "is no part")
            options = KINDS[part["kind"]].options
            require(set(part["options"]) == set(options), f"{element}.options", f"are not {', '.join(options)}")
            checked(file, f"{element}.options", {name: math.inf if value == "inf" else value for name, value in part["options"].items()}, options)
            worlds = sum(count for _, count in part["scenes"])
            block = KINDS[part["kind"]].block
            shards += math.ceil(math.ceil(part["rows"] / block) * worlds / max(1, math.ceil(per_shard / block)))
            scenes += worlds
            require(shards <= MOST_SHARDS, "shard_rows", f"of {per_shard} make more than {MOST_SHARDS} files", "give more rows to a shard, or fewer rows")
            require(scenes <= MOST_SCENES, "scenes", f"are more than {MOST_SCENES}", "cut the campaign into several")
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError, RecursionError) as error:
        if isinstance(error, FleetError):
            raise
        raise FleetError(file, "plan", "is no plan of a campaign", "move the folder away and run the campaign again") from None


def parts_of(plan: dict[str, Any]) -> list[Part]:
    """The parts. A plan has names and counts of scenes in place of each scene: there may be a million of them."""
    return [Part(**{**part, "scenes": [[name, k] for name, count in part["scenes"] for k in range(count)]}) for part in plan["parts"]]


def blocks_per_scene(part: Part) -> int:
    return math.ceil(part.rows / KINDS[part.kind].block)


def shards_of(plan: dict[str, Any]) -> list[Shard]:
    """All shards: whole blocks, about shard_rows rows each."""
    out = []
    for part in parts_of(plan):
        blocks = blocks_per_scene(part) * len(part.scenes)
        per_shard = max(1, math.ceil(plan["campaign"]["shard_rows"] / KINDS[part.kind].block))
        for k, begin in enumerate(range(0, blocks, per_shard)):
            name = f"{part.index:02d}-{part.kind}-{part.robot}/{k:06d}.parquet"
            out.append(Shard(len(out), part, begin, min(blocks, begin + per_shard), name))
    return out


def segments_of(part: Part, begin: int, end: int) -> Iterator[Segment]:
    """Blocks begin to end, cut where scenes begin."""
    each, block = blocks_per_scene(part), KINDS[part.kind].block
    while begin < end:
        scene, first = divmod(begin, each)
        count = min(end - begin, each - first)
        yield Segment(scene, first * block, min(part.rows, (first + count) * block), begin)
        begin += count


def blocks_of(part: Part, begin: int, end: int) -> list[tuple[int, slice]]:
    """(number, rows in the shard) of each block."""
    size, out, row = KINDS[part.kind].block, [], 0
    for segment in segments_of(part, begin, end):
        for k, first in enumerate(range(segment.begin, segment.end, size)):
            count = min(size, segment.end - first)
            out.append((segment.block + k, slice(row, row + count)))
            row += count
    return out


def rows_in(shard: Shard) -> int:
    return sum(segment.end - segment.begin for segment in segments_of(shard.part, shard.begin, shard.end))
