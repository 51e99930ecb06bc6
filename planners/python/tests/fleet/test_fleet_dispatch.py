# SPDX-License-Identifier: BSD-3-Clause
"""Shards and workers without processes: whatever fails, dies or joins, each shard ends once, and is given up only after failures at two nodes."""
import collections
import os
import random

import pytest

if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow"):
        pytest.importorskip(name)
from leeway.fleet import FleetError, dispatch
from leeway.fleet.errors import DiskError
from leeway.fleet.maker import maker

PLAN = {"id": "0" * 64, **maker()}
RECORD = ({"rows": 1, **maker()}, 0.0)


class Future:
    def __init__(self, key, answer):
        self.key, self.answer, self.cancelled, self.status = key, answer, False, "finished"
        if answer == "lost":  # finished, and its worker is dead by now
            self.status = "lost"

    def add_done_callback(self, call):
        if self.answer is not None:
            call(self)

    def exception(self, timeout):
        assert self.status != "lost", "Dask waits for ever"
        return self.answer if isinstance(self.answer, Exception) else None

    def result(self, timeout):
        return self.answer

    def release(self):
        pass

    def cancel(self):
        self.cancelled = True


class Cluster:
    """A client whose workers answer at once, by a function of node and shard: a record, an exception, or "dies"; then another worker of the node joins."""
    status = "running"

    def __init__(self, nodes, answer, state=lambda node: {}, restart=True):
        self.answer, self.state, self.restart = answer, state, restart
        self.workers, self.count, self.tries = {}, 0, collections.defaultdict(list)
        self.scheduler = self
        self.address = "tcp://scheduler"
        for node in nodes:
            self.join(node)

    def join(self, node, threads=1):
        self.count += 1
        self.workers[f"tcp://{node}:{self.count}"] = (node, threads)

    def scheduler_info(self, n_workers):
        return {"workers": {address: {"nthreads": threads} for address, (_, threads) in self.workers.items()}}

    def submit(self, function, *arguments, key, workers, pure, retries):
        (address,) = workers
        if address not in self.workers:
            return Future(key, None)  # nobody answers
        node, _ = self.workers[address]
        if function is dispatch.statement:
            return Future(key, {"node": node, "fault": "", **maker(), **self.state(node)})
        index = arguments[-1]
        self.tries[index].append(node)
        found = self.answer(node, index)
        if found == "dies":
            del self.workers[address]
            if self.restart:
                self.join(node)
            found = None
        return Future(key, found)


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    monkeypatch.setattr(dispatch, "LOOK_SECONDS", 0.001)
    monkeypatch.setattr(dispatch, "ALONE_SECONDS", 0.05)


def ended(cluster, shards):
    """(what each shard came to, lines on workers that were set aside, the end of the campaign or None)"""
    work = dispatch.Dispatch(cluster, PLAN, "base", "folder", list(range(shards)))
    out, end = {}, None
    for index, found in work:
        if index is None:
            end = found
            break
        assert index not in out, "a shard ended twice"
        out[index] = found
    assert end is not None or (sorted(out) == list(range(shards)) and not work.given and not work.waiting)
    return out, work.aside, end


def test_a_shard_that_kills_its_workers_is_given_up_and_takes_no_other_with_it():
    cluster = Cluster("ab", lambda node, index: "dies" if index == 5 else RECORD)
    out, aside, end = ended(cluster, 60)
    assert end is None and not aside and isinstance(out[5], FleetError) and "took 11 workers with it" in str(out[5])
    assert all(found == RECORD for index, found in out.items() if index != 5) and len(cluster.tries[5]) == 11
    assert max(len(tries) for index, tries in cluster.tries.items() if index != 5) <= 3


def test_an_answer_that_its_worker_took_with_it_is_made_again():
    lost = {3, 7, 8}
    cluster = Cluster("ab", lambda node, index: "lost" if index in lost and not lost.discard(index) else RECORD)
    out, aside, end = ended(cluster, 30)
    assert end is None and not aside and all(found == RECORD for found in out.values())
    assert {index for index, tries in cluster.tries.items() if len(tries) == 2} == {3, 7, 8}


def test_shards_that_fail_everywhere_set_no_node_aside():
    out, aside, end = ended(Cluster("abc", lambda node, index: ValueError(node) if index % 3 == 0 else RECORD), 90)
    assert end is None and not aside and {index for index, found in out.items() if isinstance(found, ValueError)} == set(range(0, 90, 3))


def test_two_nodes_that_fail_at_different_shards_finish_all():
    out, aside, end = ended(Cluster("ab", lambda node, index: ValueError() if index == {"a": 3, "b": 4}[node] else RECORD), 30)
    assert end is None and not aside and all(found == RECORD for found in out.values())


def test_a_shard_waits_for_another_node_while_there_was_one():
    """The second node dies for good before it judges."""
    cluster = Cluster("ab", lambda node, index: "dies" if node == "b" else ValueError("a") if index == 2 else RECORD, restart=False)
    out, aside, end = ended(cluster, 30)
    assert end is None and not aside and isinstance(out[2], ValueError) and sum(found == RECORD for found in out.values()) == 29


