#!/usr/bin/python3
"""Line coverage of src/ by the tests that are not nightly, in a build of its own (gcov, counted by gcovr).

    coverage.py BUILD SOURCE RESULT.xml

It fails below 90 %, and prints layers and the files with most lines that no test runs. A test that fails counts, too: whether it
passes is a matter of scripts/test.
"""
import json
import os
import shutil
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

BUILD, SOURCE, RESULT = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve()
GOAL = 0.90
FOLDER = BUILD / "coverage"
JOBS = os.environ.get("JOBS", str(os.cpu_count()))
# Tests have threads. As in sanitizers.py, gcc 12 takes what its own avx512fintrin.h leaves undefined for a fault of ours.
FLAGS = "-O1 --coverage -fprofile-update=atomic -Wno-error=uninitialized -Wno-error=maybe-uninitialized"


def build():
    subprocess.run(["cmake", "-S", SOURCE, "-B", FOLDER, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None", "-DE2E_CDIFF_BENCHMARKS=OFF",
                    f"-DCMAKE_CXX_FLAGS={FLAGS}", "-Wno-dev"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", FOLDER, "-j", JOBS], check=True)


def run_tests():
    for counts in FOLDER.rglob("*.gcda"):
        counts.unlink()
    environment = {**os.environ, "BUILD": str(FOLDER), "ROS_HOME": str(FOLDER / "ros_home"), "E2E_CDIFF_CACHE": str(FOLDER / "cache")}
    environment.pop("ROS_MASTER_URI", None)
    command = f'. scripts/environment && cd "{FOLDER}" && exec "{SOURCE}/scripts/isolated" ctest -j {JOBS} --timeout 900 -LE nightly'
    subprocess.run(["bash", "-c", command], cwd=SOURCE, env=environment, check=False)


def covered():
    """Lines that ran and all lines, by file below src/."""
    shown = subprocess.run(["gcovr", "--root", SOURCE, "--filter", f"{SOURCE}/src/", "--json-summary", "-j", JOBS, FOLDER],
                           check=True, capture_output=True, text=True).stdout
    return {entry["filename"]: (entry["line_covered"], entry["line_total"]) for entry in json.loads(shown)["files"]}


def cases_of(files):
    """The case `src`; prints what each layer has, and the files with most gaps."""
    ran, lines = Counter(), Counter()
    for name, (covered_lines, all_lines) in files.items():
        for place in ("src", "/".join(Path(name).parts[:2])):
            ran[place] += covered_lines
            lines[place] += all_lines
    for place in sorted(lines):
        print(f"{100.0 * ran[place] / lines[place]:6.1f} %  {ran[place]} of {lines[place]} lines  {place}")
    for name, (covered_lines, all_lines) in sorted(files.items(), key=lambda item: item[1][0] - item[1][1])[:20]:
        print(f"{all_lines - covered_lines:5d} lines not run in {name}")
    share = ran["src"] / lines["src"]
    failure = None if share >= GOAL else f"{100.0 * share:.1f} % of the lines of src run; expected {100.0 * GOAL:.0f} %"
    return [("src", 0.0, failure)]


def main():
    if not shutil.which("gcovr"):
        print("coverage: gcovr is not installed (Debian package gcovr)")
        return 77
    begin = time.monotonic()
    build()
    run_tests()
    cases = cases_of(covered())
    print(f"{(time.monotonic() - begin) / 60.0:.1f} min")
    junit.write(RESULT, "coverage", cases)
    return any(failure for _, _, failure in cases)


if __name__ == "__main__":
    sys.exit(main())
