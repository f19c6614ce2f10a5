"""Programs that speak badly connect to the ports of a session's nodes."""
import socket
import struct
import subprocess

from gate import Gate
from programs import ROOT, Folder, Program, RosMaster, misbehavior

SESSION = ["scenario:=roundabout_entry", "cbv_planner:=pdm_lite", "set:=at_most=1 target_speed=0.5 protocol.time_limit=3600"]


def ports(program):
    """Ports on which processes of the session listen."""
    listed = subprocess.run(["ss", "-Hltnp"], check=True, capture_output=True, text=True).stdout
    mine = [f"pid={process}," for process in program.living()]
    return sorted({int(line.split()[3].rpartition(":")[2]) for line in listed.splitlines() if any(one in line for one in mine)})


def field(text):
    return struct.pack("<I", len(text)) + text


def garbage(random):
    """Bytes that no client of roscpp or XML-RPC sends."""
    header = b"".join(field(part) for part in (b"callerid=/x", b"topic=/traffic", b"type=*", b"md5sum=*"))
    call = b"<?xml version='1.0'?><methodCall><methodName>%s</methodName><params>%s</params></methodCall>"
    return random.choice([
        lambda: random.randbytes(random.randrange(1, 4000)),
        lambda: struct.pack("<I", random.choice([0, 1, 10**9 - 1, 2**31 - 1, 2**32 - 1])) + random.randbytes(64),
        lambda: struct.pack("<I", len(header)) + header[:random.randrange(len(header))],
        lambda: struct.pack("<I", 8) + struct.pack("<I", random.choice([4, 2**31, 2**32 - 1])) + b"abcd",
        lambda: b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n" % random.choice([-5, 0, 2**31 - 1, 10**12]) + random.randbytes(200),
        lambda: b"POST / HTTP/1.1\r\nContent-Length: 100000\r\n\r\n" + call % (b"publisherUpdate", b"<param>" * random.randrange(300)),
        lambda: (body := call % (b"requestTopic", b"<param><value><i4>%d</i4></value></param>" % random.randrange(2**40)))
        and b"POST / HTTP/1.1\r\nContent-Length: %d\r\n\r\n" % len(body) + body,
        lambda: b"GET /" + b"a" * random.randrange(100000) + b" HTTP/1.0\r\n\r\n",
    ])()


def connect(program, port, data):
    try:
        connection = socket.create_connection(("127.0.0.1", port), timeout=10)
    except OSError as error:
        return f"port {port} does not listen any more ({error})"
    try:
        with connection:
            connection.sendall(data)
            connection.settimeout(0.05)
            connection.recv(100)
    except OSError:
        pass  # closed or not answered, as it may be
    return None if program.process.poll() is None else f"the session ended: {program.text()[-300:]}"


def trials(random, count):
    with Folder() as folder, RosMaster(folder) as master:  # an open session, as with nodes of a user's own
        program = Program([ROOT / "scripts" / "session", *SESSION, f"results:={folder / 'r'}"], folder, E2E_CDIFF_MASTER=master.uri)
        program.find("traffic_simulator_node")
        program.wait_for((folder / "r" / ".reserve").exists, "the session's first tick")
        open_ports = ports(program)
        for index in range(count - 1):
            port = open_ports[index % len(open_ports)]
            yield f"port {index % len(open_ports)} of {len(open_ports)}", lambda port=port: connect(program, port, garbage(random))
        program.process.terminate()
        yield "the session goes on until it is stopped", lambda: misbehavior(program, program.end(60), {130})


GATE = Gate("malformed_connections", "bytes that no client sends to every port of a session's nodes: the session goes on", 1000, trials)
