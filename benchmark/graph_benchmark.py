"""Print what the node graph makes of the speed of one process, as "figure value unit goal".

    scripts/benchmark graph [--rounds N] [--seconds S]

Runs the same session on a town by turns: in one process with results, as nodes with a bag, and as nodelets with a bag. A stage is what a tick
spends in the thread of the session or of the simulator; a rate is the ticks by the time of all stages, so no start counts. A share is the
median over the rounds of a rate by that of the one process beside it. All three must give the same trace. A wait is the mean time from a tick
to the handling of an answer to it.
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

STEP = 0.05  # [s] of simulated time a tick
ROUTE = "25318"
KEYS = ("traffic.density=50", "traffic.forget_distance=160", "max_cbv=2", "protocol.blocked_time=1000", "verdict.judge=false")
GOALS = {"nodes": 0.6, "nodelets": 0.85}


def town(data):
    """Arguments of the session, for cdiff and for scripts/session."""
    routes, network = data / "bench2drive/bench2drive220.xml", data / "carla_towns/Town05.net.xml"
    for file in (routes, network):
        if not file.is_file():
            print(f"benchmark: '{file}' is missing; set E2E_CDIFF_DATA to the folder with carla_towns and bench2drive", file=sys.stderr)
            sys.exit(3)
    return {"bench2drive": str(routes), "route": ROUTE, "network": str(network), "cbv_planner": "pdm_lite"}


def run(command, results, environment):
    """Trace of one session."""
    done = subprocess.run(command, env={**os.environ, **environment}, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        sys.exit(f"benchmark: a session failed: {' '.join(command)}\n{done.stdout[-2000:]}")
    return json.loads((results / "summary.json").read_text())["trace_sha256"]


def one_process(session, keys, seed, results):
    cdiff = Path(os.environ.get("BUILD", "build")) / "devel/lib/e2e_cdiff/cdiff"
    options = [part for name, value in session.items() for part in ("--" + name.replace("_", "-"), value)]
    settings = [part for key in keys for part in ("--set", key)]
    return run([cdiff.as_posix(), "run", *options, *settings, "--seed", str(seed), "--results", str(results), "--quiet"], results,
               {"E2E_CDIFF_STAGES_FILE": str(stages_file(results))})


def graph(kind, session, keys, seed, results):
    """The same of the node graph, which leaves its mean waits beside the results."""
    arguments = [f"{name}:={value}" for name, value in session.items()]
    return run(["scripts/session", *arguments, f"set:={' '.join(keys)}", f"seed:={seed}", f"results:={results}", "record:=true",
                f"nodelets:={'true' if kind == 'nodelets' else 'false'}"], results,
               {"E2E_CDIFF_WAITS_FILE": str(waits_file(results)), "E2E_CDIFF_STAGES_FILE": str(stages_file(results))})


def waits_file(results):
    return results.with_suffix(".waits")


def stages_file(results):
    return results.with_suffix(".stages")


def stages_of(results):
    """Time of each stage [us] in a tick."""
    ticks = json.loads((results / "summary.json").read_text())["simulated_seconds"] / STEP
    pairs = (line.split() for line in stages_file(results).read_text().splitlines())
    return {stage: float(seconds) / ticks * 1e6 for stage, seconds in pairs}


def rate(kind, session, seconds, seed, results):
    """Ticks per second, trace and place of a session of so many seconds."""
    keys = [*KEYS, f"protocol.time_limit={seconds:g}"]
    place = results / f"{kind}_{seed}"
    trace = one_process(session, keys, seed, place) if kind == "one_process" else graph(kind, session, keys, seed, place)
    return 1e6 / sum(stages_of(place).values()), trace, place


def main():
    parser = argparse.ArgumentParser(prog="scripts/benchmark graph")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--seconds", type=float, default=60.0, help="simulated time of a session [s]")
    options = parser.parse_args()
    session = town(Path(os.environ.get("E2E_CDIFF_DATA", "../shared/data")))
    rates, waits, stages = {"one_process": [], "nodes": [], "nodelets": []}, {}, {}
    with tempfile.TemporaryDirectory() as scratch:
        for seed in range(1, options.rounds + 1):
            traces = set()
            for kind, values in rates.items():
                value, trace, results = rate(kind, session, options.seconds, seed, Path(scratch))
                values.append(value)
                traces.add(trace)
                stages[kind] = stages_of(results)
                if kind in GOALS:
                    waits[kind] = json.loads(waits_file(results).read_text())
            if len(traces) != 1:
                sys.exit("benchmark: one process, nodes and nodelets have different traces")
    for kind, values in rates.items():
        print(f"graph_{kind} {statistics.median(values):.1f} ticks/s -")
    for kind, goal in GOALS.items():
        print(f"graph_{kind}_per_one_process {statistics.median(a / b for a, b in zip(rates[kind], rates['one_process'])):.2f} times >={goal:g}")
    for kind, channels in waits.items():
        for channel, milliseconds in channels.items():
            print(f"graph_{kind}_wait_{channel} {milliseconds:.3f} ms -")
    for kind, times in stages.items():
        for stage, microseconds in times.items():
            print(f"graph_{kind}_stage_{stage} {microseconds:.0f} us/tick -")
    return 0


if __name__ == "__main__":
    sys.exit(main())
