# SPDX-License-Identifier: BSD-3-Clause
"""JSON, YAML and TOML of others: regular files only, and a key that is there twice is an error that names both lines.

Readers differ in which of two equal keys they take, so a file with both means one thing here and another elsewhere.
"""
from __future__ import annotations

import functools
import json
import pathlib
import re
from typing import Any

from .errors import FleetError
from .files import open_regular, read_regular

try:
    import tomllib
except ImportError:  # Python 3.10 and before
    import tomli as tomllib

__all__ = ["ONCE", "parse_json", "parse_toml", "parse_yaml", "read_documents", "read_text", "regular"]

MOST_BYTES = 1 << 28  # of a document
MOST_DEPTH = 64  # of tables and lists in each other
MOST_ENTRIES = 1 << 26  # of a document, those of each alias counted again
ONCE = "keep one of them"
JSON_TOKEN = re.compile(r'"(?:[^"\\]|\\.)*"|[{}\[\]:,]', re.DOTALL)
SURROGATE = re.compile(r"\\u[dD][89a-fA-F]")
TOML_PLACE = re.compile(r"\(at line (\d+), column \d+\)$")


class _Twice(ValueError):
    """A key that is there twice."""


def read_text(path, most: int = MOST_BYTES, remedy: str = "correct the path") -> str:
    """The text of a regular file. Raises FleetError for a pipe, a device or a folder, for too many bytes, and for bytes that are no UTF-8."""
    try:
        return read_regular(path, most).decode("utf-8-sig")
    except OSError as error:
        raise FleetError(path, "", error.strerror or str(error), remedy) from None
    except UnicodeDecodeError as error:
        raise FleetError(path, "", f"is no text of UTF-8: {error.reason} at byte {error.start}", "write it as UTF-8") from None


def regular(path, remedy: str = "correct the path") -> pathlib.Path:
    """The path, for a reader that would wait for a pipe. Raises FleetError for a pipe, a device or a folder, and if it cannot be read."""
    try:
        open_regular(path).close()
    except (OSError, ValueError) as error:  # a NUL in the path is a ValueError
        raise FleetError(path, "", getattr(error, "strerror", None) or str(error), remedy) from None
    return pathlib.Path(path)


def _entries(value: Any, depth: int, known: dict[int, int]) -> int:
    """Entries of a table or list, and of all in it. Raises ValueError for one that is too deep, too large, or in itself."""
    if not isinstance(value, (dict, list)):
        return 1
    if id(value) not in known:
        if depth > MOST_DEPTH:
            raise ValueError(f"has more than {MOST_DEPTH} tables and lists in each other")
        known[id(value)] = 1 + sum(_entries(entry, depth + 1, known) for entry in (value.values() if isinstance(value, dict) else value))
        if known[id(value)] > MOST_ENTRIES:
            raise ValueError(f"has more than {MOST_ENTRIES} entries")
    return known[id(value)]


def _checked(value: Any) -> Any:
    _entries(value, 0, {})
    return value


def _pairs(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    out = dict(pairs)
    if len(out) < len(pairs):
        raise _Twice
    return out


def _constant(name: str) -> None:
    raise ValueError(f"has {name}, which is no JSON")


def _json_twice(text: str) -> str:
    """Names the key that is there twice: a second look at a text of JSON."""
    opened: list[dict[str, int]] = []  # lines of the keys of open objects
    word = None
    for token in JSON_TOKEN.finditer(text):
        mark = token.group()
        if mark in ("{", "["):
            opened.append({})
        elif mark in ("}", "]"):
            opened.pop()
        elif mark == ":" and word is not None:
            key, line = json.loads(word.group()), 1 + text.count("\n", 0, word.start())
            if key in opened[-1]:
                return f"has the key {key!r} in line {opened[-1][key]} and again in line {line}"
            opened[-1][key] = line
        elif mark != ",":
            word = token
    return "has a key twice"


def parse_json(text: str) -> Any:
    """Raises ValueError with the fault, also for NaN and for tables in tables without end."""
    try:
        found = _checked(json.loads(text, object_pairs_hook=_pairs, parse_constant=_constant))
        if SURROGATE.search(text):
            json.dumps(found, ensure_ascii=False).encode()
        return found
    except UnicodeEncodeError:
        raise ValueError("has half of a character of two \\u") from None
    except _Twice:
        raise ValueError(_json_twice(text)) from None
    except RecursionError:
        raise ValueError(f"has more than {MOST_DEPTH} tables and lists in each other") from None


@functools.lru_cache(maxsize=None)
def _yaml_loader():
    import yaml

    class Loader(yaml.SafeLoader):
        """YAML without duplicate keys."""

        def compose_mapping_node(self, anchor):
            node, lines = super().compose_mapping_node(anchor), {}
            for key, _ in node.value:
                name, line = (key.tag, str(key.value)), key.start_mark.line + 1
                if name in lines:
                    raise _Twice(f"has the key {key.value!r} in line {lines[name]} and again in line {line}")
                lines[name] = line
            return node

    return Loader


def parse_yaml(text: str) -> list[Any]:
    """All documents but the empty ones. Raises ValueError with the fault."""
    import yaml
    try:
        return [_checked(found) for found in yaml.load_all(text, _yaml_loader()) if found is not None]
    except RecursionError:
        raise ValueError(f"has more than {MOST_DEPTH} tables and lists in each other") from None
    except Exception as error:  # its parser raises errors of many kinds
        raise ValueError(" ".join(str(error).split()) or type(error).__name__) from None


def _toml_twice(text: str, message: str) -> str:
    """TOML's parser names the second place only: the first one is looked for, as it is written there."""
    place = TOML_PLACE.search(message)
    lines = [line.strip() for line in text.splitlines()]
    if place is None or not any(word in message for word in ("overwrite", "twice", "Duplicate", "immutable", "multiple")):
        return message
    here = min(int(place.group(1)), len(lines)) - 1
    name = re.split(r"[=\]]", lines[here])[0].strip()
    for k in range(here - 1, -1, -1):
        if re.split(r"[=\]]", lines[k])[0].strip().replace("[[", "[") == name.replace("[[", "["):
            return f"has {name.lstrip('[').strip()} in line {k + 1} and again in line {here + 1}"
        if lines[k].startswith("[") and not name.startswith("["):
            break
    return message


def parse_toml(text: str) -> dict[str, Any]:
    """Raises ValueError with the fault."""
    try:
        return _checked(tomllib.loads(text + "\n"))  # the end of a text has no line
    except tomllib.TOMLDecodeError as error:
        raise ValueError(_toml_twice(text, str(error))) from None
    except RecursionError:
        raise ValueError(f"has more than {MOST_DEPTH} tables and lists in each other") from None


def read_documents(path) -> list[Any]:
    """The values of a file of JSON or YAML: one, or several with --- between. Raises FleetError."""
    path = pathlib.Path(path)
    text = read_text(path)
    try:
        return [parse_json(text)] if path.suffix == ".json" else parse_yaml(text)
    except ValueError as error:
        raise FleetError(path, "", str(error), ONCE if "again in line" in str(error) else "correct the file") from None
