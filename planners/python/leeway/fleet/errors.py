# SPDX-License-Identifier: BSD-3-Clause
"""Errors of campaigns: each names file, element and remedy."""
from __future__ import annotations

import contextlib
from typing import Iterator

from .._core import Error

__all__ = ["DiskError", "FleetError", "named"]


class FleetError(Error):
    """Unusable campaign, manifest or result. It is a leeway.Error, thus a ValueError."""

    def __init__(self, file, element: str, problem: str, remedy: str):
        super().__init__(f"{file}: {element + ': ' if element else ''}{problem}; {remedy}")
        self.file, self.element, self.problem, self.remedy = str(file), element, problem, remedy

    def __reduce__(self):
        return type(self), (self.file, self.element, self.problem, self.remedy)


@contextlib.contextmanager
def named(file, element: str) -> Iterator[None]:
    """Faults of the library get the campaign's file and element before them."""
    try:
        yield
    except FleetError:
        raise
    except (ValueError, RuntimeError) as error:  # leeway.Error is a ValueError, and so are faults of arguments
        problem, _, remedy = str(error).rpartition("; ")
        raise FleetError(file, element, problem or remedy, remedy if problem else "correct it") from None


class DiskError(FleetError):
    """A result cannot be written: the next one could not either."""
