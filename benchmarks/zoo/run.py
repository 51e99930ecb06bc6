# SPDX-License-Identifier: BSD-3-Clause
"""Runs one command with a time limit, and reports its end."""
import os
import signal
import subprocess
import tempfile
import time
from dataclasses import dataclass


@dataclass
class Outcome:
    status: int  # exit status; negative: ended by that signal
    seconds: float
    out: str
    notices: str  # standard error
    timed_out: bool = False

    @property
    def crashed(self):
        return not self.timed_out and self.status not in (0, 1, 2)

    @property
    def word(self):
        if self.timed_out:
            return "time limit"
        return f"crash {self.status}" if self.crashed else {0: "yes", 1: "no", 2: "error"}[self.status]

    @property
    def message(self):
        """The error, or the last line of standard error if there is none."""
        lines = [line for line in self.notices.replace("\r", "\n").splitlines() if line.strip()]
        errors = [line for line in lines if "error:" in line]
        text = (errors or lines or [""])[-1]
        return text.removeprefix("leeway: error: ").strip()


def run(command, limit, cache=None):
    """`cache` takes the place of the user's. Standard output and error go through files, so that a program that writes much never waits for a reader."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        begin = time.monotonic()
        process = subprocess.Popen([str(word) for word in command], stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                                   env={**os.environ, "XDG_CACHE_HOME": str(cache)} if cache else None, start_new_session=True)
        timed_out = False
        try:
            status = process.wait(timeout=limit)
        except subprocess.TimeoutExpired:
            timed_out = True
            os.killpg(process.pid, signal.SIGKILL)
            status = process.wait()
        except BaseException:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            raise
        seconds = time.monotonic() - begin
        texts = []
        for stream in (out, err):
            stream.seek(0)
            texts.append(stream.read().decode("utf-8", "replace"))
    return Outcome(status, round(seconds, 3), texts[0], texts[1], timed_out)
