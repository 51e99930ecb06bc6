# SPDX-License-Identifier: BSD-3-Clause
"""The referee: paths of several planners on the same problems, audited on the real meshes, as one page.

    leeway-bench planning --row leeway --row "own states" --row VAMP --module vamp.so --paths paths.jsonl
    python -m leeway.fleet referee paths.jsonl --data ../shared/data --out referee

Each line of the file is a path with its problem, planner, times and joints. The audit proves or refutes its edges by a checker and looks at
dense states; the length in contact is given as a share of the path's. The name of the planner plays no part.
"""
from __future__ import annotations

import base64
import html
import pathlib
import subprocess
import sys
from typing import Any, NamedTuple

import numpy
import pandas

from .._core import Checker, Robot, Scene, Verdict
from .campaign import REQUIRED, Option, checked
from .cases import Case, Cases, same_name
from .documents import ONCE, parse_json, read_text, regular
from .errors import FleetError, named
from .files import MOST_BYTES
from .looks import look_at_path
from .paths import read_states

__all__ = ["Refereed", "judge", "referee"]

STEP = 0.01  # radians or metres of a joint between dense states
WORST = 3  # pictures
SOURCE = "give the file of leeway-bench planning --paths"
LINE = {"problem": Option(str, REQUIRED), "way": Option(str, REQUIRED), "run": Option(int, REQUIRED), "plan_us": Option(float, REQUIRED, 0),
    "simplify_us": Option(float, 0.0, 0), "in_contact": Option(bool, None), "path": Option(list, REQUIRED, of=list), "joints": Option(list, REQUIRED)}


class Refereed(NamedTuple):
    page: pathlib.Path
    paths: pandas.DataFrame
    table: pandas.DataFrame

    @property
    def contradictions(self) -> int:
        """Paths that are proved free and have a dense state in contact."""
        return int(self.paths["contradiction"].sum())

    def __repr__(self) -> str:
        return f"{self.table.to_string(index=False)}\n\n{len(self.paths)} paths, {self.contradictions} contradictions; page {self.page}"


def _group_of(robot: Robot, joints: list[str], problem: str) -> str:
    for name, members in robot.groups.items():
        if sorted(members) == sorted(joints):
            return name
    if sorted(joints) == sorted(robot.variables):
        return ""
    raise FleetError(problem, "joints", f"are those of no group: {', '.join(joints)}", "give the robot's SRDF")


class _Court:
    """Robots and checkers of the problem that is judged."""

    def __init__(self, cases: Cases):
        self.cases, self.robots, self.last = cases, {}, (None, None)

    def checker(self, file: pathlib.Path, line: dict[str, Any]) -> Checker:
        """For the joints of a line."""
        key = (line["problem"], tuple(line["joints"]))
        if self.last[0] != key:
            case, packages = self.cases.case(line["problem"]), [str(self.cases.data)]
            files = (case.urdf, case.srdf)
            with named(file, f"{line['place']}, {line['problem']}"):
                if files not in self.robots:
                    self.robots[files] = Robot(regular(case.urdf), regular(case.srdf) if case.srdf else "", packages=packages)
                robot = self.robots[files]
                reference = {name: value for name, value in start_of(case).items() if name in robot.variables}
                scene = Scene(regular(case.scene), packages=packages) if case.scene else Scene()
                self.last = (key, Checker(robot, scene, group=_group_of(robot, line["joints"], line["problem"]), reference=reference or None))
        return self.last[1]


def start_of(case: Case) -> dict[str, float]:
    """The start state of a problem by joint."""
    return read_states(case.request) if case.request else {}


def _toward(checker: Checker, a: numpy.ndarray, b: numpy.ndarray) -> numpy.ndarray:
    """From a to b, the shorter way for endless joints."""
    return numpy.where(checker.wraps, numpy.remainder(b - a + numpy.pi, 2 * numpy.pi) - numpy.pi, b - a)


def judge(checker: Checker, path: numpy.ndarray, step: float = STEP) -> dict[str, Any]:
    """Verdict, least clearance and share of the length in contact of a path."""
    found = checker.path(path, slack=1e-4)
    blocked = numpy.flatnonzero(found.verdicts == int(Verdict.BLOCKED))
    least, edge, t, share = look_at_path(checker, path, "both", step)
    free = found.all_free
    pair = checker.clearance(_worst_state(checker, path, {"edge": edge, "t": t})).pairs
    touching = len(blocked) > 0 and bool((found.clearance[blocked] <= 0).any())
    return {"proved": free, "contact": touching or least <= 0, "share": share, "least": least, "edge": edge, "t": t,
        "pair": " and ".join(checker.names[pair]), "contradiction": free and least <= 0}


def _worst_state(checker: Checker, path: numpy.ndarray, found: dict[str, Any]) -> list[float]:
    a, b = path[found["edge"]], path[found["edge"] + 1]
    return (a + found["t"] * _toward(checker, a, b)).tolist()


