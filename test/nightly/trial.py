"""Changed sources built and tested in a copy of the source tree."""
import json
import os
import re
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from source_copy import SourceCopy, environment_of, ninja  # noqa: E402

# Limits of memory are for the libraries as they ship.
LIMITED = "*Memory*"


@dataclass
class Program:
    """A test program: its file, the folder of its source below test/, the cases that run every day, and its time without a change."""

    name: str
    path: Path
    folder: str
    left_out: str = ""  # pattern of gtest
    seconds: float = 0.0
    failures: list = field(default_factory=list)  # cases that failed in the last run


def left_out_of(arguments):
    """Pattern of cases behind the '-' of a --gtest_filter among a test's arguments."""
    filters = [argument.partition("=")[2] for argument in arguments if argument.startswith("--gtest_filter=-")]
    return filters[0][1:] if filters else ""


class Trial:
    """A copy at `root`, configured with `options` of CMake; kept there, it is built anew only where the source has changed. With
    `own_programs` the test programs are the copy's, else those of `source_build`, which then run with the libraries of the copy."""

    def __init__(self, source, source_build, root, options=(), own_programs=True):
        self.source, self.root = source, root
        self.copy = SourceCopy(source, source_build, root)
        self.build = self.copy.build
        self.tests_in = self.build if own_programs else source_build
        subprocess.run(["cmake", "-S", root, "-B", self.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                        "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache", *options], check=True, stdout=subprocess.DEVNULL)

    def programs(self):
        """Test programs that run every day, by name. Which of their cases do not is known once they are built."""
        places = re.findall(r"^build (\S*?(test_\w+)): CXX_EXECUTABLE_LINKER\S* test/(\S+?)/CMakeFiles/",
                            (self.tests_in / "build.ninja").read_text(), re.MULTILINE)
        shown = subprocess.run(["ctest", "--show-only=json-v1"], cwd=self.tests_in, check=True, capture_output=True, text=True).stdout
        tests = {test["name"]: test for test in json.loads(shown)["tests"]}
        found = {}
        for path, name, folder in places:
            test = tests.get(name, {})
            labels = sum((p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"), [])
            if test and "nightly" not in labels:
                found[name] = Program(name, self.tests_in / path, folder, left_out_of(test.get("command", [])))
        return found

    def compile(self, names):
        """None when these targets build in the copy, else what ninja says."""
        built, output = self.copy.ninja(names)
        return None if built else output[-3000:]

    def compile_programs(self, names):
        """None when these test programs build where programs() finds them, else what ninja says."""
        built, output = ninja(self.tests_in, self.source, names)
        return None if built else output[-3000:]

    def passes(self, program, limit, cases=None):
        """Whether a program ends with success within `limit` seconds; leaves failed cases in `failures`. `cases`: these alone."""
        environment = environment_of(self.build, self.root)
        environment.setdefault("E2E_CDIFF_DATA", str(self.source / ".." / "shared" / "data"))
        chosen = ":".join(cases) if cases else "*-" + ":".join(filter(None, [program.left_out, LIMITED]))
        command = [program.path, f"--gtest_filter={chosen}", "--gtest_fail_fast"]
        program.failures = []
        begin = time.monotonic()
        process = subprocess.Popen(command, env=environment, cwd=self.build, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   text=True, errors="replace", start_new_session=True)
        try:
            output, _ = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            end_group(process)
            program.failures = ["no end"]
            return False
        program.seconds = time.monotonic() - begin
        if process.returncode != 0:
            failed = re.findall(r"^\[  FAILED  \] ([\w/.]+)(?:, where .*)? \(\d+ ms\)$", output, re.MULTILINE)
            program.failures = failed or [f"exit code {process.returncode}"]
        return process.returncode == 0


def end_group(process):
    """Ends a process and those that it started, SUMO among them."""
    try:
        os.killpg(process.pid, 9)
    except ProcessLookupError:
        pass
    process.communicate()
