# SPDX-License-Identifier: BSD-3-Clause
"""Files of a folder of results: regular ones alone are read, so that nothing in a folder can hold a run up or lead it out."""
from __future__ import annotations

import errno
import hashlib
import os
import pathlib
import stat
from typing import IO

__all__ = ["MOST_BYTES", "append_line", "digest_of_file", "is_inside", "open_regular", "read_regular"]

MOST_BYTES = 1 << 30  # of a manifest or a list of runs


def open_regular(path) -> IO[bytes]:
    """Opens a file for reading. Raises OSError for a pipe, a device or a folder, without waiting for anybody."""
    handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
    if not stat.S_ISREG(os.fstat(handle).st_mode):
        os.close(handle)
        raise OSError(errno.EINVAL, "is no regular file", str(path))
    return open(handle, "rb")


def read_regular(path, most: int = MOST_BYTES) -> bytes:
    """All bytes. Raises OSError as open_regular(), and for a file of more than `most` bytes."""
    with open_regular(path) as file:
        data = file.read(most + 1)
    if len(data) > most:
        raise OSError(errno.EFBIG, f"has more than {most} bytes", str(path))
    return data


def append_line(path, line: str) -> None:
    """Adds a line to a file, which is made if it is missing. Raises OSError for a link, a pipe, a device or a folder."""
    handle = os.open(path, os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC, 0o666)
    with open(handle, "w", encoding="utf-8") as file:
        if not stat.S_ISREG(os.fstat(handle).st_mode):
            raise OSError(errno.EINVAL, "is no regular file", str(path))
        file.write(line + "\n")


def digest_of_file(path) -> str:
    """SHA-256, 64 hexadecimal digits."""
    digest = hashlib.sha256()
    with open_regular(path) as file:
        for chunk in iter(lambda: file.read(1 << 20), b""):
            digest.update(chunk)
    return digest.hexdigest()


def is_inside(folder: pathlib.Path, name: str) -> bool:
    """Is the file's folder a real one below `folder`, or not there yet? A link could lead anywhere."""
    place = folder
    for part in pathlib.PurePosixPath(name).parts[:-1]:
        place = place / part
        if place.is_symlink():
            return False
    return True
