# SPDX-License-Identifier: BSD-3-Clause
"""Tables and plots of a campaign's results, as one HTML page."""
from __future__ import annotations

import base64
import html
import io
import pathlib
from typing import Any, NamedTuple

import numpy
import pandas
import pyarrow

from .._core import Verdict
from .documents import parse_json
from .errors import FleetError
from .files import open_regular, read_regular
from .manifest import content_digest, read_manifest, sound_records
from .plan import Part, parts_of, rows_in, shards_of
from .registry import KINDS
from .shard import times_of, write_atomically
from .tables import read_rows

__all__ = ["Report", "frame_of", "report"]

AGAIN = "move the file away and run the campaign again"
MOST_ROWS = 2_000_000  # that a plot looks at
TOLD = 5  # missing shards by name
MOST_FIGURE = 1e15  # of runs: seconds, rows
NAMES = {int(v): v.name for v in (Verdict.FREE, Verdict.BLOCKED, Verdict.UNDECIDED)}


class Report(NamedTuple):
    page: pathlib.Path
    tables: dict[str, pandas.DataFrame]  #: part to its figures
    contradictions: int  #: rows of all parts that a dense look refutes
    missing: list[str]  #: files that were not made yet
    faults: dict[str, str]  #: file to fault: its rows are left out

    def __repr__(self) -> str:
        lines = [f"{name}\n{table.to_string(index=False)}\n" for name, table in self.tables.items()]
        return "\n".join([*lines, *self.holes(), f"{self.contradictions} contradictions; page {self.page}"])

    def holes(self) -> list[str]:
        """Lines on rows that the figures lack."""
        missing = [f"{name}: is missing" for name in self.missing[:TOLD]]
        if len(self.missing) > TOLD:
            missing.append(f"and {len(self.missing) - TOLD} other shards are missing")
        return missing + [f"{name}: {fault}; its rows are left out" for name, fault in self.faults.items()]


def frame_of(folder, part: Part, columns: list[str] | None = None, times: bool = False, most: int | None = None) -> pandas.DataFrame:
    """Rows of a part, those of finished shards; times: measured columns in place of the others. Raises FleetError for a file that is not the
    recorded one, or no table of this part."""
    plan, records = read_manifest(folder)
    shards = shards_of(plan)
    sound, faults = sound_records(pathlib.Path(folder), plan, {i: record for i, record in records.items() if shards[i].part.index == part.index})
    for name, fault in faults.items():
        raise FleetError(pathlib.Path(folder) / name, "", fault, "run the campaign again: it makes the file again")
    return _frame(pathlib.Path(folder), plan, part, set(sound), columns, times, most)


def _frame(folder: pathlib.Path, plan: dict[str, Any], part: Part, whole: set[int], columns: list[str] | None = None, times: bool = False,
        most: int | None = None) -> pandas.DataFrame:
    frames, count = [], 0
    for shard in shards_of(plan):
        if shard.part.index != part.index or shard.index not in whole or (most is not None and count >= most):
            continue
        path = times_of(folder / shard.name) if times else folder / shard.name
        try:
            with open_regular(path) as file:
                frame = read_rows(file, rows_in(shard), columns).to_pandas()
        except (OSError, ValueError, KeyError, MemoryError, OverflowError, pyarrow.ArrowException) as error:
            raise FleetError(path, "", f"is no table of this campaign: {str(error).splitlines()[0] if str(error) else type(error).__name__}", AGAIN) from None
        frames.append(frame)
        count += rows_in(shard)
    return pandas.concat(frames, ignore_index=True) if frames else pandas.DataFrame()


def _scene_names(part: Part) -> list[str]:
    return [name for name, _ in part.scenes]


