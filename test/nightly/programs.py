"""Programs that a gate starts, watches and ends, and what they leave behind."""
import json
import os
import random
import re
import secrets
import shutil
import signal
import socket
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CDIFF = Path(os.environ.get("BUILD", ROOT / "build")) / "devel" / "lib" / "e2e_cdiff" / "cdiff"
# Names a session's processes, those of SUMO and roslaunch among them, by an environment variable that children inherit.
MARK = "E2E_CDIFF_GATE"
# What roscpp itself says of a message of no use, with its sender.
OF_ROSCPP = re.compile(r".*Exception thrown when deserializing message.*")
RAW_TEXTS = re.compile(r"Traceback \(most recent|terminate called|Assertion|std::|json\.exception|core dumped")


class Folder:
    """A temporary folder, which goes with the trial, as do the programs that were started in it."""

    def __enter__(self):
        self.path = Path(tempfile.mkdtemp(prefix="cdiff_gate_"))
        return self.path

    def __exit__(self, *_):
        for program in Program.started:
            if self.path in program.log.parents:
                program.kill()
        Program.started = [program for program in Program.started if self.path not in program.log.parents]
        shutil.rmtree(self.path, ignore_errors=True)


class Program:
    """A command whose processes carry a mark of their own; what they write goes into a file."""

    started = []  # until their Folder goes

    def __init__(self, command, folder, **environment):
        self.mark = secrets.token_hex(8)
        self.log = folder / "log.txt"
        environment = {**os.environ, "ROS_IP": "127.0.0.1", **environment, MARK: self.mark}
        environment.pop("ROS_MASTER_URI", None)
        self.begin = time.monotonic()
        with self.log.open("wb") as log:
            self.process = subprocess.Popen([str(part) for part in command], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                            stdout=log, stderr=subprocess.STDOUT, start_new_session=True)
        Program.started.append(self)

    def end(self, limit):
        """The exit code, None where the program has not ended within `limit` seconds; then it is killed."""
        try:
            return self.process.wait(timeout=limit)
        except subprocess.TimeoutExpired:
            return None
        finally:
            self.orphans = self.left_behind()
            self.kill()

    def left_behind(self):
        """Programs that still run a moment after the first one has ended."""
        end = time.monotonic() + 3.0
        while self.living() and time.monotonic() < end:
            time.sleep(0.1)
        return [f"{process} {sorted(names(process))}" for process in self.living()]

    def kill(self):
        for process in self.living():
            try:
                os.kill(process, signal.SIGKILL)
            except ProcessLookupError:
                pass
        self.process.wait()

    def living(self):
        """Ids of processes with the mark."""
        wanted = f"{MARK}={self.mark}".encode()
        found = []
        for folder in Path("/proc").glob("[0-9]*"):
            try:
                if wanted in (folder / "environ").read_bytes().split(b"\0") and "Z" not in state(folder):
                    found.append(int(folder.name))
            except OSError:
                pass
        return found

    def find(self, name, limit=60.0):
        """Id of the process whose program or ROS name is `name`, once there is one."""
        end = time.monotonic() + limit
        while time.monotonic() < end:
            for process in self.living():
                if name in names(process):
                    return process
            time.sleep(0.02)
        raise RuntimeError(f"no process '{name}' within {limit} s: {self.text()[-500:]}")

    def wait_for(self, condition, what, limit=60.0):
        """Waits until `condition()` holds, while the program runs."""
        end = time.monotonic() + limit
        while not condition():
            if self.process.poll() is not None or time.monotonic() > end:
                raise RuntimeError(f"{what} did not come: {self.text()[-500:]}")
            time.sleep(0.02)

    def text(self):
        return self.log.read_text(errors="replace")


class RosMaster:
    """A ROS master on a free port, and programs that use it, for as long as the block lasts."""

    def __init__(self, folder):
        self.folder, self.programs = folder, []

    def __enter__(self):
        port = free_port()
        self.uri = f"http://127.0.0.1:{port}"
        master = self.run(["rosmaster", "--core", "-p", port])
        master.wait_for(lambda: socket.socket().connect_ex(("127.0.0.1", port)) == 0, "the ROS master")
        return self

    def run(self, command):
        """Starts a program that finds this master; it ends with the block."""
        folder = self.folder / f"program_{len(self.programs)}"
        folder.mkdir()
        self.programs.append(Program(["env", f"ROS_MASTER_URI={self.uri}", *command], folder))
        return self.programs[-1]

    def __exit__(self, *_):
        for program in reversed(self.programs):
            program.kill()


def free_port():
    """Below the ports that the kernel gives to connections."""
    while socket.socket().connect_ex(("127.0.0.1", port := random.randrange(20000, 32000))) == 0:
        pass
    return port


def state(folder):
    return (folder / "stat").read_text().rpartition(")")[2].split()[0]


def names(process):
    """Names by which a process is known: that of its program and its ROS name."""
    try:
        words = Path(f"/proc/{process}/cmdline").read_bytes().decode(errors="replace").split("\0")
    except OSError:
        return set()
    return {Path(words[0]).name, *(word.partition(":=")[2] for word in words if word.startswith("__name:="))}


def run_cdiff(arguments, folder, limit=60, **environment):
    """The ended program and its exit code."""
    program = Program([CDIFF, *arguments], folder, **environment)
    return program, program.end(limit)


def misbehavior(program, code, allowed):
    """What no program may do, whatever it is given: end by a signal or not at all, leave processes, write raw texts of libraries."""
    if code is None:
        return "no end within the limit: " + program.text()[-300:]
    if code not in allowed:
        return f"exit code {code}: " + program.text()[-300:]
    if program.orphans:
        return f"processes left: {program.orphans}"
    raw = RAW_TEXTS.search(OF_ROSCPP.sub("", program.text()))
    return f"raw text '{raw.group()}': {program.text()[-300:]}" if raw else None


def half_files(folder):
    """Files that are only written on the way to others."""
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if ".tmp" in path.name or path.suffix in {".active", ".part"})


def bag_of(results):
    """The bag of a session, under its own name or that of one whose recorder was killed."""
    return next(path for path in (results / "session.bag", results / "session.bag.active") if path.exists())


def summary(results):
    return json.loads((results / "summary.json").read_text())


def ticks(results):
    """The last tick of a session's trace."""
    with (results / "trace.csv").open("rb") as trace:
        trace.seek(-min(2000, trace.seek(0, os.SEEK_END)), os.SEEK_END)
        return int(trace.read().splitlines()[-1].partition(b",")[0])


def faults(results):
    return " | ".join(str(fault) for fault in summary(results)["faults"])


def wrong_loss(results, culprit, kept=()):
    """What the result of a session that lost a part does not say of `culprit`; `kept`: half files that may stay."""
    if summary(results)["status"] != "error":
        return f"status {summary(results)['status']}"
    if culprit not in faults(results):
        return f"{culprit} is not named: {faults(results)}"
    half = [name for name in half_files(results) if name not in kept]
    return f"half files: {half}" if half else None
