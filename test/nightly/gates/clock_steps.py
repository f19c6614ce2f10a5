"""The clock of the machine is set forward or back while a session of the node graph runs."""
import subprocess
import tempfile
import time
from pathlib import Path

from gate import Gate
from programs import ROOT, Folder, Program, misbehavior, run_cdiff

# libfaketime's clock_nanosleep() refuses what Python's sleep() asks for, so this gate has a clock of its own.
CLOCK = Path(__file__).with_name("parts") / "set_clock.c"
STEPS = [0.1, 10.0, 1000.0, -0.1, -10.0, -1000.0]  # [s]
SESSION = ["roundabout_entry", "pdm_lite", "at_most=8"]


def reference():
    """The course with a clock that goes on."""
    with Folder() as folder:
        program, code = run_cdiff(["run", SESSION[0], "--cbv-planner", SESSION[1], "--quiet", "--results", folder / "r"], folder)
        failure = misbehavior(program, code, {0, 1})
        if failure:
            raise RuntimeError(failure)
        return (folder / "r" / "trace.csv").read_bytes()


def drive(library, step, delay, expected):
    with Folder() as folder:
        offset = folder / "offset"
        offset.write_text("0\n")
        program = Program([ROOT / "scripts" / "session", f"scenario:={SESSION[0]}", f"cbv_planner:={SESSION[1]}", f"set:={SESSION[2]}",
                           "record:=true", f"results:={folder / 'r'}"], folder, LD_PRELOAD=str(library), CDIFF_CLOCK_OFFSET=str(offset))
        program.find("traffic_simulator_node")
        time.sleep(delay)
        offset.write_text(f"{step}\n")
        failure = misbehavior(program, program.end(90), {0, 1})
        return failure or (None if (folder / "r" / "trace.csv").read_bytes() == expected else "another course")


def trials(random, count):
    expected = reference()
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / "set_clock.so"
        subprocess.run(["gcc", "-shared", "-fPIC", "-O1", CLOCK, "-o", library], check=True)
        for index in range(count):
            step, delay = STEPS[index % len(STEPS)], random.uniform(0.0, 6.0)
            yield f"{step:+} s after {delay:.2f} s", lambda step=step, delay=delay: drive(library, step, delay, expected)


GATE = Gate("clock_steps", "the clock set by 0.1, 10 or 1,000 s, forward or back, while a session starts or runs: the same course", 60, trials)
