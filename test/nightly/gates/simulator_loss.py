"""SUMO is killed or stopped at some moment of a session in one process."""
import os
import signal
import time

from gate import Gate
from programs import CDIFF, Folder, Program, misbehavior, wrong_loss

LIMIT = 45.0  # [s]
# Slowly enough that the moment falls into the session.
SESSION = ["run", "roundabout_entry", "--cbv-planner", "pdm_lite", "--quiet", "--set", "at_most=4", "--set", "target_speed=1"]


def lose(sign, delay):
    with Folder() as folder:
        program = Program([CDIFF, *SESSION, "--results", folder / "r"], folder)
        sumo = program.find("sumo")
        time.sleep(delay)
        os.kill(sumo, sign)
        return misbehavior(program, program.end(LIMIT), {2}) or wrong_loss(folder / "r", "SUMO")


def trials(random, count):
    for index in range(count):
        sign = (signal.SIGKILL, signal.SIGSTOP)[index % 2]
        delay = random.uniform(0.0, 4.0)
        yield f"{sign.name} after {delay:.2f} s", lambda sign=sign, delay=delay: lose(sign, delay)


GATE = Gate("simulator_loss", "SUMO killed or stopped: exit code 2 within 45 s, SUMO named, no process and no half file left", 240, trials)
