#!/usr/bin/python3
"""Draw changes of meaning at random, apply them one by one in a copy of the source and count those for which a test fails.

    drawn_mutants.py BUILD SOURCE RESULT.xml [--seed N] [--count N] [--only WORD] [--again] [--copy DIR] [--results FILE]

Mutants (mutation.py) come from the sources in FOLDERS until `count` of them compiled and are not among equivalent_mutants.yaml. A mutant is
killed when a case of the tests of its folder, or of those in BEYOND, fails twice. The test programs are those of BUILD; only the library of the
mutant's layer is built anew, with the accesses to containers in its file checked. Results are kept line by line in
BUILD/drawn_mutants/SEED.jsonl (with a table, SEED.md): started again with the same seed, the script goes on behind the last. Fails below the
GOAL, the exact share of killed ones.

    --seed N     of the draw; default $MUTANTS_SEED, else today's date as in 20260131
    --count N    default $MUTANTS_COUNT, else 150
    --only WORD  only sources with WORD in their path
    --again      tries those again that survived or did not compile
    --copy DIR   where the copy lies and stays; default a folder in the temporary one, removed at the end
"""
import argparse
import datetime
import fcntl
import hashlib
import itertools
import json
import os
import re
import shutil
import sys
import tempfile
import time
from pathlib import Path

import yaml

import mutation
from trial import Trial

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

# Tests of other folders that see what a folder does, in the order in which they run.
BEYOND = {"metrics": ["record", "session"], "guidance": ["planners", "diffusion"], "diffusion": ["planners"], "cbv": ["session"],
          "dynamics": ["planning", "planners", "diffusion", "session"], "planning": ["planners", "session"], "planners": ["session"],
          "session": ["record"], "simulation": ["session"]}
FOLDERS = sorted(BEYOND)
GOAL = 0.95
SLOWEST = 15.0  # [s] programs that take longer are left out
CHECKED = "#define _GLIBCXX_ASSERTIONS 1\n"  # ahead of a mutant's file: an access beyond a container's end aborts
ABORTED = "exit code -6"
LONGEST = 30.0  # [s] of all programs for a mutant, the nearest to its file and the quick ones first


def arguments():
    parser = argparse.ArgumentParser(usage=__doc__)
    for name in ("build", "source", "result"):
        parser.add_argument(name, type=lambda text: Path(text).resolve())
    today = int(datetime.date.today().strftime("%Y%m%d"))
    parser.add_argument("--seed", type=int, default=int(os.environ.get("MUTANTS_SEED", today)))
    parser.add_argument("--count", type=int, default=int(os.environ.get("MUTANTS_COUNT", 150)))
    parser.add_argument("--only", default="")
    parser.add_argument("--again", action="store_true")
    parser.add_argument("--copy", type=lambda text: Path(text).resolve())
    parser.add_argument("--results", type=Path)
    return parser.parse_args()


def sources_below(folder, word):
    """Sources to change, in the order of their paths; what trains needs libtorch and is left out."""
    paths = [path for name in FOLDERS for path in sorted((folder / name).rglob("*.cpp")) if "training" not in path.parts]
    names = [(str(path.relative_to(folder)), path) for path in paths]
    return [mutation.Source(name, path.read_text()) for name, path in names if word in name]


def equivalents():
    """Reasons by (file, old line, new line)."""
    listed = yaml.safe_load((Path(__file__).parent / "equivalent_mutants.yaml").read_text()) or []
    return {(row["file"], " ".join(row["was"].split()), " ".join(row["now"].split())): row["reason"] for row in listed}


