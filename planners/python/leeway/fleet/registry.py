# SPDX-License-Identifier: BSD-3-Clause
"""The kinds of work by name."""
from __future__ import annotations

from .audits import Audits
from .kinds import Edges, Kind, States
from .plans import Plans
from .schedules import Schedules
from .spheres import Spheres
from .trajectories import Trajectories

__all__ = ["KINDS"]

KINDS: dict[str, Kind] = {"states": States(), "edges": Edges(), "trajectories": Trajectories(), "plans": Plans(), "audit": Audits(), "spheres": Spheres(),
    "schedules": Schedules()}
