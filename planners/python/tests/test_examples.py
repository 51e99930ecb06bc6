# SPDX-License-Identifier: BSD-3-Clause
"""The scripts of examples/python run and draw pictures that are not blank; the script of README.md runs."""
import os
import re
import subprocess
import sys

import pytest

from conftest import ROOT

SCRIPTS = sorted((ROOT / "examples" / "python").glob("[0-9]*.py"))
PACKAGES = {"03_world": ["toppra"], "04_pink": ["pink", "daqp"], "05_mink": ["mink", "daqp"], "06_optimise_path": ["scipy"]}


def run(arguments, folder):
    environment = dict(os.environ, MPLBACKEND="Agg", MPLCONFIGDIR=str(folder), PYTHONWARNINGS="error::DeprecationWarning:leeway")
    done = subprocess.run([sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, timeout=240)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_examples_draw_their_picture(script, tmp_path):
    if not os.environ.get("LEEWAY_PYTHON_EXTRAS"):
        for package in ["matplotlib", *PACKAGES.get(script.stem, [])]:
            pytest.importorskip(package)
    printed = run([script, tmp_path / "out.png"], tmp_path)
    import matplotlib.image
    pixels = matplotlib.image.imread(tmp_path / "out.png")
    assert pixels.shape[0] > 200 and pixels[..., :3].std() > 0.05 and "out.png" in printed
    if script.stem in ("04_pink", "05_mink"):
        limits_hold(printed)
    if script.stem == "07_live":
        person_is_safe(printed)


def person_is_safe(printed):
    """Without its guard the arm hits the hand; with it, it keeps 100 mm while it moves, waits while the hand comes nearer than that, and arrives."""
    moving, always, desk = map(int, re.search(r"^guarded +person (-?\d+) mm while it moved, (-?\d+) mm at all times; desk (-?\d+) mm$", printed, re.MULTILINE).groups())
    assert moving >= 100 > always > 0 and desk > 0
    assert int(re.search(r"^unguarded person (-?\d+) mm", printed, re.MULTILINE)[1]) < 0
    assert float(re.search(r"of which it stood ([\d.]+) s", printed)[1]) > 0.1


def limits_hold(printed):
    """Rows of name, time, least clearance and sign changes: leeway's limit keeps 10 mm, and the corners of its near states end the rattling."""
    rows = {m[1]: m for m in re.finditer(r"^(\S.*?)  +\d+ +(?:contact|([\d.]+) mm(, [\d.]+ proved)?) +([\d.]+)$", printed, re.MULTILINE)}
    assert rows["no limit"][2] is None
    least, proved, changes = rows["leeway"].groups()[1:]
    assert float(least) > 9.9 and proved and 5 * float(changes) < float(rows["leeway, one state"][4])


def test_examples_are_there():
    assert [script.name[:2] for script in SCRIPTS] == ["01", "02", "03", "04", "05", "06", "07", "08"]


def test_script_of_the_readme_runs(tmp_path):
    page = (ROOT / "planners" / "python" / "README.md").read_text()
    code = re.search(r"```python\n(.*?)```", page, re.DOTALL).group(1).replace("examples/first", str(ROOT / "examples" / "first"))
    printed = run(["-c", code], tmp_path)
    assert "Plan(SOLVED" in printed and printed.strip().endswith("True")
