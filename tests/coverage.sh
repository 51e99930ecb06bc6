#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Which lines and branches of the core do the release tests execute? Builds with gcc's counters, runs the tests, prints a table by file and
# writes lines not covered to BUILD/not_covered.txt.
#
#   tests/coverage.sh [BUILD (default build-coverage)]
#
# JOBS=2 limits the cores. Left out are tests that build or install something, the zoo, and valgrind; benchmarks and examples are not built.
set -euo pipefail
cd "$( dirname "${BASH_SOURCE[0]}" )/.."
build=${1:-build-coverage}
jobs=${JOBS:-$( nproc )}
.ci/install.sh core bridge tests mutation
tools=${LEEWAY_MUTATION_DIR:-build/mutation}/venv/bin

options=( -DCMAKE_BUILD_TYPE=Release -DCMAKE_C_FLAGS="--coverage -fprofile-update=atomic" -DCMAKE_C_FLAGS_RELEASE="-O1 -DNDEBUG"
	-DCMAKE_EXE_LINKER_FLAGS=--coverage -DCMAKE_SHARED_LINKER_FLAGS=--coverage -DLEEWAY_BUILD_BENCHMARKS=OFF -DLEEWAY_BUILD_EXAMPLES=OFF )
[ -e "$build/CMakeCache.txt" ] || options+=( -G Ninja )
if command -v ccache >/dev/null; then
	options+=( -DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache )
fi
cmake -S . -B "$build" "${options[@]}" >/dev/null
cmake --build "$build" --parallel "$jobs"

# Counts of an earlier run do not count
find "$build" -name '*.gcda' -delete
status=0
ctest --test-dir "$build" --parallel "$jobs" --timeout 900 --output-on-failure --exclude-regex '^(install|as_built|memcheck|zoo|mutation)\.' |
	tail -n 40 || status=$?

"$tools/gcovr" --root . --filter core/src/ --object-directory "$build/core" --exclude-throw-branches --gcov-ignore-parse-errors \
	--json "$build/coverage.json" --csv "$build/coverage.csv" -j "$jobs" "$build/core"
"$tools/python" - "$build" <<'PYTHON'
import csv, json, pathlib, sys
build = pathlib.Path(sys.argv[1])
rows = list(csv.DictReader(open(build / "coverage.csv")))
print(f"{'file':44}{'lines':>8}{'of':>8}{'%':>7}{'branches':>10}{'of':>8}{'%':>7}")
def show(name, lines, of_lines, branches, of_branches):
    def part(a, b):
        return f"{100 * a / b:6.1f}" if b else "     -"
    print(f"{name:44}{lines:8}{of_lines:8} {part(lines, of_lines)}{branches:10}{of_branches:8} {part(branches, of_branches)}")
totals = [0, 0, 0, 0]
for row in sorted(rows, key=lambda r: r["filename"]):
    numbers = [int(row[name]) for name in ("line_covered", "line_total", "branch_covered", "branch_total")]
    totals = [a + b for a, b in zip(totals, numbers)]
    show(row["filename"], *numbers)
show("all", *totals)
lines = branches = 0
with open(build / "not_covered.txt", "w") as out:
    for file in json.load(open(build / "coverage.json"))["files"]:
        text = pathlib.Path(file["file"]).read_text().split("\n")
        for line in file["lines"]:
            missed = [i for i, b in enumerate(line.get("branches", [])) if b["count"] == 0]
            code = text[line["line_number"] - 1].strip() if line["line_number"] <= len(text) else ""
            if line["count"] == 0:
                lines += 1
                out.write(f"{file['file']}:{line['line_number']}: line: {code}\n")
            elif missed:
                branches += len(missed)
                out.write(f"{file['file']}:{line['line_number']}: {len(missed)} of {len(line['branches'])} branches: {code}\n")
print(f"not covered: {lines} lines, and {branches} branches of lines that are covered; {build / 'not_covered.txt'} lists them")
PYTHON
exit "$status"
