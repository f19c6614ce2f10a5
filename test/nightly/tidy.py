#!/usr/bin/python3
"""clang-tidy, with the list of .clang-tidy, on every source that is compiled.

    tidy.py BUILD SOURCE RESULT.xml
"""
import os
import subprocess
import sys
from pathlib import Path

BUILD, SOURCE, RESULT = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve()
sys.exit(subprocess.run(["/usr/bin/python3", SOURCE / "scripts/check", "--tidy", "--all", "--junit", RESULT],
                        env={**os.environ, "BUILD": str(BUILD)}, check=False).returncode)
