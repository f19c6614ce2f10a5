"""A bag that is cut off at any byte is replayed as far as it goes."""
import shutil
import tempfile
from pathlib import Path

from gate import Gate
from programs import Folder, misbehavior, run_cdiff, ticks


def recorded(folder):
    program, code = run_cdiff(["run", "roundabout_entry", "--cbv-planner", "pdm_lite", "--record", "--quiet", "--set", "protocol.time_limit=3",
                               "--results", folder / "r"], folder)
    failure = misbehavior(program, code, {0, 1})
    if failure:
        raise RuntimeError(failure)
    return folder / "r" / "session.bag"


def replay_part(bag, size, whole):
    """`whole`: ticks of the whole session, which a part must not exceed."""
    with Folder() as folder:
        part = folder / "part.bag"
        part.write_bytes(bag[:size])
        program, code = run_cdiff(["replay", part, "--results", folder / "r", "--quiet"], folder)
        failure = misbehavior(program, code, {0, 1, 2, 3})
        if failure or code == 3:
            return failure or ("refused, and a result" if (folder / "r").exists() else None)
        seen = ticks(folder / "r")
        return None if seen <= whole else f"{seen} ticks of {whole}"


def trials(random, count):
    folder = Path(tempfile.mkdtemp(prefix="cdiff_gate_"))
    try:
        path = recorded(folder)
        bag, whole = path.read_bytes(), ticks(path.parent)
        for index in range(count):
            # Every second one in the last bytes, in the index.
            size = len(bag) - 1 - index // 2 if index % 2 else random.randrange(len(bag))
            yield f"{size} of {len(bag)} bytes", lambda size=size: replay_part(bag, size, whole)
    finally:
        shutil.rmtree(folder)


GATE = Gate("cut_bags", "a bag cut off at any byte replays as far as it goes, or is refused without a result", 1024, trials)
