# SPDX-License-Identifier: BSD-3-Clause
"""Tests of tests/batches.py, on folders of CTest whose programs are scripts that print as GoogleTest does."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

BATCHES = pathlib.Path(__file__).resolve().parents[1] / "batches.py"

# $1 is the filter. The case of BEHAVIOUR says what goes wrong.
PROGRAM = """#!/bin/sh
names=$( echo "$1" | sed 's/--gtest_filter=//; s/:/ /g' )
echo "started with $( echo $names | wc -w )" >>log
case BEHAVIOUR in
fails) echo "[  FAILED  ] Suite.One"; status=1 ;;
dies) kill -SEGV $$ ;;
hangs) exec sleep 60 ;;
loses) names=Suite.One ;;
skips) echo "[  SKIPPED ] Suite.One"; echo "[  SKIPPED ] Suite.One" ;;
esac
echo "[==========] $( echo $names | wc -w ) tests from 1 test suite ran. (1 ms total)"
exit ${status:-0}
"""


def folder_of(folder, behaviour, count=3, other="true"):
    program = folder / "program"
    program.write_text(PROGRAM.replace("BEHAVIOUR", behaviour))
    program.chmod(0o755)
    names = ["One", "Two"] + [f"T{i}" for i in range(count - 2)]
    lines = [f'add_test([=[Suite.{name}]=] "{program}" "--gtest_filter=Suite.{name}" "--gtest_also_run_disabled_tests")\n'
        f'set_tests_properties([=[Suite.{name}]=] PROPERTIES WORKING_DIRECTORY "{folder}")\n' for name in names]
    (folder / "CTestTestfile.cmake").write_text("".join(lines) + f'add_test(other "{other}")\n')
    return folder


def run(folder, *options):
    done = subprocess.run([sys.executable, BATCHES, folder, "--jobs", "2", *options], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


class Batches(unittest.TestCase):
    def setUp(self):
        held = tempfile.TemporaryDirectory()
        self.addCleanup(held.cleanup)
        self.folder = pathlib.Path(held.name)

    def test_tests_of_a_program_share_processes_and_others_run_too(self):
        status, said = run(folder_of(self.folder, "passes", 100))
        self.assertEqual(status, 0, said)
        self.assertEqual(sorted((self.folder / "log").read_text().split()[2::3]), ["33", "33", "34"])
        self.assertIn("100 tests in 3 processes", said)
        self.assertIn("Test #101: other", said)

    def test_a_batch_that_goes_wrong_is_told_and_fails(self):
        for behaviour, told in {"fails": "Suite.One", "dies": "-11", "hangs": "no end after 2.0 s", "loses": "1 of 3 tests ran"}.items():
            status, said = run(folder_of(self.folder, behaviour), "--timeout", "2")
            self.assertEqual(status, 1, said)
            self.assertIn("FAILED program: 3 tests", said)
            self.assertIn(told, said)

    def test_a_failure_of_another_test_is_one(self):
        self.assertEqual(run(folder_of(self.folder, "passes", other="false"))[0], 1)

    def test_skipped_tests_are_counted_once(self):
        status, said = run(folder_of(self.folder, "skips"))
        self.assertEqual(status, 0, said)
        self.assertIn("3 tests, 1 skipped", said)

    def test_chosen_names_only_and_none_is_an_error(self):
        folder = folder_of(self.folder, "passes")
        self.assertIn("1 tests in 1 processes", run(folder, "--tests-regex", "One")[1])
        self.assertIn("2 tests in 1 processes", run(folder, "--exclude-regex", "One")[1])
        status, said = run(folder, "--tests-regex", "Nothing")
        self.assertEqual(status, 1, said)


if __name__ == "__main__":
    unittest.main()
