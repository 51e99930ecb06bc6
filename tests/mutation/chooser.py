# SPDX-License-Identifier: BSD-3-Clause
"""The tests that a mutant meets, in order: those first that can be expected to kill most per second."""
import heapq
import threading
from collections import Counter

SINGLES = 8  # tests that run alone before others of one program share a process
BATCH_TESTS = 40
BATCH_SECONDS = 3.0


def kind_of(name):
    """(case, suite) of a test's name, without parameters: Worlds/Conformance.Ends/Arm is of Conformance.Ends and of Conformance."""
    parts = [part for part in name.split("  #")[0].split("/") if "." in part] or [name]
    return parts[0], parts[0].split(".")[0]


class Chooser:
    """Remembers kills of a run by test and by file. Safe to ask from several threads."""

    def __init__(self, tests):
        self.tests = tests
        self.lock = threading.Lock()
        self.kills = Counter()  # test
        self.file_kills = Counter()  # (file, test)
        self.runs = Counter()  # test
        self.here = {}
        self.kinds = [kind_of(t["name"]) for t in tests]
        self.sizes = [sum(bits.bit_count() for bits in t["lines"].values()) for t in tests]

    def saw(self, file, survived, killer):
        """Notes the tests (by number) that let a mutant of the file pass, and the one that did not, or None."""
        with self.lock:
            self.runs.update(survived)
            if killer is not None:
                self.runs[killer] += 1
                self.kills[killer] += 1
                self.file_kills[(file, killer)] += 1

    def reaching(self, file, lines):
        """Numbers of the tests that execute one of these lines of the file."""
        mask = sum(1 << n for n in lines)
        return [i for i, test in enumerate(self.tests) if test["lines"].get(file, 0) & mask]

    def value(self, number, special):
        """Kills to expect per second. `special` in (0, 1]: the share of the file in the test's executed lines, beside other tests."""
        own, here = self.kills[number], self.here[number]
        chance = (own + 6 * here + special) / (self.runs[number] + 6 * here + 8)
        return chance / (self.tests[number]["seconds"] + 0.1)

    def order(self, numbers, file):
        """The tests by their value, where one that resembles earlier ones (parameters of a case, cases of a suite) counts for less."""
        shares = [self.tests[n]["lines"].get(file, 0).bit_count() / (self.sizes[n] + 1) for n in numbers]
        most = max(shares, default=0) or 1
        with self.lock:
            self.here = {n: self.file_kills[(file, n)] for n in numbers}
            values = {n: self.value(n, max(0.05, share / most)) for n, share in zip(numbers, shares)}
        cases, suites, ordered = Counter(), Counter(), []

        def worth(number):
            case, suite = self.kinds[number]
            return values[number] / (1 + cases[case]) / (1 + 0.2 * suites[suite])

        heap = [(-worth(n), n) for n in numbers]
        heapq.heapify(heap)
        while heap:
            _, number = heapq.heappop(heap)
            now = -worth(number)
            if heap and now > heap[0][0]:
                heapq.heappush(heap, (now, number))
                continue
            ordered.append(number)
            case, suite = self.kinds[number]
            cases[case] += 1
            suites[suite] += 1
        return ordered

    def batches(self, ordered, program_of):
        """Lists of test numbers to run in one process each. The first tests run alone; of the rest, short ones of one program (program_of gives
        its name, or None for a test that cannot share) run together."""
        for number in ordered[:SINGLES]:
            yield [number]
        rest = list(ordered[SINGLES:])
        while rest:
            batch, seconds, left = [rest[0]], self.tests[rest[0]]["seconds"], []
            program = program_of(self.tests[rest[0]])
            for number in rest[1:]:
                more = self.tests[number]["seconds"]
                if program is not None and len(batch) < BATCH_TESTS and seconds + more <= BATCH_SECONDS and \
                        program_of(self.tests[number]) == program:
                    batch.append(number)
                    seconds += more
                else:
                    left.append(number)
            yield batch
            rest = left
