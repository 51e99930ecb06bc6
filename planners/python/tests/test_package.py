# SPDX-License-Identifier: BSD-3-Clause
"""The package as such: versions, docstrings, type stubs, the source distribution."""
import ast
import os
import pathlib
import re
import subprocess
import sys
import tarfile

import pytest

import leeway
from conftest import ROOT

HERE = ROOT / "planners" / "python"


def test_versions_are_equal():
    of_cmake = re.search(r"project\(leeway VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text()).group(1)
    of_wheel = re.search(r'^version = "([\d.]+)"', (HERE / "pyproject.toml").read_text(), re.MULTILINE).group(1)
    assert leeway.__version__ == of_cmake == of_wheel


def test_no_page_names_the_other_project_of_the_package_index():
    name = re.search(r'^name = "([^"]+)"', (HERE / "pyproject.toml").read_text(), re.MULTILINE).group(1)
    files = [path for room in (".ci", "core", "ompl_bridge", "planners", "examples", "benchmarks", "tests") for path in (ROOT / room).rglob("*")
        if path.is_file() and "node_modules" not in path.parts]
    listed = [words for path in [*ROOT.glob("*.md"), *files] for words in re.findall(r"pip install \S+", path.read_text(errors="ignore"))]
    named = {re.match(r"[\w.-]*", words.split()[2].strip("\"'`")).group(0) for words in listed}
    assert name != "leeway" and name in named and "leeway" not in named


def public_members():
    for name in leeway.__all__:
        value = getattr(leeway, name)
        yield name, value
        if isinstance(value, type) and value.__module__.startswith("leeway._core"):
            for member in vars(value):
                if not member.startswith("_") and not issubclass(value, int):
                    yield f"{name}.{member}", getattr(value, member)


def test_everything_public_has_a_docstring():
    bare = [name for name, value in public_members() if not (getattr(value, "__doc__", None) or "").strip()]
    assert bare == ["__version__"] or bare == []


def test_stubs_hold_every_name_and_no_unknown_type():
    stub = pathlib.Path(leeway._core.__file__).parent / "_core.pyi"
    text = stub.read_text()
    classes = {node.name: node for node in ast.parse(text).body if isinstance(node, ast.ClassDef)}
    for name, _ in public_members():
        head, _, member = name.partition(".")
        if head in classes and member:
            names = {node.name for node in classes[head].body if isinstance(node, ast.FunctionDef)}
            assert member in names, name
    assert "leeway::" not in text and "std::" not in text
    assert (stub.parent / "py.typed").exists()


def test_named_results_say_something(checker, states):
    for text in (repr(checker), repr(checker.clearance(states)), repr(checker.clearance(states[0])), repr(checker.path(states[:3])),
            repr(checker.plan(states[0], states[0])), repr(leeway.Margins(environment=0.1)), repr(leeway.Padding(robot=0.1))):
        assert "0x" not in text and re.search(r"\d", text)


def test_source_distribution_configures(tmp_path):
    if not os.environ.get("LEEWAY_PYTHON_EXTRAS"):
        pytest.importorskip("scikit_build_core")
    build = f"import sys; sys.path.insert(0, {str(HERE)!r}); import backend; print(backend.build_sdist({str(tmp_path)!r}))"
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run([sys.executable, "-c", build], cwd=HERE, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    name = done.stdout.split()[-1]
    with tarfile.open(tmp_path / name) as archive:
        archive.extractall(tmp_path)
    unpacked = tmp_path / name.removesuffix(".tar.gz")
    options = ["-DLEEWAY_BUILD_PYTHON=ON", f"-DPython_EXECUTABLE={sys.executable}"]
    options += [f"-DLEEWAY_BUILD_{part}=OFF" for part in ("OMPL", "TESTS", "EXAMPLES", "BENCHMARKS")]
    done = subprocess.run(["cmake", "-S", unpacked / "_sources", "-B", tmp_path / "build", *options], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    files = {path.relative_to(unpacked).as_posix() for path in unpacked.rglob("*") if path.is_file()}
    assert {"pyproject.toml", "backend.py", "leeway/__init__.py", "_sources/LICENSE"} <= files
    assert not any("_sources/_sources" in name or name.endswith(".so") for name in files)
