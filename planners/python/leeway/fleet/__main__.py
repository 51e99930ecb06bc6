# SPDX-License-Identifier: BSD-3-Clause
"""python -m leeway.fleet run campaign.toml, status, verify, report, referee. Exit status: 0 done; 1 not complete, a fault, a contradiction; 2 bad input."""
from __future__ import annotations

import argparse
import signal
import sys

from .._core import Error, whole_number


def _count(text: str) -> int:
    try:
        return whole_number("it", int(text))
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m leeway.fleet", description="Campaigns: labelled states and edges, plans, audits, by the million.")
    commands = parser.add_subparsers(dest="command", required=True)
    run = commands.add_parser("run", help="make the shards that are not there yet")
    run.add_argument("campaign", help="TOML file")
    run.add_argument("--out", help="folder of the results (default: CAMPAIGN.fleet beside the file)")
    run.add_argument("--workers", type=_count, default=1, help="processes on this machine; 0: this one, without Dask")
    run.add_argument("--scheduler", default="", help="address of a Dask scheduler whose workers see the same folders")
    run.add_argument("--dry-run", action="store_true", help="cost from a sample; writes nothing")
    run.add_argument("--trust", action="store_true", help="do not read recorded files again first")
    run.add_argument("--quiet", action="store_true", help="no estimate, no bar")
    status = commands.add_parser("status", help="the shards that are there and have the recorded bytes")
    status.add_argument("--trust", action="store_true", help="by the manifest alone; do not read the files")
    verify = commands.add_parser("verify", help="compare files with the manifest; make some shards again")
    verify.add_argument("--campaign", help="TOML file, for --remake")
    verify.add_argument("--remake", type=_count, default=0, help="random shards to make again and compare")
    report = commands.add_parser("report", help="tables and plots")
    commands.add_parser("referee", help="paths of several planners on the same problems, audited on the meshes; its own --help")
    report.add_argument("--page", help="HTML file (default: report.html in the folder)")
    for command in (status, verify, report):
        command.add_argument("folder", help="folder of the results")
    return parser


def _execute(a: argparse.Namespace) -> int:
    if a.command == "run":
        from .running import run
        found = run(a.campaign, a.out, workers=a.workers, scheduler=a.scheduler, dry_run=a.dry_run, quiet=a.quiet, trust=a.trust)
        print(found.text(a.workers) if a.dry_run else found)
        return 0 if a.dry_run or found.complete else 1
    if a.command == "status":
        from .running import status
        found = status(a.folder, a.trust)
        print(found)
        return 0 if found.complete else 1
    if a.command == "verify":
        from .verifying import verify
        found = verify(a.folder, a.campaign, a.remake)
        print(found)
        return 0 if found.sound else 1
    from .reporting import report
    found = report(a.folder, a.page)
    print(found)
    return 0 if not found.contradictions and not found.faults else 1


def _interrupt(number, frame) -> None:
    """The first Ctrl-C ends the command. Others, which the impatient send, do not disturb its end."""
    signal.signal(number, signal.SIG_IGN)
    raise KeyboardInterrupt


def main(arguments=None) -> int:
    arguments = sys.argv[1:] if arguments is None else arguments
    try:
        if arguments[:1] == ["referee"]:
            from .referee import main as referee
            return referee(arguments[1:])
        return _execute(_parser().parse_args(arguments))
    except Error as error:
        print(error, file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("interrupted; run the same command again, it goes on where it was", file=sys.stderr)
        return 130


if __name__ == "__main__":
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # nohup ignores it, and so do we then
        signal.signal(signal.SIGINT, _interrupt)
    sys.exit(main())
