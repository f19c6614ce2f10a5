"""A page of a watched session, as its server sees it."""
import base64
import json
import os
import socket
import struct


class PageSocket:
    """The socket of a live page, without a browser."""

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
        self.bytes = self.asked = 0

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

    def message(self):
        """The next one."""
        while True:
            kind, content = self.next()
            if kind == 9:
                self.frame(0xA, content, bytes(4))
            if kind == 1:
                return content

    def ask(self, command):
        """Why the session refuses a command; empty: it does not."""
        self.asked += 1
        self.send({"id": self.asked, **command})
        while True:
            for answer in json.loads(self.message()).get("answers", []):
                return answer["refused"]

    def wait_for_end(self):
        """Takes all that comes, then the report."""
        while b'"over":' not in self.message():
            pass
        with self.connect() as report:
            self.request(report, f"GET {self.path}report.html HTTP/1.1\r\nHost: {self.host}\r\n\r\n")
            text = b""
            while data := report.recv(1 << 20):
                text += data
        self.socket.close()
        return text.decode()
