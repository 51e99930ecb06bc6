# SPDX-License-Identifier: BSD-3-Clause
"""A campaign under the guard of tests/guard: every command writes into its folder of results and nowhere else."""
import os
import shutil
import subprocess
import sys

import pytest

from fleet_damage import guarded, made
from fleet_processes import SMALL

assert made  # a fixture
if os.environ.get("LEEWAY_PYTHON_EXTRAS") != "required":
    for name in ("distributed", "pyarrow"):
        pytest.importorskip(name)
if not os.environ.get("LEEWAY_GUARD"):
    pytest.skip("LEEWAY_GUARD names no library: run the tests by ctest on Linux", allow_module_level=True)


def fleet(folder, *arguments, places):
    """(status, what the guard refused, standard error) of a command in the folder."""
    log = folder / "guard.log"
    log.unlink(missing_ok=True)
    done = subprocess.run([sys.executable, "-m", "leeway.fleet", *arguments], cwd=folder, env=guarded(places, log), capture_output=True, text=True, timeout=300,
        check=False)
    return done.returncode, log.read_text() if log.exists() else "", done.stderr


def test_a_command_writes_outside_of_its_results(tmp_path):
    (tmp_path / "c.toml").write_text(SMALL)
    out = tmp_path / "out"
    for arguments in (["run", "c.toml", "--dry-run"], ["run", "c.toml", "--out", "out", "--workers", "0"], ["status", "out"], ["verify", "out"], ["report", "out"],
            ["run", "c.toml", "--out", "out", "--workers", "0"]):
        status, refused, err = fleet(tmp_path, *arguments, places=[out])
        assert status == 0 and not refused, (arguments, refused, err)
    assert {path.name for path in tmp_path.iterdir()} <= {"c.toml", "out", "guard.log"}


def test_the_guard_sees_no_write_of_a_command(made, tmp_path):
    """Without a place to write, `run` is refused and noted: the test above can fail."""
    shutil.copy(made / "c.toml", tmp_path / "c.toml")
    status, refused, err = fleet(tmp_path, "run", "c.toml", "--out", "out", "--workers", "0", places=["/nowhere"])
    assert status == 2 and "mkdir" in refused and "Traceback" not in err, (status, refused, err)
