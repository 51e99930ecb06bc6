# SPDX-License-Identifier: BSD-3-Clause
"""Kind of work on somebody's paths: all of some files in all scenes, or the rows of a table, each with a scene and a start of its own.

A table is CSV or Parquet with the columns

| column | content |
|---|---|
| path | file of paths, relative to the campaign |
| name | of one path in the file; empty or no such column: all of them, a row each |
| scene | name of a scene of the campaign, kitchens/17 of a generator, or a scene file; empty: no obstacles |
| start | MoveIt request; its start state has the joints outside of the group, and the path should begin there; empty or no such column: none |
"""
from __future__ import annotations

import csv
import io
import pathlib
from typing import Any

import numpy
import pyarrow
import pyarrow.parquet

from .._core import Checker, Verdict
from .campaign import Option, files_of
from .documents import read_text
from .errors import FleetError
from .files import digest_of_file, read_regular
from .kinds import CHECKS, Kind, Part, Rows, named_pairs, pair_columns, worst
from .looks import look_at_path
from .paths import once
from .tables import Column, Words
from .worlds import Worlds, scene_digest

__all__ = ["Audits"]

COLUMNS = ("path", "name", "scene", "start")
NEEDED = ("path", "scene")


def _cells_of_csv(file: pathlib.Path) -> dict[str, list[str]]:
    rows = [row for row in csv.reader(io.StringIO(read_text(file), newline=""), strict=True) if row]
    names = [name.strip() for name in rows[0]] if rows else []
    once(file, "header", names, "column")
    for k, row in enumerate(rows[1:], 1):
        if len(row) != len(names):
            raise FleetError(file, f"row {k}", f"has {len(row)} cells under {len(names)} columns", "correct the row")
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(names)}


def _cells_of_parquet(file: pathlib.Path) -> dict[str, list[str]]:
    table = pyarrow.parquet.read_table(io.BytesIO(read_regular(file)))
    once(file, "schema", table.column_names, "column")
    for field in table.schema:
        kind = field.type.value_type if pyarrow.types.is_dictionary(field.type) else field.type
        if not (pyarrow.types.is_string(kind) or pyarrow.types.is_large_string(kind)):
            raise FleetError(file, field.name, f"has the type {field.type}", "give texts")
    return {name: [value or "" for value in table.column(name).to_pylist()] for name in table.column_names}


def _read_table(file: pathlib.Path) -> list[dict[str, str]]:
    """The rows, each with all columns."""
    try:
        cells = _cells_of_parquet(file) if file.suffix == ".parquet" else _cells_of_csv(file)
    except FleetError:
        raise
    except OSError as error:
        raise FleetError(file, "", error.strerror or f"is no Parquet: {error}", "correct the path or the file") from None
    except (ValueError, csv.Error, pyarrow.ArrowException) as error:
        raise FleetError(file, "", f"is no table: {str(error).splitlines()[0]}", "give CSV, or Parquet that ends in .parquet") from None
    for name in (*cells, *NEEDED):
        if name not in COLUMNS or name not in cells:
            raise FleetError(file, name, "is no known column" if name in cells else "is missing", f"known are {', '.join(COLUMNS)}")
    count = len(cells["path"])
    if count == 0:
        raise FleetError(file, "", "has no rows", "give a row for each path and scene")
    rows = [{name: cells[name][k] if name in cells else "" for name in COLUMNS} for k in range(count)]
    places: dict[tuple, int] = {}
    for k, row in enumerate(rows, 1):
        if not row["path"]:
            raise FleetError(file, f"row {k}", "has no path", "give a file of paths")
        if tuple(row.values()) in places:
            raise FleetError(file, f"row {places[tuple(row.values())]} and row {k}", "are the same", "keep one of them")
        places[tuple(row.values())] = k
    return rows