class Results:
    """Verdicts in a file of JSON lines; the first says from which sources and seed they are."""

    def __init__(self, path, sources, options):
        self.path = path
        text = Path(mutation.__file__).read_text() + "".join(source.name + source.text for source in sources)
        head = {"seed": options.seed, "only": options.only, "sources": hashlib.sha256(text.encode()).hexdigest()}
        self.rows = {}
        if path.exists():
            lines = [json.loads(line) for line in path.read_text().splitlines()]
            if lines[0] != head:
                sys.exit(f"{path} is a draw from other sources or with another seed or --only; choose another --seed, or remove it")
            self.rows = {row["key"]: row for row in lines[1:]}
        if options.again:
            self.rows = {key: row for key, row in self.rows.items() if row["verdict"] in ("killed", "equivalent")}
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("".join(json.dumps(row) + "\n" for row in [head, *self.rows.values()]))

    def add(self, mutant, verdict, by, seconds):
        row = {"key": mutant.key, "file": mutant.file, "line": mutant.line, "kind": mutant.kind, "old": mutant.old, "new": mutant.new,
               "verdict": verdict, "by": by, "seconds": round(seconds, 1)}
        self.rows[mutant.key] = row
        with self.path.open("a") as file:
            file.write(json.dumps(row) + "\n")
        print(f"{verdict:10} {seconds:5.1f} s  {mutant.kind:10} {mutant.file}:{mutant.line}  {by}", flush=True)
        if verdict == "survived":
            print(f"    was {mutant.old}\n    now {mutant.new}", flush=True)

    def number(self, verdict):
        return sum(row["verdict"] == verdict for row in self.rows.values())

    def counted(self):
        return self.number("killed") + self.number("survived")

    def rate(self):
        return self.number("killed") / max(1, self.counted())

    def summary(self):
        others = ", ".join(f"{self.number(verdict)} {verdict}" for verdict in ("equivalent", "uncompiled"))
        return f"{self.number('killed')} of {self.counted()} killed ({100 * self.rate():.1f} %); not counted: {others}"

    def table(self):
        """All rows as Markdown, survivors first."""
        order = ["survived", "equivalent", "killed", "uncompiled"]
        rows = sorted(self.rows.values(), key=lambda row: (order.index(row["verdict"]), row["file"], row["line"]))
        lines = [self.summary(), "", "| Place | Operator | Was | Now | Verdict | By | s |", "|---|---|---|---|---|---|---|"]
        for row in rows:
            code = [row[name].replace("|", "\\|") for name in ("old", "new")]
            lines.append(f"| {row['file']}:{row['line']} | {row['kind']} | `{code[0]}` | `{code[1]}` | {row['verdict']} | {row['by']} | {row['seconds']} |")
        return "\n".join(lines) + "\n"


def included_by(source, planner):
    """Folders below src of which a planner or its tests include a header."""
    files = [path for top in ("src", "test") for path in (source / top / "planners" / planner).rglob("*.*") if path.suffix in (".h", ".cpp")]
    return {found for path in files for found in re.findall(r'#include "(planners/\w+)/', path.read_text())}


