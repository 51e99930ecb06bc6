# SPDX-License-Identifier: BSD-3-Clause
"""manifest.json: the plan of a campaign and a record of each finished shard. Equal campaigns give equal bytes."""
from __future__ import annotations

import contextlib
import fcntl
import json
import pathlib
from typing import Any, Iterator

from .campaign import digest_of_file
from .errors import FleetError
from .plan import FORMAT
from .shard import write_atomically
from .tables import add_digests

__all__ = ["content_digest", "locked", "read_manifest", "sound_records", "start_manifest", "write_manifest"]

NAME = "manifest.json"


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
        manifest = json.loads(path.read_text())
        plan = manifest["plan"]
        version, records = plan["format"], {record["index"]: record for record in manifest["shards"]}
    except OSError as error:
        raise FleetError(path, "", error.strerror or str(error), "give the folder of a campaign's results") from None
    except (ValueError, KeyError, TypeError):
        raise FleetError(path, "", "is no manifest of a campaign", "move it away and run the campaign again: whole files are kept") from None
    if version != FORMAT:
        raise FleetError(path, "plan.format", f"is {version}, and this version of leeway knows {FORMAT}",
            f"go on with leeway {plan.get('leeway', 'of the time')}, or give another --out folder")
    return plan, records


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
    if not (folder / NAME).exists():
        write_manifest(folder, plan, {})
        return {}
    old, records = read_manifest(folder)
    if old["leeway"] != plan["leeway"]:
        raise FleetError(folder / NAME, "plan.leeway", f"is {old['leeway']}, and this is leeway {plan['leeway']}",
            f"go on with leeway {old['leeway']}, or give another --out folder")
    if old["id"] != plan["id"]:
        raise FleetError(folder / NAME, "plan", f"is of another campaign, {_difference(old, plan)}",
            "give another --out folder, or put the campaign back as it was")
    return records


def sound_records(folder: pathlib.Path, records: dict[int, dict[str, Any]]) -> tuple[dict[int, dict[str, Any]], dict[str, str]]:
    """(records whose files have the recorded bytes, the other files with their fault)."""
    sound, faults = {}, {}
    for index, record in records.items():
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
        lock = open(folder / ".lock", "w")
    except OSError as error:
        raise FleetError(folder, "", f"cannot hold results: {error.strerror or error}", "give another --out folder") from None
    with lock as file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise FleetError(folder, "", "another run works in this folder", "wait for it, or give another --out folder") from None
        yield
