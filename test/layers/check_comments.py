#!/usr/bin/python3
"""Comments of headers: every class, struct and enum at namespace level has a `///` comment directly above it, and no `///` comment stands above
`#pragma once`, where it would describe no declaration. Writes JUnit: check_comments.py ROOT [JUNIT]. Exit code 1 when a header fails."""

import re
import sys
from pathlib import Path
from xml.sax.saxutils import escape, quoteattr

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


def write_junit(path, results):
    failed = sum(1 for faults in results.values() if faults)
    cases = []
    for name, faults in results.items():
        body = f"<failure message={quoteattr(faults[0])}>{escape(chr(10).join(faults))}</failure>" if faults else ""
        cases.append(f'  <testcase name={quoteattr(name)} classname="comments">{body}</testcase>')
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f'<?xml version="1.0" encoding="UTF-8"?>\n<testsuite name="comments" tests="{len(results)}" failures="{failed}" errors="0">\n'
                    + "\n".join(cases) + "\n</testsuite>\n", encoding="utf-8")


def main():
    check_itself()
    root = Path(sys.argv[1])
    headers = sorted(path for folder in ("include", "src") for path in (root / folder).rglob("*.h"))
    if not headers:
        sys.exit(f"no headers below {root}")
    results = {}
    for header in headers:
        name = header.relative_to(root).as_posix()
        results[name] = faults_of(header.read_text(encoding="utf-8"))
        for fault in results[name]:
            print(f"{name}: {fault}")
    if len(sys.argv) > 2:
        write_junit(Path(sys.argv[2]), results)
    failed = sum(1 for faults in results.values() if faults)
    print(f"{len(results)} headers, {failed} with faults")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