def _by_scene(part: Part, frame: pandas.DataFrame) -> pandas.DataFrame:
    if part.options.get("table"):  # rows have names of scenes
        return frame.assign(scenes=[name or "no obstacles" for name in frame["scene"].astype(str)])
    names = numpy.array(_scene_names(part), object)
    if not frame["scene"].between(0, len(names) - 1).all():
        raise ValueError(f"a scene is none of {len(names)}")
    return frame.assign(scenes=[name or "no obstacles" for name in names[frame["scene"]]])


def _states(part: Part, frame: pandas.DataFrame) -> pandas.DataFrame:
    least = part.options["min_d"]
    grouped = _by_scene(part, frame.assign(free=frame["lower"] > least, width=frame["upper"] - frame["lower"])).groupby("scenes")
    return grouped.agg(states=("free", "size"), free=("free", "mean"), median_clearance=("upper", "median"), widest_interval=("width", "max")).reset_index()


def _verdicts(part: Part, frame: pandas.DataFrame) -> pandas.DataFrame:
    frame = _by_scene(part, frame)
    if not frame["verdict"].isin(NAMES).all():
        raise ValueError("a verdict is none")
    out = frame.groupby(["scenes", frame["verdict"].map(NAMES)]).size().unstack(fill_value=0)
    for name in ("audited", "contradiction"):
        if name in frame:
            out[name] = frame.groupby("scenes")[name].sum()
    return out.reset_index()


def _plans(part: Part, frame: pandas.DataFrame) -> pandas.DataFrame:
    frame = _by_scene(part, frame.assign(solved=frame["outcome"] == "SOLVED"))
    grouped = frame.groupby(["scenes", frame["planner"].astype(str)], observed=True)
    return grouped.agg(plans=("solved", "size"), solved=("solved", "sum"), median_length=("length", "median"), median_ms=("ms", "median"),
        p95_ms=("ms", lambda x: x.quantile(0.95)), in_contact=("contact", "sum"), proved=("proved", "sum"), least_clearance=("least", "min"), contradiction=("contradiction", "sum")).reset_index()


def _audit(part: Part, frame: pandas.DataFrame) -> pandas.DataFrame:
    frame = _by_scene(part, frame.assign(contact=frame["least"] <= 0, proved=frame["verdict"] == int(Verdict.FREE)))
    return frame.groupby("scenes").agg(paths=("contact", "size"), proved_free=("proved", "sum"), in_contact=("contact", "sum"),
        longest_contact=("contact_share", "max"), least_clearance=("least", "min"), contradiction=("contradiction", "sum")).reset_index()


def _spheres(part: Part, frame: pandas.DataFrame) -> pandas.DataFrame:
    return frame[["link", "shapes", "spheres", "encloses", "uncovered", "excess"]]


TABLES = {"states": _states, "edges": _verdicts, "trajectories": _verdicts, "plans": _plans, "audit": _audit, "spheres": _spheres,
    "schedules": _verdicts}
PLOTTED = {"states": ("upper", "clearance, m"), "edges": ("least", "least clearance of audited edges, m"), "trajectories": ("least", "least clearance of audited trajectories, m"),
    "plans": ("length", "length of paths, rad or m"), "audit": ("least", "least clearance of paths, m"), "spheres": ("uncovered", "part of a link outside of all spheres, m"),
    "schedules": ("lower", "proved lower bound of clearances, m")}


def _plot(part: Part, frame: pandas.DataFrame) -> str:
    """A histogram as an image in the page."""
    from matplotlib.figure import Figure
    column, label = PLOTTED[part.kind]
    values = frame[column].to_numpy() if column in frame else numpy.empty(0)
    values = values[numpy.isfinite(values)]
    if not len(values):
        return ""
    figure = Figure(figsize=(6, 2.4), dpi=110, layout="constrained")
    axes = figure.add_subplot()
    axes.hist(values, bins=60, color="#36707a")
    axes.set(xlabel=label, ylabel="rows")
    out = io.BytesIO()
    figure.savefig(out, format="png")
    return f'<img alt="{html.escape(label)}" src="data:image/png;base64,{base64.b64encode(out.getvalue()).decode()}">'


