# SPDX-License-Identifier: BSD-3-Clause
"""Generators of scenes."""
from __future__ import annotations


def generate(worlds, name, entry, instance):
    raise NotImplementedError
