# SPDX-License-Identifier: BSD-3-Clause
"""Campaigns beyond one process: labels, plans and audits by the million, from a TOML file (`pip install leeway-robotics[fleet]`).

    python -m leeway.fleet run campaign.toml --workers 8

A campaign is cut into shards, each a pure function of the plan and its number; Dask spreads them over processes or machines. Results are
Parquet files with hashes in manifest.json. Whatever dies, the next run goes on, and the bytes are the same.
"""
from .errors import FleetError

__all__ = ["FleetError", "report", "run", "status", "verify"]


def __getattr__(name):  # so that a worker, which makes shards only, imports neither Dask's client nor plots
    from importlib import import_module
    modules = {"run": "running", "status": "running", "verify": "verifying", "report": "reporting"}
    if name in modules:
        return getattr(import_module(f"{__name__}.{modules[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
