"""An external ego falls silent 1,000 times in a session that the wall clock paces: each time the ego brakes fully."""
import csv
from pathlib import Path

from gate import Gate
from programs import ROOT, Folder, Program, RosMaster, misbehavior

EGO = Path(__file__).with_name("parts") / "stuttering_ego.py"
STEP, PERIOD, LIMIT = 0.05, 0.1, 0.5  # [s]
SPOKEN, SILENT = 1.0, 1.0  # [s]
PACE = 4  # times real time
# An ego that stands brakes, too, so that the session goes on.
KEYS = f"real_time_factor={PACE} protocol.blocked_time=86400 traffic.density=4 max_cbv=1"


def brakes(results):
    """Brake of the ego by tick."""
    with (results / "trace.csv").open() as trace:
        return {int(row["tick"]): float(row["brake"] or 0) for row in csv.DictReader(trace) if row["role"] == "ego"}


def delay(braking, last):
    """From the last command until full braking [s of simulated time]."""
    tick = next((tick for tick in range(last, last + round(SILENT / STEP)) if braking.get(tick) == 1.0), None)
    return None if tick is None else (tick - last) * STEP


def record(folder, count):
    """A session with so many silences: ticks of the last command before each, and brakes."""
    limit = (1.1 * count + 5) * (SPOKEN + SILENT)
    with RosMaster(folder) as master:
        session = Program([ROOT / "scripts" / "session", "scenario:=roundabout_entry", "ego_planner:=external", "cbv_planner:=pdm_lite",
                           f"set:={KEYS} protocol.time_limit={limit:.0f}", f"results:={folder / 'r'}"], folder, E2E_CDIFF_MASTER=master.uri)
        master.run(["/usr/bin/python3", EGO, SPOKEN, SILENT, folder / "cut_offs.txt"])
        failure = misbehavior(session, session.end(60 + 2 * limit / PACE), {0, 1})
        if failure:
            raise RuntimeError(failure)
        lines = (folder / "cut_offs.txt").read_text().split()
        return [int(line) for line in lines if line != "None"][:count], brakes(folder / "r")


def judge(braking, last):
    if braking.get(last) == 1.0:
        return "full braking already at the last command"
    passed = delay(braking, last)
    # Full braking is asked for in the tick in which the limit has passed.
    if passed is None or passed > LIMIT + STEP + 1e-9:
        return f"full braking after {passed} s"
    return None


def trials(_, count):
    with Folder() as folder:
        cut_offs, braking = record(folder, count)
        for index in range(count):
            yield f"cut-off {index}", lambda index=index: judge(braking, cut_offs[index])


GATE = Gate("cut_offs", "an ego's commands end: full braking within 0.5 s of the last one", 1000, trials)
