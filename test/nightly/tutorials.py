#!/usr/bin/python3
"""Run the commands of README.md and docs as they stand there, each line of their code blocks one case.

    tutorials.py BUILD SOURCE RESULT.xml [DOCUMENT...]

Every document gets a folder of its own, in which the examples' files lie (BEFORE). What would take hours is made smaller (SMALLER),
and a line is left out for a reason that is given (LEFT_OUT); every other line that names a command of ours is run, also a new one.
Commands of README.md must exit with 0; elsewhere a session whose verdict failed (1) is fine. roslaunch exits with 0 whatever
happened, so there a result must have been written, and its exit code counts.
"""
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402
from programs import free_port  # noqa: E402

BUILD, SOURCE, RESULT = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), Path(sys.argv[3])
DATA = Path(os.environ.get("E2E_CDIFF_DATA", SOURCE / ".." / "shared" / "data")).resolve()
# ablations.md, results.md, reproduce.md and model_card.md take hours; what their commands do, these do.
DOCUMENTS = ["README.md", "docs/first_session.md", "docs/test_your_ego.md", "docs/your_own_scenario.md", "docs/diffusion_planner.md",
             "docs/evaluation.md", "docs/metrics.md", "docs/planners.md", "docs/protocols.md", "docs/replay.md", "docs/report.md", "docs/ros_api.md",
             "docs/suites.md", "docs/training.md"]
OURS = re.compile(r"(^|[\s;&|])(cdiff|roslaunch|rosrun|scripts/\w+|\. devel/setup\.bash)(\s|$)")
LEFT_OUT = [
    (r"git clone|scripts/(demo|test|setup)|cmake --install", "sets up what is there already"),
    (r"\.\.\.", "is abridged"),
    (r"results/guidance_effect", "compares a matrix of 210 runs"),
    (r"results/(towns|dev10|cbvs|egos|smooth|camera_egos)", "runs a matrix of 60 runs and more"),
    (r"--open-sealed", "opens a sealed suite"),
    (r"import Town01\.xodr", "needs a file of CARLA"),
    (r"--bags monday\.bag", "needs a bag of the reader's own"),
    (r"scene\.launch", "shows rviz until it is closed"),
    (r"scripts/benchmark", "measures, for which the machine must be quiet"),
]
SMALLER = [
    (r" rviz:=true", ""),
    (r"\[(--\w+)\]", r"\1"),
    (r"evaluate development", "evaluate development --seeds 1 --set protocol.time_limit=4 --set verdict.judge=false"),
    (r"collect --suite (\S+)", r"collect --scenarios $(ls \1/scenarios/*.yaml | head -12)"),
    (r"(collect .*?)( --duration \d+)?$", r"\1 --duration 6"),
    (r"--time-limit \d+", "--time-limit 40"),
    (r"sampler\.mode=paper", "sampler.mode=paper --set protocol.time_limit=4"),
]
# Commands whose results an example begins with.
BEFORE = {
    "docs/evaluation.md": ["cp $SOURCE/config/evaluations/smoke.yaml my_matrix.yaml", "cdiff evaluate smoke --results results/a",
                           "cdiff evaluate smoke --results results/b"],
    "docs/metrics.md": ["cp $DATA/reference/ttc_2d.csv pairs.csv", "cp $DATA/reference/shapiro_wilk.json cases.json"],
    "docs/your_own_scenario.md": ["sed -n '/^<routes>/,/^<\\/routes>/p' $SOURCE/docs/your_own_scenario.md > grid.rou.xml"],
    "docs/replay.md": ["cdiff run roundabout_entry --record --results results/my_run"],
}
INSTEAD = {"cdiff metric wasserstein cases.json": "cdiff metric wasserstein $DATA/reference/wasserstein.json"}


def commands(document):
    """(line number, command) of a document's code blocks, and of the README's text."""
    inside = False
    for number, line in enumerate((SOURCE / document).read_text().splitlines(), 1):
        if line.lstrip().startswith("```"):
            inside = not inside
            continue
        if inside:
            if OURS.search(line):
                yield number, re.sub(r"\s+#\s.*$", "", line).strip()
        elif document == "README.md":
            for span in re.findall(r"`(cdiff [^`]+)`", line):
                if not re.search(r"\b[A-Z]{3,}\b", span.replace("README", "")) and " " in span.strip()[6:]:
                    yield number, span