def _scene_of(file: pathlib.Path, place: str, given: str, worlds: Worlds) -> list:
    """[name, instance]"""
    scenes = worlds.plan["campaign"]["scenes"]
    name, _, number = given.rpartition("/")
    if given in scenes and scenes[given]["count"] > 1:
        raise FleetError(file, place, f"scene {given} is {scenes[given]['count']} scenes", f"give {given}/0 to {given}/{scenes[given]['count'] - 1}")
    if given in scenes or not given:
        return [given, 0]
    if name in scenes and number.isascii() and number.isdigit():
        if int(number) >= scenes[name]["count"]:
            raise FleetError(file, place, f"scene {given}: {name} has {scenes[name]['count']} scenes", f"give {name}/0 to {name}/{scenes[name]['count'] - 1}")
        return [name, int(number)]
    with_digest = worlds.plan["inputs"]["scenes"]
    if given not in with_digest:
        try:
            found = worlds.problem(given, 0)[0]
        except ValueError as error:
            raise FleetError(file, place, f"scene: {error}", "name a scene of the campaign or a scene file") from None
        with_digest[given] = scene_digest(found)
    return [given, 0]


def _note_file(file: pathlib.Path, place: str, name: str, worlds: Worlds) -> None:
    """The digest of a file that rows are a function of."""
    files = worlds.plan["inputs"]["files"]
    if name not in files:
        try:
            files[name] = digest_of_file(worlds.folder / name)
        except (OSError, ValueError) as error:
            raise FleetError(file, place, f"{name}: {getattr(error, 'strerror', None) or error}", f"paths are relative to {worlds.folder}") from None


def _rows_of_table(name: str, worlds: Worlds, variables: list[str]) -> list[list]:
    """[file, index, name in the file, scene, instance, start] of each row."""
    file, out = worlds.folder / name, []
    _note_file(file, "", name, worlds)
    for k, row in enumerate(_read_table(file), 1):
        place = f"row {k}"
        scene = _scene_of(file, place, row["scene"], worlds)
        for used in filter(None, (row["path"], row["start"])):
            _note_file(file, place, used, worlds)
        found = [[row["path"], i, path.name, *scene, row["start"]] for i, path in enumerate(worlds.paths(row["path"], variables))
            if row["name"] in ("", path.name)]
        if not found:
            raise FleetError(file, place, f"{row['path']} has no path {row['name']!r}", "give one of its names, or none for all of them")
        out += found
    return out


def _gap(checker: Checker, first: numpy.ndarray, start: dict[str, float]) -> float:
    """The greatest difference of a joint between a path's first state and its start, or NaN."""
    steps = [(first[i] - start[name], checker.wraps[i]) for i, name in enumerate(checker.variables) if name in start]
    return max((abs(numpy.remainder(step + numpy.pi, 2 * numpy.pi) - numpy.pi) if wraps else abs(step) for step, wraps in steps), default=numpy.nan)


