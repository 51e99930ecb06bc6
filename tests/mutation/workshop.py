# SPDX-License-Identifier: BSD-3-Clause
"""A private copy of one commit, built with shared libraries: a mutant compiles the objects that it changes and links one library,
and every test program stays as it is. Nothing of this touches the user's tree or build."""
import json
import os
import pathlib
import shlex
import shutil
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
LIBRARIES = ("leeway_core", "leeway_io", "leeway_ompl")
COMPILE_SECONDS = 300


class Broken(Exception):
    """A tool that a mutation run needs is missing or does not work."""


def run(command, **options):
    """Runs a command with its output in a Broken if it fails."""
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, stdin=subprocess.DEVNULL, **options)
    if done.returncode != 0:
        raise Broken(f"{shlex.join(str(w) for w in command)}: status {done.returncode}\n{(done.stdout + done.stderr)[-4000:]}")
    return done.stdout


class Workshop:
    """Folder `folder`: tree (the commit's files), build (shared libraries and test programs), map (coverage), jobs."""

    def __init__(self, folder, repository, commit):
        self.folder = pathlib.Path(folder).resolve()
        self.repository = pathlib.Path(repository).resolve()
        self.commit = commit
        self.tree = self.folder / "tree"
        self.build = self.folder / "build"
        self.commands = {}  # source, relative to the tree -> (library, object, command)
        self.users = {}  # file, relative to the tree -> sources that are compiled anew when it changes
        self.links = {}  # library -> (command, output)

    def prepare(self, data, jobs, say=print):
        """Copies, configures and builds, unless this commit's workshop is there already."""
        self.folder.mkdir(parents=True, exist_ok=True)
        stamp = self.folder / "commit"
        if stamp.exists() and stamp.read_text() != self.commit:
            raise Broken(f"{self.folder} holds commit {stamp.read_text()}, not {self.commit}: name another folder, or delete this one")
        if not self.tree.exists():
            partial = self.folder / "tree.partial"
            shutil.rmtree(partial, ignore_errors=True)
            partial.mkdir()
            with subprocess.Popen(["git", "-C", self.repository, "archive", self.commit], stdout=subprocess.PIPE) as archive:
                subprocess.run(["tar", "-x", "-C", partial], stdin=archive.stdout, check=True)
            partial.rename(self.tree)
        stamp.write_text(self.commit)
        environment = {**os.environ, "CCACHE_BASEDIR": str(self.folder), "CCACHE_NOHASHDIR": "1", **self.paths()}
        ready = self.folder / "built"
        if not ready.exists():
            say(f"building commit {self.commit[:12]} with shared libraries in {self.build}")
            options = ["-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_SKIP_BUILD_RPATH=ON", "-DLEEWAY_BUILD_BENCHMARKS=OFF",
                       "-DLEEWAY_BUILD_EXAMPLES=OFF", "-DCMAKE_GTEST_DISCOVER_TESTS_DISCOVERY_MODE=PRE_TEST",
                       f"-DCMAKE_PROJECT_leeway_INCLUDE={HERE / 'shared.cmake'}", f"-DLEEWAY_DATA_DIR={data}"]
            if shutil.which("ccache"):
                options += ["-DCMAKE_C_COMPILER_LAUNCHER=ccache", "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"]
            run(["cmake", "-S", self.tree, "-B", self.build, "-G", "Ninja", *options], env=environment)
            run(["ninja", "-C", self.build, f"-j{jobs}"], env=environment)
            ready.touch()
        self._read_commands()

    def paths(self, first=()):
        """Where programs find the libraries, those in `first` before the workshop's own."""
        own = [self.build / "core", self.build / "ompl_bridge/src/io", self.build / "ompl_bridge/src/ompl"]
        return {"LD_LIBRARY_PATH": ":".join(str(p) for p in [*first, *own])}

    def _read_commands(self):
        tree = str(self.tree) + "/"
        for entry in json.loads((self.build / "compile_commands.json").read_text()):
            words = shlex.split(entry["command"])
            library = next((name for name in LIBRARIES if f"/{name}.dir/" in entry["command"]), None)
            if not library or not entry["file"].startswith(tree):
                continue
            if os.path.basename(words[0]) == "ccache":
                words = words[1:]
            output = words[words.index("-o") + 1]
            # Relative to the tree, so that a copy of it compiles to the same bytes
            self.commands[entry["file"].removeprefix(tree)] = (library, output, [word.replace(tree, "") for word in words])
        objects = {output: source for source, (_, output, _) in self.commands.items()}
        source = None
        for line in run(["ninja", "-C", self.build, "-t", "deps"]).splitlines():
            if line and not line[0].isspace():
                source = objects.get(line.split(":")[0])
            elif source and line.strip():
                used = os.path.normpath(self.build / line.strip())
                if used.startswith(tree):
                    self.users.setdefault(used.removeprefix(tree), set()).add(source)
        for line in run(["ninja", "-C", self.build, "-t", "commands", "all"]).splitlines():
            if " -shared " in line:
                # ": && COMMAND && :", as ninja's link rules are written
                words = shlex.split(line.split(" && ")[1])
                output = words[words.index("-o") + 1]
                for library in LIBRARIES:
                    if any(f"/{library}.dir/" in word for word in words):
                        self.links[library] = (words, output)
        if set(self.links) != set(LIBRARIES):
            raise Broken(f"{self.build}: link commands of {set(LIBRARIES) - set(self.links)} were not found")

    def reference_object(self, source):
        """Bytes of a source's object without a mutant, compiled as a job compiles it."""
        path = self.folder / "objects" / (source.replace("/", "_") + ".o")
        if not path.exists():
            path.parent.mkdir(exist_ok=True)
            partial = path.with_suffix(f".{os.getpid()}.{id(path)}")
            words = self.compile_words(source, partial)
            run(words, cwd=self.tree)
            partial.rename(path)
        return path.read_bytes()

    def compile_words(self, source, output):
        words = list(self.commands[source][2])
        words[words.index("-o") + 1] = str(output)
        return words + ["-Werror"]  # as CI compiles


