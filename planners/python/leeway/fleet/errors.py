# SPDX-License-Identifier: BSD-3-Clause
"""Errors of campaigns: each names file, element and remedy."""
from __future__ import annotations

from .._core import Error

__all__ = ["DiskError", "FleetError"]


class FleetError(Error):
    """Unusable campaign, manifest or result. It is a leeway.Error, thus a ValueError."""

    def __init__(self, file, element: str, problem: str, remedy: str):
        super().__init__(f"{file}: {element + ': ' if element else ''}{problem}; {remedy}")
        self.file, self.element, self.problem, self.remedy = str(file), element, problem, remedy

    def __reduce__(self):
        return type(self), (self.file, self.element, self.problem, self.remedy)


class DiskError(FleetError):
    """A result cannot be written: the next one could not either."""
