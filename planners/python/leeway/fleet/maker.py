# SPDX-License-Identifier: BSD-3-Clause
"""The maker of rows: the version of leeway in this process, and a digest of its compiled module and Python sources."""
from __future__ import annotations

import functools
import hashlib
import pathlib

from .. import _core

__all__ = ["maker", "maker_text"]


@functools.lru_cache(maxsize=None)
def _module() -> str:
    """SHA-256 of the compiled module and of the package's Python files by name: equal builds have equal digests, wherever they are installed."""
    package = pathlib.Path(__file__).resolve().parents[1]
    files = {path.relative_to(package).as_posix(): path for path in package.rglob("*.py")}
    files["_core"] = pathlib.Path(_core.__file__)  # its ending names the version of Python
    digest = hashlib.sha256()
    for name in sorted(files):
        data = files[name].read_bytes()
        digest.update(f"{name}\0{len(data)}\0".encode())
        digest.update(data)
    return digest.hexdigest()


def maker() -> dict[str, str]:
    """Entries of plans, records and files of shards: `leeway`, the version, and `module`, the digest."""
    return {"leeway": _core.version, "module": _module()}


def maker_text(entries) -> str:
    """The entries of maker() for a message."""
    return f"leeway {entries.get('leeway')}, module {str(entries.get('module'))[:12]}"