def _lines(file: pathlib.Path) -> list[dict[str, Any]]:
    """The lines, each checked. Two of one path are an error: it would count twice."""
    lines: list[dict[str, Any]] = []
    places: dict[tuple, int] = {}
    for k, text in enumerate(read_text(file, MOST_BYTES, SOURCE).splitlines(), 1):
        if not text.strip():
            continue
        try:
            line = parse_json(text)
        except ValueError as error:
            raise FleetError(file, f"line {k}", f"is no JSON: {error}", SOURCE) from None
        if not isinstance(line, dict):
            raise FleetError(file, f"line {k}", "is no table", SOURCE)
        line = checked(file, f"line {k}", {name: value for name, value in line.items() if name in LINE and value is not None}, LINE)
        key = (same_name(line["problem"]), line["way"], line["run"])
        if key in places:
            raise FleetError(file, f"line {places[key]} and line {k}", f"are both run {line['run']} of {line['way']} on {line['problem']!r}", ONCE)
        places[key] = k
        lines.append({**line, "place": f"line {k}"})
    if not lines:
        raise FleetError(file, "", "has no paths", SOURCE)
    return lines


def _path_of(file: pathlib.Path, line: dict[str, Any], variables: list[str]) -> numpy.ndarray:
    """float64 [n, dof] in the order of the variables."""
    try:
        path = numpy.array(line["path"], float)
    except (ValueError, TypeError, OverflowError) as error:
        raise FleetError(file, line["place"], f"path is no table of numbers: {error}", SOURCE) from None
    if path.ndim != 2 or path.shape[1] != len(line["joints"]) or len(path) < 2 or not numpy.isfinite(path).all():
        raise FleetError(file, line["place"], f"path has the shape {path.shape}, or a number that is not finite", f"give 2 rows or more of {len(line['joints'])} finite numbers")
    return path[:, [line["joints"].index(name) for name in variables]]


def _judge_all(file: pathlib.Path, cases: Cases) -> pandas.DataFrame:
    court, rows = _Court(cases), []
    for line in sorted(_lines(file), key=lambda line: line["problem"]):
        case = cases.case(line["problem"])
        checker = court.checker(file, line)
        path = _path_of(file, line, checker.variables)
        found = judge(checker, path)
        rows.append({"robot": case.robot, "set": case.set, "planner": line["way"], "problem": line["problem"], "run": line["run"],
            "ms": 1e-3 * (line["plan_us"] + line["simplify_us"]), "other_auditor": line["in_contact"], **found, "path": path.tolist(),
            "joints": checker.variables, "group": checker.group, "worst": _worst_state(checker, path, found)})
    return pandas.DataFrame(rows)


def _table(paths: pandas.DataFrame) -> pandas.DataFrame:
    together = pandas.concat([paths.assign(set="all"), paths])
    grouped = together.groupby(["robot", "set", "planner"], sort=False)
    out = grouped.agg(paths=("contact", "size"), in_contact=("contact", "sum"), percent=("contact", lambda x: round(100 * x.mean(), 1)),
        worst_percent_of_length=("share", lambda x: round(100 * x.max(), 1)), proved_free=("proved", "sum"), median_ms=("ms", lambda x: round(x.median(), 2)))
    return out.reset_index()


def _bars(table: pandas.DataFrame) -> str:
    """Shares in contact by robot and planner, as an image in the page."""
    import io

    from matplotlib.figure import Figure
    whole = table[table["set"] == "all"].pivot(index="robot", columns="planner", values="percent")
    figure = Figure(figsize=(7.5, 3), dpi=110, layout="constrained")
    axes = figure.add_subplot()
    width = 0.8 / max(1, len(whole.columns))
    for k, planner in enumerate(whole.columns):
        at = numpy.arange(len(whole)) + (k - (len(whole.columns) - 1) / 2) * width
        bars = axes.bar(at, whole[planner].fillna(0), width * 0.95, label=f" {planner}")  # a label that begins with _ is none
        axes.bar_label(bars, [f"{v:.0f}" if v == v else "" for v in whole[planner]], fontsize=8)
    axes.set_xticks(range(len(whole)), whole.index, parse_math=False)
    axes.set(ylabel="paths in contact, %")
    for text in axes.legend(fontsize=8).get_texts():
        text.set_parse_math(False)
    out = io.BytesIO()
    figure.savefig(out, format="png")
    return f'<img alt="share of paths in contact" src="data:image/png;base64,{base64.b64encode(out.getvalue()).decode()}">'


def _files_of(row, start: dict[str, float], name: pathlib.Path) -> tuple[pathlib.Path, pathlib.Path]:
    """(path, table of the one state that is in contact for certain or has the least clearance)."""
    path, table = name.with_suffix(".yaml"), name.with_suffix(".csv")
    state = ", ".join(f'"{joint}": {value!r}' for joint, value in start.items())
    points = "\n".join(f"  - [{', '.join(map(repr, point))}]" for point in row.path)
    path.write_text(f"start_state: {{{state}}}\njoint_names: [{', '.join(row.joints)}]\npoints:\n{points}\n")
    worst = {**start, **dict(zip(row.joints, row.worst))}
    table.write_text(",".join(worst) + "\n" + ",".join(map(repr, worst.values())) + "\n")
    return path, table


