#!/usr/bin/python3
"""Print how many short sessions a batch runs a minute, as "figure value unit goal".

    scripts/benchmark batch [--rounds N] [--seeds N] [--seconds S] [--jobs N] [--json FILE]

Each round runs the same batch twice, by servers and with --fresh, which take turns in coming first: all shipped scenarios with diffusion
CBVs. All traces must be the same. A figure is the median over the rounds; start-up is the share that `cdiff evaluate` prints.
"""
import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
MATRIX = """scenarios: [{scenarios}]
cbv_planners: [diffusion]
seeds: [{seeds}]
set: [protocol.time_limit={seconds}, verdict.judge=false]
"""
KINDS = {"served": [], "fresh": ["--fresh"]}
GOAL = 2.0


def run(cdiff, matrix, options, kind, folder):
    """Wall time of a batch [s], its share of start-up [%], and the traces of its runs."""
    begin = time.monotonic()
    done = subprocess.run([cdiff, "evaluate", matrix, "--results", folder, "--jobs", str(options.jobs), *KINDS[kind]], check=False,
                          capture_output=True, text=True)
    wall = time.monotonic() - begin
    share = re.search(r"start-up .* took (\d+) %", done.stderr)
    if done.returncode not in (0, 1) or not share:
        sys.exit(f"the batch failed: {done.stderr[-2000:]}")
    traces = {file.parent.name: json.loads(file.read_text())["trace_sha256"] for file in Path(folder).glob("runs/*/summary.json")}
    return wall, float(share.group(1)), traces


def measure(cdiff, matrix, options, scratch):
    """Sessions a minute and share of start-up, by kind and round."""
    rates, shares = ({kind: [] for kind in KINDS} for _ in range(2))
    for number in range(options.rounds):
        order = list(KINDS) if number % 2 == 0 else list(reversed(KINDS))
        traces = {}
        for kind in order:
            wall, share, traces[kind] = run(cdiff, matrix, options, kind, Path(scratch) / f"{kind}_{number}")
            rates[kind].append(60.0 * len(traces[kind]) / wall)
            shares[kind].append(share)
        if traces["served"] != traces["fresh"]:
            sys.exit("a served session has another trace than the same one with --fresh")
    return rates, shares


def main():
    parser = argparse.ArgumentParser(prog="scripts/benchmark batch")
    parser.add_argument("--rounds", type=int, default=3, help="pairs of batches")
    parser.add_argument("--seeds", type=int, default=2, help="sessions of each scenario in a batch")
    parser.add_argument("--seconds", type=float, default=5.0, help="longest simulated time of a session")
    parser.add_argument("--jobs", type=int, default=2, help="sessions at a time")
    parser.add_argument("--json", help="also write the figures to this file")
    options = parser.parse_args()
    cdiff = Path(os.environ.get("BUILD", "build")) / "devel/lib/e2e_cdiff/cdiff"
    scenarios = sorted(file.stem for file in (ROOT / "config/scenarios").glob("*.yaml"))
    with tempfile.TemporaryDirectory() as scratch:
        matrix = Path(scratch) / "matrix.yaml"
        seeds = ", ".join(str(seed + 1) for seed in range(options.seeds))
        matrix.write_text(MATRIX.format(scenarios=", ".join(scenarios), seeds=seeds, seconds=options.seconds))
        rates, shares = measure(cdiff, matrix, options, scratch)
    figures = []
    for kind in KINDS:
        figures.append((f"batch_{kind}", statistics.median(rates[kind]), "sessions/min", ""))
        figures.append((f"batch_{kind}_start_up", statistics.median(shares[kind]), "%", ""))
    ratios = [served / fresh for served, fresh in zip(rates["served"], rates["fresh"])]
    figures.append(("batch_served_per_fresh", statistics.median(ratios), "times", f">={GOAL:g}"))
    for name, value, unit, goal in figures:
        print(f"{name} {value:.2f} {unit} {goal or '-'}")
    if options.json:
        rows = [dict(zip(("figure", "value", "unit", "goal"), figure)) for figure in figures]
        Path(options.json).write_text(json.dumps(rows, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
