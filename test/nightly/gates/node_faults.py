"""Seven kinds of faults (PX4's failure types) of six nodes, by their topic: off, stuck, slow, delayed, intermittent, garbage, wrong."""
import os
import signal
import time
from pathlib import Path

from gate import Gate
from programs import ROOT, Folder, Program, RosMaster, faults, half_files, misbehavior, run_cdiff, wrong_loss

DISTURBER = Path(__file__).with_name("parts") / "disturber.py"
NODES = {"/traffic": "traffic_simulator_node", "/cbv_0/camera/image_raw": "camera_node", "/cbv/selection": "cbv_identification_node",
         "/cbv_0/rollout": "diffusion_planner_node", "/ego/control": "ego_planner_node", "/metrics": "metrics_node"}
KINDS = ["off", "stuck", "slow", "delayed", "intermittent", "garbage", "wrong"]
SESSION = ["scenario:=roundabout_entry", "cbv_planner:=diffusion", "answer_timeout:=8"]
PACE, LIMIT = 4, 12  # times real time, [s]


def pulses(kind, random):
    """Stops of a process: after how long, and how long each [s]."""
    return {"slow": [(0.05, 0.05)] * 30, "delayed": [(random.uniform(0, 1), 2.0)],
            "intermittent": [(random.uniform(0, 0.5), random.uniform(0.1, 0.8)) for _ in range(4)]}[kind]


def disturb(process, kind, random):
    """A process that is killed, stopped for good, or stopped and let go."""
    if kind in ("off", "stuck"):
        os.kill(process, signal.SIGKILL if kind == "off" else signal.SIGSTOP)
        return
    for wait, stop in pulses(kind, random):
        time.sleep(wait)
        os.kill(process, signal.SIGSTOP)
        time.sleep(stop)
        os.kill(process, signal.SIGCONT)


def reference():
    with Folder() as folder:
        program, code = run_cdiff(["run", "roundabout_entry", "--cbv-planner", "diffusion", "--quiet", "--set", f"protocol.time_limit={LIMIT}",
                                   "--results", folder / "r"], folder)
        failure = misbehavior(program, code, {0, 1})
        if failure:
            raise RuntimeError(failure)
        return (folder / "r" / "trace.csv").read_bytes()


def judge(session, results, node, kind, expected):
    """A session that lost a node says so; any other is as if nothing had been."""
    lost = kind in ("off", "stuck")
    failure = misbehavior(session, session.end(60), {2} if lost else {0, 1, 2})
    if failure or lost:
        return failure or wrong_loss(results, node)
    if half_files(results):
        return f"half files: {half_files(results)}"
    return None if (results / "trace.csv").read_bytes() == expected else f"another course: {faults(results)}"


def attempt(topic, kind, random, expected):
    with Folder() as folder, RosMaster(folder) as master:
        results = folder / "r"
        disturber = None
        if kind in ("garbage", "wrong"):
            disturber = master.run(["/usr/bin/python3", DISTURBER, topic, kind, random.randrange(10**6)])
            disturber.wait_for(lambda: "waiting" in disturber.text(), "the disturber")
        session = Program([ROOT / "scripts" / "session", *SESSION, f"set:=at_most={PACE} protocol.time_limit={LIMIT}", f"results:={results}"],
                          folder, E2E_CDIFF_MASTER=master.uri)
        process = session.find(NODES[topic])
        if not disturber:
            session.wait_for(lambda: list(results.glob("trace.csv*")), "the session's trace")
            time.sleep(random.uniform(0.0, 1.0))
            disturb(process, kind, random)
        failure = judge(session, results, NODES[topic], kind, expected)
        return failure or ("nothing was sent" if disturber and "sent" not in disturber.text().splitlines() else None)


def trials(random, count):
    expected = reference()
    cells = [(topic, kind) for topic in NODES for kind in KINDS]
    for index in range(count):
        topic, kind = cells[index % len(cells)]
        yield f"{topic} {kind}", lambda topic=topic, kind=kind: attempt(topic, kind, random, expected)


GATE = Gate("node_faults", "42 cells of nodes and kinds of faults, 3 times: a lost node is named, else the course is the same", 126, trials)
