#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the mutation tool: its pure functions, its records, and that every hand-written mistake has exactly one place today."""
import pathlib
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

import chooser  # noqa: E402
import coverage_map  # noqa: E402
import mutate  # noqa: E402
import records  # noqa: E402
import sources  # noqa: E402

EXAMPLE = """\
// a comment with f( x )
#define HALF 0.5
static const double table[] = {
	1.0,
	2.0,
};

static double twice( double x )
{
	assert( x > 0 );
	return 2 * x; // not 3 * x
}

double f( double x )
{
	/* 2 * x
	   2 * x */
	const char* text = "2 * x";
	return twice( x ) +
		   2 * x;
}
"""


class Sources(unittest.TestCase):
    def test_comments_and_strings_are_blank_and_places_stay(self):
        code = sources.blank(EXAMPLE)
        self.assertEqual(len(code), len(EXAMPLE))
        self.assertEqual([len(line) for line in code.split("\n")], [len(line) for line in EXAMPLE.split("\n")])
        self.assertNotIn("comment", code)
        self.assertNotIn('"2 * x"', code)
        self.assertEqual(code.count("2 * x"), 2)

    def test_a_quote_in_a_comment_ends_no_string(self):
        self.assertIn("int b;", sources.blank("// it's\nint a; /* \" */\nint b;\nchar c = '\"'; int d;\n"))
        self.assertIn("int d;", sources.blank("// it's\nint a; /* \" */\nint b;\nchar c = '\"'; int d;\n"))

    def test_functions_are_found_by_definition_not_by_call(self):
        code = sources.blank(EXAMPLE)
        bodies = sources.function_bodies(code, "twice")
        self.assertEqual(len(bodies), 1)
        self.assertIn("assert", code[slice(*bodies[0])])
        self.assertNotIn("text", code[slice(*bodies[0])])

    def test_qualified_functions_and_constructors_are_found(self):
        code = "A::A( int x )\n    : m( x ), n{ x }\n{\n\tuse();\n}\nint A::get() const\n{\n\treturn m;\n}\n"
        self.assertEqual(len(sources.function_bodies(code, "A::get")), 1)
        self.assertEqual(len(sources.function_bodies(code, "A::A")), 1)

    def test_a_line_knows_its_function(self):
        code = sources.blank(EXAMPLE)
        self.assertEqual(sources.function_at(code, 11), "twice")
        self.assertEqual(sources.function_at(code, 20), "f")
        self.assertEqual(sources.function_at(code, 4), "")

    def test_only_code_is_mutated(self):
        # neither comments, the preprocessor's lines, braces, assertions nor constant tables
        self.assertEqual(sources.mutable_lines(EXAMPLE), {8, 11, 14, 18, 19, 20})

    def test_a_change_in_a_comment_is_none(self):
        self.assertFalse(sources.changes_code("x = 1; // a", "x =  1; // b"))
        self.assertTrue(sources.changes_code("x = 1; // a", "x = 2; // a"))

    def test_a_pattern_counts_inside_of_its_function_whatever_its_spaces(self):
        mistake = {"id": "1", "file": "x.c", "function": "f", "pattern": "twice( x ) + 2 * x", "replacement": "twice( x )"}
        text, line = sources.with_mistake(EXAMPLE, mistake)
        self.assertEqual(line, 19)
        self.assertIn("return twice( x );", text)

    def test_a_pattern_that_is_there_twice_or_never_is_refused(self):
        mistake = {"id": "1", "file": "x.c", "function": "", "pattern": "2 * x", "replacement": "x"}
        self.assertRaises(ValueError, sources.with_mistake, EXAMPLE, mistake)
        self.assertRaises(ValueError, sources.with_mistake, EXAMPLE, {**mistake, "pattern": "4 * x"})

    def test_a_mistake_follows_its_function_into_another_file(self):
        with tempfile.TemporaryDirectory() as folder:
            tree = pathlib.Path(folder)
            (tree / "core/src/room").mkdir(parents=True)
            (tree / "core/src/other.c").write_text("int twice;\n", encoding="utf-8")
            (tree / "core/src/room/new.c").write_text(EXAMPLE, encoding="utf-8")
            mistake = {"id": "1", "file": "core/src/old.c", "function": "twice", "pattern": "2 * x", "replacement": "x"}
            self.assertEqual(sources.find_file(tree, mistake), "core/src/room/new.c")
            (tree / "core/src/other.c").write_text(EXAMPLE, encoding="utf-8")
            self.assertRaises(ValueError, sources.find_file, tree, mistake)

    def test_a_fingerprint_forgets_places_and_nothing_else(self):
        name = sources.fingerprint("core/a.c", "f", "x = 1;", "x = 2;")
        self.assertEqual(name, sources.fingerprint("core/b.c", "f", "\tx  = 1;", "x = 2;"))
        others = {sources.fingerprint(*what) for what in (("bridge/a.c", "f", "x = 1;", "x = 2;"), ("core/a.c", "g", "x = 1;", "x = 2;"),
                                                         ("core/a.c", "f", "x = 1;", "x = 3;"), ("core/a.c", "f", "x = 0;", "x = 2;"))}
        self.assertEqual(len(others | {name}), 5)


