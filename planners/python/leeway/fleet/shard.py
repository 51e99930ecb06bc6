# SPDX-License-Identifier: BSD-3-Clause
"""One shard: its rows made, written whole or not at all, and looked at again."""
from __future__ import annotations

import atexit
import contextlib
import hashlib
import io
import os
import pathlib
import platform
import threading
import time
from typing import Any, Callable

import pyarrow

from .documents import parse_json
from .errors import DiskError, FleetError
from .files import is_inside, open_regular, read_regular
from .maker import maker
from .plan import Shard, blocks_of, check_plan, rows_in, segments_of, shards_of
from .registry import KINDS
from .tables import Column, columns_of, concatenate, content_of, file_of, read_rows, table_of, type_name
from .worlds import Worlds

__all__ = ["MOST_WRITES", "adopt", "content_of_file", "make_rows", "make_shard", "make_shard_aside", "shard_bytes", "start", "times_of", "worlds_here", "write_atomically"]

MOST_WRITES = 2  # shards of a process that are encoded and written at a time; the next one's rows wait


def write_atomically(path: pathlib.Path, data) -> None:
    """The file has all of the data or is not there, whatever ends this process or machine."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with open(part, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(part, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink()
        raise DiskError(path, "", f"cannot be written: {error.strerror or error}",
            "make room or give another --out, then run the campaign again: it goes on where it was") from None
    folder = os.open(path.parent, os.O_RDONLY)
    try:
        os.fsync(folder)
    finally:
        os.close(folder)


def times_of(path: pathlib.Path) -> pathlib.Path:
    """The file of a shard's measured times. Readers of Parquet folders pass over names that begin with _."""
    return path.with_name(f"_{path.stem}.times.parquet")


def make_rows(plan: dict[str, Any], worlds: Worlds, shard: Shard):
    """(columns, their values, measured values) of a shard."""
    part, kind = shard.part, KINDS[shard.part.kind]
    made = [kind.make(part, worlds, s.scene, s.begin, s.end) for s in segments_of(part, shard.begin, shard.end)]
    columns = kind.columns(part, worlds)
    return columns, concatenate(columns, [rows.values for rows in made]), concatenate(kind.measured(part), [rows.measured for rows in made])


def _content(shard: Shard, columns, values) -> str:
    return content_of(f"{shard.part.index}", columns, values, blocks_of(shard.part, shard.begin, shard.end))


def _metadata(plan: dict[str, Any], shard: Shard, content: str) -> dict[str, Any]:
    used = [segment.scene for segment in segments_of(shard.part, shard.begin, shard.end)]
    return {"format": plan["format"], **maker(), "manifest": plan["id"], "campaign": plan["campaign"]["name"],
        "seed": plan["campaign"]["seed"], "part": shard.part.index, "kind": shard.part.kind, "robot": shard.part.robot,
        "first_scene": used[0], "scenes": shard.part.scenes[used[0]:used[-1] + 1], "options": shard.part.options,
        "blocks": [shard.begin, shard.end], "shard": shard.index, "content": content}


def shard_bytes(plan: dict[str, Any], worlds: Worlds, shard: Shard, computed: Callable[[], None] = lambda: None):
    """(Parquet file, its record, the Parquet file of measured times or None). computed: called when the rows are there, before they are encoded."""
    columns, values, measured = make_rows(plan, worlds, shard)
    computed()
    content = _content(shard, columns, values)
    metadata = _metadata(plan, shard, content)
    data = file_of(table_of(columns, values, metadata))
    times = None
    if measured:
        times = file_of(table_of(KINDS[shard.part.kind].measured(shard.part), measured, {**metadata, "measured": True}))
    return data, _record(shard, data, content), times


def _record(shard: Shard, data, content: str) -> dict[str, Any]:
    return {"index": shard.index, "file": shard.name, "rows": rows_in(shard), "bytes": len(data), "sha256": hashlib.sha256(data).hexdigest(),
        "content": content, **maker()}


