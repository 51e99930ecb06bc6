# SPDX-License-Identifier: BSD-3-Clause
"""The statement of a worker before it gets work: its machine, its leeway, and whether it can read the campaign."""
from __future__ import annotations

import pathlib
import platform
from typing import Any

from .documents import regular
from .maker import maker, maker_text
from .registry import KINDS
from .shard import worlds_here

__all__ = ["fault_of", "statement"]

MOUNT = "let this node see the campaign's files and the --out folder under the same paths as the others, then start its worker again"


def _look(identity: str, base: str, folder: str) -> None:
    """Reads the manifest and all robots, and opens the files of scenes and of the work. Raises FleetError or leeway.Error."""
    regular(pathlib.Path(folder) / "manifest.json", MOUNT)
    worlds = worlds_here(identity, base, pathlib.Path(folder))
    plan = worlds.plan
    known = plan["campaign"]["scenes"]
    scenes = [known[name]["file"] if name in known else name for name in plan["inputs"]["scenes"]]
    for name in [*[entry["urdf"] for entry in plan["campaign"]["robots"].values()], *scenes, *plan["inputs"]["files"]]:
        regular(worlds.folder / name, MOUNT)
    for name in sorted({part["robot"] for part in plan["parts"] if KINDS[part["kind"]].of_robots}):
        worlds.robot(name)


def statement(identity: str, base: str, folder: str) -> dict[str, Any]:
    """Of the process that calls it. identity: of the plan in the folder's manifest. `fault`: the reason why it cannot work, or ""."""
    fault = ""
    try:
        _look(identity, base, folder)
    except Exception as error:  # whatever it is, this worker cannot work
        fault = str(error) or type(error).__name__
    return {"node": platform.node(), "fault": fault, **maker()}


def fault_of(plan: dict[str, Any], stated: Any) -> str:
    """The reason why a worker that stated this cannot work on the plan, or ""."""
    if not isinstance(stated, dict) or not all(isinstance(stated.get(name), str) for name in ("node", "fault", "leeway", "module")):
        return f"it states no version of leeway; install {maker_text(plan)} there"
    if (stated["leeway"], stated["module"]) != (plan["leeway"], plan["module"]):
        return f"it has {maker_text(stated)}, and the campaign {maker_text(plan)}; install the same build there"
    return stated["fault"]