def _part(folder: pathlib.Path, plan: dict[str, Any], part: Part, whole: set[int]) -> tuple[pandas.DataFrame, str, int]:
    frame = _frame(folder, plan, part, whole, most=MOST_ROWS)
    if not len(frame):
        return pandas.DataFrame({"rows": [0]}), "", 0
    try:
        if KINDS[part.kind].measured(part):
            frame["ms"] = 1e3 * _frame(folder, plan, part, whole, times=True, most=MOST_ROWS)["seconds"]
        contradictions = int(_frame(folder, plan, part, whole, ["contradiction"])["contradiction"].sum()) if "contradiction" in frame else 0  # of all rows
        return TABLES[part.kind](part, frame), _plot(part, frame), contradictions
    except FleetError:
        raise
    except (KeyError, TypeError, ValueError, IndexError, AttributeError, OverflowError, MemoryError, pyarrow.ArrowException) as error:  # of another schema
        raise FleetError(folder, f"part {part.index:02d} {part.kind}, {part.robot}", f"its files are no tables of this campaign: {error}", AGAIN) from None


def _is_figure(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and 0 <= value < MOST_FIGURE


def _runs(folder: pathlib.Path) -> str:
    try:
        lines = [parse_json(line) for line in read_regular(folder / "runs.jsonl").decode().splitlines()]
    except (OSError, ValueError):
        return ""
    fields = {"workers", "shards", "rows", "seconds", "processor_seconds"}
    lines = [r for r in lines if isinstance(r, dict) and all(_is_figure(r.get(name)) for name in fields)]
    rows = [{"workers": r["workers"], "shards": r["shards"], "rows": r["rows"], "seconds": round(r["seconds"], 1),
        "rows_a_second": round(r["rows"] / max(r["seconds"], 1e-9)), "processor_us_a_row": round(1e6 * r["processor_seconds"] / max(r["rows"], 1), 2)} for r in lines]
    return "<h2>Runs</h2>" + pandas.DataFrame(rows).to_html(index=False)


STYLE = "body{font:15px sans-serif;margin:2em auto;max-width:60em}table{border-collapse:collapse}td,th{padding:.2em .7em;text-align:right;border-bottom:1px solid #ccc}"


def report(folder, page=None) -> Report:
    """Writes a page (default: report.html in the folder). Plots and tables of a part look at its first two million rows,
    contradictions are counted in all. Files that are not the recorded ones are named and left out."""
    folder = pathlib.Path(folder)
    plan, records = read_manifest(folder)
    sound, faults = sound_records(folder, plan, records)
    tables, contradictions = {}, 0
    missing = [shard.name for shard in shards_of(plan) if shard.index not in records]
    total = len(records) + len(missing)
    text: list[Any] = [f"<!doctype html><meta charset=utf-8><title>{html.escape(plan['campaign']['name'])}</title><style>{STYLE}</style>",
        f"<h1>{html.escape(plan['campaign']['name'])}</h1><p>leeway {plan['leeway']}, seed {plan['campaign']['seed']}; {len(records)} of {total} shards, "
        f"{sum(r['rows'] for r in records.values())} rows; content <code>{content_digest(records)}</code></p>"]
    for part in parts_of(plan):
        table, plot, wrong = _part(folder, plan, part, set(sound))
        name = f"{part.index:02d} {part.kind}, {part.robot}"
        tables[name] = table
        contradictions += wrong
        text.append(f"<h2>{html.escape(name)}</h2>{table.to_html(index=False, float_format=lambda x: f'{x:.5g}')}{plot}")
    text.append(_runs(folder))
    out = pathlib.Path(page) if page is not None else folder / "report.html"
    found = Report(out, tables, contradictions, missing, faults)
    text += [f"<p><strong>{html.escape(line)}</strong></p>" for line in found.holes()]
    text.append(f"<p>{contradictions} contradictions.</p>")
    write_atomically(out, "\n".join(text).encode())
    return found