def _view(program: str, case: Case, data: pathlib.Path, group: str, motion: list, page: pathlib.Path, picture: pathlib.Path | None) -> str:
    """Calls `leeway view`. Returns the reason if it fails."""
    if not program:
        return "--program names no leeway"
    files = [word for option, file in (("--srdf", case.srdf), ("--scene", case.scene)) if file for word in (option, file)]
    call = [program, "view", "--robot", case.urdf, *files, *(["--group", group] if group else []), "--package-path", data, *motion,
        "--out", page, *(["--png", picture] if picture else [])]
    try:
        done = subprocess.run([str(part) for part in call], capture_output=True, text=True)
    except OSError as error:
        return f"{program}: {error.strerror}"
    return "" if done.returncode == 0 else (done.stderr.strip().splitlines() or ["no message"])[-1]


def _pictures(paths: pandas.DataFrame, cases: Cases, out: pathlib.Path, program: str) -> str:
    """The worst cases: files, a page of `leeway view` each, and a picture of the worst state."""
    touching = paths[paths["contact"]].sort_values("share", ascending=False, kind="stable").drop_duplicates(["robot", "planner"]).head(WORST)
    text = []
    for k, row in enumerate(touching.itertuples()):
        case, data, name = cases.case(row.problem), cases.data, out / f"worst_{k + 1}"
        path, table = _files_of(row, start_of(case), name)
        picture = name.with_suffix(".png")
        reason = _view(program, case, data, row.group, ["--path", path], name.with_suffix(".html"), None)
        reason = reason or _view(program, case, data, row.group, ["--states", table], out / f"worst_{k + 1}_state.html", picture)
        caption = html.escape(f"{row.planner}, {row.problem}: in contact on {100 * row.share:.1f} % of its length ({row.pair})")
        if reason:
            text.append(f"<p>{caption}. No picture: {html.escape(reason)}; the path is {path.name}, its worst state {table.name}.</p>")
            continue
        image = base64.b64encode(picture.read_bytes()).decode()
        text.append(f'<figure><a href="{name.name}.html"><img width=720 alt="{caption}" src="data:image/png;base64,{image}"></a><figcaption>{caption}</figcaption></figure>')
    return "\n".join(text)


STYLE = "body{font:15px sans-serif;margin:2em auto;max-width:62em}table{border-collapse:collapse}td,th{padding:.2em .7em;text-align:right;border-bottom:1px solid #ccc}"


def referee(file, data, out, program: str = "") -> Refereed:
    """Audits the paths of leeway-bench planning --paths. data: the folder of robots and scenes. program: `leeway`, for pictures. Writes paths.csv, table.csv
    and index.html into `out`."""
    file, out, cases = pathlib.Path(file), pathlib.Path(out), Cases(pathlib.Path(data).resolve())
    paths = _judge_all(file, cases)
    out.mkdir(parents=True, exist_ok=True)
    table = _table(paths)
    paths.drop(columns=["path", "joints", "worst"]).to_csv(out / "paths.csv", index=False)
    table.to_csv(out / "table.csv", index=False)
    other = paths[paths["other_auditor"].notna()]
    agree = int((other["other_auditor"].astype(bool) == other["contact"]).sum())
    second = f"leeway-bench's own auditor, which shares nothing with the checker, says the same of {agree} of {len(other)}. " if len(other) else ""
    page = out / "index.html"
    page.write_text("\n".join([f"<!doctype html><meta charset=utf-8><title>Referee</title><style>{STYLE}</style><h1>Paths on the real meshes</h1>",
        f"<p>{len(paths)} paths on {paths['problem'].nunique()} problems. In contact: an edge is refuted by a state, or dense states "
        f"({STEP} rad or m of a joint apart, finer where it is narrow) touch something. {second}{int(paths['contradiction'].sum())} paths are proved free and touch something.</p>",
        _bars(table), table[table["set"] == "all"].drop(columns="set").to_html(index=False), "<h2>Worst cases</h2>", _pictures(paths, cases, out, program),
        "<h2>By set</h2>", table[table["set"] != "all"].to_html(index=False)]), encoding="utf-8")
    return Refereed(page, paths, table)


def main(arguments: list[str]) -> int:
    import argparse
    parser = argparse.ArgumentParser(prog="python -m leeway.fleet referee", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("paths", help="file of leeway-bench planning --paths")
    parser.add_argument("--data", required=True, help="folder of robots and scenes")
    parser.add_argument("--out", default="referee", help="folder of the page")
    parser.add_argument("--program", default="", help="leeway, for pictures of the worst cases")
    a = parser.parse_args(arguments)
    found = referee(a.paths, a.data, a.out, a.program)
    print(found)
    return 1 if found.contradictions else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
