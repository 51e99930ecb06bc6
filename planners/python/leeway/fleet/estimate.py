# SPDX-License-Identifier: BSD-3-Clause
"""The cost of a campaign, from a sample of its blocks."""
from __future__ import annotations

import math
import pathlib
import shutil
import time
from typing import Any, NamedTuple

from .plan import blocks_per_scene, parts_of, rows_in, shards_of
from .registry import KINDS
from .shard import shard_bytes
from .worlds import Worlds

__all__ = ["Estimate", "estimate"]

SAMPLES = 3  # blocks of a part, at most
SECONDS = 2.0  # for a part, about
ENOUGH = 10  # shards for each worker


class Estimate(NamedTuple):
    rows: list[int]  #: of each part that are to be made
    names: list[str]
    per_row: list[float]  #: seconds of one processor
    per_scene: list[float]  #: seconds, for the first row of a scene
    scenes: list[int]
    bytes: int
    shards: int
    free: int  #: bytes of the disk

    @property
    def seconds(self) -> float:
        return sum(self.rows[i] * self.per_row[i] + self.scenes[i] * self.per_scene[i] for i in range(len(self.rows)))

    def text(self, workers: int) -> str:
        lines = [f"{'part':<40} {'rows':>12} {'us a row':>10} {'ms a scene':>11} {'hours of a processor':>21}"]
        for name, n, cost, scene, scenes in zip(self.names, self.rows, self.per_row, self.per_scene, self.scenes):
            lines.append(f"{name:<40} {n:>12} {1e6 * cost:>10.1f} {1e3 * scene:>11.1f} {(n * cost + scenes * scene) / 3600:>21.4f}")
        if workers > 1 and self.shards < workers * ENOUGH:
            lines.append(f"{self.shards} shards for {workers} workers: some will have no work at the end; a smaller shard_rows makes more shards")
        lines.append(f"{self.shards} shards, about {self.bytes / 1e6:.1f} MB ({self.free / 1e9:.1f} GB are free), "
            f"{self.seconds / max(1, workers) / 3600:.4f} h by {max(1, workers)} workers")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return self.text(1)


def _timed(plan: dict[str, Any], worlds: Worlds, shard):
    clock = time.process_time()
    data, _, _ = shard_bytes(plan, worlds, shard)
    return time.process_time() - clock, len(data)


def _sample(plan: dict[str, Any], worlds: Worlds, part, shard) -> tuple[float, float, float]:
    """(seconds a row, seconds a scene, bytes a row), from blocks spread over a part."""
    blocks = blocks_per_scene(part) * len(part.scenes)
    seconds = size = rows = scene = 0.0
    begin, count = time.process_time(), min(SAMPLES, blocks)
    for k in range(count):
        first = k * blocks // count
        piece = shard._replace(begin=first, end=min(blocks, first + max(1, math.ceil(64 / KINDS[part.kind].block))))
        fresh, _ = _timed(plan, worlds, piece)
        cost, length = _timed(plan, worlds, piece)
        scene = max(scene, fresh - cost)
        seconds, size, rows = seconds + cost, size + length, rows + rows_in(piece)
        if time.process_time() - begin > SECONDS:
            break
    return seconds / rows, max(0.0, scene), size / rows


def estimate(plan: dict[str, Any], worlds: Worlds, folder: pathlib.Path, missing: list[int] | None = None) -> Estimate:
    """Makes a few blocks of each part and throws them away."""
    shards = shards_of(plan)
    wanted = shards if missing is None else [shards[i] for i in missing]
    rows, names, costs, scenes, size = [], [], [], [], 0.0
    for part in parts_of(plan):
        mine = [shard for shard in wanted if shard.part.index == part.index]
        rows.append(sum(map(rows_in, mine)))
        names.append(f"{part.kind}, {part.robot}, {len(part.scenes)} scenes")
        cost, scene, each = _sample(plan, worlds, part, mine[0]) if mine else (0.0, 0.0, 0.0)
        costs.append(cost)
        scenes.append(scene)
        size += each * rows[-1]
    place = folder
    while not place.exists():
        place = place.parent
    counts = [len(part.scenes) for part in parts_of(plan)]
    return Estimate(rows, names, costs, scenes, counts, int(size), len(wanted), shutil.disk_usage(place).free)
