"""A bag that is cut off at any byte is replayed as far as it goes."""
import itertools
import shutil
import tempfile
from pathlib import Path

import rosbag
from gate import Gate
from programs import Folder, misbehavior, run_cdiff, ticks


def recorded(folder):
    program, code = run_cdiff(["run", "roundabout_entry", "--cbv-planner", "pdm_lite", "--record", "--quiet", "--set", "protocol.time_limit=3",
                               "--results", folder / "r"], folder)
    failure = misbehavior(program, code, {0, 1})
    if failure:
        raise RuntimeError(failure)
    return folder / "r" / "session.bag"


def last_ticks(path):
    """(end, tick) of each chunk of a bag: where its bytes end at the latest, and the last tick that it and those before it hold whole."""
    with rosbag.Bag(str(path)) as bag:
        traffic = {connection.id for connection in bag._get_connections(["/traffic"])}
        ends = [chunk.pos for chunk in bag._chunks[1:]] + [bag._index_data_pos]
        ticks_of = [sum(number for connection, number in chunk.connection_counts.items() if connection in traffic) for chunk in bag._chunks]
        # Ticks count from 0; other messages of the last one may be in the next chunk.
        return list(zip(ends, (total - 2 for total in itertools.accumulate(ticks_of))))


def replay_part(bag, size, whole, chunks):
    """`whole`: ticks of the whole session, which a part must not exceed. `chunks`: as by last_ticks()."""
    least = max((tick for end, tick in chunks if end <= size), default=-1)
    with Folder() as folder:
        part = folder / "part.bag"
        part.write_bytes(bag[:size])
        program, code = run_cdiff(["replay", part, "--results", folder / "r", "--quiet"], folder)
        failure = misbehavior(program, code, {0, 1, 2, 3})
        if failure or code == 3:
            return failure or ("refused, and a result" if (folder / "r").exists() else f"refused, with tick {least}" if least >= 0 else None)
        seen = ticks(folder / "r")
        return None if least <= seen <= whole else f"tick {seen} of {least} to {whole}"


def trials(random, count):
    folder = Path(tempfile.mkdtemp(prefix="cdiff_gate_"))
    try:
        path = recorded(folder)
        bag, whole, chunks = path.read_bytes(), ticks(path.parent), last_ticks(path)
        for index in range(count):
            # Every second one in the last bytes, in the index.
            size = len(bag) - 1 - index // 2 if index % 2 else random.randrange(len(bag))
            yield f"{size} of {len(bag)} bytes", lambda size=size: replay_part(bag, size, whole, chunks)
    finally:
        shutil.rmtree(folder)


GATE = Gate("cut_bags", "a bag cut off at any byte replays as far as it goes, or is refused without a result", 1024, trials)
