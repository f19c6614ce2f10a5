#!/usr/bin/python3
"""Steer a session by its live page in Chromium, as a person does, and repeat what was steered (docs/watch.md).

    live_page.py BUILD SOURCE RESULT.xml
"""
import json
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import browser  # noqa: E402
import junit  # noqa: E402
from watched_session import WatchedSession  # noqa: E402

BUILD, RESULT = Path(sys.argv[1]).resolve(), Path(sys.argv[3]).resolve()
CDIFF = str(BUILD / "devel/lib/e2e_cdiff/cdiff")
SESSION = ["crossing_left_turn", "--seed", "3", "--set", "protocol.time_limit=9", "--quiet"]


def text_of(element):
    return f"document.getElementById('{element}').textContent"


def steer(page, address):
    """Pauses, steps, steers, resumes; returns when the page has become the report."""
    page.open(address)
    page.wait(f"document.getElementById('now') && parseFloat({text_of('now')}) > 2")
    page.click("play")
    page.wait(f"{text_of('headline')} === 'Paused'")
    before = float(page.value(f"parseFloat({text_of('now')})"))
    page.choose("ticks", "20")
    page.click("step")
    page.wait(f"Math.abs(parseFloat({text_of('now')}) - {before} - 1) < 0.001")
    page.choose("profile", "safety_critical")
    page.choose("speed", "11")
    page.wait(f"{text_of('said')}.includes('target_speed 11')")
    page.choose("vehicle", "nobody")
    page.value("document.getElementById('choose').disabled = false")
    page.click("choose")
    page.wait(f"{text_of('said')}.startsWith('Refused: choose: vehicle')")
    page.click("step")
    page.wait("document.getElementById('changes').tBodies[0].rows.length === 2")
    page.choose("pace", "0")
    page.click("play")
    page.wait("document.title.endsWith('session report')", 120)
    if "Not judged" not in page.value("document.querySelector('.banner').textContent"):
        raise AssertionError("the report does not say that the session was steered by hand")


def summary(folder):
    return json.loads((Path(folder) / "summary.json").read_text())


def check(scratch):
    by_hand, again = str(scratch / "by_hand"), str(scratch / "again")
    with WatchedSession(CDIFF, [*SESSION, "--results", by_hand], scratch / "log") as session, browser.Browser() as page:
        steer(page, session.address)
        session.process.wait(60)
    subprocess.run([CDIFF, "run", *SESSION, "--steering", by_hand, "--results", again], check=False, capture_output=True)
    what = [change["what"] for change in summary(by_hand)["steering"]["changes"]]
    if what != ["profile", "target_speed"]:
        raise AssertionError(f"what was steered: {what}")
    if summary(by_hand)["trace_sha256"] != summary(again)["trace_sha256"]:
        raise AssertionError("the repeated session has another trace")


def main():
    if browser.program() is None:
        print("chromium is not installed; on Debian: apt-get install chromium")
        return 77
    start, fault = time.monotonic(), None
    scratch = Path(tempfile.mkdtemp())
    try:
        check(scratch)
    except (AssertionError, RuntimeError, TimeoutError, OSError, subprocess.SubprocessError) as error:
        fault = repr(error)
    shutil.rmtree(scratch)
    print(fault or "steered by the page, and repeated to the same bytes")
    junit.write(RESULT, "live_page", [("SteersAndRepeatsToTheSameBytes", time.monotonic() - start, fault)])
    return 1 if fault else 0


if __name__ == "__main__":
    sys.exit(main())
