"""Counts how large the code is: `python3 reference/count.py [FOLDER ...]`, by default that of the QP, in all its crates.

A line is documentation, a comment, blank, of unit tests or code. A type is a `struct`, an `enum` or a `trait`. The files with an
`impl` are those that add methods to a type that every room knows; the doors are the functions that judge or prove an answer.
"""

import re
import sys
from collections import Counter
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

FOLDERS = ["crates/linear/src", "crates/qp/src"]
"""What was the crate of the QP, wherever its parts stand now."""

VISIBLE = r"\s*(?:pub(?:\([^)]*\))? )?"
TYPE = re.compile(VISIBLE + r"(?:struct|enum|trait) (\w+)")
NUMBER = re.compile(VISIBLE + r"const \w+: (?:\[*[fiu]\d+|\[*usize|Twice|Duration)\b")
DOOR = re.compile(VISIBLE + r"fn ((?:certify|examine|recomputed|prove)(?:_\w+)?)\b")
METHODS = re.compile(r"impl(?:<.*>)? (ContactProblem|Factored|Scene|Model)\b")


def kinds(text):
    """Gives each line of a file with its kind. A test is an item: it ends with its brace, or at once if it is in another file."""
    tests = None
    for line in text.splitlines():
        bare = line.strip()
        if bare == "#[cfg(test)]":
            tests = line[: line.index("#")]
        if tests is not None:
            yield "unit tests", line
            if line == tests + "}" or (line.startswith(tests + "mod ") and line.endswith(";")):
                tests = None
        elif bare.startswith(("///", "//!")):
            yield "documentation", line
        elif bare.startswith("//"):
            yield "comments", line
        else:
            yield "code" if bare else "blank", line


def counts(folders):
    """Returns the numbers of these folders together by their names."""
    files = sorted(file for folder in folders for file in folder.rglob("*.rs"))
    of_tests = {name for file in files for name in re.findall(r"#\[cfg\(test\)\]\nmod (\w+);", file.read_text())}
    lines, types, doors, constants, methods, characters = Counter(), Counter(), Counter(), 0, set(), 0
    for file in files:
        in_tests = bool(of_tests & {file.stem, *file.relative_to(ROOT).parts})
        for kind, line in [("unit tests", line) for line in file.open()] if in_tests else kinds(file.read_text()):
            lines[kind] += 1
            if kind == "code":
                characters += len(line.strip())
                types.update(TYPE.findall(line) if TYPE.match(line) else ())
                doors.update(DOOR.findall(line) if DOOR.match(line) else ())
                constants += bool(NUMBER.match(line))
                methods |= {(name, file) for name in METHODS.findall(line) if METHODS.match(line)}
    twice = sorted(name for name in types if types[name] > 1)
    return {
        "lines": lines.total(),
        "lines of the largest folder": max(sum(len(file.read_text().splitlines()) for file in folder.rglob("*.rs")) for folder in folders),
        **{kind: lines[kind] for kind in ("code", "documentation", "comments", "blank", "unit tests")},
        "letters of a line of code": round(characters / max(lines["code"], 1), 2),
        "files": len(files),
        "types": types.total(),
        "names of types defined twice": f"{len(twice)}: {' '.join(twice)}",
        "numeric constants": constants,
        **{f"files with `impl {name}`": sum(of == name for of, _ in methods) for name in sorted({of for of, _ in methods})},
        "doors to certificate and proof": f"{len(doors)}: {' '.join(sorted(doors))}",
    }


def main():
    folders = sys.argv[1:] or FOLDERS
    print(*folders)
    for name, value in counts([ROOT / folder for folder in folders]).items():
        print(f"  {name:32} {value}")


if __name__ == "__main__":
    main()
