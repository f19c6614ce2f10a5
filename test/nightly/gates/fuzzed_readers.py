"""Readers of files from outside on bytes that libFuzzer makes, with address and undefined-behavior sanitizers."""
import os
import re
import shutil
import subprocess
from pathlib import Path

from gate import Gate
from programs import ROOT, Folder

BUILD = Path(os.environ["BUILD"]) / "fuzz"
RUNS = 10**5  # of one trial
FLAGS = "-O1 -g1 -fno-omit-frame-pointer -Wno-error -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined"
OFF = [f"-DE2E_CDIFF_{part}=OFF" for part in ("ROS", "TRAINING", "TESTS", "BENCHMARKS")]
# Of these readers; a scenario is also read from a file each time, which takes longer.
SHARES = {"safetensors": 1.0, "bag": 1.0, "scenario": 0.1}
SEEDS = {"safetensors": b'{"a":{"dtype":"F32","shape":[4,4],"data_offsets":[0,64]},"__metadata__":{"sha256":"00"}}',
         "scenario": (ROOT / "config" / "scenarios" / "roundabout_entry.yaml").read_bytes(), "bag": b"#ROSBAG V2.0\n"}


def build():
    subprocess.run(["cmake", "-S", ROOT, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None", "-DCMAKE_CXX_COMPILER=clang++",
                    "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache", "-DE2E_CDIFF_FUZZERS=ON", *OFF, f"-DCMAKE_CXX_FLAGS={FLAGS}"],
                   check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["ninja", "-C", BUILD, *(f"fuzz_{reader}" for reader in SHARES)], check=True, stdout=subprocess.DEVNULL)


def fuzz(reader, seed):
    """RUNS runs, or a share of them for a slow reader; what libFuzzer finds is kept beside the corpus."""
    corpus = BUILD / "corpus" / reader
    corpus.mkdir(parents=True, exist_ok=True)
    (corpus / "seed").write_bytes(SEEDS[reader])
    runs = round(RUNS * SHARES[reader])
    with Folder() as folder:
        done = subprocess.run([BUILD / "test" / "fuzz" / f"fuzz_{reader}", f"-runs={runs}", f"-seed={seed}", "-max_len=8192", "-timeout=10",
                               "-rss_limit_mb=2048", f"-artifact_prefix={corpus.parent}/{reader}_", corpus], cwd=folder, check=False,
                              capture_output=True, text=True, errors="replace", env={**os.environ, "E2E_CDIFF_SHARE": str(ROOT)})
    if done.returncode != 0:
        return done.stderr[-1500:]
    return None if re.search(rf"Done {runs} runs", done.stderr) else "fewer runs than asked for"


def trials(random, count):
    if not shutil.which("clang++"):
        raise RuntimeError("clang++ is not installed: apt-get install clang")
    build()
    for index in range(count):
        reader, seed = list(SHARES)[index % len(SHARES)], random.randrange(1, 2**31)
        yield f"{reader}, seed {seed}", lambda reader=reader, seed=seed: fuzz(reader, seed)


GATE = Gate("fuzzed_readers", "100,000 runs of libFuzzer on the reader of safetensors or bag records, or 10,000 on that of scenarios: "
            "no finding", 300, trials)
