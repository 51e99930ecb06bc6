#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The search for functions without a caller sees one, also if a comment names it."""
import unittest

import unused

HEADER = "/// As lw_old().\nLW_API lw_status lw_used( const lw_thing* thing, lw_other ( *call )( void* ) );\nLW_API const lw_thing*\n\tlw_idle( void );\n"


class Unused(unittest.TestCase):
    def test_declarations_over_several_lines_and_none_in_comments(self):
        self.assertEqual(unused.declared(HEADER), ["lw_used", "lw_idle"])

    def test_function_that_nobody_calls(self):
        self.assertEqual(unused.unused([HEADER], ["lw_used( thing, call );"]), ["lw_idle"])

    def test_comment_is_no_call(self):
        self.assertEqual(unused.unused([HEADER], ["lw_used( a, b ); // and lw_idle()", "/* lw_idle()\n */"]), ["lw_idle"])

    def test_all_are_called(self):
        self.assertEqual(unused.unused([HEADER], ["lw_used( a, b );", "f = lw_idle;"]), [])


if __name__ == "__main__":
    unittest.main()
