"""What a gate is: something that must hold at every one of many trials."""
import json
import random
import time
from dataclasses import dataclass
from typing import Callable


@dataclass
class Gate:
    """`trials(random, count)` yields (name, function) of each trial; the function returns None where the trial held, else what was wrong.
    `count`: number of trials of a whole run."""

    name: str
    holds: str  # what must hold, for the table
    count: int
    trials: Callable


class Verdict:
    """What has been tried of a gate, and what did not hold."""

    def __init__(self, gate, seed):
        self.gate, self.seed = gate, seed
        self.tried, self.failures, self.seconds = 0, [], 0.0

    def as_json(self):
        return {"gate": self.gate.name, "seed": self.seed, "tried": self.tried, "failures": self.failures, "seconds": self.seconds}


def attempt(trial):
    """A trial's failure. One that cannot be made counts as not held: nothing is left out quietly."""
    try:
        return trial()
    except Exception as error:
        return f"could not be tried: {type(error).__name__}: {error}"


def prepared(gate, draw, count):
    """The gate's trials. What they need together and cannot have is one that failed, and the last; so is that there are none."""
    none = True
    try:
        for trial in gate.trials(draw, count):
            none = False
            yield trial
        if none:
            raise RuntimeError("no trial was made")
    except Exception as error:
        text = f"could not be prepared: {type(error).__name__}: {error}"
        yield "preparation", lambda: text


def run(gate, seed, share, path):
    """Tries `share` of the gate's trials, at least one, and writes the verdict into `path` after each."""
    verdict = Verdict(gate, seed)
    begin = time.monotonic()
    for name, trial in prepared(gate, random.Random(seed), max(1, round(share * gate.count))):
        failure = attempt(trial)
        verdict.tried += 1
        verdict.seconds = time.monotonic() - begin
        if failure is not None:
            verdict.failures.append([name, failure])
            print(f"{gate.name}: {name}: {failure}", flush=True)
        path.write_text(json.dumps(verdict.as_json(), indent=1) + "\n")
    print(f"{gate.name}: {verdict.tried - len(verdict.failures)} of {verdict.tried} held, {verdict.seconds / 60:.1f} min", flush=True)
    return verdict