def adopt(plan: dict[str, Any], worlds: Worlds, folder: pathlib.Path, shard: Shard):
    """The record of a whole file of this shard that a run before wrote and did not record, or None."""
    path = folder / shard.name
    try:
        data = read_regular(path)
        table = read_rows(io.BytesIO(data), rows_in(shard))
        metadata = parse_json((table.schema.metadata or {})[b"leeway"].decode())
        columns = KINDS[shard.part.kind].columns(shard.part, worlds)
        values = columns_of(columns, table)
        content = _content(shard, columns, values)
    except (OSError, KeyError, TypeError, ValueError, IndexError, AttributeError, MemoryError, OverflowError, pyarrow.ArrowException):
        return None
    expected = _metadata(plan, shard, content)
    return _record(shard, data, content) if metadata == expected and file_of(table_of(columns, values, expected)) == data else None


def content_of_file(path: pathlib.Path, shard: Shard) -> str:
    """The digest of the rows that a file of this shard holds. Raises as tables.read_rows()."""
    with open_regular(path) as file:
        table = read_rows(file, rows_in(shard))
    columns = [Column(field.name, type_name(field.type), "", "") for field in table.schema]
    return _content(shard, columns, columns_of(columns, table))


_STARTED: dict[str, tuple[Worlds, list[Shard]]] = {}  # of the one plan that this process works on
_STARTING = threading.RLock()
_SPENT = [0.0]
_WRITES = threading.BoundedSemaphore(MOST_WRITES)
atexit.register(_STARTED.clear)  # before the interpreter takes the module of the worlds down


def start(worlds: Worlds) -> None:
    """From now on this process makes shards of the plan of these worlds."""
    _STARTED.clear()
    _STARTED[worlds.plan["id"]] = worlds, shards_of(worlds.plan)
    _spent()


def _spent() -> float:
    """Processor time of this process since the last call, seconds: a sum over shards counts nothing twice, though they overlap."""
    with _STARTING:
        now, before = time.process_time(), _SPENT[0]
        _SPENT[0] = now
    return now - before


def worlds_here(identity: str, base: str, folder: pathlib.Path) -> Worlds:
    """The worlds of the plan in the folder's manifest, once in each process. identity: of the plan."""
    return _started(identity, base, folder)[0]


def _started(identity: str, base: str, folder: pathlib.Path) -> tuple[Worlds, list[Shard]]:
    with _STARTING:
        if identity not in _STARTED:
            path = folder / "manifest.json"
            try:
                plan = parse_json(read_regular(path).decode())["plan"]
            except OSError as error:
                raise FleetError(path, "", f"{error.strerror or error}, for a worker on {platform.node()}",
                    "give an --out folder and a campaign that all workers see under the same paths") from None
            except (ValueError, KeyError, TypeError) as error:
                raise FleetError(path, "", f"is no manifest of a campaign: {error}", "start the campaign again") from None
            check_plan(path, plan)
            if plan["id"] != identity:
                raise FleetError(path, "", "is of another campaign", "let one run at a time work in this folder")
            start(Worlds(plan, base))
        return _STARTED[identity]


def make_shard(identity: str, base: str, folder: str, index: int, computed: Callable[[], None] = lambda: None) -> tuple[dict[str, Any], float]:
    """Makes one shard's file, on any machine that has both folders. Returns its record and the processor time of this process since
    the last one, seconds.

    identity: of the plan in the folder's manifest. computed: called when the rows are there, before they are encoded and written.
    """
    out = pathlib.Path(folder)
    worlds, shards = _started(identity, base, out)
    plan, shard = worlds.plan, shards[index]
    if not is_inside(out, shard.name):
        raise FleetError(out / shard.name, "", "is reached through a link, which may lead anywhere", "replace the link by its folder")
    record = adopt(plan, worlds, out, shard) if (out / shard.name).exists() else None
    if record is None:
        data, record, times = shard_bytes(plan, worlds, shard, computed)
        if times is not None:
            write_atomically(times_of(out / shard.name), times)
        write_atomically(out / shard.name, data)
    return record, _spent()


def make_shard_aside(identity: str, base: str, folder: str, index: int) -> tuple[dict[str, Any], float]:
    """make_shard() for a worker of Dask, which begins the next shard while this one is encoded and written."""
    with contextlib.ExitStack() as writing:
        def computed() -> None:
            writing.enter_context(_WRITES)
            distributed.secede()

        import distributed
        return make_shard(identity, base, folder, index, computed)
