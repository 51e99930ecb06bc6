# SPDX-License-Identifier: BSD-3-Clause
"""Hands shards to the workers of a Dask scheduler, each to a worker that has stated its version and that it can read the campaign.

A node is a machine with all of its workers. A worker whose statement has a fault is set aside. A shard that fails at one node goes to
another; while it does, the first one gets no other work. If it fails there too it is given up, and if it does not, the first node was
wrong: the second time it is set aside. A node that cannot write is set aside at once. Its shards go to others.
"""
from __future__ import annotations

import asyncio
import collections
import concurrent.futures
import itertools
import math
import pathlib
import queue
import sys
import time
from typing import Any, Iterator

from .errors import DiskError, FleetError
from .nodes import fault_of, statement
from .shard import MOST_WRITES, make_shard_aside

__all__ = ["CampaignEnd", "Dispatch"]

WINDOW = 8  # shards per thread that wait at a worker
LOOK_SECONDS = 1.0  # between two lists of the workers
ALONE_SECONDS = 5.0  # that a campaign waits for others after its last node was set aside
ANSWER_SECONDS = 30.0  # for an answer that a worker has: it may have died since
DEATHS = 10  # workers that a shard may take with it before it counts as failed
WRONG = 2  # shards that fail at a node and not at another one, until it is set aside


class CampaignEnd(FleetError):
    """The campaign cannot go on: no scheduler, or no node."""


class _Worker:
    """One that the scheduler lists. `node` is None until it has stated its name."""

    def __init__(self, address: str, threads: int):
        self.address, self.threads = address, max(1, threads)
        self.node: str | None = None
        self.aside = False
        self.shards: set[int] = set()  #: that it has

    @property
    def works(self) -> bool:
        return self.node is not None and not self.aside


