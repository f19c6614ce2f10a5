"""Print what live pages cost a session, as "figure value unit goal".

    scripts/benchmark watch [--pairs N] [--cbv-planner NAME]

Runs the same session by turns: unwatched, watched without a page, and with a page that takes everything. Each time is that of the whole
program; a figure is the median over the rounds of its time by that of the unwatched session beside it. All three must give the same trace.
"""
import argparse
import base64
import json
import os
import re
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import time
from pathlib import Path

GOAL = 5.0  # [%]


class Page:
    """The socket of a page, which throws away what it gets."""

    def __init__(self, address):
        host, _, path = address.removeprefix("http://").partition("/")
        self.host, self.path = host, "/" + path
        self.socket = self.connect()
        key = base64.b64encode(os.urandom(16)).decode()
        self.request(self.socket, f"GET {self.path}socket HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nUpgrade: websocket\r\n"
                                  f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n")
        self.rest = b""
        while b"\r\n\r\n" not in self.rest:
            self.rest += self.socket.recv(65536)
        self.rest = self.rest.partition(b"\r\n\r\n")[2]
        self.bytes = 0

    def connect(self):
        name, _, port = self.host.partition(":")
        return socket.create_connection((name, int(port)), timeout=60)

    @staticmethod
    def request(to, text):
        to.sendall(text.encode())

    def send(self, command):
        data, mask = json.dumps(command).encode(), os.urandom(4)
        self.frame(0x1, bytes(byte ^ mask[i % 4] for i, byte in enumerate(data)), mask)

    def frame(self, kind, masked, mask):
        self.socket.sendall(bytes([0x80 | kind, 0x80 | len(masked)]) + mask + masked)  # of less than 126 bytes

    def take(self, count):
        while len(self.rest) < count:
            data = self.socket.recv(1 << 20)
            if not data:
                raise ConnectionError("the server closed the page's socket")
            self.rest += data
        data, self.rest = self.rest[:count], self.rest[count:]
        self.bytes += count
        return data

    def next(self):
        """Kind and content of the next frame."""
        head = self.take(2)
        length = head[1] & 127
        if length >= 126:
            length = struct.unpack(">H", self.take(2))[0] if length == 126 else struct.unpack(">Q", self.take(8))[0]
        return head[0] & 15, self.take(length)

    def watch(self):
        """As fast as possible, to the end and the report."""
        self.send({"id": 1, "do": "pace", "value": "0"})
        while True:
            kind, content = self.next()
            if kind == 9:
                self.frame(0xA, content, bytes(4))
            if kind == 1 and b'"over":' in content:
                break
        with self.connect() as report:
            self.request(report, f"GET {self.path}report.html HTTP/1.1\r\nHost: {self.host}\r\n\r\n")
            while report.recv(1 << 20):
                pass
        self.socket.close()


def run(cdiff, arguments, folder, watched, paged):
    """Wall and processor time [s] of one session, its trace, and the bytes that its page took."""
    begin, taken = time.monotonic(), 0
    process = subprocess.Popen([cdiff, "run", *arguments, "--results", folder, "--overwrite", "--quiet", *(["--watch"] if watched else [])],
                               stderr=subprocess.PIPE, text=True)
    if watched:
        address = re.search(r"http://\S+/", process.stderr.readline()).group(0)
        page = Page(address)
        if paged:
            page.watch()
            taken = page.bytes
        else:
            page.send({"id": 1, "do": "pace", "value": "0"})
            time.sleep(0.05)
            page.socket.close()
    process.stderr.close()
    _, _, usage = os.wait4(process.pid, 0)
    wall = time.monotonic() - begin
    return wall, usage.ru_utime + usage.ru_stime, json.loads((Path(folder) / "summary.json").read_text())["trace_sha256"], taken


def main():
    parser = argparse.ArgumentParser(prog="scripts/benchmark watch")
    parser.add_argument("--pairs", type=int, default=5, help="rounds")
    parser.add_argument("--cbv-planner", default="pdm_lite", help="planner of the CBVs; a fast one has the highest share")
    options = parser.parse_args()
    cdiff = Path(os.environ.get("BUILD", "build")) / "devel/lib/e2e_cdiff/cdiff"
    arguments = ["crossing_left_turn", "--seed", "3", "--mode", "safety_critical", "--cbv-planner", options.cbv_planner]
    kinds = {"no_page": (True, False), "page": (True, True)}
    shares = {(kind, time_of): [] for kind in kinds for time_of in ("wall", "processor")}
    with tempfile.TemporaryDirectory() as scratch:
        for _ in range(options.pairs):
            plain = run(cdiff, arguments, scratch, False, False)
            for kind, how in kinds.items():
                watched = run(cdiff, arguments, scratch, *how)
                if watched[2] != plain[2]:
                    sys.exit(f"the trace with {kind} is another one")
                for i, time_of in enumerate(("wall", "processor")):
                    shares[kind, time_of].append(100.0 * (watched[i] / plain[i] - 1.0))
                if watched[3]:
                    taken = watched[3]
    for (kind, time_of), values in shares.items():
        goal = f"<= {GOAL:g}" if (kind, time_of) == ("page", "wall") else ""
        print(f"watch_{kind}_{time_of} {statistics.median(values):.1f} % {goal}".rstrip())
    print(f"watch_page_data {taken / 1e6:.2f} MB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
