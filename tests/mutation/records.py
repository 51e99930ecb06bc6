# SPDX-License-Identifier: BSD-3-Clause
"""The memory of a run: a file of JSON lines that grows with every mutant, the classes that people gave to survivors, and the table."""
import csv
import json
import os
import pathlib
import threading
import tomllib
from collections import Counter

CLASSES = ("equivalent", "rounding", "speed", "defensive", "sanitizer", "gap", "closed")
COLUMNS = ("id", "file", "line", "function", "before", "after", "result", "by", "how", "class", "seconds", "tests run", "tests that reach it", "rule")


class State:
    """The JSON lines of a run: the first names the run, each later one the fate of a mutant (the last one of an id counts)."""

    def __init__(self, path, header):
        self.path = pathlib.Path(path)
        self.results = {}
        self.lock = threading.Lock()
        if self.path.exists():
            lines = self.path.read_text(encoding="utf-8").split("\n")
            known = json.loads(lines[0])
            for name, value in header.items():
                if known.get(name) != value:
                    raise ValueError(f"{self.path} is of a run with {name} {known.get(name)}, not {value}")
            for line in lines[1:-1]:  # the text after the last line end was cut off by a kill
                record = json.loads(line)
                self.results[record["id"]] = record
            if lines[-1]:
                self.path.write_text("\n".join(lines[:-1]) + "\n", encoding="utf-8")
        else:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self.path.write_text(json.dumps(header) + "\n", encoding="utf-8")

    def add(self, record):
        with self.lock, open(self.path, "a", encoding="utf-8") as file:
            file.write(json.dumps(record) + "\n")
            file.flush()
            os.fsync(file.fileno())
            self.results[record["id"]] = record


def read_classes(path):
    """{fingerprint: {class, why}} from survivors.toml."""
    with open(path, "rb") as file:
        entries = tomllib.load(file)
    for name, entry in entries.items():
        if entry.get("class") not in CLASSES or not entry.get("why"):
            raise ValueError(f"{path}: {name}: needs a class ({', '.join(CLASSES)}) and why")
    return entries


def class_of(record, classes):
    """The class of a survivor: hand-given, or "equivalent" by its object files, or "" as long as nobody looked."""
    if record["result"] == "killed":
        return ""
    if record["result"] == "equivalent":
        return "equivalent"
    given = classes.get(record["fingerprint"])
    return given["class"] if given else record.get("expected", "")


def counts(records, classes):
    """How many compiled, were killed, and so on; and scores in percent: killed of those that are not equivalent, and of those that change an
    answer (neither rounding nor speed, nor events that do not happen)."""
    found = Counter()
    for record in records:
        if record["result"] in ("killed", "equivalent", "stale"):
            found[record["result"]] += 1
        elif record["result"] == "survived":
            found["survived"] += 1
            found[class_of(record, classes) or "not classified"] += 1
    same = found["equivalent"] - sum(r["result"] == "equivalent" for r in records)
    others = found["survived"] - same
    of_answers = others - found["rounding"] - found["speed"] - found["defensive"]
    found["compiled"] = found["killed"] + found["survived"] + found["equivalent"] - same

    def score(survivors):
        return round(100 * found["killed"] / (found["killed"] + survivors), 1) if found["killed"] + survivors else 0.0

    return dict(found), {"killed of those not equivalent, percent": score(others),
                         "killed of those that change an answer, percent": score(of_answers)}


def write_table(path, header, records, classes):
    """The table of a run: survivors first, then the killed."""
    totals, scores = counts(records, classes)
    order = {"survived": 0, "stale": 1, "equivalent": 2, "killed": 3}
    rows = sorted((r for r in records if r["result"] in order), key=lambda r: (order[r["result"]], r["file"], r["line"], r["id"]))
    with open(path, "w", encoding="utf-8", newline="") as file:
        for name, value in {**header, **totals, **scores}.items():
            file.write(f"# {name}: {value}\n")
        table = csv.writer(file, lineterminator="\n")
        table.writerow(COLUMNS)
        for r in rows:
            table.writerow([r["id"], r["file"], r["line"], r["function"], r["before"], r["after"], r["result"], r.get("by", ""), r.get("how", ""),
                            class_of(r, classes), r.get("seconds", ""), r.get("tests_run", ""), r.get("tests_that_reach", ""), r.get("rule", "")])
    return totals, scores


def describe(record, classes):
    """A survivor in four lines."""
    given = classes.get(record["fingerprint"], {})
    what = f"{class_of(record, classes) or 'not classified'}{': ' + given['why'] if given else ''}"
    why = f"  ({record['why']})" if record.get("why") else ""
    return (f"{record['file']}:{record['line']} {record['function']}  [{record['fingerprint']}]  {what}{why}\n"
            f"  - {record['before']}\n  + {record['after']}\n"
            f"  {record.get('tests_run', 0)} of {record.get('tests_that_reach', 0)} tests that reach it, {record.get('seconds', 0)} s")