def test_nodes_that_cannot_write_end_the_campaign_when_there_is_no_other():
    out, aside, end = ended(Cluster("ab", lambda node, index: DiskError("x", "", "cannot be written", "make room")), 30)
    assert not out and len(aside) == 2 and "all nodes are set aside, 30 shards are missing" in str(end) and "make room" in str(end)


@pytest.mark.parametrize("stated", [{"leeway": "9.9.9"}, {"module": "0" * 64}, {"leeway": None}, {"module": 3}, {"fault": None}, {"node": None}, {"fault": "no folder; mount it"}])
def test_a_statement_with_a_fault_gets_no_work(stated):
    cluster = Cluster("ab", lambda node, index: RECORD, lambda node: stated if node == "a" else {})
    out, aside, end = ended(cluster, 30)
    assert end is None and len(aside) == 1 and "tcp://a:1" in aside[0] and "; " in aside[0] and {node for tries in cluster.tries.values() for node in tries} == {"b"}


def test_a_record_of_another_maker_is_no_result():
    cluster = Cluster("ab", lambda node, index: RECORD if node == "b" else ({**RECORD[0], "leeway": "9.9.9"}, 0.0))
    out, aside, end = ended(cluster, 30)
    assert end is None and all(found == RECORD for found in out.values()) and len(aside) == 1 and "node a" in aside[0]


def test_a_lost_scheduler_ends_the_campaign():
    cluster = Cluster("a", lambda node, index: RECORD)
    cluster.status = "connecting"
    out, _, end = ended(cluster, 3)
    assert not out and "the connection is lost: connecting; start the scheduler again" in str(end)


def test_random_faults_never_lose_or_repeat_a_shard():
    first = int(os.environ.get("LEEWAY_TEST_SEED", "20260101"))
    for seed in range(first, first + 150):
        print(f"seed {seed}")
        rng = random.Random(seed)
        nodes, shards = "abcd"[:rng.randint(1, 4)], rng.randint(1, 80)
        chances = {node: rng.choice([0, 0, 0.02, 0.3, 1]) for node in nodes}
        deadly = {node: rng.choice([0, 0, 0, 0.02]) for node in nodes}
        poison = {index for index in range(shards) if rng.random() < rng.choice([0, 0.05])}
        failed = collections.defaultdict(set)

        def answer(node, index):
            if rng.random() < deadly[node]:
                return "dies"
            if index in poison or rng.random() < chances[node]:
                failed[index].add(node)
                return ValueError(f"{index} at {node}")
            return RECORD

        cluster = Cluster(nodes, answer)
        for _ in range(rng.randint(0, 3)):
            cluster.join(rng.choice(nodes), rng.randint(1, 3))
        out, aside, end = ended(cluster, shards)
        for index, found in out.items():
            assert found == RECORD or len(failed[index]) > 1 or len(nodes) == 1 or aside, (seed, index, found)
        assert end is None or len(aside) >= len(nodes), seed
        assert not any(index in poison and found == RECORD for index, found in out.items())


def test_a_node_at_which_all_fails_is_set_aside_after_few_shards():
    cluster = Cluster("ab", lambda node, index: ValueError("broken") if node == "a" else RECORD)
    out, aside, end = ended(cluster, 200)
    assert end is None and all(found == RECORD for found in out.values()) and len(aside) == 1 and "2 shards failed there and not at other nodes: broken" in aside[0]
    assert sum(tries.count("a") for tries in cluster.tries.values()) <= dispatch.WINDOW


@pytest.fixture
def halted(monkeypatch):
    """Between two answers: shard 3 failed at node a, and node b, which could judge it, was there once."""
    monkeypatch.setattr(dispatch, "ALONE_SECONDS", 5)
    cluster = Cluster("ab", lambda node, index: RECORD)
    work = dispatch.Dispatch(cluster, PLAN, "base", "folder", list(range(10)))
    for address in cluster.workers:
        work.workers[address] = dispatch._Worker(address, 1)
        work.workers[address].node = cluster.workers[address][0]
    work.ever = {"a", "b"}
    work.failed[3] = {"a": ValueError("once")}
    return work


def test_a_node_on_trial_gets_no_other_work_until_it_is_judged(halted):
    a, b = halted.workers.values()
    assert halted._on_trial() == {"a"} and not halted._fits(5, a, {"a"}) and halted._fits(5, b, {"a"}) and halted._fits(3, b, {"a"}) and not halted._fits(3, a, {"a"})
    halted.failed[4] = {"b": ValueError("too")}
    assert halted._fits(4, a, halted._on_trial()) and halted._fits(3, b, halted._on_trial())


def test_without_a_judge_a_node_goes_on_and_its_failed_shard_waits(halted):
    _, b = halted.workers.values()
    del halted.workers[b.address]
    assert halted._on_trial() == set() and not list(halted._given_up())
    halted.moved -= 6
    assert [index for index, _ in halted._given_up()] == [3] and 3 not in halted.waiting
