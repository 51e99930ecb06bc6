# SPDX-License-Identifier: BSD-3-Clause
"""Looks at results again: bytes against the manifest, and rows made a second time."""
from __future__ import annotations

import pathlib
from typing import Any, NamedTuple

import pyarrow
import pyarrow.parquet

from .._core import whole_number
from .documents import parse_json
from .errors import FleetError
from .files import open_regular
from .maker import maker, maker_text
from .manifest import read_manifest, sound_records
from .plan import Shard, shards_of, worlds_of
from .seeds import stream_of
from .shard import content_of_file, shard_bytes

__all__ = ["Verified", "verify"]

TOLD = 5  # missing shards by name


class Verified(NamedTuple):
    shards: int
    missing: list[str]  #: files that were not made yet
    faults: dict[str, str]  #: file to fault
    remade: int  #: shards made a second time
    different: list[str]  #: of these, with other bytes

    @property
    def sound(self) -> bool:
        return not (self.missing or self.faults or self.different)

    def __repr__(self) -> str:
        lines = [f"{self.shards} shards: {len(self.missing)} missing, {len(self.faults)} with a fault; {self.remade} made again, {len(self.different)} of them different"]
        lines += [f"{name}: is missing" for name in self.missing[:TOLD]]
        if len(self.missing) > TOLD:
            lines.append(f"and {len(self.missing) - TOLD} other shards are missing")
        return "\n".join(lines + [f"{name}: {fault}" for name, fault in self.faults.items()] + [f"{name}: other bytes when made again" for name in self.different])


def _fault_of_file(path: pathlib.Path, plan: dict[str, Any], shard: Shard, record: dict[str, Any]) -> str:
    """The reason if the file itself says that another build of leeway made it, if it is another shard, or has other rows; or ""."""
    try:
        with open_regular(path) as file:
            about = parse_json((pyarrow.parquet.read_schema(file).metadata or {})[b"leeway"].decode())
        found = {name: about[name] for name in ("leeway", "module", "manifest", "shard", "content")}
    except (OSError, KeyError, TypeError, ValueError, MemoryError, pyarrow.ArrowException):
        return "does not say which leeway made it"
    if (found["leeway"], found["module"]) != (plan["leeway"], plan["module"]):
        return f"was made by {maker_text(found)}, and the campaign is of {maker_text(plan)}"
    if (found["manifest"], found["shard"], found["content"]) != (plan["id"], record["index"], record["content"]):
        return "was made for another campaign, or is another shard"
    try:
        return "" if content_of_file(path, shard) == record["content"] else "has other rows than the recorded ones"
    except (OSError, KeyError, TypeError, ValueError, MemoryError, OverflowError, pyarrow.ArrowException) as error:
        return f"is no table of this campaign: {' '.join(str(error).split())[:200]}"


def verify(folder, campaign=None, remake: int = 0, seed: int = 1) -> Verified:
    """Compares each file with its recorded hash, its rows with their digest, and its maker with the campaign's. campaign, remake: makes so many random shards again and
    compares their bytes."""
    folder, remake, seed = pathlib.Path(folder), whole_number("remake", remake), whole_number("seed", seed)
    plan, records = read_manifest(folder)
    shards = shards_of(plan)
    sound, faults = sound_records(folder, plan, records)
    for index, record in list(sound.items()):
        fault = _fault_of_file(folder / record["file"], plan, shards[index], record)
        if fault:
            faults[record["file"]] = fault
            del sound[index]
    different: list[str] = []
    chosen: list[int] = []
    if remake:
        if campaign is None:
            raise FleetError(folder, "", "shards cannot be made again without their campaign", "give its TOML file")
        if (plan["leeway"], plan["module"]) != tuple(maker().values()):
            raise FleetError(folder, "", f"is of {maker_text(plan)}, and this is {maker_text(maker())}", "make shards again by the build that made them")
        worlds = worlds_of(campaign)
        if worlds.plan["id"] != plan["id"]:
            raise FleetError(campaign, "", "is another campaign than the manifest's", "give the campaign that made these results")
        random, left = stream_of("verify", seed), sorted(sound)
        chosen = [left.pop(random.integer(0, len(left) - 1)) for _ in range(min(remake, len(left)))]
        different = [shards[i].name for i in chosen if shard_bytes(plan, worlds, shards[i])[0] != (folder / shards[i].name).read_bytes()]
    return Verified(len(shards), [shard.name for shard in shards if shard.index not in records], faults, len(chosen), different)
