# SPDX-License-Identifier: BSD-3-Clause
"""Runs a campaign: a Dask graph of shards. Whatever dies, a run after it goes on with the shards that are not there."""
from __future__ import annotations

import contextlib
import json
import logging
import multiprocessing.resource_tracker
import pathlib
import shutil
import signal
import sys
import time
from typing import Any, Iterator, NamedTuple

from .._core import whole_number
from .dispatch import CampaignEnd, Dispatch
from .errors import DiskError, FleetError
from .estimate import Estimate, estimate
from .files import append_line
from .manifest import content_digest, locked, read_manifest, sound_records, start_manifest, write_manifest
from .plan import rows_in, shards_of, worlds_of
from .shard import make_shard, start
from .worlds import Worlds

__all__ = ["Summary", "run", "status"]

MANIFEST_SECONDS = 2.0  # between two manifests while shards come in, at least
MANIFEST_SHARE = 0.02  # of the time that writing manifests may take
TOLD = 5  # failures
MOST_WORKERS = 4096  # processes of this machine
CONNECT_SECONDS = 20
KEPT = 1 << 30  # bytes of free memory that workers keep: without it the pages of each shard's arrays are fetched again
DASK = {"distributed.logging.distributed": "critical", "distributed.worker.daemon": True,
    "distributed.admin.tick.limit": "1h", "distributed.admin.tick.interval": "1s", "distributed.admin.system-monitor.interval": "2s",
    "distributed.worker.memory.monitor-interval": "1s", "distributed.worker.profile.enabled": False,  # with their defaults 4 % of a core
    "distributed.nanny.pre-spawn-environ": {"MALLOC_TRIM_THRESHOLD_": KEPT, "MALLOC_MMAP_THRESHOLD_": KEPT, "OMP_NUM_THREADS": 1,
        "MKL_NUM_THREADS": 1, "OPENBLAS_NUM_THREADS": 1}}


class Summary(NamedTuple):
    """End of a run."""
    folder: pathlib.Path
    shards: int  #: of the campaign
    done: int  #: with a record
    made: int  #: by this run
    rows: int  #: made by this run
    seconds: float
    processor_seconds: float
    content: str  #: digest of all rows that are there
    failures: list[str]
    aside: list[str] = []  #: lines on workers that were set aside
    faults: dict[str, str] = {}  #: file to fault, of `status`
    missing: list[str] = []  #: files that are not there, of `status`

    @property
    def complete(self) -> bool:
        return self.done == self.shards and not self.faults

    def __repr__(self) -> str:
        state = "complete" if self.complete else f"{self.shards - self.done} shards are missing"
        lines = [f"{self.done} of {self.shards} shards in {self.folder}, {state}", f"this run: {self.made} shards, {self.rows} rows, {self.seconds:.1f} s, "
            f"{self.processor_seconds:.1f} s of processor time", f"content {self.content}", *self.failures[:TOLD]]
        if len(self.failures) > TOLD:
            lines.append(f"and {len(self.failures) - TOLD} other shards failed")
        lines += [f"{name}: {fault}" for name, fault in self.faults.items()] + [f"{name}: is missing" for name in self.missing[:TOLD]]
        if len(self.missing) > TOLD:
            lines.append(f"and {len(self.missing) - TOLD} other shards are missing")
        return "\n".join(lines)


class Progress:
    """A bar with the time that is left, on standard error."""

    def __init__(self, expected: float, quiet: bool):
        self.expected, self.quiet = max(expected, 1e-9), quiet
        self.begin = self.told = time.monotonic()
        self.live = sys.stderr.isatty()

    def step(self, cost: float, text: str, last: bool = False) -> None:
        now = time.monotonic()
        if self.quiet or (not last and now - self.told < (0.2 if self.live else 10)):
            return
        self.told, share = now, min(1.0, cost / self.expected)
        left = (now - self.begin) * (1 - share) / share if share > 0 else float("nan")
        bar = "#" * round(30 * share)
        sys.stderr.write(f"{chr(13) if self.live else ''}[{bar:<30}] {100 * share:5.1f} %  {text}  {_clock(now - self.begin)} gone, {_clock(left)} left"
            + ("" if self.live and not last else "\n"))
        sys.stderr.flush()


def _clock(seconds: float) -> str:
    if not seconds < 1e8:
        return "?"
    return f"{int(seconds) // 3600}:{int(seconds) // 60 % 60:02d}:{int(seconds) % 60:02d}"


@contextlib.contextmanager
def _without_interrupts() -> Iterator[None]:
    """Threads that begin here, and the processes that they start, get no SIGINT: Ctrl-C reaches a whole process group, and the client ends its workers."""
    multiprocessing.resource_tracker.ensure_running()  # it would let signals through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextlib.contextmanager
def _client(workers: int, scheduler: str) -> Iterator[Any]:
    """A client of the scheduler at this address, or of a cluster of processes on this machine."""
    import dask
    import distributed
    with dask.config.set(DASK):
        if scheduler:
            try:
                client = distributed.Client(scheduler, timeout=CONNECT_SECONDS)
            except (OSError, ValueError, TimeoutError) as error:
                raise CampaignEnd(scheduler, "", f"cannot be reached: {error or type(error).__name__}", "give --scheduler the address that dask scheduler prints") from None
            with client:
                yield client
            return
        with _without_interrupts():
            local = distributed.LocalCluster(n_workers=workers, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0",
                silence_logs=logging.CRITICAL)
        with local as cluster, distributed.Client(cluster) as client:
            yield client