class Mistakes(unittest.TestCase):
    def test_each_has_exactly_one_place_today(self):
        stale = []
        for mistake in mutate.read_mistakes():
            try:
                file = sources.find_file(mutate.REPOSITORY, mistake)
                text = (mutate.REPOSITORY / file).read_text(encoding="utf-8")
                changed, _ = sources.with_mistake(text, mistake)
                self.assertNotEqual(changed, text)
            except (OSError, ValueError) as error:
                stale.append(str(error))
        self.assertEqual(stale, [], "\nThese mistakes have lost their place. Find it again by what they say, and correct function, pattern and "
                         "replacement in tests/mutation/mistakes.toml; or move them to its notes if the code is gone.\n" + "\n".join(stale))

    def test_each_says_what_it_is(self):
        names = set()
        for mistake in mutate.read_mistakes():
            self.assertNotIn(mistake["id"], names)
            names.add(mistake["id"])
            self.assertTrue(mistake["what"])
            self.assertIn(mistake["expected"], ("killed", *records.CLASSES))
            self.assertTrue(mistake["expected"] == "killed" or mistake["why"], mistake["id"])

    def test_classes_of_survivors_can_be_read(self):
        records.read_classes(HERE / "survivors.toml")


class Records(unittest.TestCase):
    def test_a_state_goes_on_after_it_was_cut_off(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "state.jsonl"
            state = records.State(path, {"commit": "c", "seed": 1})
            state.add({"id": "r1", "result": "survived"})
            state.add({"id": "r1", "result": "killed"})
            with open(path, "a", encoding="utf-8") as file:
                file.write('{"id": "r2", "resu')
            again = records.State(path, {"commit": "c", "seed": 1})
            self.assertEqual(again.results, {"r1": {"id": "r1", "result": "killed"}})
            again.add({"id": "r2", "result": "killed"})
            self.assertEqual(len(records.State(path, {"commit": "c", "seed": 1}).results), 2)
            self.assertRaises(ValueError, records.State, path, {"commit": "d", "seed": 1})

    def test_equivalent_mutants_do_not_count(self):
        kinds = [("killed", ""), ("killed", ""), ("killed", ""), ("survived", "a"), ("survived", "b"), ("survived", "c"), ("equivalent", ""), ("invalid", "")]
        found = [{"result": result, "fingerprint": name} for result, name in kinds]
        totals, scores = records.counts(found, {"a": {"class": "equivalent", "why": "x"}, "c": {"class": "speed", "why": "x"}})
        self.assertEqual(list(scores.values()), [60.0, 75.0])
        self.assertEqual((totals["killed"], totals["survived"], totals["equivalent"], totals["not classified"]), (3, 3, 2, 1))
        self.assertEqual(totals["compiled"], 7)


class Choosing(unittest.TestCase):
    def setUp(self):
        self.tests = [{"name": f"t{i}", "seconds": 0.1 * (i + 1), "lines": {"a.c": 0b1110 if i < 20 else 0b1000}, "command": ["p"]}
                      for i in range(30)]

    def test_only_tests_that_execute_the_line_run(self):
        choose = chooser.Chooser(self.tests)
        self.assertEqual(choose.reaching("a.c", [1]), list(range(20)))
        self.assertEqual(len(choose.reaching("a.c", [3])), 30)
        self.assertEqual(choose.reaching("b.c", [1]), [])

    def test_quick_tests_come_first_and_those_that_kill_before_them(self):
        choose = chooser.Chooser(self.tests)
        self.assertEqual(choose.order([2, 0, 1], "a.c"), [0, 1, 2])
        for _ in range(3):
            choose.saw("a.c", [0, 1], 2)
        self.assertEqual(choose.order([2, 0, 1], "a.c")[0], 2)

    def test_what_resembles_earlier_tests_waits(self):
        tests = [{"name": name, "seconds": 0.1, "lines": {"a.c": 0b10}, "command": ["p"]}
                 for name in ("W/Suite.case/A", "W/Suite.case/B", "W/Suite.case/C", "Suite.other", "Second.one")]
        order = chooser.Chooser(tests).order(range(5), "a.c")
        self.assertEqual(order[0], 0)
        self.assertEqual(set(order[1:3]), {3, 4})

    def test_batches_hold_each_test_once(self):
        choose = chooser.Chooser(self.tests)
        batches = list(choose.batches(list(range(30)), lambda test: test["command"][0]))
        self.assertEqual(sorted(n for batch in batches for n in batch), list(range(30)))
        self.assertTrue(all(len(batch) == 1 for batch in batches[:chooser.SINGLES]))
        self.assertLess(len(batches), 30)

    def test_bits_name_lines(self):
        self.assertEqual(coverage_map.lines_of(0b10110), {1, 2, 4})


if __name__ == "__main__":
    unittest.main()
