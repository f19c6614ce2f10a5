#!/usr/bin/python3
"""The pages of the public API: every public declaration has a comment that Doxygen can read.

    api_docs.py BUILD SOURCE RESULT.xml
"""
import shutil
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

if not shutil.which("doxygen"):
    sys.exit(77)
begin = time.monotonic()
done = subprocess.run(["cmake", "--build", sys.argv[1], "--target", "docs"], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
print(done.stdout)
junit.write(sys.argv[3], "api_docs", [("public_api", time.monotonic() - begin, done.stdout[-3000:] if done.returncode != 0 else None)])
sys.exit(done.returncode != 0)
