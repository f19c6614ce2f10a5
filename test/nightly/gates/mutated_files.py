"""Files of each kind that people write or record, with changes drawn at random."""
import os
import re
import shutil
import tempfile
from pathlib import Path

from gate import Gate
from programs import ROOT, Folder, misbehavior, run_cdiff

NETWORK, DEMAND = (ROOT / "networks" / "crossing_district" / f"crossing_district.{kind}.xml" for kind in ("net", "rou"))
DATA = Path(os.environ.get("E2E_CDIFF_DATA", ROOT / ".." / "shared" / "data"))
ROUTES = DATA / "bench2drive" / "drivetransformer_bench2drive_dev10.xml"
DRIVE = ["--cbv-planner", "pdm_lite", "--quiet", "--set", "protocol.time_limit=1", "--results", "results"]
LONGER = [part.replace("time_limit=1", "time_limit=6") for part in DRIVE]
TRAIN = ["--stage", "encoder", "--steps", "1", "--batch", "1", "--validation-samples", "1", "--validation-share", "0", "--image-scale", "0.5"]
EXTREMES = [b"-1", b"0", b"1e308", b"-1e308", b"99999999999999999999", b"nan", b"inf", b"", b"x", b"../../x", b"\xff\xfe", b"1\n2"]


def change_number(content, random):
    """Another value of a number: a near one, one of another place, or one that nobody expects."""
    numbers = list(re.finditer(rb"-?\d+\.?\d*", bytes(content[:300000])))
    if numbers:
        number = random.choice(numbers)
        near = b"%g" % (float(number.group()) * random.choice([0.5, 0.9, 1.1, 2.0, -1.0]))
        content[number.start():number.end()] = random.choice([near, random.choice(numbers).group(), random.choice(EXTREMES)])


def damage(content, random):
    """A bit, or a part that is left out, doubled, overwritten or cut off."""
    begin = random.randrange(len(content))
    end = min(len(content), begin + random.randrange(1, 200))
    kind = random.randrange(5)
    if kind == 0:
        content[begin] ^= 1 << random.randrange(8)
    elif kind == 1:
        del content[begin:end]
    elif kind == 2:
        content[begin:begin] = content[begin:end]
    elif kind == 3:
        content[begin:end] = random.randbytes(end - begin)
    else:
        del content[begin:]


def mutate(content, random):
    """Half of the mutants have other numbers alone, so that their form is whole."""
    content = bytearray(content)
    change = random.choice([change_number, damage])
    for _ in range(random.randrange(1, 4)):
        if content:
            change(content, random)
    return bytes(content)


def recorded(arguments, pattern):
    """A file that a command of the program writes."""
    with Folder() as folder:
        program, code = run_cdiff(arguments, folder)
        failure = misbehavior(program, code, {0, 1})
        if failure:
            raise RuntimeError(failure)
        return next(folder.rglob(pattern)).read_bytes()


# For each kind: the original, the name of the mutant, the command that reads it, its exit codes. {} is the mutant's path.
KINDS = {
    "network": (NETWORK.read_bytes, "mutant.net.xml", ["run", "crossing_straight", *DRIVE, "--network", "{}"], {0, 1, 3}),
    "demand": (DEMAND.read_bytes, "mutant.rou.xml", ["run", "crossing_straight", *DRIVE, "--set", "demand={}"], {0, 1, 3}),
    "OpenDRIVE": ((ROOT / "config/openscenario/straight_road.xodr").read_bytes, "mutant.xodr", ["import", "{}"], {0, 3}),
    "OpenSCENARIO": ((ROOT / "config/openscenario/cut_in.xosc").read_bytes, "mutant.xosc", ["run", "{}", *DRIVE], {0, 1, 3}),
    "scenario": ((ROOT / "config/scenarios/roundabout_entry.yaml").read_bytes, "mutant.yaml", ["validate", "--fast", "{}"], {0, 3}),
    "matrix": ((ROOT / "config/evaluations/smoke.yaml").read_bytes, "mutant.yaml",
               ["evaluate", "{}", "--engine", "print", "--results", "results"], {0, 3}),
    "route file": (ROUTES.read_bytes, "mutant.xml", ["evaluate", "smoke", "--bench2drive", "{}", "--networks", str(DATA / "carla_towns"), "--engine", "print",
                                                  "--results", "results"], {0, 3}),
    "bag": (lambda: recorded(["run", "crossing_straight", *LONGER, "--record"], "session.bag"), "mutant.bag",
            ["replay", "{}", "--quiet", "--results", "results"], {0, 1, 2, 3}),
    "shard": (lambda: recorded(["collect", "--scenarios", "roundabout_entry", "--duration", "5", "--results", "data"], "*.shard"),
              "data/mutant.shard", ["train", "--data", "data", "--output", "results", *TRAIN], {0, 2, 3}),
}


def read_mutant(kind, mutant):
    _, name, command, allowed = KINDS[kind]
    with Folder() as folder:
        path = folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(mutant)
        (folder / "data").mkdir(exist_ok=True)
        if kind == "OpenSCENARIO":
            for part in ("straight_road.xodr", "catalogs"):
                os.symlink(ROOT / "config/openscenario" / part, folder / part)
        program, code = run_cdiff([part.replace("{}", str(path)) for part in command], folder, limit=60)
        failure = misbehavior(program, code, allowed)
        if failure:
            kept = Path(tempfile.gettempdir()) / f"cdiff_gate_{path.stem}_{os.getpid()}_{os.urandom(4).hex()}{path.suffix}"
            shutil.copy(path, kept)
            return f"{failure} ({kept})"
        return "refused without the file's name: " + program.text()[-300:] if code == 3 and "mutant" not in program.text() else None


def trials(random, count):
    originals = {kind: KINDS[kind][0]() for kind in KINDS}
    for index in range(count):
        kind = list(KINDS)[index % len(KINDS)]
        mutant = mutate(originals[kind], random)
        yield f"{kind} {index // len(KINDS)}", lambda kind=kind, mutant=mutant: read_mutant(kind, mutant)


GATE = Gate("mutated_files", "a changed network, demand, OpenDRIVE, OpenSCENARIO, scenario, matrix, route file, bag or shard: "
            "it is read, or refused by name", 1000 * len(KINDS), trials)
