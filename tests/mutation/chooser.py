# SPDX-License-Identifier: BSD-3-Clause
"""Which tests a mutant meets, and in which order: those first that can be expected to kill most per second."""
import threading
from collections import Counter

SINGLES = 8  # tests that run alone before others of one program share a process
BATCH_TESTS = 40
BATCH_SECONDS = 3.0


class Chooser:
    """Remembers kills of a run by test and by file. Safe to ask from several threads."""

    def __init__(self, tests):
        self.tests = tests
        self.lock = threading.Lock()
        self.kills = Counter()  # test
        self.file_kills = Counter()  # (file, test)
        self.runs = Counter()  # test
        self.sizes = [sum(bits.bit_count() for bits in t["lines"].values()) for t in tests]

    def saw(self, file, survived, killer):
        """Tells what tests (by number) let a mutant of the file pass, and which one did not, or None."""
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

    def value(self, number, file):
        """Kills to expect per second."""
        own, here = self.kills[number], self.file_kills[(file, number)]
        # A test that reaches little says more about what it reaches
        special = 0.3 + 0.7 * min(1.0, 1500 / (self.sizes[number] + 1))
        chance = (own + 6 * here + 0.5 * special) / (self.runs[number] + 6 * here + 8)
        return chance / (self.tests[number]["seconds"] + 0.1)

    def order(self, numbers, file):
        with self.lock:
            return sorted(numbers, key=lambda n: -self.value(n, file))

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
