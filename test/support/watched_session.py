"""A session of `cdiff run --watch`, with the address of its page."""
import re
import subprocess
import time


class WatchedSession:
    """Runs until its page ends it; kills it at the end of a `with`."""

    def __init__(self, cdiff, arguments, log):
        self.log = log
        with open(log, "w") as output:
            self.process = subprocess.Popen([cdiff, "run", *arguments, "--watch"], stdout=output, stderr=output)
        self.address = self.wait_for_address()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def wait_for_address(self, seconds=60):
        end = time.monotonic() + seconds
        while time.monotonic() < end and self.process.poll() is None:
            found = re.search(r"http://127\.0\.0\.1:\d+/[0-9a-f]{32}/", self.log.read_text())
            if found:
                return found.group(0)
            time.sleep(0.05)
        raise RuntimeError(f"no address was printed: {self.log.read_text()}")
