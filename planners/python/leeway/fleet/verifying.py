# SPDX-License-Identifier: BSD-3-Clause
"""Looks at results again: bytes against the manifest, and rows made a second time."""
from __future__ import annotations

import pathlib
from typing import NamedTuple

from .errors import FleetError
from .manifest import read_manifest, sound_records
from .plan import shards_of, worlds_of
from .seeds import stream_of
from .shard import shard_bytes

__all__ = ["Verified", "verify"]


class Verified(NamedTuple):
    shards: int
    missing: int
    faults: dict[str, str]  #: file to fault
    remade: int  #: shards made a second time
    different: list[str]  #: of these, with other bytes

    @property
    def sound(self) -> bool:
        return not (self.missing or self.faults or self.different)

    def __repr__(self) -> str:
        lines = [f"{self.shards} shards: {self.missing} missing, {len(self.faults)} with a fault; {self.remade} made again, {len(self.different)} of them different"]
        return "\n".join(lines + [f"{name}: {fault}" for name, fault in self.faults.items()] + [f"{name}: other bytes when made again" for name in self.different])


def verify(folder, campaign=None, remake: int = 0, seed: int = 1) -> Verified:
    """Compares each file with its recorded hash. campaign, remake: makes so many random shards again and compares their bytes."""
    folder = pathlib.Path(folder)
    plan, records = read_manifest(folder)
    sound, faults = sound_records(folder, records)
    shards, different = shards_of(plan), []
    chosen: list[int] = []
    if remake:
        if campaign is None:
            raise FleetError(folder, "", "shards cannot be made again without their campaign", "give its TOML file")
        worlds = worlds_of(campaign)
        if worlds.plan["id"] != plan["id"]:
            raise FleetError(campaign, "", "is another campaign than the manifest's", "give the campaign that made these results")
        random, left = stream_of("verify", seed), sorted(sound)
        chosen = [left.pop(random.integer(0, len(left) - 1)) for _ in range(min(remake, len(left)))]
        different = [shards[i].name for i in chosen if shard_bytes(plan, worlds, shards[i])[0] != (folder / shards[i].name).read_bytes()]
    return Verified(len(shards), len(shards) - len(records), faults, len(chosen), different)
