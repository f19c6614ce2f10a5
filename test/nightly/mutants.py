#!/usr/bin/python3
"""Apply each change of mutants.yaml in a copy of the source and see that a test fails.

    mutants.py BUILD SOURCE RESULT.xml [WORD...]

The copy lies in a temporary folder, apart from the package that ROS finds. With words, only the mutants in whose name or file one occurs. GTEST_FILTER is
handed on to the tests. A mutant that survives, does not compile or no longer applies is a failure, and so is a test that fails
without any.
"""
import os
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import yaml

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402
from source_copy import SourceCopy, environment_of  # noqa: E402

BUILD, SOURCE, RESULT = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), Path(sys.argv[3])
COPY = Path(tempfile.gettempdir()) / f"e2e_cdiff_mutants_{os.getpid()}"
COPY_BUILD = COPY / "build"


def failing_test(programs):
    """The first program that fails, None when all pass."""
    environment = environment_of(COPY_BUILD, COPY)
    environment.setdefault("E2E_CDIFF_DATA", str(SOURCE / ".." / "shared" / "data"))
    for name in programs:
        program = next(path for path in COPY_BUILD.rglob(f"test_{name}") if path.is_file())
        try:
            done = subprocess.run([program], env=environment, cwd=COPY_BUILD, timeout=600, capture_output=True, text=True, check=False)
        except subprocess.TimeoutExpired:
            return f"{name} (no end)"
        if done.returncode != 0:
            return name
    return None


def changed(text, mutant):
    """The text with the mutant's changes; ValueError where one does not apply."""
    for was, now in [(mutant["was"], mutant["now"]), *mutant.get("also", [])]:
        if text.count(was) != 1:
            raise ValueError(f"{mutant['file']} holds '{was}' {text.count(was)} times; mutants.yaml must follow the code")
        text = text.replace(was, now)
    return text


def verdict(mutant, copy):
    """None when the mutant is killed, else why not."""
    path = COPY / "src" / mutant["file"]
    original = path.read_text()
    try:
        path.write_text(changed(original, mutant))
        built, output = copy.ninja([f"test_{name}" for name in mutant["tests"]])
        if not built:
            return "does not compile:\n" + output[-1500:]
        killer = failing_test(mutant["tests"])
        if killer is None:
            return "survives " + ", ".join(mutant["tests"])
        print(f"killed    {mutant['name']} ({mutant['file']}) by {killer}", flush=True)
        return None
    except ValueError as error:
        return str(error)
    finally:
        path.write_text(original)


def main():
    mutants = yaml.safe_load((Path(__file__).parent / "mutants.yaml").read_text())
    words = sys.argv[4:]
    mutants = [m for m in mutants if not words or any(word in m["name"] + " " + m["file"] for word in words)]
    copy = SourceCopy(SOURCE, BUILD, COPY)
    subprocess.run(["cmake", "-S", COPY, "-B", COPY_BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"],
                   check=True, stdout=subprocess.DEVNULL)
    programs = sorted({name for mutant in mutants for name in mutant["tests"]})
    begin = time.monotonic()
    built, output = copy.ninja([f"test_{name}" for name in programs])
    broken = failing_test(programs) if built else output[-3000:]
    cases = [("without a mutant", time.monotonic() - begin, broken and f"fails: {broken}")]
    for mutant in [] if broken else mutants:
        begin = time.monotonic()
        reason = verdict(mutant, copy)
        if reason:
            print(f"NOT KILLED {mutant['name']} ({mutant['file']}): {reason}", flush=True)
        cases.append((f"{mutant['name']} ({mutant['file']})", time.monotonic() - begin, reason))
    junit.write(RESULT, "mutants", cases)
    failed = sum(reason is not None for _, _, reason in cases)
    print(f"{len(cases) - 1} mutants, {len(cases) - failed - (not broken)} killed" if not broken else f"no mutant was tried: {broken}")
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    finally:
        shutil.rmtree(COPY, ignore_errors=True)
