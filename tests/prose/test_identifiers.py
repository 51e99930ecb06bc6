#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The search for stale names, on a small repository of known names."""
import pathlib
import tempfile
import unittest

import identifiers

FILES = {
    "core/src/room/work.c": "static int lwi_known_work( struct x { int a_member; } );",
    "tests/room/room_test.cpp": "TEST( Kernels, SolidGapExceedsDistance )\nTEST_F( Kernels, BoxGapExceedsDistance )",
    "program.cpp": 'option( "--known" );',
}


class Names(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        root = pathlib.Path(folder.name)
        for name, text in FILES.items():
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        self.sources = identifiers.Sources(root, identifiers.repository_files(root))

    def unknown(self, text):
        return [name for _, name in identifiers.unknown_names("core/docs/page.md", text, self.sources)]

    def test_known_names_of_every_kind_are_found(self):
        for name in ["lwi_known_work", "lwi_known_work()", "lwi_*_work", "x.a_member", "--known", "room/work.c", "work.c", "../src/room/work.c",
                     "Kernels.SolidGapExceedsDistance", "Kernels.Box..", "Kernels.*GapExceedsDistance", "build/bin/any", "NAME/NAME.urdf"]:
            self.assertEqual(self.unknown(f"text `{name}` text"), [], name)
        self.assertEqual(self.unknown("`Kernels.SolidGap..`, `.BoxGap..`"), [])

    def test_stale_names_of_every_kind_are_seen(self):
        for name in ["lwi_gone_work", "gone_work()", "lwi_*_gone", "x.gone_member", "--gone", "room/gone.c", "gone.c", "Kernels.Gone..",
                     "Kernels.SolidGap", "Kernels.*_exceeds_distance"]:
            self.assertEqual(self.unknown(f"text `{name}` text"), [name])
        self.assertEqual(self.unknown("`Kernels.Solid..`, `.Gone..`"), [".Gone.."])

    def test_words_formulas_and_listings_are_no_names(self):
        self.assertEqual(self.unknown("`word` `a + b_c` `-1`\n```\n`gone_name`\n```"), [])


if __name__ == "__main__":
    unittest.main()
