#!/usr/bin/python3
"""Check that training keeps away from the sealed suites (docs/sealed_suites.md).

    check_sealed_suites.py SOURCE_FOLDER RESULT_XML

No file that makes or uses training data names netgenerate or a sealed suite, and no network of the training suite's code comes
from SUMO's generator: the only file that calls netgenerate is scripts/draw_sealed_suites. The check tries itself on planted
findings first.
"""
import re
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

FORBIDDEN = re.compile(r"netgenerate|sealed_[a-d]\b|sealed_[a-d]_|draw_sealed")
TOPS = ["src", "include", "config", "launch", "examples", "networks", "cmake", "benchmark"]
SCRIPTS_THAT_DRAW = ("scripts/draw_sealed_suites", "scripts/sealed_suites/")
SUITES = tuple(f"config/suites/sealed_{letter}/" for letter in "abcd")
MATRICES = "config/evaluations/"  # they evaluate and make no training data
TEXT = {".cpp", ".h", ".py", ".yaml", ".yml", ".cmake", ".txt", ".xml", ".launch", ".in", ".netccfg", ".sh", ""}


def files_of(root):
    for top in [*TOPS, "scripts"]:
        for path in sorted((root / top).rglob("*")):
            name = str(path.relative_to(root))
            if path.is_file() and path.suffix in TEXT and not name.startswith((*SUITES, MATRICES)):
                yield name, path


def findings(root):
    """"FILE: WORD" for each file outside the drawing scripts that names netgenerate or a sealed suite."""
    found = []
    for name, path in files_of(root):
        if name.startswith(SCRIPTS_THAT_DRAW):
            continue
        match = FORBIDDEN.search(path.read_text(errors="replace"))
        if match:
            found.append(f"{name}: {match.group(0)}")
    return found


def planted():
    """Findings in a tree where training code calls netgenerate and a training command reads a sealed suite: two."""
    with tempfile.TemporaryDirectory() as work:
        root = Path(work)
        for name, text in (("src/suite/network_generator.cpp", 'runProgram("netgenerate", options);'),
                           ("scripts/train_all", "cdiff collect --suite sealed_a --results data"),
                           ("src/suite/seal.cpp", "a sealed suite must not change"),
                           ("config/suites/sealed_a/suite.yaml", "name: sealed_a")):
            (root / name).parent.mkdir(parents=True, exist_ok=True)
            (root / name).write_text(text)
        return findings(root)


def main(root, result):
    wanted = ["src/suite/network_generator.cpp: netgenerate", "scripts/train_all: sealed_a"]
    cases = {"FindsWhatIsPlanted": [] if planted() == wanted else [f"expected {wanted}, found {planted()}"],
             "TrainingKeepsAwayFromThem": findings(root) if any(files_of(root)) else ["no file was read"]}
    junit.write(result, "sealed_suites", [(name, 0.0, "\n".join(faults) or None) for name, faults in cases.items()])
    print("\n".join(sum(cases.values(), [])))
    return 1 if any(cases.values()) else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2])))
