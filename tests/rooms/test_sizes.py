#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of sizes.py on sources whose sizes are known."""
import pathlib
import tempfile
import unittest

import sizes

SOURCE = '''// int not_one( void )
#include "a.h"
static const int table[2] = { 1, 2 };
enum kind { ONE, TWO };
struct box
{
	int a;
	bool is_open() const { return true; }
	box( int b )
		: a( b )
	{
	}
};
#if defined( A )
static int first( int x )
{
#else
static int first( void )
{
#endif
	const char* brace = "{"; // {
	char other = '{';
	return x == 1'000 ? brace[0] : other;
}

namespace room
{
TEST( Box, is_open )
{
	auto inner = [] {
		return 1;
	};
	for ( ;; )
	{
	}
	const char* raw = R"({ { {)";
}
} // namespace room
extern "C" {
int last( int a,
	int b )
{
	return a + b;
}
}
'''


class Functions(unittest.TestCase):
    def test_each_definition_and_its_lines(self):
        found = [(sizes.test_name(SOURCE, line) or name, line, lines) for name, line, lines in sizes.functions(SOURCE)]
        self.assertEqual(found, [("is_open", 8, 1), ("box", 9, 4), ("first", 15, 10), ("Box.is_open", 28, 10), ("last", 40, 5)])

    def test_braces_that_do_not_pair_are_no_silence(self):
        with self.assertRaises(ValueError):
            sizes.functions("int f( void )\n{\n")


class Limits(unittest.TestCase):
    def problems(self, files):
        with tempfile.TemporaryDirectory() as root:
            for name, text in files.items():
                path = pathlib.Path(root) / "core" / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            return sizes.survey(pathlib.Path(root), ["core"])[0]

    def test_the_largest_allowed_pass(self):
        body = "int f( void )\n{\n" + "\n" * (sizes.MOST_FUNCTION - 3) + "}\n"
        files = {"%d.c" % i: "" for i in range(sizes.MOST_FOLDER - 1)}
        self.assertEqual(self.problems({"a.c": body + "\n" * (sizes.MOST_FILE - sizes.MOST_FUNCTION), **files}), [])

    def test_one_line_more_is_told_by_name(self):
        body = "int f( void )\n{\n" + "\n" * (sizes.MOST_FUNCTION - 2) + "}\n"
        self.assertRegex(self.problems({"a.h": body})[0], r"core/a\.h:1: f has 81 lines")
        self.assertRegex(self.problems({"a.cpp": "\n" * (sizes.MOST_FILE + 1)})[0], r"core/a\.cpp: 801 lines")

    def test_one_source_more_in_a_folder(self):
        files = {"room/%d.c" % i: "" for i in range(sizes.MOST_FOLDER + 1)}
        self.assertRegex(self.problems(files)[0], r"core/room: 23 sources")
        self.assertEqual(self.problems({"build/%d.c" % i: "" for i in range(sizes.MOST_FOLDER + 1)}), [])


if __name__ == "__main__":
    unittest.main()
