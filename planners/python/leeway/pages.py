# SPDX-License-Identifier: BSD-3-Clause
"""Pages of paths, in files and in notebooks."""
from __future__ import annotations

import html
import os

import numpy

from ._core import Checker, view_page


class Page:
    """One HTML page with robot, obstacles, paths and their clearances: any browser opens it from disk, without a network."""

    def __init__(self, text: str, height: int):
        self.html = text
        self._height = height

    def save(self, file: str | os.PathLike) -> None:
        """Writes the page, whole or not at all."""
        partial = os.fspath(file) + ".partial"
        with open(partial, "w", encoding="utf-8") as out:
            out.write(self.html)
        os.replace(partial, file)

    def _repr_html_(self) -> str:
        """The page inside of a notebook's cell."""
        return f'<iframe srcdoc="{html.escape(self.html, quote=True)}" width="100%" height="{self._height}" style="border: 0"></iframe>'

    def __repr__(self) -> str:
        return f"<leeway.Page: {len(self.html) / 1e6:.1f} MB; save(file), or show it in a notebook>"


def view(checker: Checker, path, *, min_d: float = 0.0, check: str = "both", height: int = 720) -> Page:
    """A page on which a path is played, with its clearances; several paths are compared.

    path: float64 [n, dof] of the checker's group, a Plan, or a dict of these by name. min_d: metres, drawn as the required clearance.
    height: pixels of the page in a notebook. The result is shown by notebooks, and has save(file) and html.
    Raises InputError if this build of the package has no pages: it says how to build one."""
    named = path if isinstance(path, dict) else {"path": path}
    states = []
    for name, one in named.items():
        given = getattr(one, "path", one)
        if given is None:
            raise ValueError(f"{name}: the plan has no path: {getattr(one, 'message', '')}")
        states.append((str(name), numpy.atleast_2d(numpy.asarray(given, dtype=float))))
    return Page(view_page(checker, states, min_d, check), height)
