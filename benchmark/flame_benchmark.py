"""Draw where the processor time of a session in one process goes, as a flame graph.

    scripts/benchmark flame [--seconds S] [--output FILE.svg]

Samples `cdiff run` and its SUMO on the town of `scripts/benchmark graph` with perf (Debian package linux-perf). Writes the picture, and beside
it FILE.folded with a line "frame;frame;... samples" for each stack, which other viewers read. A box is as wide as its function's share, those that
it calls stand on it.
"""
import argparse
import collections
import html
import os
import re
import shutil
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

from graph_benchmark import KEYS, town

WIDTH, ROW = 1200, 16  # [px]
NARROWEST = 0.5  # [px] of a box that is drawn
FREQUENCY = 999  # [1/s]


def refuse(text, exit_code):
    print(f"benchmark: {text}", file=sys.stderr)
    sys.exit(exit_code)


def record(seconds, data):
    """Samples one session into a file of perf."""
    session = town(Path(os.environ.get("E2E_CDIFF_DATA", "../shared/data")))
    cdiff = Path(os.environ.get("BUILD", "build")) / "devel/lib/e2e_cdiff/cdiff"
    options = [part for name, value in session.items() for part in ("--" + name.replace("_", "-"), value)]
    settings = [part for key in (*KEYS, f"protocol.time_limit={seconds:g}") for part in ("--set", key)]
    done = subprocess.run(["perf", "record", "--quiet", "-e", "cpu-clock", "-F", str(FREQUENCY), "--call-graph", "dwarf,16384", "-o", str(data),
                           cdiff.as_posix(), "run", *options, *settings, "--results", str(data.parent / "session"), "--quiet"],
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if not data.is_file() or done.returncode not in (0, 1):
        refuse(f"perf could not sample the session; /proc/sys/kernel/perf_event_paranoid must be 1 or less, or run as root\n{done.stdout[-2000:]}", 2)


def fold(lines):
    """Samples of each stack, outermost function first and below it the program."""
    stacks, program, frames = collections.Counter(), "", []
    for line in [*lines, ""]:
        if not line.strip():
            if frames:
                stacks[(program, *reversed(frames))] += 1
            frames = []
        elif line[0].isspace():
            name = line.split(None, 1)[1].strip().replace("(anonymous namespace)::", "")
            frames.append(re.sub(r"\(.*", "", name).strip().replace(";", ":") or "unknown")
        else:
            program = line.split()[0]
    return stacks


def tree(stacks):
    """Nested {name: [samples, children]}."""
    root = {}
    for stack, samples in stacks.items():
        level = root
        for name in stack:
            entry = level.setdefault(name, [0, {}])
            entry[0] += samples
            level = entry[1]
    return root


def boxes(level, left, depth, scale):
    """Left edge, depth, width and name of each box that is wide enough."""
    for name, (samples, children) in sorted(level.items()):
        width = samples * scale
        if width >= NARROWEST:
            yield left, depth, width, name
            yield from boxes(children, left, depth + 1, scale)
        left += width


def picture(stacks):
    drawn = list(boxes(tree(stacks), 0.0, 0, WIDTH / sum(stacks.values())))
    height = (max(box[1] for box in drawn) + 1) * ROW
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}" font-family="monospace" font-size="11">']
    for left, depth, width, name in drawn:
        top, hue = height - (depth + 1) * ROW, zlib.crc32(name.encode()) % 60
        letters = int(width / 7)
        text = html.escape(name[:letters]) if letters > 2 else ""
        parts.append(f'<g><title>{html.escape(name)}, {width / WIDTH:.1%}</title><rect x="{left:.1f}" y="{top}" width="{width:.1f}" height="{ROW - 1}" '
                     f'fill="hsl({hue},80%,65%)"/><text x="{left + 2:.1f}" y="{top + 12}">{text}</text></g>')
    return "\n".join([*parts, "</svg>", ""])


def main():
    parser = argparse.ArgumentParser(prog="scripts/benchmark flame")
    parser.add_argument("--seconds", type=float, default=60.0, help="simulated time of the session [s]")
    parser.add_argument("--output", type=Path, default=Path("flame.svg"))
    options = parser.parse_args()
    if shutil.which("perf") is None:
        refuse("the program perf is missing; install it: apt-get install linux-perf", 3)
    with tempfile.TemporaryDirectory() as scratch:
        data = Path(scratch) / "perf.data"
        record(options.seconds, data)
        script = subprocess.run(["perf", "script", "-i", str(data), "-F", "comm,ip,sym"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        stacks = fold(script.stdout.splitlines())
    if not stacks:
        refuse("perf took no sample", 2)
    options.output.with_suffix(".folded").write_text("".join(f"{';'.join(stack)} {samples}\n" for stack, samples in sorted(stacks.items())))
    options.output.write_text(picture(stacks))
    print(f"flame_samples {sum(stacks.values())} samples -")
    print(options.output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
