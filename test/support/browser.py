"""Chromium without a window, driven through a pipe by its DevTools protocol."""
import base64
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
from pathlib import Path

PROGRAMS = ("chromium", "chromium-browser", "google-chrome")


def program():
    """Path of the browser; None where none is installed."""
    return next((path for path in map(shutil.which, PROGRAMS) if path), None)


class Browser:
    """One page of a browser that keeps nothing. Use it in a `with`."""

    def __init__(self, width=1300, height=900):
        self.folder = tempfile.TemporaryDirectory(prefix="e2e_cdiff_browser_")
        to_browser, self.to = os.pipe()
        self.come, from_browser = os.pipe()

        def connect():  # the browser reads descriptor 3 and writes 4
            first, second = os.dup(to_browser), os.dup(from_browser)
            os.dup2(first, 3)
            os.dup2(second, 4)

        self.process = subprocess.Popen(
            [program(), "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars", f"--user-data-dir={self.folder.name}",
             f"--window-size={width},{height}", "--remote-debugging-pipe", "about:blank"],
            preexec_fn=connect, close_fds=False, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)  # noqa: PLW1509
        os.close(to_browser)
        os.close(from_browser)
        self.number, self.rest, self.session = 0, b"", None
        targets = self.ask("Target.getTargets")["targetInfos"]
        page = next(target["targetId"] for target in targets if target["type"] == "page")
        self.session = self.ask("Target.attachToTarget", targetId=page, flatten=True)["sessionId"]
        self.ask("Page.enable")
        self.size(width, height)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end_processes()
        os.close(self.to)
        os.close(self.come)
        self.folder.cleanup()

    def end_processes(self):
        """Ends the browser and its helpers, which still write into the folder when it is gone."""
        try:
            while True:
                os.killpg(self.process.pid, signal.SIGKILL)
                self.process.wait()
                time.sleep(0.05)
        except ProcessLookupError:
            pass

    def message(self):
        while b"\0" not in self.rest:
            data = os.read(self.come, 1 << 20)
            if not data:
                raise RuntimeError("the browser has ended")
            self.rest += data
        text, _, self.rest = self.rest.partition(b"\0")
        return json.loads(text)

    def ask(self, method, **parameters):
        self.number += 1
        call = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            call["sessionId"] = self.session
        os.write(self.to, json.dumps(call).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") != self.number:
                continue
            if "error" in answer:
                raise RuntimeError(f"{method}: {answer['error']['message']}")
            return answer["result"]

    def size(self, width, height):
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 600)

    def dark(self, wanted):
        self.ask("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if wanted else "light"}])

    def open(self, address):
        self.ask("Page.navigate", url=address)

    def value(self, expression):
        """Of an expression of JavaScript in the page."""
        answer = self.ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{expression}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def wait(self, expression, seconds=60):
        """Until an expression is true; errors are taken for false while a page loads."""
        end = time.monotonic() + seconds
        while True:
            try:
                if self.value(f"Boolean({expression})"):
                    return
            except RuntimeError:
                if self.process.poll() is not None:
                    raise
            if time.monotonic() > end:
                raise TimeoutError(f"never true: {expression}")
            time.sleep(0.05)

    def click(self, element):
        self.value(f"document.getElementById('{element}').click()")

    def choose(self, element, value):
        """Gives a control another value, as its user does."""
        self.value(f"(() => {{ const it = document.getElementById('{element}'); it.value = {json.dumps(value)};"
                   " it.dispatchEvent(new Event('input', { bubbles: true })); it.dispatchEvent(new Event('change', { bubbles: true })); })()")

    def picture(self, file, whole=False):
        taken = self.ask("Page.captureScreenshot", format="png", captureBeyondViewport=whole,
                         **({"clip": {**self.ask("Page.getLayoutMetrics")["cssContentSize"], "scale": 1}} if whole else {}))
        Path(file).write_bytes(base64.b64decode(taken["data"]))
