# SPDX-License-Identifier: BSD-3-Clause
"""Build backend: scikit-build-core, with the sources of the whole library in the source distribution.

In a clone the library's CMakeLists.txt is two folders up. A source distribution has a copy of the needed folders in _sources.
"""
import os
import pathlib
import shutil
import tempfile

from scikit_build_core import build as _build
from scikit_build_core.build import *  # noqa: F401,F403: all other hooks

HERE = pathlib.Path(__file__).resolve().parent
CLONE = HERE.parent.parent
PARTS = ["CMakeLists.txt", "precompile.cmake", "LICENSE", "README.md", "core", "ompl_bridge", "planners", "benchmarks/README.md", "examples/first", "examples/python",
    "examples/kitchen/README.md"]
NO_SOURCES = shutil.ignore_patterns("__pycache__", "build", "dist", "*.egg-info")


def _in_clone():
    return (CLONE / "planners" / "python").resolve() == HERE and (CLONE / "core").is_dir()


def _settings(config_settings):
    """In a source distribution CMake begins in the copy."""
    settings = dict(config_settings or {})
    if not _in_clone():
        settings.setdefault("cmake.source-dir", "_sources")
    return settings


def _copy(source, target):
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.is_dir():
        shutil.copytree(source, target, ignore=NO_SOURCES)
    else:
        shutil.copy2(source, target)


def build_sdist(sdist_directory, config_settings=None):
    if not _in_clone():
        return _build.build_sdist(sdist_directory, config_settings)
    sdist_directory, before = os.path.abspath(sdist_directory), os.getcwd()
    with tempfile.TemporaryDirectory() as folder:  # the clone stays as it is
        stage = pathlib.Path(folder, "leeway")
        _copy(HERE, stage)
        for part in PARTS:
            _copy(CLONE / part, stage / "_sources" / part)
        os.chdir(stage)
        try:
            return _build.build_sdist(sdist_directory, config_settings)
        finally:
            os.chdir(before)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    return _build.build_wheel(wheel_directory, _settings(config_settings), metadata_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    return _build.build_editable(wheel_directory, _settings(config_settings), metadata_directory)
