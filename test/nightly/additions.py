#!/usr/bin/python3
"""Add a thing of each kind with scripts/add in a copy of the source, count the files that it takes, build it and run its tests.
The learned planner is trained on a few samples, too, and drives with the weights that come of it.

    additions.py BUILD SOURCE RESULT.xml
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402
from source_copy import SourceCopy, environment_of  # noqa: E402

BUILD, SOURCE, RESULT = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), Path(sys.argv[3])
# Kind, name, most files (registration included, pages of docs that a test prints apart), test programs.
ADDITIONS = [
    ("planner", "night_rider", 4, ["test_planners_night_rider", "test_planners_registry"]),
    ("learned_planner", "night_pilot", 9, ["test_planners_night_pilot", "test_planners_registry", "test_learning_task_registry"]),
    ("objective", "night_axis", 3, ["test_guidance_objective_gradients", "test_guidance_guidance_options"]),
    ("metric", "night_speed", 2, ["test_metrics_night_speed_metric", "test_metrics_metric_registry", "test_metrics_metric_keys"]),
    ("topic", "night_report", 3, ["test_node_graph_channels"]),
]
# Compares docs/ros_api.md with the table, which has one topic more here.
EXPECTED_FAILURES = {"test_node_graph_channels": {"Channels.TheDocumentationShowsTheTable"}}


def contents(root):
    return {path: path.read_bytes() for path in root.rglob("*") if path.is_file() and "build" not in path.relative_to(root).parts[:1]}


def fault_of_tests(copy, programs):
    environment = environment_of(copy.build, copy.root)
    for name in programs:
        program = next(path for path in copy.build.rglob(name) if path.is_file() and os.access(path, os.X_OK))
        done = subprocess.run([program], env=environment, cwd=copy.build, timeout=600, capture_output=True, text=True, check=False)
        failed = set(re.findall(r"^\[  FAILED  \] ([\w/.]+)", done.stdout, re.MULTILINE))
        expected = done.returncode == 1 and failed == EXPECTED_FAILURES.get(name)
        if done.returncode != 0 and not expected:
            return f"{name} fails:\n{done.stdout[-2000:]}"
    return None


def fault_of_training(copy, name):
    """Collects a few samples, trains a learned planner on them and lets it drive; before that it must say what it lacks."""
    built, output = copy.ninja(["cdiff", "cdiff_train"])
    if not built:
        return "does not build:\n" + output[-3000:]
    data, weights, results = copy.root / "results" / "data", copy.root / "weights" / name, copy.root / "results" / "run"
    drive = ["run", "crossing_straight", "--set", f"ego_planner={name}", "--set", "protocol.time_limit=5", "--set", "verdict.judge=false",
             "--results", results]
    train = ["train", "--task", name, "--data", data / "shards", "--output", weights, "--steps", "20", "--validation-share", "0", "--device", "cpu"]
    for arguments, code, expected in [
            (drive, 3, f"cdiff train --task {name}"),
            (["collect", "--scenarios", "crossing_straight", "--duration", "10", "--results", data], 0, ""),
            (train, 0, f"model written to {weights}"),
            (drive, 0, f"ego {name}")]:
        done = subprocess.run([copy.build / "devel/lib/e2e_cdiff/cdiff", *arguments], env=environment_of(copy.build, copy.root), cwd=copy.root,
                              timeout=300, capture_output=True, text=True, check=False)
        output = done.stdout + done.stderr
        if done.returncode != code or expected not in output:
            return f"cdiff {arguments[0]}: exit code {done.returncode}, {code} was expected:\n{output[-2000:]}"
    return None


def fault_of(copy, kind, name, most, programs):
    before = contents(copy.root)
    done = subprocess.run([copy.root / "scripts/add", kind, name], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        return f"scripts/add: {done.stderr}"
    after = contents(copy.root)
    touched = sorted(str(path.relative_to(copy.root)) for path in after if before.get(path) != after[path])
    if not 0 < len(touched) <= most:
        return f"takes {len(touched)} files, at most {most} were expected: {', '.join(touched)}"
    built, output = copy.ninja(programs)
    if not built:
        return "does not build:\n" + output[-3000:]
    fault = fault_of_tests(copy, programs)
    return fault_of_training(copy, name) if kind == "learned_planner" and not fault else fault


def main():
    root = Path(tempfile.gettempdir()) / f"e2e_cdiff_additions_{os.getpid()}"
    cases = []
    try:
        copy = SourceCopy(SOURCE, BUILD, root)
        subprocess.run(["cmake", "-S", root, "-B", copy.build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                        "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache", "-DE2E_CDIFF_TESTS=ON"], check=True, capture_output=True)
        for kind, name, most, programs in ADDITIONS:
            start = time.monotonic()
            fault = fault_of(copy, kind, name, most, programs)
            print(f"{kind}: {fault or 'added'}", flush=True)
            cases.append((kind, time.monotonic() - start, fault))
    finally:
        shutil.rmtree(root, ignore_errors=True)
    junit.write(RESULT, "additions", cases)
    return 1 if any(fault for _, _, fault in cases) else 0


if __name__ == "__main__":
    sys.exit(main())
