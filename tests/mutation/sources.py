# SPDX-License-Identifier: BSD-3-Clause
"""Facts about C and C++ text for mutation: functions, code without comments, lines that may be mutated, patterns."""
import hashlib
import re


def blank(text):
    """The text with comments, and the contents of strings and characters, as spaces: places and line ends stay."""
    pattern = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.DOTALL)

    def spaces(match):
        found = match.group(0)
        if found[0] in "\"'":
            return found[0] + " " * (len(found) - 2) + found[-1]
        return re.sub(r"[^\n]", " ", found)

    return pattern.sub(spaces, text)


def closing(code, at):
    """Place of the bracket that closes the one at `at` in blanked code, or -1."""
    pairs = {"(": ")", "{": "}", "[": "]"}
    end, depth = pairs[code[at]], 0
    for place in range(at, len(code)):
        if code[place] == code[at]:
            depth += 1
        elif code[place] == end:
            depth -= 1
            if depth == 0:
                return place
    return -1


def function_bodies(code, name):
    """(begin, end) of each definition of a function in blanked code, from its name to the brace that closes it.
    `name` may be qualified as in the source (World::detach)."""
    found = []
    for match in re.finditer(r"(?<![\w:.>])" + re.escape(name) + r"\s*(?=\()", code):
        bracket = match.end()
        after = closing(code, bracket)
        if after < 0:
            continue
        # Between the parameters and the body of a definition: qualifiers, or the initialisers of a constructor
        body = re.match(r"\s*(?:(?:const|noexcept|override|final)\s*)*(?::(?!:)[^;{]*?(?:\{[^{}]*\}[^;{]*?)*)?\{", code[after + 1:])
        if body:
            opening = after + body.end()
            end = closing(code, opening)
            if end > 0:
                found.append((match.start(), end + 1))
    return found


def function_at(code, line):
    """Name of the function that holds the line (1 is the first) of blanked code, or "": of a definition whose braces stand in
    column 0, as everywhere in this project."""
    lines = code.split("\n")
    opening = None
    for number in range(line - 1, -1, -1):
        if lines[number].startswith("}") and number < line - 1:
            return ""
        if lines[number].startswith("{"):
            opening = number
            break
    if opening is None:
        return ""
    head = " ".join(lines[max(0, opening - 12):opening])
    head = re.split(r"[;}]", head)[-1]
    match = re.search(r"([A-Za-z_~][\w:~]*)\s*\(", head)
    return match.group(1) if match else ""


def is_mutable(code_lines, number):
    """Whether line `number` (1 is the first) of blanked code may be mutated: it holds code, and neither a check that a release
    leaves out nor a line for the preprocessor nor a brace alone."""
    line = code_lines[number - 1].strip()
    if not line or line.startswith("#") or line.strip("{}();, \t") == "":
        return False
    return not re.search(r"\b(assert|_Static_assert|static_assert)\s*\(", line)


def table_lines(code):
    """Numbers of the lines inside of constant tables (static const ... = { ... };): pure data."""
    found = set()
    for match in re.finditer(r"\b(?:static\s+const|const\s+static|static\s+constexpr|constexpr\s+static)\b[^;{}()=]*=\s*\{", code):
        end = closing(code, match.end() - 1)
        if end > 0:
            found.update(range(code.count("\n", 0, match.start()) + 1, code.count("\n", 0, end) + 2))
    return found


def mutable_lines(text):
    """Numbers of all lines of a source file that may be mutated."""
    code = blank(text)
    lines = code.split("\n")
    tables = table_lines(code)
    return {n for n in range(1, len(lines) + 1) if n not in tables and is_mutable(lines, n)}


def changes_code(before, after):
    """Whether two versions of a line differ in more than comments and spaces."""
    def bare(line):
        return re.sub(r"\s+", " ", re.sub(r"//.*|/\*.*?\*/", "", line)).strip()
    return bare(before) != bare(after)


def pattern_of(text):
    """A regular expression for exactly this text, whatever spaces and line ends stand where it has some."""
    return r"\s+".join(re.escape(word) for word in text.split())


def places(text, mistake):
    """(begin, end) of each place in the file's text where the pattern of a mistake stands inside of its function."""
    expression = mistake["pattern"] if mistake.get("regex") else pattern_of(mistake["pattern"])
    areas = function_bodies(blank(text), mistake["function"]) if mistake.get("function") else [(0, len(text))]
    return [(m.start() + begin, m.end() + begin) for begin, end in areas for m in re.finditer(expression, text[begin:end])]


def find_file(tree, mistake):
    """The file that holds a mistake's place, relative to the tree: the one that it names, or where its function went: the only file below the
    same folder of sources with exactly one place. ValueError if there is none."""
    named = tree / mistake["file"]
    if named.exists() and len(places(named.read_text(encoding="utf-8"), mistake)) == 1:
        return mistake["file"]
    folder = tree / mistake["file"].split("/src/")[0] / "src"
    found = []
    for path in sorted(p for p in folder.rglob("*") if p.suffix in (".c", ".h", ".cpp", ".hpp")):
        if mistake.get("function") or path.name == named.name:
            count = len(places(path.read_text(encoding="utf-8"), mistake))
            found += [str(path.relative_to(tree))] * count
    if len(found) != 1:
        raise ValueError(f"{mistake['id']}: {len(found)} places in {mistake.get('function') or 'the whole'} of {mistake['file']}, or where it went")
    return found[0]


def with_mistake(text, mistake):
    """The file's text with the mistake in it, and the first line that changes. ValueError unless there is exactly one place."""
    found = places(text, mistake)
    if len(found) != 1:
        raise ValueError(f"{mistake['id']}: {len(found)} places in {mistake.get('function') or 'the whole'} of {mistake['file']}")
    begin, end = found[0]
    changed = text[:begin] + mistake["replacement"] + text[end:]
    lines, others = text.split("\n"), changed.split("\n")
    first = next(n for n, (a, b) in enumerate(zip(lines, others), 1) if a != b)
    return changed, first


def fingerprint(file, function, before, after):
    """Names a mutant by its change, so that it keeps its name when lines move, and functions between files of one part."""
    text = "\0".join((file.split("/")[0], function, " ".join(before.split()), " ".join(after.split())))
    return hashlib.sha256(text.encode()).hexdigest()[:12]
