# SPDX-License-Identifier: BSD-3-Clause
"""Certificates of free motions, checked by the independent checker that is in this package: it shares no code with the engine.

    data = checker.certificate( path, sources=["arm.urdf"] )
    verdict = leeway.certificate.check( data, files=["arm.urdf"] )
    assert verdict.accepted, verdict.text
"""
from __future__ import annotations

import hashlib
import os
import typing

from . import check_certificate as _checker


class Verdict(typing.NamedTuple):
    """accepted, the sentence of the checker, and (link, link or object, reason) of the pairs that may touch and are not proved."""
    accepted: bool
    text: str
    allowed: list[tuple[str, str, str]]


def content(certificate: bytes | str | os.PathLike) -> dict[str, typing.Any]:
    """All that a certificate says, as JSON has it: FORMAT.md. Raises ValueError for a damaged one."""
    if not isinstance(certificate, (bytes, bytearray)):
        with open(certificate, "rb") as file:
            certificate = file.read()
    try:
        return _checker.content_of(bytes(certificate))
    except (_checker.Damaged, OverflowError) as error:
        raise ValueError(f"damaged: {error}") from error


def check(certificate: bytes | str | os.PathLike, *, files: typing.Iterable[str | os.PathLike] = ()) -> Verdict:
    """Checks a certificate, its bytes or its file, in seconds; check_certificate.c does it in milliseconds.

    files: robot, SRDF, scene or motion from which it must have been made, by SHA-256. Raises OSError for a file that cannot be read; whatever is
    wrong with the certificate is a verdict."""
    try:
        given = content(certificate)
        for name in files:
            with open(name, "rb") as file:
                digest = hashlib.sha256(file.read()).hexdigest()
            if digest not in [source["sha256"] for source in given["sources"]]:
                return Verdict(False, f"rejected: the certificate was not made from {os.fspath(name)}", [])
        model = _checker.Model(given)
        text = _checker.Proof(model, given).run()
    except _checker.Rejected as error:
        return Verdict(False, f"rejected: {error}", [])
    except _checker.Damaged as error:
        return Verdict(False, f"damaged: {error}", [])
    except (KeyError, TypeError, ValueError, IndexError, OverflowError, RecursionError) as error:
        return Verdict(False, f"damaged: {error}", [])
    names = [link.name for link in model.links]
    allowed = [(names[r["a"]], model.objects[r["b"]] if r["object"] else names[r["b"]], r["reason"]) for r in model.allowed]
    return Verdict(True, text, allowed)
