#!/usr/bin/python3
"""Draw the sealed suites again and compare them with config/suites, byte by byte (docs/sealed_suites.md).

    redraw.py BUILD SOURCE RESULT.xml
"""
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

SOURCE, RESULT = Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve()
start = time.monotonic()
done = subprocess.run([SOURCE / "scripts" / "draw_sealed_suites", "--check"], capture_output=True, text=True, check=False)
fault = None if done.returncode == 0 else done.stdout + done.stderr
print(fault or "both suites are what their seeds give")
junit.write(RESULT, "sealed_suites_redrawn", [("EveryByteIsWhatItsSeedGives", time.monotonic() - start, fault)])
sys.exit(done.returncode)