def _here(worlds: Worlds, folder: pathlib.Path, missing: list[int]) -> Iterator[tuple[int, Any]]:
    """The same in this process, without Dask."""
    start(worlds)
    for index in missing:
        try:
            yield index, make_shard(worlds.plan["id"], str(worlds.folder), str(folder), index)
        except Exception as error:  # as a worker reports it
            yield index, error


def _remove(path: pathlib.Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError as error:
        raise FleetError(path, "", f"cannot be replaced: {error.strerror or error}", "move it away and run the campaign again") from None


def _remove_leavings(folder: pathlib.Path) -> None:
    """Half-written files of runs that were killed."""
    for path in folder.glob("**/.*.part"):
        _remove(path)


def _note(folder: pathlib.Path, summary: Summary, workers: int, begin: float) -> None:
    """A line for `report`; no part of the results' digests."""
    line = {"begin": begin, "seconds": summary.seconds, "processor_seconds": summary.processor_seconds, "workers": workers, "shards": summary.made,
        "rows": summary.rows, "complete": summary.complete}
    try:
        append_line(folder / "runs.jsonl", json.dumps(line))
    except OSError as error:
        print(f"{folder / 'runs.jsonl'}: {error.strerror or error}; this run is not noted", file=sys.stderr)


def _work(plan, base, folder, records, missing, work, costs: Estimate | None, quiet: bool):
    """Takes shards as they are done. Returns (made, rows, processor seconds, failures)."""
    shards = shards_of(plan)
    cost = [rows_in(s) * (costs.per_row[s.part.index] if costs else 1.0) for s in shards]
    progress = Progress(sum(cost[i] for i in missing), quiet)
    made = rows = 0
    done = processor = 0.0
    failures: list[str] = []
    due = time.monotonic() + MANIFEST_SECONDS
    try:
        for index, found in work:
            if isinstance(found, BaseException):
                failures.append(str(found) if index is None else f"{shards[index].name}: {type(found).__name__}: {found}")
                if isinstance(found, (DiskError, CampaignEnd)):
                    break
                continue
            records[index], seconds = found
            made, rows, processor, done = made + 1, rows + records[index]["rows"], processor + seconds, done + cost[index]
            progress.step(done, f"{len(records)} of {len(shards)} shards", made == len(missing))
            before = time.monotonic()
            if before > due:
                write_manifest(folder, plan, records)
                due = time.monotonic() + max(MANIFEST_SECONDS, (time.monotonic() - before) / MANIFEST_SHARE)
    finally:
        if made:
            write_manifest(folder, plan, records)
    return made, rows, processor, failures


def run(campaign, out=None, *, workers: int = 1, scheduler: str = "", dry_run: bool = False, quiet: bool = False, trust: bool = False):
    """Runs a campaign's shards that are not there yet. Returns a Summary; with dry_run an Estimate, and nothing is written.

    campaign: path of a TOML file. out: folder of the results (default: beside the campaign, named like it). workers: processes of a local
    Dask cluster; 0 = this process, without Dask. scheduler: address of a Dask scheduler instead, whose workers see both folders under the
    same paths. trust: files that are recorded are not read again first.
    """
    workers = whole_number("workers", workers, 0, MOST_WORKERS)  # 0: this process
    worlds = worlds_of(campaign)
    plan, base = worlds.plan, worlds.folder
    folder = pathlib.Path(out) if out is not None else base / (pathlib.Path(campaign).stem + ".fleet")
    folder = folder.resolve()
    if dry_run:
        return estimate(plan, worlds, folder)
    with locked(folder):
        records = start_manifest(folder, plan)
        if not trust:
            records, faults = sound_records(folder, plan, records)
            for name, fault in faults.items():
                print(f"{folder / name}: {fault}; it is made again", file=sys.stderr)
                _remove(folder / name)
        _remove_leavings(folder)
        count = len(shards_of(plan))
        missing = [i for i in range(count) if i not in records]
        begin, clock = time.time(), time.monotonic()
        result: tuple = (0, 0, 0.0, [])
        aside: list[str] = []
        if missing:
            costs = None if quiet else estimate(plan, worlds, folder, missing)
            if costs is not None:
                print(costs.text(workers), file=sys.stderr)
                if costs.bytes > shutil.disk_usage(folder).free:
                    print("the results may not fit on this disk", file=sys.stderr)
            with _client(workers, scheduler) if workers or scheduler else contextlib.nullcontext() as client:
                clock = time.monotonic()
                if client is not None and not quiet:
                    print(f"dashboard {client.dashboard_link}", file=sys.stderr)
                work = _here(worlds, folder, missing) if client is None else Dispatch(client, plan, base, folder, missing)
                aside = getattr(work, "aside", aside)
                result = _work(plan, base, folder, records, missing, work, costs, quiet)
        made, rows, processor, failures = result
        summary = Summary(folder, count, len(records), made, rows, time.monotonic() - clock, processor, content_digest(records), failures, aside)
        _note(folder, summary, workers, begin)
    return summary


def status(folder, trust: bool = False) -> Summary:
    """The shards that are there: files with the recorded bytes. trust: by the manifest alone, the files are not read."""
    folder = pathlib.Path(folder)
    plan, records = read_manifest(folder)
    shards = shards_of(plan)
    sound, faults = (records, {}) if trust else sound_records(folder, plan, records)
    missing = [shard.name for shard in shards if shard.index not in records]
    return Summary(folder, len(shards), len(sound), 0, 0, 0.0, 0.0, content_digest(records), [], [], faults, missing)
