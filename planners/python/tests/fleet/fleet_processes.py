# SPDX-License-Identifier: BSD-3-Clause
"""A small campaign, and the processes that tests of campaigns start."""
import json
import os
import pathlib
import subprocess
import sys
import time

from conftest import FIRST

SMALL = f"""
name = "small"
seed = 5
shard_rows = 512
[robots.arm]
urdf = "{FIRST}/arm.urdf"
srdf = "{FIRST}/arm.srdf"
group = "arm"
[scenes.desk]
file = "{FIRST}/scene.yaml"
[[work]]
kind = "states"
scenes = ["desk"]
rows = 2000
[[work]]
kind = "edges"
scenes = ["desk"]
rows = 600
audit = 0.1
audit_step = 0.05
"""


def files(folder):
    """Name and bytes of each result."""
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(pathlib.Path(folder).rglob("*"))
        if path.suffix in (".parquet", ".json") and not path.name.endswith("times.parquet")}


def command(*arguments, **options):
    return subprocess.Popen([sys.executable, "-m", "leeway.fleet", *map(str, arguments)], **options)


def start_scheduler(folder):
    """(process, address)"""
    address_file = folder / "address.json"
    scheduler = subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
        "--scheduler-file", address_file], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    for _ in range(600):
        if address_file.exists() and address_file.read_text().rstrip().endswith("}"):
            break
        time.sleep(0.1)
    return scheduler, json.loads(address_file.read_text())["address"]


def start_worker(address, threads=1, preload="", path=""):
    """A worker as on another machine. preload: a module with dask_setup(), found in the folder `path`, which is searched first."""
    env = {**os.environ, "PYTHONPATH": f"{path}:{os.environ.get('PYTHONPATH', '')}"} if path else None
    return subprocess.Popen([sys.executable, "-m", "distributed.cli.dask_worker", address, "--nworkers", "1", "--nthreads", str(threads), "--no-dashboard",
        "--death-timeout", "20", *(["--preload", preload] if preload else [])], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=env)
