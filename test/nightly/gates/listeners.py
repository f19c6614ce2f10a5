"""No port of a session can be reached from outside its network namespace."""
import socket
import subprocess
import time

from gate import Gate
from programs import ROOT, Folder, Program, misbehavior

SESSION = ["scenario:=roundabout_entry", "cbv_planner:=pdm_lite", "record:=true", "set:=at_most=2"]


def ports_inside(process):
    """Ports on which anything listens in the network namespace of a process."""
    listed = subprocess.run(["nsenter", "-t", str(process), "-U", "--preserve-credentials", "-n", "ss", "-Hltn"], check=True,
                            capture_output=True, text=True).stdout
    return sorted({int(line.split()[3].rpartition(":")[2]) for line in listed.splitlines()})


def answers(port):
    with socket.socket() as connection:
        connection.settimeout(1.0)
        return connection.connect_ex(("127.0.0.1", port)) == 0


def look(delay):
    with Folder() as folder:
        program = Program([ROOT / "scripts" / "session", *SESSION, f"results:={folder / 'r'}"], folder)
        simulator = program.find("traffic_simulator_node")
        time.sleep(delay)
        ports = ports_inside(simulator)
        reached = [port for port in ports if answers(port)]
        failure = misbehavior(program, program.end(90), {0, 1})
        if len(ports) < 10:
            return f"only {len(ports)} ports of master and nodes were found"
        return failure or (f"reached from outside: {reached}" if reached else None)


def trials(random, count):
    for _ in range(count):
        delay = random.uniform(1.0, 5.0)
        yield f"after {delay:.2f} s", lambda delay=delay: look(delay)


GATE = Gate("listeners", "no port of master, nodes and SUMO of a session can be reached from outside its network namespace", 10, trials)
