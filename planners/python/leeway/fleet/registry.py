# SPDX-License-Identifier: BSD-3-Clause
"""The kinds of work by name."""
from __future__ import annotations

from .kinds import Edges, Kind, States

__all__ = ["KINDS"]

KINDS: dict[str, Kind] = {"states": States(), "edges": Edges()}
