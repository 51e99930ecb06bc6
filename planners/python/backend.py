# SPDX-License-Identifier: BSD-3-Clause
"""Build backend: scikit-build-core, with the sources of the whole library in the source distribution.

In a clone the library's CMakeLists.txt is two folders up. A source distribution has a copy of the needed folders in _sources.
"""
import contextlib
import pathlib
import shutil

from scikit_build_core import build as _build
from scikit_build_core.build import *  # noqa: F401,F403: all other hooks

HERE = pathlib.Path(__file__).resolve().parent
CLONE = HERE.parent.parent
COPY = HERE / "_sources"
PARTS = ["CMakeLists.txt", "LICENSE", "README.md", "core", "ompl_bridge", "planners", "benchmarks/README.md", "examples/first", "examples/python",
    "examples/kitchen/README.md"]


def _in_clone():
    return not COPY.exists()


def _settings(config_settings):
    """In a source distribution CMake begins in the copy."""
    settings = dict(config_settings or {})
    if not _in_clone():
        settings.setdefault("cmake.source-dir", "_sources")
    return settings


@contextlib.contextmanager
def _copied_sources():
    if not _in_clone():
        yield
        return
    try:
        for part in PARTS:
            target = COPY / part
            target.parent.mkdir(parents=True, exist_ok=True)
            if (CLONE / part).is_dir():
                shutil.copytree(CLONE / part, target, ignore=shutil.ignore_patterns("__pycache__", "_sources", "dist", "*.egg-info"))
            else:
                shutil.copy2(CLONE / part, target)
        yield
    finally:
        shutil.rmtree(COPY, ignore_errors=True)


def build_sdist(sdist_directory, config_settings=None):
    with _copied_sources():
        return _build.build_sdist(sdist_directory, config_settings)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    return _build.build_wheel(wheel_directory, _settings(config_settings), metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    return _build.build_editable(wheel_directory, _settings(config_settings), metadata_directory)
