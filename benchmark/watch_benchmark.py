"""Print what live pages cost a session, as "figure value unit goal".

    scripts/benchmark watch [--pairs N] [--cbv-planner NAME]

Runs the same session by turns: unwatched, watched without a page, and with a page that takes everything. Each time is that of the whole
program; a figure is the median over the rounds of its time by that of the unwatched session beside it. All three must give the same trace.
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

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "test/support"))
from page_socket import PageSocket  # noqa: E402

GOAL = 5.0  # [%]


def run(cdiff, arguments, folder, watched, paged):
    """Wall and processor time [s] of one session, its trace, and the bytes that its page took."""
    begin, taken = time.monotonic(), 0
    process = subprocess.Popen([cdiff, "run", *arguments, "--results", folder, "--overwrite", "--quiet", *(["--watch"] if watched else [])],
                               stderr=subprocess.PIPE, text=True)
    if watched:
        page = PageSocket(next(found.group(0) for line in process.stderr if (found := re.search(r"http://\S+/", line))))
        if paged:
            page.ask({"do": "pace", "value": "0"})
            page.wait_for_end()
            taken = page.bytes
        else:
            page.ask({"do": "pace", "value": "0"})
            page.socket.close()
    process.stderr.close()
    _, _, usage = os.wait4(process.pid, 0)
    wall = time.monotonic() - begin
    return wall, usage.ru_utime + usage.ru_stime, json.loads((Path(folder) / "summary.json").read_text())["trace_sha256"], taken


def main():
    parser = argparse.ArgumentParser(prog="scripts/benchmark watch")
    parser.add_argument("--pairs", type=int, default=5, help="rounds")
    parser.add_argument("--cbv-planner", default="pdm_lite", help="planner of the CBVs; a fast one has the highest share")
    options = parser.parse_args()
    cdiff = Path(os.environ.get("BUILD", "build")) / "devel/lib/e2e_cdiff/cdiff"
    arguments = ["crossing_left_turn", "--seed", "3", "--cbv-planner", options.cbv_planner]
    kinds = {"no_page": (True, False), "page": (True, True)}
    shares = {(kind, time_of): [] for kind in kinds for time_of in ("wall", "processor")}
    with tempfile.TemporaryDirectory() as scratch:
        for _ in range(options.pairs):
            plain = run(cdiff, arguments, scratch, False, False)
            for kind, how in kinds.items():
                watched = run(cdiff, arguments, scratch, *how)
                if watched[2] != plain[2]:
                    sys.exit(f"the trace with {kind} is another one")
                for i, time_of in enumerate(("wall", "processor")):
                    shares[kind, time_of].append(100.0 * (watched[i] / plain[i] - 1.0))
                if watched[3]:
                    taken = watched[3]
    for (kind, time_of), values in shares.items():
        goal = f"<= {GOAL:g}" if (kind, time_of) == ("page", "wall") else ""
        print(f"watch_{kind}_{time_of} {statistics.median(values):.1f} % {goal}".rstrip())
    print(f"watch_page_data {taken / 1e6:.2f} MB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
