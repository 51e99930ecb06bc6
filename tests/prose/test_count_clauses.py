#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of count_clauses.py on lines whose class is known."""
import pathlib
import tempfile
import unittest

import count_clauses

CLAUSES = [
    "tests what is near",
    "What a batch leaves is proved alone.",
    "the thread who holds it knows who waits",
    "tells which links can meet",
    "Which lanes are live depends on the level.",
    "the answer depends on which room it is in",
]
OTHERS = [
    "What is free? All of it.",
    "the order is kept, no matter what the level is",
    "the box, which holds every vertex,",
    "in which case the answer is UNDECIDED",
    "a state of which edges are composed",
    "users who link the library",
    "the caller, who owns it,",
    "returns `what` and sets \"what is near\"",
    "@param what the element in words; what() has it, as --what does",
    "somewhat whatever whichever whole",
]


class Clauses(unittest.TestCase):
    def test_noun_clauses_are_hits(self):
        for line in CLAUSES:
            self.assertTrue(count_clauses.has_clause(line), line)

    def test_questions_relative_clauses_and_quotes_are_none(self):
        for line in OTHERS:
            self.assertFalse(count_clauses.has_clause(line), line)


class Lines(unittest.TestCase):
    def test_comments_of_all_kinds_and_no_strings(self):
        source = 'int a; // one\n/* two\n * three */ int b;\nchar c[] = "// none"; int d = 4 / 2;\n/// four\nint e; ///< five\n//\n'
        self.assertEqual(list(count_clauses.comment_lines(source)), [(1, "one"), (2, "two"), (3, "three"), (5, "four"), (6, "five")])

    def test_comments_and_docstrings_of_scripts(self):
        source = '#!/bin/sh\n# one\nrun "$#" # two\n"""three\n\nfour"""\nfive = {}\n# SPDX-License-Identifier: none\n"""six"""\n'
        self.assertEqual(list(count_clauses.script_lines(source)), [(2, "one"), (3, "two"), (4, "three"), (6, "four"), (9, "six")])

    def test_fenced_blocks_are_no_docs(self):
        self.assertEqual(list(count_clauses.doc_lines("# Title\n\n```\nwhat is\n```\n- item\n")), [(1, "Title"), (6, "item")])

    def test_a_folder_is_counted(self):
        with tempfile.TemporaryDirectory() as root:
            folder = pathlib.Path(root) / "room" / "deep"
            folder.mkdir(parents=True)
            (folder / "a.c").write_text("// what is near\nint a; // the box\n")
            (folder / "b.md").write_text("Who calls is known.\n")
            (folder / "c.txt").write_text("what is not read\n")
            (folder / "build").mkdir()
            (folder / "build" / "d.c").write_text("// what is built\n")
            lines, hits = count_clauses.count("room", pathlib.Path(root))
            self.assertEqual(lines, 3)
            self.assertEqual([(path.name, number) for path, number, _ in hits], [("a.c", 1), ("b.md", 1)])


if __name__ == "__main__":
    unittest.main()
