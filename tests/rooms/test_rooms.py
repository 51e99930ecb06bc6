#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The room script sees an include and a call that point up, made on purpose in a house of two rooms."""
import pathlib
import re
import tempfile
import unittest

import rooms

HOUSE = rooms.House("src", [("cellar", "wine"), ("roof", "tiles")], "objects")
GOOD = {"cellar/wine.h": "", "cellar/wine.c": '#include "cellar/wine.h"\n', "roof/tiles.c": '#include "cellar/wine.h"\n', "roof/tiles.h": ""}
CALLS_DOWN = {("cellar", "wine.c"): "0000 T wine\n", ("roof", "tiles.c"): "0000 T tiles\n                 U wine\n"}


def problems(files, listings):
    with tempfile.TemporaryDirectory() as folder:
        root = pathlib.Path(folder)
        for name, text in files.items():
            path = root / "src" / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
        placed = list(rooms.files_of(root, HOUSE))
        arrows = [("includes", *arrow) for arrow in rooms.includes(root, HOUSE)] + [("calls", *arrow) for arrow in rooms.calls(listings)]
        return rooms.problems_of(HOUSE, placed, arrows)


class Rooms(unittest.TestCase):
    def test_arrows_that_point_down_are_no_problem(self):
        self.assertEqual(problems(GOOD, CALLS_DOWN), [])

    def test_include_that_points_up(self):
        found = problems({**GOOD, "cellar/wine.c": '#include "roof/tiles.h"\n'}, CALLS_DOWN)
        self.assertEqual(len(found), 1)
        self.assertIn("wine.c: includes roof/tiles.h of roof", found[0])

    def test_include_of_an_installed_header_that_points_up(self):
        found = problems({**GOOD, "cellar/wine.c": '#include "leeway/roof/tiles.hpp"\n#include "leeway/tiles.h"\n'}, CALLS_DOWN)
        self.assertEqual(len(found), 1)
        self.assertIn("wine.c: includes leeway/roof/tiles.hpp of roof", found[0])

    def test_call_that_points_up(self):
        found = problems(GOOD, {**CALLS_DOWN, ("cellar", "wine.c"): "0000 T wine\n                 U tiles\n"})
        self.assertEqual(len(found), 1)
        self.assertIn("wine.c: calls tiles", found[0])

    def test_files_of_a_room_that_call_each_other_in_a_circle(self):
        one_way = {("cellar", "wine.c"): "0000 T wine\n                 U cask\n", ("cellar", "cask.c"): "0000 T cask\n                 U hoop\n",
                   ("cellar", "hoop.c"): "0000 T hoop\n"}
        self.assertEqual(rooms.circle_problems(HOUSE, one_way), [])
        circle = {**one_way, ("cellar", "hoop.c"): "0000 T hoop\n                 U wine\n"}
        found = rooms.circle_problems(HOUSE, circle)
        self.assertEqual(len(found), 1)
        self.assertIn("cask.c, hoop.c, wine.c", found[0])

    def test_file_outside_of_every_room(self):
        found = problems({**GOOD, "loose.c": ""}, CALLS_DOWN)
        self.assertEqual(len(found), 1)
        self.assertIn("loose.c", found[0])

    def test_crowded_room(self):
        found = problems({**GOOD, **{f"roof/tile{i}.c": "" for i in range(rooms.LARGEST_ROOM)}}, CALLS_DOWN)
        self.assertEqual(len(found), 1)
        self.assertIn("at most", found[0])

    def test_house_without_objects_sees_includes(self):
        found = problems({**GOOD, "cellar/wine.c": '#include "roof/tiles.h"\n#include "other/house.h"\n#include "plain.h"\n'}, {})
        self.assertEqual(len(found), 1)
        self.assertIn("includes roof/tiles.h", found[0])


class Houses(unittest.TestCase):
    def test_every_include_of_a_house_names_a_file_that_is_there(self):
        """Else a header of another room, named without its room, would be an arrow that nobody sees."""
        root = pathlib.Path(__file__).resolve().parents[2]
        for house in rooms.HOUSES:
            there = {path.name for _, path in rooms.files_of(root, house) if path.suffix in (".h", ".hpp")}
            for room, path in rooms.files_of(root, house):
                for header in re.findall(r'^\s*#\s*include\s+"([^"/]+)"', path.read_text(), re.MULTILINE):
                    self.assertFalse(header in there and not (path.parent / header).exists(), f"{path}: {header} without its room")


if __name__ == "__main__":
    unittest.main()
