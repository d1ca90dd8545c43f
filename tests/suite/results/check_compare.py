"""check_compare.py A B: Google Benchmark's compare.py reads both."""

import json
import os
import subprocess
import sys

TOOL = "/usr/share/benchmark/compare.py"
try:
    import numpy  # noqa: F401, what the tool imports
    import scipy  # noqa: F401
except ImportError:
    print("skipped: python3-numpy or python3-scipy is not installed")
    sys.exit(77)
if not os.path.exists(TOOL):
    print("skipped: libbenchmark-tools is not installed")
    sys.exit(77)

done = subprocess.run(
    [sys.executable, TOOL, "--no-color", "benchmarks", *sys.argv[1:3]],
    capture_output=True,
    text=True,
    check=False,
)
print(done.stdout, done.stderr)
assert done.returncode == 0, "compare.py fails"
with open(sys.argv[1], encoding="utf-8") as file:
    for entry in json.load(file)["benchmarks"]:
        assert entry["name"] in done.stdout, entry["name"]
