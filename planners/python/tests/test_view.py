# SPDX-License-Identifier: BSD-3-Clause
"""Pages from Python: whole, with the paths that were given, and safe inside of a notebook."""
import html
import json
import re

import numpy as np
import pytest

import leeway

ROBOT = """<robot name="turn">
  <link name="foot"><collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision></link>
  <link name="arm"><collision><origin xyz="0.4 0 0"/><geometry><box size="0.3 0.1 0.1"/></geometry></collision></link>
  <joint name="yaw" type="revolute"><parent link="foot"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" velocity="1" effort="1"/></joint>
</robot>"""


@pytest.fixture(scope="module")
def checker():
    return leeway.Checker(leeway.Robot(ROBOT), leeway.Scene())


def model(page):
    return json.loads(re.search(r'<script type="application/json" id="model">(.*?)</script>', page.html, re.S).group(1))


def test_a_page_has_the_path(checker, tmp_path):
    page = leeway.view(checker, [[-1.0], [1.0]], min_d=0.01)
    data = model(page)
    assert data["motion"]["steps"][0]["q"] == [-1.0] and data["motion"]["steps"][-1]["q"] == [1.0]
    assert data["min_d"] == 0.01 and "more" not in data
    page.save(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text(encoding="utf-8") == page.html
    assert [p.name for p in tmp_path.iterdir()] == ["page.html"]


def test_several_paths_keep_their_names(checker):
    plan = checker.plan([-1.0], [1.0], seconds=10)
    data = model(leeway.view(checker, {"<b>": plan, "back": np.array([[1.0], [0.0], [-1.0]])}))
    assert data["motion"]["source"] == "<b>" and [m["source"] for m in data["more"]] == ["back"]
    assert data["more"][0]["length"] == pytest.approx(2)


def test_a_notebook_gets_the_whole_page(checker):
    page = leeway.view(checker, [[0.0], [0.5]], height=500)
    shown = page._repr_html_()
    assert 'height="500"' in shown
    inside = re.search(r'srcdoc="(.*)" width', shown, re.S).group(1)
    assert '"' not in inside and html.unescape(inside) == page.html


def test_what_is_no_path_is_refused(checker):
    for bad in ([], [[0.0, 1.0]], {}, [[float("nan")]]):
        with pytest.raises(ValueError):
            leeway.view(checker, bad)
