#!/usr/bin/python3
"""Try the gates of docs/reliability.md.

    gates.py [--share S] [--seed N] BUILD SOURCE RESULT.xml [GATE...]

Each gate makes many trials, in which something must hold every time; files of gates/ have one each. --share 0.1 makes a tenth of them.
Verdicts go to BUILD/gates and into the table of docs/reliability.md.
"""
import argparse
import importlib
import os
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "gates"), str(HERE.parent / "support"), str(HERE)]
import gate  # noqa: E402
import gate_table  # noqa: E402
import junit  # noqa: E402


def all_gates():
    """Gates by name, one of every file of the folder."""
    gates = [importlib.import_module(path.stem).GATE for path in sorted((HERE / "gates").glob("*.py"))]
    return {found.name: found for found in gates}


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--share", type=float, default=1.0, help="share of the trials, above 0")
    parser.add_argument("--seed", type=int, default=int(time.time()) // 86400, help="of what is drawn; without it the day's")
    parser.add_argument("build", type=Path)
    parser.add_argument("source", type=Path)
    parser.add_argument("result", type=Path)
    parser.add_argument("gates", nargs="*")
    given = parser.parse_intermixed_args()
    if not 0.0 < given.share <= 1.0:
        parser.error(f"--share is {given.share}; expected a number above 0, and at most 1")
    return given


def main():
    given = arguments()
    os.environ["BUILD"] = str(given.build.resolve())
    gates = all_gates()
    unknown = [name for name in given.gates if name not in gates]
    if unknown:
        sys.exit(f"no gate '{unknown[0]}'; there are: {' '.join(gates)}")
    folder = given.build / "gates"
    folder.mkdir(parents=True, exist_ok=True)
    stamp = gate_table.stamp_of(given.source)
    verdicts = [gate.run(gates[name], given.seed, given.share, folder / f"{name}.json") for name in given.gates or gates]
    gate_table.write(given.source / "docs" / "reliability.md", gates, verdicts, stamp)
    junit.write(given.result, "gates", [(v.gate.name, v.seconds, f"{len(v.failures)} of {v.tried}" if v.failures else None) for v in verdicts])
    return any(verdict.failures for verdict in verdicts)


if __name__ == "__main__":
    sys.exit(main())
