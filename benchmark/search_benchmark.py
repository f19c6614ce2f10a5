#!/usr/bin/python3
"""Print what `cdiff search` finds beside random draws of the same budget, as "figure value unit goal".

    scripts/benchmark search [SCENARIO...] [--budget N] [--seeds N] [--first N] [--jobs N] [--mode MODE] [--ego EGO]
                             [--cbv-planner NAME] [--json FILE]

Each scenario and seed is searched by both methods. A figure with `difference` is evolution minus random, a mean over the
pairs. Each found case runs again: `repeated` counts those that give the same trace. A scenario is worse where evolution found
more cases over all seeds or, with as many, the higher mean of worst scores.
"""
import argparse
import csv
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

METHODS = ("evolution", "random")


def search(cdiff, options, scenario, method, seed, results):
    """Number of cases that were found, and the largest score."""
    command = [cdiff, "search", scenario, "--budget", str(options.budget), "--method", method, "--seed", str(seed),
               "--mode", options.mode, "--results", results, "--jobs", str(options.jobs)]
    for option, value in (("--ego", options.ego), ("--cbv-planner", options.cbv_planner)):
        command += [option, value] if value else []
    ended = subprocess.run(command, capture_output=True, text=True)
    if ended.returncode != 0:
        sys.exit(f"cdiff search ended with {ended.returncode}: {ended.stderr[-2000:]}")
    with open(Path(results) / "cases.csv", newline="", encoding="utf-8") as file:
        cases = list(csv.DictReader(file))
    found = [case for case in cases if case["found"] == "yes"]
    return {"found": len(found), "worst_score": max(float(case["score"]) for case in cases),
            "repeated": sum(repeats(cdiff, Path(results), case) for case in found)}


def repeats(cdiff, results, case):
    """Whether the scenario of a found case, run again, gives the same trace. As in the search, a session that breaks is tried again."""
    again = results / "again" / case["id"]
    command = [cdiff, "run", str(results / "found" / f"{case['id']}.yaml"), "--quiet", "--overwrite", "--results", str(again)]
    for _ in range(2):
        ended = subprocess.run(command, capture_output=True, text=True, check=False)
        if ended.returncode in (0, 1):
            return json.loads((again / "summary.json").read_text())["trace_sha256"] == case["trace_sha256"]
        print(f"{case['id']}: cdiff run ended with {ended.returncode}: {ended.stderr[-500:]}", file=sys.stderr, flush=True)
    return False


def mean(values):
    return sum(values) / len(values)


def figures_of(pairs):
    """Figures by name, of a list of {method: {quantity: value}}, one for each scenario and seed."""
    figures = {}
    for quantity, unit in (("found", "cases"), ("worst_score", ""), ("repeated", "cases")):
        for method in METHODS:
            figures[f"search_{quantity}_{method}"] = (mean([pair[method][quantity] for pair in pairs]), unit)
        if quantity == "repeated":
            continue
        differences = [pair["evolution"][quantity] - pair["random"][quantity] for pair in pairs]
        figures[f"search_{quantity}_difference"] = (mean(differences), unit)
        figures[f"search_{quantity}_higher"] = (sum(value > 0 for value in differences), "pairs")
        figures[f"search_{quantity}_lower"] = (sum(value < 0 for value in differences), "pairs")
    return figures


def standing(pairs):
    """1 where evolution found worse cases than random draws in a scenario's pairs, -1 where random draws did, else 0."""
    worst = {method: tuple(sum(pair[method][quantity] for pair in pairs) for quantity in ("found", "worst_score"))
             for method in METHODS}
    return (worst["evolution"] > worst["random"]) - (worst["evolution"] < worst["random"])


def search_pairs(cdiff, options, scenario):
    pairs = []
    for seed in range(options.first, options.first + options.seeds):
        with tempfile.TemporaryDirectory() as scratch:
            pairs.append({method: search(cdiff, options, scenario, method, seed, str(Path(scratch) / method)) for method in METHODS})
        print(f"{scenario} seed {seed}: {pairs[-1]}", file=sys.stderr, flush=True)
    return pairs


def main():
    parser = argparse.ArgumentParser(prog="scripts/benchmark search")
    parser.add_argument("scenario", nargs="*", default=["t_junction_straight"], help="shipped names or files")
    parser.add_argument("--budget", type=int, default=40, help="cases of a search")
    parser.add_argument("--seeds", type=int, default=5, help="pairs of searches")
    parser.add_argument("--first", type=int, default=1, help="first seed")
    parser.add_argument("--jobs", type=int, default=2, help="sessions at a time")
    parser.add_argument("--mode", default="safety_critical", help="mode of the CBVs")
    parser.add_argument("--ego", default="", help="as cdiff search takes it; the scenario's without")
    parser.add_argument("--cbv-planner", default="", help="planner of the CBVs; the scenario's without")
    parser.add_argument("--json", help="also write the figures to this file")
    options = parser.parse_args()
    cdiff = str(Path(os.environ.get("BUILD", "build")) / "devel/lib/e2e_cdiff/cdiff")
    pairs = {scenario: search_pairs(cdiff, options, scenario) for scenario in options.scenario}
    figures = figures_of([pair for of_scenario in pairs.values() for pair in of_scenario])
    standings = [standing(of_scenario) for of_scenario in pairs.values()]
    figures["search_scenarios_worse"] = (standings.count(1), "scenarios")
    figures["search_scenarios_milder"] = (standings.count(-1), "scenarios")
    for name, (value, unit) in figures.items():
        print(f"{name} {value:.2f} {unit or '-'} -")
    if options.json:
        rows = [{"figure": name, "value": value, "unit": unit, "goal": ""} for name, (value, unit) in figures.items()]
        Path(options.json).write_text(json.dumps(rows, indent=2) + "\n")


if __name__ == "__main__":
    main()
