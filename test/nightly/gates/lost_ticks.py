"""Sessions of the node graph of 10 000 ticks each: every tick is in the bag once, and the course is that of one process."""
import rosbag

from gate import Gate
from programs import ROOT, Folder, Program, misbehavior, run_cdiff

TICKS = 10000
KEYS = ["target_speed=0.5", "route.start_offset=5", "route.end_offset=5", "protocol.time_limit=500", "protocol.blocked_time=86400"]


def recorded_ticks(bag):
    with rosbag.Bag(str(bag)) as recorded:
        return [message.tick for _, message, _ in recorded.read_messages("/traffic")]


def what_is_lost(ticks):
    """Lost, repeated and reordered ticks, None where there is none."""
    lost = len(set(range(TICKS)) - set(ticks))
    repeated = len(ticks) - len(set(ticks))
    reordered = sum(later <= earlier for earlier, later in zip(ticks, ticks[1:]))
    return f"{lost} lost, {repeated} repeated, {reordered} reordered" if lost or repeated or reordered else None


def drive(seed):
    with Folder() as folder:
        graph = Program([ROOT / "scripts" / "session", "scenario:=roundabout_entry", "cbv_planner:=pdm_lite", f"seed:={seed}", "record:=true",
                         f"set:={' '.join(KEYS)}", f"results:={folder / 'graph'}"], folder)
        failure = misbehavior(graph, graph.end(600), {0, 1})
        if failure:
            return failure
        lost = what_is_lost(recorded_ticks(folder / "graph" / "session.bag"))
        alone, code = run_cdiff(["run", "roundabout_entry", "--cbv-planner", "pdm_lite", "--seed", seed, "--quiet", "--results", folder / "one",
                                 *(part for key in KEYS for part in ("--set", key))], folder, limit=300)
        failure = lost or misbehavior(alone, code, {0, 1})
        same = (folder / "graph" / "trace.csv").read_bytes() == (folder / "one" / "trace.csv").read_bytes()
        return failure or (None if same else "another course than in one process")


def trials(random, count):
    for _ in range(count):
        seed = random.randrange(10**6)
        yield f"seed {seed}", lambda seed=seed: drive(seed)


GATE = Gate("lost_ticks", "10 000 ticks of the node graph: each is in the bag once, in order, and the course is that of one process", 10, trials)
