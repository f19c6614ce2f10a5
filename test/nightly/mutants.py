#!/usr/bin/python3
"""Apply each change of mutants.yaml in a copy of the source and see that a test fails.

    mutants.py BUILD SOURCE RESULT.xml [WORD...]

The copy lies in a temporary folder, apart from the package that ROS finds. With words, only the mutants in whose name or file one occurs.
A mutant that survives, does not compile or no longer applies is a failure, and so is a test that fails without any.
"""
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path

import yaml

from trial import Trial

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

BUILD, SOURCE, RESULT = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), Path(sys.argv[3])
COPY = Path(tempfile.gettempdir()) / f"e2e_cdiff_mutants_{os.getpid()}"


def failing_test(trial, programs):
    """The first program that fails, None when all pass."""
    return next((name for name in programs if not trial.passes(trial.programs()[f"test_{name}"], 600.0)), None)


def changed(text, mutant):
    """The text with the mutant's changes; ValueError where one does not apply."""
    for was, now in [(mutant["was"], mutant["now"]), *mutant.get("also", [])]:
        if text.count(was) != 1:
            raise ValueError(f"{mutant['file']} holds '{was}' {text.count(was)} times; mutants.yaml must follow the code")
        text = text.replace(was, now)
    return text


def verdict(mutant, trial):
    """None when the mutant is killed, else why not."""
    path = COPY / "src" / mutant["file"]
    original = path.read_text()
    try:
        path.write_text(changed(original, mutant))
        broken = trial.compile([f"test_{name}" for name in mutant["tests"]])
        if broken:
            return "does not compile:\n" + broken
        killer = failing_test(trial, mutant["tests"])
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
    trial = Trial(SOURCE, BUILD, COPY)
    programs = sorted({name for mutant in mutants for name in mutant["tests"]})
    begin = time.monotonic()
    broken = trial.compile([f"test_{name}" for name in programs]) or failing_test(trial, programs)
    cases = [("without a mutant", time.monotonic() - begin, broken and f"fails: {broken}")]
    for mutant in [] if broken else mutants:
        begin = time.monotonic()
        reason = verdict(mutant, trial)
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
