"""A session repeats to the byte, also beside programs that take the processors, and with another seed it does not."""
import hashlib
import os
import subprocess

from gate import Gate
from programs import Folder, misbehavior, run_cdiff, ticks

KEYS = ["target_speed=0.5", "route.start_offset=5", "route.end_offset=5", "protocol.time_limit=500", "protocol.blocked_time=86400"]
LONG = [part for key in KEYS for part in ("--set", key)]
# The last has 10 000 ticks.
SESSIONS = [["roundabout_entry", "--mode", mode] for mode in ("naturalistic", "safety_critical")] + \
           [["crossing_left_turn", "--mode", mode] for mode in ("naturalistic", "safety_critical")] + \
           [["t_junction_left", "--mode", mode] for mode in ("naturalistic", "safety_critical")] + \
           [["roundabout_entry", "--cbv-planner", "pdm_lite", *LONG]]
FILES = ["trace.csv", "vehicles.csv", "plans.csv"]


class Load:
    """As many busy programs as there are processors."""

    def __init__(self, wanted):
        self.wanted = wanted

    def __enter__(self):
        count = len(os.sched_getaffinity(0)) if self.wanted else 0
        self.programs = [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(count)]

    def __exit__(self, *_):
        for program in self.programs:
            program.kill()
            program.wait()


def drive(session, seed):
    """Hash of what a session wrote, and its ticks."""
    with Folder() as folder:
        program, code = run_cdiff(["run", *session, "--seed", seed, "--quiet", "--results", folder / "r"], folder, limit=300)
        failure = misbehavior(program, code, {0, 1})
        if failure:
            raise RuntimeError(failure)
        written = b"".join((folder / "r" / name).read_bytes() for name in FILES if (folder / "r" / name).exists())
        return hashlib.sha256(written).hexdigest(), ticks(folder / "r")


def compare(session, loaded, first):
    """`first`: hashes of earlier runs, by session; a session without one is driven with another seed, too."""
    key = " ".join(session)
    if key not in first:
        first[key], driven = drive(session, 1)
        if drive(session, 2)[0] == first[key]:
            return "another seed gives the same bytes"
        if session[-1] == LONG[-1] and driven < 10000:
            return f"only {driven} ticks"
    with Load(loaded):
        return None if drive(session, 1)[0] == first[key] else "other bytes"


def trials(_, count):
    first = {}
    for index in range(count):
        session, loaded = SESSIONS[index % len(SESSIONS)], index // len(SESSIONS) % 2 == 1
        yield f"{' '.join(session)}{' under load' if loaded else ''}", lambda s=session, busy=loaded: compare(s, busy, first)


GATE = Gate("same_bytes", "a session repeats to the byte, half of them under load; another seed differs", 28, trials)