class Judge:
    """Builds mutants and runs the tests that may see them, quick ones first."""

    def __init__(self, trial, layers):
        self.trial, self.layers = trial, layers
        self.programs = self._known_programs()
        self.changed = set()  # layers whose library holds a mutant
        self.included = {path.name: included_by(trial.source, path.name) for path in (trial.source / "src/planners").iterdir() if path.is_dir()}

    def _known_programs(self):
        folders = {*self.layers, *(name for layer in self.layers for name in BEYOND[layer])}
        return [program for program in self.trial.programs().values() if program.folder.split("/")[0] in folders]

    def failing_without(self):
        """What is wrong without a mutant, None if all is well; measures the programs."""
        broken = self.trial.compile_programs([program.name for program in self.programs])
        broken = broken or self.trial.compile([f"e2e_cdiff_{layer}" for layer in FOLDERS])
        if broken:
            return broken
        self.programs = self._known_programs()
        failed = [program for program in self.programs if not self.trial.passes(program, SLOWEST)]
        for program in [program for program in failed if program.failures == ["no end"]]:
            print(f"left out: {program.name}, more than {SLOWEST:.0f} s", flush=True)
            self.programs.remove(program)
            failed.remove(program)
        return "; ".join(f"{program.name} fails without a mutant: {program.failures}" for program in failed) or None

    def programs_for(self, mutant):
        """The test of the file's name, then those of its folder, then those beyond."""
        layer, *rest = Path(mutant.file).parts
        folders = [layer, *BEYOND[layer]]
        inner = "/".join([layer, *rest[:-1]])
        chosen = [program for program in self.programs
                  if program.folder.split("/")[0] in folders and not self._of_another_planner(program.folder, inner)]
        stem = Path(mutant.file).stem

        def order(program):
            return (not program.name.endswith(stem), folders.index(program.folder.split("/")[0]), program.folder != inner, program.seconds)
        ordered = sorted(chosen, key=order)
        until = itertools.accumulate(program.seconds for program in ordered)
        return [program for program, seconds in zip(ordered, until) if seconds <= LONGEST]

    def _of_another_planner(self, folder, inner):
        """Whether these are tests of a planner that includes nothing of the planner in `inner`."""
        parts = folder.split("/")
        if len(parts) == 1 or parts[0] != "planners" or not inner.startswith("planners/") or folder == inner:
            return False
        return inner not in self.included[parts[1]]

    def verdict(self, mutant, text):
        """(verdict, by what)."""
        path = self.trial.root / "src" / mutant.file
        try:
            if not self._compiles(path, mutant.applied(text)):
                return "uncompiled", ""
            verdict, by = self._killer(self.programs_for(mutant))
            if by.endswith(ABORTED) and self._fails(path, text, mutant, by):
                verdict, by = "survived", ""  # the code itself does not stand the checks
            return verdict, by
        finally:
            path.write_text(text)

    def _compiles(self, path, text):
        """Builds the layer with a file changed, whose accesses to vectors, arrays and optionals are checked."""
        layer = path.relative_to(self.trial.root / "src").parts[0]
        path.write_text(CHECKED + text)
        built = self.trial.compile([f"e2e_cdiff_{name}" for name in {*self.changed, layer}]) is None
        self.changed = {layer} if built else {*self.changed, layer}
        return built

    def _fails(self, path, text, mutant, by):
        """Whether the program that aborts with a mutant does so without it."""
        programs = [program for program in self.programs_for(mutant) if by.startswith(program.name + " ")]
        return self._compiles(path, text) and self._killer(programs)[0] == "killed"

    def _killer(self, programs):
        for program in programs:
            limit = 10.0 + 8.0 * program.seconds
            known = program.seconds
            if self.trial.passes(program, limit):
                program.seconds = known
                continue
            by = program.failures[0]
            cases = [by] if "." in by else None
            again = self.trial.passes(program, limit, cases)
            program.seconds = known
            if not again:
                return "killed", f"{program.name} {by}"
        return "survived", ""


def try_all(judge, sources, options, results):
    texts = {source.name: source.text for source in sources}
    known = equivalents()
    for mutant in mutation.draw(sources, options.seed):
        if results.counted() >= options.count:
            return
        reason = known.get((mutant.file, mutant.old, mutant.new))
        row = results.rows.get(mutant.key)
        if reason and (row is None or row["verdict"] == "survived"):
            results.add(mutant, "equivalent", reason, 0.0)
        if mutant.key in results.rows:
            continue
        begin = time.monotonic()
        verdict, by = judge.verdict(mutant, texts[mutant.file])
        results.add(mutant, verdict, by, time.monotonic() - begin)


def main():
    options = arguments()
    sources = sources_below(options.source / "src", options.only)
    folder = options.build / "drawn_mutants"
    results = Results(options.results or folder / f"{options.seed}.jsonl", sources, options)
    root = options.copy or Path(tempfile.gettempdir()) / "e2e_cdiff_drawn_mutants"
    root.mkdir(parents=True, exist_ok=True)
    lock = root.parent.joinpath(root.name + ".lock").open("w")
    fcntl.flock(lock, fcntl.LOCK_EX)
    begin = time.monotonic()
    trial = Trial(options.source, options.build, root, [f"-DE2E_CDIFF_MUTATED={';'.join(FOLDERS)}"], own_programs=False)
    judge = Judge(trial, sorted({Path(source.name).parts[0] for source in sources}))
    broken = judge.failing_without()
    print(f"without a mutant: {broken or 'passes'} ({time.monotonic() - begin:.0f} s)", flush=True)
    if not broken:
        try_all(judge, sources, options, results)
    results.path.with_suffix(".md").write_text(results.table())
    failure = None if results.rate() >= GOAL else results.summary()
    junit.write(options.result, "drawn_mutants", [("without a mutant", 0.0, broken), (f"share killed, seed {options.seed}",
                                                                                     time.monotonic() - begin, failure)])
    print(f"seed {options.seed}: {results.summary()}; table: {results.path.with_suffix('.md')}", flush=True)
    if options.copy is None:
        shutil.rmtree(root, ignore_errors=True)
    return 1 if broken or failure else 0


if __name__ == "__main__":
    sys.exit(main())
