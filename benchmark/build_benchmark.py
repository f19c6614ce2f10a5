#!/usr/bin/python3
"""Measure builds from nothing, as scripts/setup makes them but without ccache, and after a change of one file.

    scripts/benchmark build [--json FILE] [--folder DIR] [--targets TARGET...] [--touch FILE...]

Prints "figure value unit goal": wall and processor time of what the demo builds (build_demo), of everything with tests (build_all), and
of building everything again after one source of each of three layers was touched (build_touch_LAYER); the compiled files and linked
targets of each. --targets builds these instead of both. The builds lie in a folder that is removed at the end (below DIR, default /tmp).
"""
import argparse
import contextlib
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TOUCHED = ["src/core/text.cpp", "src/planners/pdm_lite/pdm_lite.cpp", "src/node_graph/messages/traffic_conversions.cpp"]
ENVIRONMENT = {**os.environ, "CCACHE_DISABLE": "1", "PATH": "/usr/bin:" + os.environ["PATH"]}


def processor_seconds():
    """Of all children that have ended, theirs included."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def timed(command, build):
    """Wall and processor seconds of a command; ends the program with the command's output when it fails."""
    cpu, wall = processor_seconds(), time.monotonic()
    done = subprocess.run(command, cwd=ROOT, env={**ENVIRONMENT, "BUILD": str(build)}, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"benchmark: {' '.join(map(str, command))} failed:\n{done.stdout[-3000:]}")
    return time.monotonic() - wall, processor_seconds() - cpu


def logged(build):
    """Lines of ninja's log so far."""
    log = build / ".ninja_log"
    return log.read_text().splitlines() if log.exists() else []


def counts(build, lines):
    """Compiled files and linked targets among the outputs in lines of ninja's log."""
    listed = subprocess.run(["ninja", "-C", build, "-t", "targets", "all"], env=ENVIRONMENT, capture_output=True, text=True, check=True).stdout
    rules = dict(line.rsplit(": ", 1) for line in listed.splitlines() if ": " in line)
    made = {line.split("\t")[3] for line in lines if line.count("\t") >= 4}
    of = [rules.get(output, "") for output in made]
    return sum("_COMPILER_" in rule for rule in of), sum("_LINKER_" in rule for rule in of)


class Figures:
    def __init__(self):
        self.rows = []

    def add(self, name, value, unit):
        self.rows.append({"figure": name, "value": value, "unit": unit, "goal": ""})
        print(f"{name} {value:.3f} {unit} -", flush=True)

    def measure(self, name, command, build):
        before = len(logged(build))
        wall, cpu = timed(command, build)
        files, targets = counts(build, logged(build)[before:])
        for suffix, value, unit in (("wall", wall, "s"), ("processor", cpu, "s"), ("files", files, "files"), ("targets", targets, "targets")):
            self.add(f"{name}_{suffix}", value, unit)


@contextlib.contextmanager
def touched(path):
    """Newer than everything that was built from it, and as before afterward: other builds of the tree do not notice."""
    status = path.stat()
    os.utime(path)
    try:
        yield
    finally:
        os.utime(path, ns=(status.st_atime_ns, status.st_mtime_ns))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", help="also write the figures to this file")
    parser.add_argument("--folder", help="build below this folder")
    parser.add_argument("--targets", nargs="+", default=[], help="build these from nothing, instead of what the demo needs and everything")
    parser.add_argument("--touch", nargs="*", default=TOUCHED, help="sources to touch, one after another")
    options = parser.parse_args()
    sources = [ROOT / name for name in options.touch]
    for source in sources:
        if not source.is_file():
            parser.error(f"there is no '{source.relative_to(ROOT)}'")
    figures = Figures()
    with tempfile.TemporaryDirectory(prefix="e2e_cdiff_build_", dir=options.folder) as folder:
        if not options.targets:
            figures.measure("build_demo", ["scripts/setup", "--only", "e2e_cdiff_session_programs"], Path(folder) / "demo")
        build = Path(folder) / "all"
        figures.measure("build_targets" if options.targets else "build_all",
                        ["scripts/setup", *(["--only", *options.targets] if options.targets else [])], build)
        for source in sources:
            with touched(source):
                name = "_".join(["build_touch", *source.relative_to(ROOT).parts[1:2]])
                figures.measure(name, ["ninja", "-C", str(build), *options.targets], build)
    if options.json:
        Path(options.json).write_text(json.dumps(figures.rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