class Audits(Kind):
    """Somebody's paths: proofs of their edges, and dense looks. A row is a path."""
    block = 4
    options = {"files": Option(list, []), "table": Option(str, ""), **CHECKS, "slack": Option(float, 1e-4, 1e-9), "audit_step": Option(float, 0.01, 1e-6)}

    def prepare(self, campaign, element: str, entry: dict[str, Any]) -> dict[str, Any]:
        if len(entry["robots"]) != 1:
            raise FleetError(campaign.file, f"{element}.robots", "are not one", "give the robot of these paths")
        if bool(entry["files"]) == bool(entry["table"]):
            raise FleetError(campaign.file, element, "has both or none of files and table", "give one of them")
        if entry["table"] and entry["scenes"]:
            raise FleetError(campaign.file, f"{element}.scenes", "are given beside a table, whose rows name theirs", "leave the entry out")
        return {"files": files_of(campaign, f"{element}.files", entry["files"])}

    def count(self, entry, extra, worlds, robot) -> int:
        variables = worlds.checker_of(robot, worlds.problem("", 0)[0]).variables
        if entry["table"]:
            extra["paths"] = _rows_of_table(entry["table"], worlds, variables)
            for start in sorted({row[5] for row in extra["paths"]} - {""}):
                worlds.start(start, robot)  # refuses one of another robot
        else:
            extra["paths"] = [[file, i, path.name] for file in extra["files"] for i, path in enumerate(worlds.paths(file, variables))]
        return len(extra["paths"])

    def columns(self, part: Part, worlds: Worlds) -> list[Column]:
        place = [Column("scene", "string", "", "of the table"), Column("start", "string", "", "request of the table"),
            Column("start_gap", "double", "rad or m", "greatest difference of a joint between the first state and the start; NaN without a start")]
        return [*(place if part.options["table"] else [Column("scene", "int32", "", "index into the part's scenes")]), Column("file", "string", "", "of the path"),
            Column("path", "string", "", "its name in the file"), Column("states", "int64", "1", "of the path"),
            Column("length", "double", "rad or m", "Euclidean"), Column("verdict", "uint8", "", "of all edges: 1 FREE, 2 BLOCKED, 3 UNDECIDED"),
            Column("edge", "int64", "", "the first edge that is not FREE; -1 if there is none"), Column("t", "double", "1", "share of it"),
            Column("lower", "double", "m", "proved lower bound of all clearances of a FREE path; else 0"),
            *pair_columns("the deciding pair"), Column("outside", "bool", "", "a state is outside of the joint limits"),
            Column("least", "double", "m", "least clearance of dense states"), Column("contact_share", "double", "1", "share of the length in contact"),
            Column("contradiction", "bool", "", "a dense state refutes the verdict")]

    def _row(self, part: Part, checker: Checker, path: numpy.ndarray) -> dict[str, Any]:
        o = part.options
        found = checker.path(path, min_d=o["min_d"], slack=o["slack"], check=o["check"])
        verdict = worst(found.verdicts)
        edge = int(numpy.flatnonzero(found.verdicts == verdict)[0]) if verdict != int(Verdict.FREE) else -1
        least, _, _, share = look_at_path(checker, path, o["check"], o["audit_step"])
        lower = float(found.lower.min()) if edge < 0 else 0.0
        outside = (path < checker.lower - 1e-5) | (path > checker.upper + 1e-5)
        pair = found.pairs[max(0, edge)]
        return {"states": len(path), "length": float(numpy.linalg.norm(numpy.diff(path, axis=0), axis=1).sum()), "verdict": verdict, "edge": edge,
            "t": float(found.t[max(0, edge)]), "lower": lower, "outside": bool(outside[:, ~checker.wraps].any()), "least": least, "contact_share": share,
            "contradiction": edge < 0 and (least <= o["min_d"] or least < lower - 1e-9),
            "pair": named_pairs(checker, pair[None])}

    def make(self, part: Part, worlds: Worlds, scene: int, begin: int, end: int) -> Rows:
        rows, given = [], part.extra["paths"][begin:end]
        for file, index, _, *own in given:
            name, instance, start = own or (*part.scenes[scene], "")
            checker = worlds.checker(part.robot, name, instance, start)
            path = worlds.paths(file, checker.variables)[index].positions
            row = self._row(part, checker, path)
            row.update({"start_gap": _gap(checker, path[0], worlds.start(start, part.robot)) if start else numpy.nan} if own else {"scene": scene})
            rows.append(row)
        place = numpy.arange(len(rows), dtype="<i4")
        values: dict[str, Any] = {name: numpy.array([row[name] for row in rows]) for name in rows[0] if name != "pair"}
        values.update(file=Words(place, [entry[0] for entry in given]), path=Words(place, [entry[2] for entry in given]))
        for name in ("first", "second"):
            values[name] = Words(place, [row["pair"][name].strings()[0] for row in rows])
        if part.options["table"]:
            several = worlds.plan["campaign"]["scenes"]
            values["scene"] = Words(place, [f"{entry[3]}/{entry[4]}" if several.get(entry[3], {}).get("count", 1) > 1 else entry[3] for entry in given])
            values["start"] = Words(place, [entry[5] for entry in given])
        return Rows(values, {})
