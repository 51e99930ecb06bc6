#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Runs a campaign while its workers and its scheduler are killed at random, then compares all bytes with those of an undisturbed run.

    soak_fleet.py CAMPAIGN.toml OUT [--kills 10] [--workers 2] [--seed 1] [--wait 6]

OUT gets two folders, `calm` (one worker; kept if it is there) and `killed`. A kill is SIGKILL: of a worker, or of the process with the scheduler and
the client, after which the campaign is started again. Exit status 1 if a byte differs, or if fewer kills than asked fell into the work.
"""
import argparse
import pathlib
import random
import signal
import subprocess
import sys
import time

import psutil


def start(campaign, folder, workers):
    return subprocess.Popen([sys.executable, "-m", "leeway.fleet", "run", campaign, "--out", str(folder), "--workers", str(workers), "--quiet"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def shards(folder):
    return len(list(folder.rglob("*.parquet")))


def workers_of(process):
    """Its workers: processes that the nannies made."""
    try:
        children = psutil.Process(process.pid).children(recursive=True)
        return [child for child in children if any("spawn_main" in word for word in child.cmdline())]
    except psutil.Error:
        return []


def kill(process, random_numbers, kind):
    if kind == "scheduler":
        process.kill()
        process.wait()
        return True
    victims = workers_of(process)
    if not victims:
        return False
    try:
        random_numbers.choice(victims).send_signal(signal.SIGKILL)
    except psutil.Error:
        return False
    return True


def disturbed(a, folder, random_numbers):
    """Kills until enough have been killed, then lets the campaign end. Returns the kills of each kind."""
    kills = {"worker": 0, "scheduler": 0}
    process = start(a.campaign, folder, a.workers)
    while sum(kills.values()) < a.kills:
        time.sleep(random_numbers.uniform(0.5, a.wait))
        if process.poll() is not None:
            if process.returncode == 0:
                break  # too early
            process = start(a.campaign, folder, a.workers)
            continue
        kind = random_numbers.choice(["worker", "scheduler"])
        if kill(process, random_numbers, kind):
            kills[kind] += 1
            print(f"killed a {kind}; {shards(folder)} shards are there", flush=True)
        if kind == "scheduler":
            time.sleep(1)  # workers notice and give the folder's lock back
            process = start(a.campaign, folder, a.workers)
    while process.wait() != 0:
        process = start(a.campaign, folder, a.workers)
    return kills


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("campaign")
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--wait", type=float, default=6.0, help="seconds between two kills, at most")
    a = parser.parse_args()
    calm, killed = a.out / "calm", a.out / "killed"
    if not (calm / "manifest.json").exists() and start(a.campaign, calm, 1).wait() != 0:
        sys.exit("the calm run failed")
    print(f"seed {a.seed}")
    kills = disturbed(a, killed, random.Random(a.seed))
    names = sorted(path.relative_to(calm) for path in calm.rglob("*.parquet") if not path.name.endswith(".times.parquet"))
    different = [str(name) for name in [*names, "manifest.json"] if (calm / name).read_bytes() != (killed / name).read_bytes()]
    print(f"{kills['worker']} workers and {kills['scheduler']} schedulers killed; {len(names)} shards and the manifest compared, {len(different)} differ")
    sys.exit(1 if different or sum(kills.values()) < a.kills else 0)


if __name__ == "__main__":
    main()
