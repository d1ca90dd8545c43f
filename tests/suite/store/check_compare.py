"""check_compare.py A B: Google Benchmark's compare.py reads both, shows the
stages that have a time in both, with digits, and no gain for any other."""

import json
import os
import subprocess
import sys
import tempfile

TOOL = "/usr/share/benchmark/compare.py"

# What it takes of SciPy and NumPy, where these are not installed.
STANDINS = {
    "scipy/stats.py": """
def mannwhitneyu(*args, **kwargs):
    raise NotImplementedError
def gmean(rows):
    product = [1.0, 1.0]
    for row in rows:
        product = [p * r ** (1 / len(rows)) for p, r in zip(product, row)]
    return Pair(product)
class Pair(list):
    def any(self):
        return any(self)
""",
    "scipy/__init__.py": "",
    "numpy.py": "from scipy.stats import Pair as array\n",
}


def compared(first, second):
    """What the tool prints."""
    try:
        import numpy  # noqa: F401
        import scipy  # noqa: F401
        found = True
    except ImportError:
        found = False
    with tempfile.TemporaryDirectory() as folder:
        if not found:
            os.mkdir(os.path.join(folder, "scipy"))
            for name, text in STANDINS.items():
                with open(os.path.join(folder, name), "w") as file:
                    file.write(text)
        done = subprocess.run(
            [sys.executable, TOOL, "--no-utest", "--no-color", "benchmarks",
             first, second],
            env={**os.environ, "PYTHONPATH": folder}, capture_output=True,
            text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def entries_of(path):
    with open(path, encoding="utf-8") as file:
        return {b["name"]: b for b in json.load(file)["benchmarks"]}


def main(first, second):
    text = compared(first, second)
    print(text)
    lines = {line.split()[0]: line.split()[1:] for line in text.splitlines()
             if "/" in line.split(" ")[0]}
    old, new = entries_of(first), entries_of(second)
    errors = 0
    for name in old.keys() | new.keys():
        timed = all(name in b and "real_time" in b[name] for b in (old, new))
        assert (name in lines) == timed, name
        errors += not timed
        if timed:
            digits = [float(v) for v in lines[name][2:]]
            assert all(v >= 1 for v in digits), lines[name]
    assert lines and errors, "stages with and without a time in both"


if __name__ == "__main__":
    if not os.path.exists(TOOL):
        print("skipped: libbenchmark-tools is not installed")
        sys.exit(77)
    main(*sys.argv[1:3])
