#!/usr/bin/python3
"""Comments of headers: every class, struct and enum at namespace level has a `///` comment directly above it, and no `///` comment stands above
`#pragma once`, where it would describe no declaration. Writes JUnit: check_comments.py ROOT [JUNIT]. Exit code 1 when a header fails."""

import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

# clang-format keeps what stands in a namespace at column 0, so a type at namespace level is one that starts a line. A declaration without
# a body ("class Foo;") names a type that is described where it is defined; an explicit specialization is described by its template.
TYPE = re.compile(r"^(?:class|struct|enum(?: class| struct)?|union)\s+(?:alignas\([^)]*\)\s*)?(?:\[\[[^\]]*\]\]\s*)?(\w[\w:]*)(<?)")
PRAGMA = "#pragma once"


def is_declaration(lines, index):
    """Whether the type that starts at a line is only declared: a ';' comes before a '{'."""
    text = " ".join(lines[index:index + 8])
    brace, semicolon = text.find("{"), text.find(";")
    return brace < 0 or 0 <= semicolon < brace


def undocumented_types(text):
    """(line, name) of each type at namespace level without a `///` comment directly above it."""
    lines = text.splitlines()
    found = []
    for i, line in enumerate(lines):
        match = TYPE.match(line)
        if not match or match.group(2) or is_declaration(lines, i):
            continue
        above = i - 1
        while above >= 0 and lines[above].startswith("template"):
            above -= 1
        if above < 0 or not lines[above].startswith("///"):
            found.append((i + 1, match.group(1)))
    return found


def faults_of(text):
    """Texts of what is wrong with a header."""
    faults = [f"line {line}: {name} has no `///` comment directly above it" for line, name in undocumented_types(text)]
    head = text[:max(text.find(PRAGMA), 0)]
    for i, line in enumerate(head.splitlines()):
        if line.startswith("///"):
            faults.append(f"line {i + 1}: a `///` comment above {PRAGMA} describes no declaration")
            break
    return faults


def check_itself():
    """The rules on small texts, so that a check that finds nothing cannot pass."""
    good = "#pragma once\nnamespace a {\n/// A pose.\nstruct Pose {\n  struct Inner {};\n};\nclass Later;\n/// T.\ntemplate <class T>\nclass Box {};\n}\n"
    assert faults_of(good) == [], faults_of(good)
    assert len(faults_of(good.replace("/// A pose.\n", ""))) == 1
    assert len(faults_of(good.replace("/// T.\n", "\n"))) == 1
    assert len(faults_of("/// Poses.\n" + good)) == 1
    assert undocumented_types("enum class Kind : int { kA };\n") == [(1, "Kind")]


def main():
    check_itself()
    root = Path(sys.argv[1])
    headers = sorted(path for folder in ("include", "src") for path in (root / folder).rglob("*.h"))
    if not headers:
        sys.exit(f"no headers below {root}")
    found = [f"{header.relative_to(root).as_posix()}: {fault}" for header in headers for fault in faults_of(header.read_text(encoding="utf-8"))]
    print("\n".join([*found, f"{len(headers)} headers, {len(found)} faults"]))
    if len(sys.argv) > 2:
        junit.write_findings(sys.argv[2], "comments", [("headers", found)])
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
