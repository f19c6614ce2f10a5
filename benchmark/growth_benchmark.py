#!/usr/bin/python3
"""Print what a batch of many runs costs beside its sessions, as "figure value unit goal".

    scripts/benchmark growth [--runs N] [--jobs N] [--json FILE]

Each run starts its session, whose simulator ends at once: nothing is driven. The share of a run is the wall time from the first claim to
the last record, without the time that the runs' own processes took.
"""
import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

MATRIX = """name: growth
scenarios: [arterial_exit]
cbv_planners: [pdm_lite]
seeds: [{seeds}]
retries: 0
timeout: 60
set: [sumo.binary=/bin/false]
"""


def ended(command, codes):
    """Wall time [s] and largest memory of one process [MB] of a command that ends with one of these codes."""
    begin = time.monotonic()
    with tempfile.TemporaryFile() as output:
        process = subprocess.Popen(command, stdout=output, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        wall = time.monotonic() - begin
        if process.returncode not in codes:
            output.seek(0)
            sys.exit(f"{command[1]} ended with {process.returncode}: {output.read()[-2000:].decode(errors='replace')}")
    return wall, usage.ru_maxrss / 1000.0


def measure(cdiff, matrix, options, results):
    """Figures by name."""
    planning, _ = ended([cdiff, "evaluate", matrix, "--results", results, "--engine", "print"], (0,))
    working, worker_memory = ended([cdiff, "worker", results, "--jobs", str(options.jobs)], (0,))
    own = sum(json.loads(file.read_text())["wall_seconds"] for file in Path(results).glob("runs/*/record.json")) / options.jobs
    # Every run broke. One is run again, and all are summed up.
    merging, memory = ended([cdiff, "evaluate", matrix, "--results", results, "--resume", "--only", "seed=1"], (2,))
    files = max(len(list(folder.iterdir())) for folder in Path(results).glob("runs/*/"))
    return {"growth_plan_a_run": (1e3 * planning / options.runs, "ms", ""),
            "growth_claim_and_record_a_run": (1e3 * max(0.0, working - own) / options.runs * options.jobs, "ms", "<=30"),
            "growth_merge": (merging, "s", "<=60"),
            "growth_memory": (max(memory, worker_memory), "MB", "<=500"),
            "growth_files_a_run": (files, "files", "")}


def main():
    parser = argparse.ArgumentParser(prog="scripts/benchmark growth")
    parser.add_argument("--runs", type=int, default=10000, help="runs of the batch")
    parser.add_argument("--jobs", type=int, default=2, help="sessions at a time")
    parser.add_argument("--json", help="also write the figures to this file")
    options = parser.parse_args()
    cdiff = str(Path(os.environ.get("BUILD", "build")) / "devel/lib/e2e_cdiff/cdiff")
    with tempfile.TemporaryDirectory() as scratch:
        matrix = Path(scratch) / "matrix.yaml"
        matrix.write_text(MATRIX.format(seeds=", ".join(str(seed + 1) for seed in range(options.runs))))
        figures = measure(cdiff, str(matrix), options, str(Path(scratch) / "results"))
    for name, (value, unit, goal) in figures.items():
        print(f"{name} {value:.2f} {unit} {goal or '-'}")
    if options.json:
        rows = [{"figure": name, "value": value, "unit": unit, "goal": goal} for name, (value, unit, goal) in figures.items()]
        Path(options.json).write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