class Folder:
    """Where the commands of one document run, with a ROS master of its own."""

    def __init__(self, document):
        self.strict = document == "README.md"
        self.path = BUILD / "tutorials" / Path(document).stem
        shutil.rmtree(self.path, ignore_errors=True)
        self.path.mkdir(parents=True)
        (self.path / "devel").symlink_to(BUILD / "devel")
        for name in ("scripts", "config"):
            (self.path / name).symlink_to(SOURCE / name)
        for name in ("bench2drive/bench2drive220.xml", "carla_towns/Town01.net.xml"):
            if (DATA / name).is_file():
                (self.path / Path(name).name).symlink_to(DATA / name)
        self.background = []
        self.new_master()

    def new_master(self):
        self.port = free_port()

    def run(self, command, limit=900):
        """None when the command does what it should, else why not."""
        begin = time.time()
        waits = not command.endswith("&")
        if command.startswith("roslaunch") and not self.background:
            self.new_master()
        text = command.rstrip("& ").replace("roslaunch ", f"roslaunch -p {self.port} ", 1)
        script = f"cd '{SOURCE}' && . scripts/environment && cd '{self.path}'\ncdiff() {{ rosrun e2e_cdiff cdiff \"$@\"; }}\n{text}\n"
        environment = {**os.environ, "BUILD": str(BUILD), "HOME": str(self.path), "SOURCE": str(SOURCE), "DATA": str(DATA),
                       "ROS_HOME": str(self.path / "ros"), "ROS_MASTER_URI": f"http://127.0.0.1:{self.port}"}
        log = open(self.path / f"log_{len(list(self.path.glob('log_*')))}", "w+")
        process = subprocess.Popen(["bash", "-c", script], env=environment, stdout=log, stderr=subprocess.STDOUT, start_new_session=True)
        if not waits:
            self.background.append((process, command, begin, log))
            time.sleep(5)
            return None
        return self.outcome(process, command, begin, log, limit)

    def outcome(self, process, command, begin, log, limit):
        try:
            code = process.wait(limit)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return f"no end within {limit} s"
        log.seek(0)
        tail = log.read()[-2500:]
        fine = {0} if self.strict or not re.search(r"cdiff (run|evaluate|replay)|roslaunch|scripts/session", command) else {0, 1}
        if code not in fine:
            return f"exit code {code}\n{tail}"
        if not command.startswith("roslaunch"):
            return None
        if not any(path.stat().st_mtime >= begin for path in self.path.rglob("summary.json")):
            return f"no result was written\n{tail}"
        codes = [int(path.read_text()) for path in self.path.rglob("exit_code") if path.stat().st_mtime >= begin]
        return None if codes and set(codes) <= fine else f"the session's exit code is {codes}\n{tail}"

    def finish(self):
        """Outcomes of what was put in the background."""
        for process, command, begin, log in self.background:
            yield command, self.outcome(process, command, begin, log, 120)


def prepared(command):
    for pattern, replacement in SMALLER:
        command = re.sub(pattern, replacement, command)
    return INSTEAD.get(command, command)


def run_document(document, cases):
    folder = Folder(document)

    def note(name, begin, failure):
        cases.append((name, time.monotonic() - begin, failure))
        print(f"{cases[-1][1]:7.1f} s  {'FAILED' if failure else 'passed'}  {name}" + (f"\n{failure}" if failure else ""), flush=True)

    for command in BEFORE.get(document, []):
        begin = time.monotonic()
        note(f"{document} before: {command}", begin, folder.run(command))
    for number, command in commands(document):
        reason = next((reason for pattern, reason in LEFT_OUT if re.search(pattern, command)), None)
        if "bench2drive220.xml" in command and not (folder.path / "bench2drive220.xml").exists():
            reason = "needs the real networks"
        if reason:
            print(f"           left out {document}:{number} {command}: {reason}", flush=True)
            continue
        begin = time.monotonic()
        note(f"{document}:{number} {prepared(command)}", begin, folder.run(prepared(command)))
    for command, failure in folder.finish():
        note(f"{document} {command}", time.monotonic(), failure)


def main():
    cases = []
    for document in sys.argv[4:] or DOCUMENTS:
        run_document(document, cases)
    junit.write(RESULT, "tutorials", cases)
    return any(failure for _, _, failure in cases)


if __name__ == "__main__":
    sys.exit(main())
