"""A node of a session is killed or stopped at some moment."""
import os
import signal
import time

from gate import Gate
from programs import ROOT, Folder, Program, bag_of, misbehavior, run_cdiff, ticks, wrong_loss

LIMIT = 45.0  # [s]
NODES = ["traffic_simulator_node", "cbv_identification_node", "ego_planner_node", "cbv_planner_node", "metrics_node", "recorder_node"]
SESSION = ["scenario:=roundabout_entry", "cbv_planner:=pdm_lite", "record:=true", "set:=at_most=2 target_speed=1"]


def what_is_wrong(folder, node):
    """What result and bag of a session that lost `node` do not say."""
    recorder = node == "recorder_node"
    return wrong_loss(folder / "r", node, {"session.bag.active"} if recorder else ()) or replay(folder, recorder)


def replay(folder, recorder):
    """What is wrong with the bag: one of a recorder that was lost may lack its first chunk, or all."""
    results = folder / "r"
    begun = (results / "trace.csv").read_bytes().count(b"\n") > 1  # else there is nothing to replay
    if (recorder or not begun) and not list(results.glob("session.bag*")):
        return None
    program, code = run_cdiff(["replay", bag_of(results), "--results", folder / "again", "--quiet"], folder)
    wrong = misbehavior(program, code, {0, 1, 2} | ({3} if recorder or not begun else set()))
    if wrong or code == 3 or not begun:
        return wrong
    if not (folder / "again" / "trace.csv").exists():
        return "the replay has no trace"
    missing = ticks(results) - ticks(folder / "again")
    # A lost recorder may lack its last chunk; another one writes what it was told of until the end.
    return f"the replay lacks {missing} of {ticks(results)} ticks" if missing > (1000 if recorder else 1) else None


def lose(node, sign, delay):
    with Folder() as folder:
        program = Program([ROOT / "scripts" / "session", *SESSION, f"results:={folder / 'r'}"], folder)
        process = program.find(node)
        time.sleep(delay)
        os.kill(process, sign)
        return misbehavior(program, program.end(LIMIT), {2}) or what_is_wrong(folder, node)


def trials(random, count):
    for index in range(count):
        node, sign = NODES[index // 2 % len(NODES)], (signal.SIGKILL, signal.SIGSTOP)[index % 2]
        delay = random.uniform(1.0, 8.0)
        yield f"{node} {sign.name} after {delay:.2f} s", lambda n=node, s=sign, d=delay: lose(n, s, d)


GATE = Gate("node_loss", "a node killed or stopped: exit code 2 within 45 s, the node named, its bag replays, no process left", 240, trials)
