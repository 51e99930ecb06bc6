#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of names.py on names whose class is known."""
import unittest

import names


class Names(unittest.TestCase):
    def test_names_of_the_convention(self):
        text = "TEST( Box, IsOpen )\nTEST_P( Box, GapOf8Boxes )\n  TEST_F( Box, SomewhatWhole )\nBEST( box, what )\n"
        self.assertEqual(names.problems_of(text, "a.cpp"), [])

    def test_other_names_are_told_with_their_line(self):
        for name in ("is_open", "isOpen", "Is_Open", "WhatIsNear", "TellsWhichIsNear"):
            found = names.problems_of("\nTEST( Box, %s )\n" % name, "a.cpp")
            self.assertEqual([problem.split(": ")[:2] for problem in found], [["a.cpp:2", name]], name)


if __name__ == "__main__":
    unittest.main()
