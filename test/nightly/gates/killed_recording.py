"""A session that records is killed at some moment; its bag gives all that it holds."""
import os
import signal
import time

from gate import Gate
from programs import CDIFF, Folder, Program, bag_of, misbehavior, run_cdiff, ticks

SESSION = ["run", "roundabout_entry", "--cbv-planner", "pdm_lite", "--quiet", "--record", "--set", "at_most=20", "--set", "target_speed=1", "--set",
           "protocol.time_limit=400"]
CHUNK = 768 * 1024  # [byte]
LEAST = 400  # ticks in so many bytes of this session's bag
FINAL = ["summary.json", "trace.csv", "vehicles.csv", "plans.csv", "report.html", "session.bag", "exit_code"]


def kill_and_replay(delay):
    with Folder() as folder:
        results = folder / "r"
        program = Program([CDIFF, *SESSION, "--results", results], folder)
        program.wait_for(lambda: any(path.stat().st_size > CHUNK for path in results.glob("*.bag*")), "the first chunk of the bag")
        time.sleep(delay)
        for process in program.living():
            os.kill(process, signal.SIGKILL)
        program.end(10)
        halves = [name for name in FINAL if (results / name).exists()]
        if halves:
            return f"half results under final names: {halves}"
        replay, code = run_cdiff(["replay", bag_of(results), "--results", folder / "again", "--quiet"], folder)
        return misbehavior(replay, code, {0, 1, 2}) or (None if ticks(folder / "again") > LEAST else "ticks are missing")


def trials(random, count):
    for _ in range(count):
        delay = random.uniform(0.0, 2.0)
        yield f"{delay:.2f} s behind the first chunk", lambda delay=delay: kill_and_replay(delay)


GATE = Gate("killed_recording", "kill -9 while recording: no half result under a final name, the bag replays", 100, trials)