class Job:
    """One worker's copy of the sources, and its libraries."""

    def __init__(self, workshop, number):
        self.workshop = workshop
        self.folder = workshop.folder / "jobs" / str(number)
        shutil.rmtree(self.folder, ignore_errors=True)
        for name in ("lib", "objects", "scratch"):
            (self.folder / name).mkdir(parents=True)
        self.tree = self.folder / "tree"
        for part in sorted({source.split("/")[0] for source in workshop.commands}):
            shutil.copytree(workshop.tree / part, self.tree / part)

    def build(self, file, text):
        """Compiles and links with `file` (relative to the tree) holding `text`: "built", "same" (the objects are those of the
        original), "invalid" (does not compile) or "unused" (no library is made of it)."""
        place = self.tree / file
        original = place.read_text(encoding="utf-8")
        for library in (self.folder / "lib").iterdir():
            library.unlink()
        place.write_text(text, encoding="utf-8")
        try:
            return self._compile(sorted(self.workshop.users.get(file, ())))
        finally:
            place.write_text(original, encoding="utf-8")

    def _compile(self, sources):
        if not sources:
            return "unused"
        changed = {}
        for source in sources:
            output = self.folder / "objects" / (source.replace("/", "_") + ".o")
            try:
                done = subprocess.run(self.workshop.compile_words(source, output), cwd=self.tree, capture_output=True,
                                      stdin=subprocess.DEVNULL, timeout=COMPILE_SECONDS, check=False)
            except subprocess.TimeoutExpired:
                return "invalid"
            if done.returncode != 0:
                return "invalid"
            if output.read_bytes() != self.workshop.reference_object(source):
                changed[self.workshop.commands[source][1]] = str(output)
        if not changed:
            return "same"
        for library, (words, output) in self.workshop.links.items():
            if not any(word in changed for word in words):
                continue
            target = self.folder / "lib" / output_name(words, output)
            linked = [changed.get(word, word) for word in words]
            linked[linked.index("-o") + 1] = str(target)
            if subprocess.run(linked, cwd=self.workshop.build, capture_output=True, check=False).returncode != 0:
                return "invalid"
        return "built"


def output_name(words, output):
    """File name under which programs look for a shared library."""
    for word in words:
        if word.startswith("-Wl,-soname,"):
            return word.split(",")[2]
    return os.path.basename(output)
