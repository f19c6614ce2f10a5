"""A session of the node graph that goes on for hours: neither memory nor descriptors nor threads of its processes may grow."""
import time
from pathlib import Path

from gate import Gate
from programs import ROOT, Folder, Program, RosMaster, misbehavior, names

WARM_UP, HOLD = 20.0, 130.0
GROWTH = 1.0  # [MB/h]
STEP = 20.0  # [s] between two looks
# The ego stands, so that the session goes on; vehicles come and go around it.
SESSION = ["scenario:=roundabout_entry", "ego_planner:=external", "cbv_planner:=diffusion", "record:=true"]
EGO = Path(__file__).with_name("parts") / "standing_ego.py"


def holdings(process):
    """Resident memory of its own [MB], descriptors and threads of a process; pages of files come and go as the kernel likes."""
    folder = Path(f"/proc/{process}")
    status = dict(line.split(":", 1) for line in (folder / "status").read_text().splitlines() if ":" in line)
    own = sum(int(status[key].split()[0]) for key in ("RssAnon", "RssShmem"))
    return own / 1024, len(list((folder / "fd").iterdir())), int(status["Threads"])


def growth(looks):
    """Slope of resident memory by least squares [MB/h]."""
    middle = sum(t for t, _ in looks) / len(looks)
    mean = sum(look[0] for _, look in looks) / len(looks)
    spread = sum((t - middle) ** 2 for t, _ in looks)
    return 3600 * sum((t - middle) * (look[0] - mean) for t, look in looks) / spread


def what_grew(looks):
    """What a process holds more of at the end, None where nothing does."""
    slope = growth(looks)
    if slope > GROWTH:
        return f"{slope:.2f} MB/h"
    for index, kind in ((1, "descriptors"), (2, "threads")):
        first, last = looks[0][1][index], looks[-1][1][index]
        if abs(last - first) > 2:
            return f"{first} to {last} {kind}"
    return None


def watch(program, minutes, looks):
    """Looks at every node of the session until `minutes` have passed, or the session has ended."""
    end = program.begin + 60 * minutes
    while time.monotonic() < end and program.process.poll() is None:
        for process in program.living():
            nodes = [name for name in names(process) if name.endswith("_node") or name == "sumo"]
            if nodes:
                looks.setdefault(min(nodes), []).append((time.monotonic() - program.begin, holdings(process)))
        time.sleep(STEP)


def start(folder, master, seconds):
    """The session and its ego."""
    keys = f"at_most=1 protocol.blocked_time=86400 protocol.time_limit={seconds:.0f}"
    session = Program([ROOT / "scripts" / "session", *SESSION, f"results:={folder / 'r'}", f"set:={keys}"], folder,
                      E2E_CDIFF_MASTER=master.uri)
    master.run(["/usr/bin/python3", EGO])
    return session


def compare(looks):
    """Prints what each process holds after the warm-up, and at the end; what grew, None where nothing did."""
    late = {name: [look for look in seen if look[0] > 60 * WARM_UP] for name, seen in looks.items()}
    grown = []
    for name, seen in sorted(late.items()):
        print(f"soak: {name}: {growth(seen):+.2f} MB/h, {seen[0][1]} to {seen[-1][1]}", flush=True)
        what = what_grew(seen)
        grown += [f"{name}: {what}"] if what else []
    return "; ".join(grown) or None


def soak(minutes):
    with Folder() as folder, RosMaster(folder) as master:
        session = start(folder, master, 60 * (WARM_UP + minutes) + 600)
        looks = {}
        watch(session, WARM_UP + minutes, looks)
        if session.process.poll() is not None:
            return f"ended after {time.monotonic() - session.begin:.0f} s: {session.text()[-300:]}"
        session.process.terminate()
        return misbehavior(session, session.end(120), {0, 1, 130}) or compare(looks)


def trials(_, minutes):
    """One, which lasts as many minutes as others have trials."""
    yield f"{minutes} minutes", lambda: soak(minutes)


GATE = Gate("soak", "for 130 minutes after 20: at most 1 MB an hour, descriptors and threads within 2", int(HOLD), trials)