class Dispatch:
    """Iterates over (index, (record, seconds) or an exception) of each shard as it is done; (None, CampaignEnd) ends it."""

    def __init__(self, client, plan: dict[str, Any], base: pathlib.Path, folder: pathlib.Path, missing: list[int]):
        self.client, self.plan, self.where = client, plan, (plan["id"], str(base), str(folder))
        self.waiting = collections.deque(missing)
        self.left = set(missing)
        self.workers: dict[str, _Worker] = {}
        self.asked: dict[str, Any] = {}  #: key of a statement to (worker, future)
        self.given: dict[str, Any] = {}  #: key of a shard to (index, worker, future)
        self.failed: dict[int, dict[str, BaseException]] = {}  #: shard to the nodes at which it failed
        self.deaths: collections.Counter = collections.Counter()  #: of workers, by shard
        self.wrong: collections.Counter = collections.Counter()  #: shards that other nodes made, by node
        self.aside: list[str] = []  #: lines on workers that were set aside
        self.done: queue.SimpleQueue = queue.SimpleQueue()
        self.count = itertools.count()
        self.ever: set[str] = set()  #: nodes that worked at some time
        self.looked = self.alone = -math.inf
        self.moved = time.monotonic()  #: when a worker last answered

    def __iter__(self) -> Iterator[tuple[int | None, Any]]:
        if not self.client.scheduler_info(n_workers=-1)["workers"]:
            print(f"{self.client.scheduler.address} has no workers yet; waiting for them", file=sys.stderr)
        while self.left:
            end = self._look_at_workers() if time.monotonic() - self.looked > LOOK_SECONDS else None
            if end is not None:
                yield None, end
                return
            yield from self._given_up()
            self._hand_out()
            try:
                future = self.done.get(timeout=LOOK_SECONDS)
            except queue.Empty:
                continue
            self.moved = time.monotonic()
            yield from self._take(future)

    # workers

    def _gone(self, reason: object) -> CampaignEnd:
        address = self.client.scheduler.address if self.client.scheduler else "scheduler"
        return CampaignEnd(address, "", f"the connection is lost: {reason}", "start the scheduler again, then the campaign: it goes on where it was")

    def _look_at_workers(self) -> CampaignEnd | None:
        """Asks new workers for their statements, and takes the shards of dead ones back."""
        try:
            listed = self.client.scheduler_info(n_workers=-1)["workers"]
        except (OSError, TimeoutError) as error:
            return self._gone(type(error).__name__)
        if self.client.status != "running":
            return self._gone(self.client.status)
        self.looked = time.monotonic()
        for address in [address for address in self.workers if address not in listed]:
            self._bury(self.workers.pop(address))
        for address, entry in listed.items():
            if address not in self.workers:
                self.workers[address] = _Worker(address, entry["nthreads"])
                self._submit(self.asked, (self.workers[address],), statement, *self.where)
        if not self.aside or self.asked or any(worker.works for worker in self.workers.values()):
            self.alone = self.looked
        if self.looked - self.alone > ALONE_SECONDS:
            return CampaignEnd(self.client.scheduler.address, "", f"all nodes are set aside, {len(self.left)} shards are missing: {self.aside[-1]}",
                "mend the nodes, start their workers again, then the campaign: it goes on where it was")
        return None

    def _submit(self, keep: dict[str, Any], about: tuple, function, *arguments) -> None:
        """Calls a function at about's last entry, a worker."""
        worker = about[-1]
        key = f"leeway-{function.__name__}-{self.plan['id'][:16]}-{id(self)}-{next(self.count)}"
        future = self.client.submit(function, *arguments, key=key, workers=[worker.address], pure=False, retries=0)
        keep[key] = (*about, future)
        future.add_done_callback(self.done.put)

    def _bury(self, worker: _Worker) -> None:
        self._forget(worker)
        for index in worker.shards:
            self.deaths[index] += 1

    def _forget(self, worker: _Worker) -> None:
        """Takes all questions to a worker back, and its shards."""
        for keep in (self.asked, self.given):
            for key in [key for key, entry in keep.items() if entry[-2] is worker]:
                keep.pop(key)[-1].cancel()
        self.waiting.extendleft(sorted(worker.shards, reverse=True))

    def _set_aside(self, worker: _Worker, reason: str) -> None:
        line = f"worker {worker.address}{f' on node {worker.node}' if worker.node else ''} is set aside: {reason}"
        self.aside.append(line)
        print(line, file=sys.stderr)
        worker.aside = True
        self._forget(worker)
        worker.shards.clear()

    def _set_node_aside(self, node: str, reason: str) -> None:
        for worker in self.workers.values():
            if worker.node == node and not worker.aside:
                self._set_aside(worker, reason)

    def _nodes(self) -> set[str]:
        return {worker.node for worker in self.workers.values() if worker.works and worker.node is not None}

    # shards

    def _on_trial(self) -> set[str]:
        """Nodes at which a shard failed that another node can judge."""
        nodes = self._nodes()
        return {node for failed in self.failed.values() if not nodes <= failed.keys() for node in failed}

    def _given_up(self) -> Iterator[tuple[int, BaseException]]:
        """Shards that failed at two nodes, or at the only one there is; and those that took too many workers with them."""
        nodes = self._nodes()
        stuck = not self.given and time.monotonic() - self.moved > ALONE_SECONDS
        for index in list(self.failed):
            failed = self.failed[index]
            alone = bool(nodes) and not self.asked and nodes <= failed.keys() and (len(self.ever) == 1 or stuck)
            if len(failed) > 1 or alone:
                self.waiting.remove(index)
                yield self._end(index), list(self.failed.pop(index).values())[-1]
        for index in [index for index, count in self.deaths.items() if count > DEATHS and index in self.waiting]:
            self.waiting.remove(index)
            yield self._end(index), FleetError(f"shard {index}", "", f"took {DEATHS + 1} workers with it", "look at their logs: is there memory enough?")

    def _end(self, index: int) -> int:
        self.left.discard(index)
        self.deaths.pop(index, None)
        return index

    def _room(self, worker: _Worker, threads: int) -> int:
        """Shards that a worker can be given. Near the end they are shared out evenly."""
        share = math.ceil(len(self.waiting) / (2 * threads)) * worker.threads
        return min(WINDOW * worker.threads, max(worker.threads + MOST_WRITES, share)) - len(worker.shards)

    def _fits(self, index: int, worker: _Worker, trial: set[str]) -> bool:
        """A failed shard needs another node; a shard with a dead worker is worked on alone; a node on trial gets failed shards of other nodes only."""
        failed = self.failed.get(index, {})
        if worker.node in failed or (worker.node in trial and not failed):
            return False
        return not worker.shards or not (self.deaths[index] or any(self.deaths[other] for other in worker.shards))

    def _hand_out(self) -> None:
        workers = [worker for worker in self.workers.values() if worker.works]
        if not workers or not self.waiting:
            return
        threads, trial = sum(worker.threads for worker in workers), self._on_trial()
        kept = []
        while self.waiting:
            index = self.waiting.popleft()
            able = [worker for worker in workers if self._room(worker, threads) > 0 and self._fits(index, worker, trial)]
            if able:
                worker = min(able, key=lambda one: len(one.shards) / one.threads)
                worker.shards.add(index)
                self._submit(self.given, (index, worker), make_shard_aside, *self.where, index)
                continue
            kept.append(index)
            if not (self.failed.get(index) or self.deaths[index]):
                break  # all behind it are alike
        self.waiting.extendleft(reversed(kept))

    def _take(self, future) -> Iterator[tuple[int | None, Any]]:
        """Reads a future; those taken back are passed over."""
        asked, given = self.asked.pop(future.key, None), self.given.pop(future.key, None)
        if asked is None and given is None:
            return
        try:
            if future.status == "lost":  # its worker died with the answer: Dask would wait for it
                raise concurrent.futures.CancelledError
            error = future.exception(ANSWER_SECONDS)
            found = future.result(ANSWER_SECONDS) if error is None else None
            future.release()
        except (asyncio.CancelledError, concurrent.futures.CancelledError, asyncio.TimeoutError, OSError) as lost:
            if given is not None:
                given[1].shards.discard(given[0])
                self.waiting.appendleft(given[0])
            if self.client.status != "running":
                yield None, self._gone(type(lost).__name__)
                return
            future.cancel()
            if asked is not None:
                self.workers.pop(asked[0].address, None)  # it is asked again
            return
        if asked is not None:
            self._judge(asked[0], found, error)
            return
        index, worker, _ = given
        worker.shards.discard(index)
        if error is None and {name: found[0].get(name) for name in ("leeway", "module")} != {name: self.plan[name] for name in ("leeway", "module")}:
            error = FleetError(worker.address, "", "made a shard by another build of leeway than it stated", "start its worker again")
            self._set_node_aside(worker.node, str(error))
        if error is None:
            self._made(index)
            yield self._end(index), found
        else:
            self._fail(index, worker, error)

    def _judge(self, worker: _Worker, stated: Any, error: BaseException | None) -> None:
        """A worker's statement is here."""
        fault = fault_of(self.plan, stated) if error is None else f"{type(error).__name__}: {error}; {fault_of(self.plan, None)}"
        worker.node = stated["node"] if error is None and isinstance(stated, dict) else None
        if fault:
            self._set_aside(worker, fault)
        else:
            self.ever.add(worker.node)

    def _made(self, index: int) -> None:
        for node, error in self.failed.pop(index, {}).items():
            self.wrong[node] += 1
            if self.wrong[node] >= WRONG:
                self._set_node_aside(node, f"{self.wrong[node]} shards failed there and not at other nodes: {error}")

    def _fail(self, index: int, worker: _Worker, error: BaseException) -> None:
        self.waiting.appendleft(index)
        if isinstance(error, DiskError):
            self._set_node_aside(worker.node, str(error))
        elif not worker.aside:
            self.failed.setdefault(index, {})[worker.node] = error
