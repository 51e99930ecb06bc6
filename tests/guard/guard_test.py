#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Does the guard see each call that changes a file? Each is made outside of the stated places, where it has to fail and to be noted, and
inside, where it has to work.

    guard_test.py LIBRARY
"""
import ctypes
import os
import pathlib
import subprocess
import sys
import tempfile
import textwrap

LIBC = ctypes.CDLL(None, use_errno=True) if __name__ == "__main__" else None


def by_libc(name, *arguments, result=ctypes.c_int):
    function = getattr(LIBC, name)
    function.restype = result
    answer = function(*[a.encode() if isinstance(a, str) else a for a in arguments])
    if answer in (-1, None):
        raise OSError(ctypes.get_errno(), name)


def buffer(path):
    return ctypes.create_string_buffer(path.encode())


# name -> call(folder); the file "old", the folder "olds" and the link "oldlink" are there
CALLS = {
    "open": lambda f: os.open(f"{f}/new", os.O_WRONLY | os.O_CREAT), "open to append": lambda f: os.open(f"{f}/old", os.O_WRONLY | os.O_APPEND),
    "open by a way around": lambda f: os.open(f"{f}/olds/../new", os.O_RDWR | os.O_CREAT),
    "openat": lambda f: os.open("new", os.O_WRONLY | os.O_CREAT, dir_fd=os.open(f, os.O_RDONLY)), "truncate": lambda f: os.truncate(f"{f}/old", 0),
    "unlink": lambda f: os.unlink(f"{f}/old"), "unlinkat": lambda f: os.unlink("old", dir_fd=os.open(f, os.O_RDONLY)), "rmdir": lambda f: os.rmdir(f"{f}/olds"),
    "mkdir": lambda f: os.mkdir(f"{f}/new"), "mkdirat": lambda f: os.mkdir("new", dir_fd=os.open(f, os.O_RDONLY)), "mkfifo": lambda f: os.mkfifo(f"{f}/new"),
    "mknod": lambda f: os.mknod(f"{f}/new"), "symlink": lambda f: os.symlink("old", f"{f}/new"), "link": lambda f: os.link(f"{f}/old", f"{f}/new"),
    "rename": lambda f: os.rename(f"{f}/old", f"{f}/new"), "chmod": lambda f: os.chmod(f"{f}/old", 0o600), "utime": lambda f: os.utime(f"{f}/old", (1, 1)),
    "fopen": lambda f: by_libc("fopen", f"{f}/new", "w", result=ctypes.c_void_p), "fopen64": lambda f: by_libc("fopen64", f"{f}/old", "a", result=ctypes.c_void_p),
    "fopen to update": lambda f: by_libc("fopen", f"{f}/old", "r+", result=ctypes.c_void_p), "creat": lambda f: by_libc("creat", f"{f}/new", 0o600),
    "creat64": lambda f: by_libc("creat64", f"{f}/new", 0o600), "open64": lambda f: by_libc("open64", f"{f}/new", os.O_WRONLY | os.O_CREAT, 0o600),
    "remove": lambda f: by_libc("remove", f"{f}/old"), "mkstemp": lambda f: by_libc("mkstemp", buffer(f"{f}/new-XXXXXX")),
    "mkdtemp": lambda f: by_libc("mkdtemp", buffer(f"{f}/new-XXXXXX"), result=ctypes.c_char_p), "truncate64": lambda f: by_libc("truncate64", f"{f}/old", ctypes.c_longlong(0)),
}


def fill(folder):
    folder.mkdir()
    (folder / "old").write_text("old")
    (folder / "olds").mkdir()


def try_call(name, folder):
    """In a process under the guard: prints done, or what was refused."""
    try:
        CALLS[name](folder)
        print("done")
    except OSError as error:
        print(f"refused {error.errno}")


def run(library, name, folder, inside, log):
    variables = {**os.environ, "LD_PRELOAD": str(library), "LEEWAY_GUARD_WRITES": f"/nowhere:{inside}", "LEEWAY_GUARD_LOG": str(log)}
    variables.pop("LEEWAY_GUARD_READS", None)
    return subprocess.run([sys.executable, "-B", __file__, "--call", name, folder], env=variables, capture_output=True, text=True)


def main():
    if sys.argv[1] == "--call":
        return try_call(*sys.argv[2:])
    library, faults = pathlib.Path(sys.argv[1]).resolve(), []
    for name in CALLS:
        with tempfile.TemporaryDirectory() as scratch:
            inside, outside, log = (pathlib.Path(scratch) / part for part in ("inside", "inside-out", "log"))
            fill(inside)
            fill(outside)  # its name begins with that of a stated place, and it is none
            good = run(library, name, inside, inside, log)
            if good.stdout != "done\n" or log.exists():
                faults.append(f"{name}: inside: {good.stdout}{good.stderr}{log.read_text() if log.exists() else ''}")
            bad = run(library, name, outside, inside, log)
            noted = log.read_text() if log.exists() else ""
            left = sorted(path.name for path in outside.iterdir())
            if bad.stdout != "refused 1\n" or str(outside) not in noted or left != ["old", "olds"] or (outside / "old").read_text() != "old":
                faults.append(f"{name}: outside: {bad.stdout}{bad.stderr}{noted}{left}")
    print(textwrap.indent("\n".join(faults), "    ") or f"{len(CALLS)} calls are seen")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
