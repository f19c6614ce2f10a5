#!/usr/bin/python3
"""Write what `scripts/test --nightly` ran last into the table of a document, one row a check.

    record.py --stamp SOURCE                before the checks: prints date, revision and machine
    record.py BUILD DOCUMENT STAMP

A row of a check that did not run this time stays as it is, with its own date; one that never ran says so. The tests
without the label are one row, `every other test`. The gates have a table of their own and no row.
"""
import datetime
import json
import os
import platform
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

BEGIN, END = "<!-- written by scripts/test --nightly: begin -->", "<!-- end -->"
HEAD = ["| Check | Last run | Revision | Machine | Result | Minutes |", "|---|---|---|---|---|---|"]
OTHERS = "every other test"
ELSEWHERE = {"gates"}  # in docs/reliability.md, a row for each
NEVER = "not run yet"


def known_tests(build):
    """Names of ctest's tests with the label, in its order, and of those without."""
    shown = subprocess.run(["ctest", "--show-only=json-v1"], cwd=build, check=True, capture_output=True, text=True).stdout
    names = {True: [], False: []}
    for test in json.loads(shown)["tests"]:
        labels = [p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"]
        names["nightly" in sum(labels, [])].append(test["name"])
    return names[True], names[False]


def revision(folder):
    """Commit of the source, with '+' where files differ from it."""
    git = ["git", "-C", str(folder)]
    commit = subprocess.run([*git, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    changed = subprocess.run([*git, "status", "--porcelain", "-uno"], capture_output=True, text=True).stdout.strip()
    return (commit or "unknown") + ("+" if changed else "")


def machine():
    model = next((line.partition(":")[2].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                  if line.startswith("model name")), platform.machine())
    return f"{len(os.sched_getaffinity(0))} cores, {model}"


def cases(build, name):
    """Passed and failed cases in the result file that a test wrote, None without one."""
    path = Path(build) / "test_results" / "e2e_cdiff" / f"gtest-{name}.xml"
    try:
        found = list(ElementTree.parse(path).getroot().iter("testcase"))
    except (OSError, ElementTree.ParseError):
        return None
    skipped = sum(case.find("skipped") is not None or case.get("result") == "skipped" for case in found)
    failed = sum(case.find("failure") is not None or case.find("error") is not None for case in found)
    return len(found) - failed - skipped, failed, skipped


def was_skipped(run):
    """Whether a program said that it cannot run here; one that ctest could not start has failed."""
    skipped = run.find("skipped")
    return skipped is not None and "SKIP_RETURN_CODE" in skipped.get("message", "")


def outcome(build, name, run):
    """The text of a row's result."""
    if was_skipped(run):
        return "left out: a program or input that it needs is missing"
    passed = run.find("failure") is None and run.get("status") == "run"
    counts = cases(build, name)
    if counts is None:
        return "passed" if passed else "failed"
    text = f"{counts[0]} passed, {counts[1]} failed" + (f", {counts[2]} skipped" if counts[2] else "")
    return text if passed or counts[1] else text + ", ended before its last case"


def rows_of(build, nightly, others, stamp):
    """A row for each test with the label that ran, one for all tests without it if all of them ran."""
    runs = list(ElementTree.parse(Path(build) / "Testing" / "ctest.xml").getroot().iter("testcase"))
    rows = {}
    ran = [run for run in runs if run.get("name") in others]
    if len(ran) == len(others):
        skipped = sum(was_skipped(run) for run in ran)
        passed = sum(run.get("status") == "run" and run.find("failure") is None for run in ran) - skipped
        seconds = sum(float(run.get("time")) for run in ran)
        text = f"{passed} programs passed, {len(ran) - passed - skipped} failed" + (f", {skipped} skipped" if skipped else "")
        rows[OTHERS] = [*stamp, text, f"{seconds / 60:.1f}"]
    for run in runs:
        if run.get("name") in nightly:
            rows[run.get("name")] = [*stamp, outcome(build, run.get("name"), run), f"{float(run.get('time')) / 60:.1f}"]
    return rows


def kept_rows(table):
    """Rows of an earlier table, by check."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines() if line.startswith("| ")]
    return {row[0].strip("`"): row[1:] for row in rows if row[0] != "Check"}


def main():
    if sys.argv[1] == "--stamp":
        print(json.dumps([datetime.date.today().isoformat(), revision(sys.argv[2]), machine()]))
        return
    build, document, stamp = sys.argv[1], Path(sys.argv[2]), json.loads(sys.argv[3])
    text = document.read_text()
    before, _, rest = text.partition(BEGIN)
    table, _, after = rest.partition(END)
    nightly, others = known_tests(build)
    rows = {**kept_rows(table), **rows_of(build, nightly, others, stamp)}
    lines = HEAD + ["| " + " | ".join([check if check == OTHERS else f"`{check}`", *rows.get(check, [NEVER, "", "", "", ""])]) + " |"
                    for check in [OTHERS, *nightly] if check not in ELSEWHERE]
    temporary = document.with_suffix(".md.new")
    temporary.write_text(before + BEGIN + "\n" + "\n".join(lines) + "\n" + END + after)
    temporary.replace(document)


if __name__ == "__main__":
    main()
