#!/usr/bin/python3
"""Count the test cases in a folder of JUnit files and print "N passed, N failed, N skipped".

A second argument names ctest's list of failed programs, one "number:name" a line: one that left no failed case
(it crashed or ran out of time) counts as one. Exits 1 when any failed, a file cannot be read, or none was run.
"""
import re
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def outcome(case):
    if case.find("failure") is not None or case.find("error") is not None:
        return "failed"
    if case.find("skipped") is not None or case.get("status") == "notrun" or case.get("result") == "skipped":
        return "skipped"
    return "passed"


def programs_that_died(folder, failed_list):
    """Names in ctest's list without a failed case in their result file."""
    if not failed_list.is_file():
        return []
    died = []
    for line in failed_list.read_text().split():
        name = line.partition(":")[2]
        cases = []
        for path in folder.rglob("*.xml"):
            # gtest-NAME.xml of NAME, rostest-NAME.xml of _ctest_PACKAGE_rostest_NAME.test
            if not name.removesuffix(".test").endswith(re.sub("^(gtest|rostest)-", "", path.stem)):
                continue
            try:
                cases += ElementTree.parse(path).getroot().iter("testcase")
            except ElementTree.ParseError:
                pass  # main() counts it
        if not any(outcome(case) == "failed" for case in cases):
            died.append(name)
    return died


def main():
    counts = {"passed": 0, "failed": 0, "skipped": 0}
    if len(sys.argv) > 2:
        for name in programs_that_died(Path(sys.argv[1]), Path(sys.argv[2])):
            print(f"failed: {name} (ended without saying which case)")
            counts["failed"] += 1
    for path in sorted(Path(sys.argv[1]).rglob("*.xml")):
        try:
            root = ElementTree.parse(path).getroot()
        except ElementTree.ParseError as error:
            print(f"{path}: not readable: {error}")
            counts["failed"] += 1
            continue
        for case in root.iter("testcase"):
            result = outcome(case)
            counts[result] += 1
            if result == "failed":
                print(f"failed: {case.get('classname')}.{case.get('name')} ({path.name})")
    print(f"{counts['passed']} passed, {counts['failed']} failed, {counts['skipped']} skipped")
    return 1 if counts["failed"] or not counts["passed"] else 0


if __name__ == "__main__":
    sys.exit(main())
