# SPDX-License-Identifier: BSD-3-Clause
"""manifest.json: the plan of a campaign and a record of each finished shard. Equal campaigns give equal bytes."""
from __future__ import annotations

import contextlib
import fcntl
import json
import os
import pathlib
import re
from typing import Any, Iterator

from .campaign import shown
from .documents import parse_json
from .errors import FleetError
from .files import digest_of_file, is_inside, read_regular
from .maker import maker_text
from .plan import FORMAT, check_plan, rows_in, shards_of
from .shard import write_atomically
from .tables import add_digests

__all__ = ["content_digest", "locked", "read_manifest", "sound_records", "start_manifest", "write_manifest"]

NAME = "manifest.json"
REMEDY = "move it away and run the campaign again: whole files are kept"
HASH = re.compile("[0-9a-f]{64}")
RECORD = ("bytes", "sha256", "content", "leeway", "module")  # entries of a record beside those that follow from the plan


def write_manifest(folder: pathlib.Path, plan: dict[str, Any], records: dict[int, dict[str, Any]]) -> None:
    manifest = {"plan": plan, "shards": [records[i] for i in sorted(records)], "content": content_digest(records)}
    write_atomically(folder / NAME, (json.dumps(manifest, sort_keys=True, indent=1) + "\n").encode())


def content_digest(records: dict[int, dict[str, Any]]) -> str:
    """Of all rows; it does not depend on shards."""
    return add_digests(record["content"] for record in records.values())


def read_manifest(folder) -> tuple[dict[str, Any], dict[int, dict[str, Any]]]:
    """(plan, records by index)."""
    path = pathlib.Path(folder) / NAME
    try:
        manifest = parse_json(read_regular(path).decode())
        plan, shards, content = manifest["plan"], manifest["shards"], manifest["content"]
        version = plan["format"]
    except OSError as error:
        raise FleetError(path, "", error.strerror or str(error), "give the folder of a campaign's results") from None
    except (ValueError, KeyError, TypeError) as error:
        raise FleetError(path, "", f"is no manifest of a campaign: {error}", REMEDY) from None
    if version != FORMAT:
        raise FleetError(path, "plan.format", f"is {version}, and this version of leeway knows {FORMAT}",
            f"go on with leeway {plan.get('leeway', 'of the time')}, or give another --out folder")
    check_plan(path, plan)
    records = _checked_records(path, plan, shards)
    if content != content_digest(records):
        raise FleetError(path, "content", "is not the digest of the shards: the file was changed", REMEDY)
    return plan, records


def _checked_records(path: pathlib.Path, plan: dict[str, Any], given: Any) -> dict[int, dict[str, Any]]:
    """The records, each of a shard of the plan: names and rows are computed, never believed."""
    shards, records = shards_of(plan), {}
    if not isinstance(given, list):
        raise FleetError(path, "shards", "is no list", REMEDY)
    for i, record in enumerate(given):
        index = record.get("index") if isinstance(record, dict) else None
        if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < len(shards) or index in records:
            raise FleetError(path, f"shards[{i}].index", f"is {shown(index)}; the plan has {len(shards)} shards, each once", REMEDY)
        expected = {"index": index, "file": shards[index].name, "rows": rows_in(shards[index])}
        for name, value in expected.items():
            if record.get(name) != value or isinstance(record.get(name), bool):
                raise FleetError(path, f"shards[{i}].{name}", f"is {shown(record.get(name))}, and shard {index} has {value}", REMEDY)
        for name in ("sha256", "content"):
            if not isinstance(record.get(name), str) or not HASH.fullmatch(record[name]):
                raise FleetError(path, f"shards[{i}].{name}", f"is {shown(record.get(name))}, no digest", REMEDY)
        if not isinstance(record.get("leeway"), str) or not isinstance(record.get("module"), str):
            raise FleetError(path, f"shards[{i}]", f"does not say which leeway made shard {index}", REMEDY)
        if not isinstance(record.get("bytes"), int) or isinstance(record["bytes"], bool) or set(record) != {*expected, *RECORD}:
            raise FleetError(path, f"shards[{i}]", "is no record of a shard", REMEDY)
        records[index] = record
    return records


def _difference(old: Any, new: Any, place: str = "") -> str:
    """The first place at which two plans differ."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in sorted({*old, *new}):
            if key != "id" and old.get(key) != new.get(key):
                return _difference(old.get(key), new.get(key), f"{place}.{key}".lstrip("."))
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        for i, pair in enumerate(zip(old, new)):
            if pair[0] != pair[1]:
                return _difference(*pair, f"{place}[{i}]")
    return f"{place}: {json.dumps(old)[:60]} there, {json.dumps(new)[:60]} now"


def start_manifest(folder: pathlib.Path, plan: dict[str, Any]) -> dict[int, dict[str, Any]]:
    """The records of runs before; a new manifest if there is none. Raises FleetError if the folder is another campaign's."""
    if not os.path.lexists(folder / NAME):
        write_manifest(folder, plan, {})
        return {}
    old, records = read_manifest(folder)
    if old["leeway"] != plan["leeway"]:
        raise FleetError(folder / NAME, "plan.leeway", f"is {old['leeway']}, and this is leeway {plan['leeway']}",
            f"go on with leeway {old['leeway']}, or give another --out folder")
    if old["module"] != plan["module"]:
        raise FleetError(folder / NAME, "plan.module", f"is of another build, {maker_text(old)}; this is {maker_text(plan)}",
            "go on with that build, or give another --out folder")
    if old["id"] != plan["id"]:
        raise FleetError(folder / NAME, "plan", f"is of another campaign, {_difference(old, plan)}",
            "give another --out folder, or put the campaign back as it was")
    return records


def sound_records(folder: pathlib.Path, plan: dict[str, Any], records: dict[int, dict[str, Any]]) -> tuple[dict[int, dict[str, Any]], dict[str, str]]:
    """(records whose files have the recorded bytes and were made by the plan's build of leeway, the other files with their fault)."""
    sound, faults = {}, {}
    for index, record in records.items():
        if (record["leeway"], record["module"]) != (plan["leeway"], plan["module"]):
            faults[record["file"]] = f"was made by {maker_text(record)}, and the campaign is of {maker_text(plan)}"
            continue
        if not is_inside(folder, record["file"]):
            raise FleetError(folder / record["file"], "", "is reached through a link, which may lead anywhere", "replace the link by its folder")
        try:
            digest = digest_of_file(folder / record["file"])
        except OSError as error:
            faults[record["file"]] = error.strerror or str(error)
            continue
        if digest == record["sha256"]:
            sound[index] = record
        else:
            faults[record["file"]] = "its bytes are not the recorded ones"
    return sound, faults


@contextlib.contextmanager
def locked(folder: pathlib.Path) -> Iterator[None]:
    """One run at a time in a folder. The lock goes with the process."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = os.fdopen(os.open(folder / ".lock", os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC, 0o666), "w")
    except OSError as error:
        raise FleetError(folder, "", f"cannot hold results: {error.strerror or error}", "give another --out folder") from None
    with lock as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise FleetError(folder, "", "another run works in this folder", "wait for it, or give another --out folder") from None
        yield
