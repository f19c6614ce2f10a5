"""SUMO is killed or stopped at some moment of a session in one process."""
import os
import signal
import time

from gate import Gate
from programs import Folder, Program, CDIFF, faults, half_files, misbehavior, summary

LIMIT = 45.0  # [s]
# Slowly enough that the moment falls into the session.
SESSION = ["run", "roundabout_entry", "--cbv-planner", "pdm_lite", "--quiet", "--set", "at_most=4", "--set", "target_speed=1"]


def what_is_wrong(results):
    """What the result of a session that lost SUMO does not say."""
    if summary(results)["status"] != "error":
        return f"status {summary(results)['status']}"
    if "SUMO" not in faults(results):
        return f"SUMO is not named: {faults(results)}"
    return f"half files: {half_files(results)}" if half_files(results) else None


def lose(sign, delay):
    with Folder() as folder:
        program = Program([CDIFF, *SESSION, "--results", folder / "r"], folder)
        sumo = program.find("sumo")
        time.sleep(delay)
        os.kill(sumo, sign)
        begin = time.monotonic()
        failure = misbehavior(program, program.end(LIMIT), {2})
        return failure or what_is_wrong(folder / "r") or (f"{time.monotonic() - begin:.0f} s" if time.monotonic() - begin > LIMIT else None)


def trials(random, count):
    for index in range(count):
        sign = (signal.SIGKILL, signal.SIGSTOP)[index % 2]
        delay = random.uniform(0.0, 4.0)
        yield f"{sign.name} after {delay:.2f} s", lambda sign=sign, delay=delay: lose(sign, delay)


GATE = Gate("simulator_loss", "SUMO killed or stopped: exit code 2 within 45 s, SUMO named, no process and no half file left", 240, trials)
