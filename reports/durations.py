"""Times and buffers of the published campaigns' stages, as `plan` takes them:

  python3 reports/durations.py PROGRAM [--check]

writes reports/published/durations.csv; with --check it only compares that file
with the campaigns, and says how many stages it predicts within a factor of two.
"""

import csv
import glob
import gzip
import io
import json
import math
import os
import statistics
import subprocess
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
TABLE = os.path.join(HERE, "published", "durations.csv")
COLUMNS = ["experiment", "method", "stage", "n", "operations", "seconds",
           "least", "most", "bytes"]
UNITS = {"s": 1, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
# What is over at once measures starts, not operations.
SHORTEST = 0.02


def counted(program):
    """Operations of every stage that a profile has."""
    known = {}
    for profile in ("smoke", "quick", "standard", "paper", "study", "long"):
        p = subprocess.run([program, "list", "--json", "--profile=" + profile],
                           capture_output=True, text=True, timeout=120)
        for case in json.loads(p.stdout) if p.returncode == 0 else []:
            for stage in case["stages"]:
                name = case["name"] + "/" + stage["name"]
                key = name, stage["iterations"]
                known.setdefault(name, {})[key] = stage["operations"]
    return known


def published(operations):
    """(kind, n, operations) -> [(seconds, bytes)] of each stored stage whose
    operations are known without doubt."""
    found = {}
    for path in sorted(glob.glob(os.path.join(HERE, "campaigns", "*",
                                              "results.json.gz"))):
        with gzip.open(path) as f:
            stages = json.load(f)["benchmarks"]
        for b in stages:
            own = operations.get(b["name"], {})
            if b.get("cpu_time") is None or not own:
                continue
            p = b["physinv"]
            profiled = [o for (_, i), o in own.items() if i == b["iterations"]]
            ops = profiled[0] if profiled else max(own.values())
            seconds = b["cpu_time"] * UNITS[b["time_unit"]] + 1e-3 * sum(
                p.get(k) or 0 for k in ("setup_ms", "warmup_ms", "measure_ms",
                                        "data_ms"))
            key = (p["experiment"], p["method"], p["stage"], p["n"],
                   float(f"{ops:.3g}"))
            found.setdefault(key, []).append((seconds,
                                              p["peak_buffer_bytes"]))
    return found


def table(found):
    out = io.StringIO()
    write = csv.writer(out, lineterminator="\n")
    write.writerow(COLUMNS)
    for key, runs in sorted(found.items()):
        seconds = [r[0] for r in runs]
        write.writerow([*key[:4], f"{key[4]:.3g}",
                        *(f"{x:.3g}" for x in (statistics.median(seconds),
                                               min(seconds), max(seconds))),
                        max(r[1] for r in runs)])
    return out.getvalue()


def told(found, key, others):
    """By the nearest row of the same kind, as durations.cpp has it."""
    near = [(abs(math.log(k[4] / key[4])), k) for k in others
            if k[:3] == key[:3] and k[4] > 0]
    if not near or min(near)[0] > math.log(4):
        return None
    row = min(near)[1]
    return statistics.median(r[0] for r in found[row]) * key[4] / row[4]


def shares(found):
    """Of all stored stages, and of those predicted by others' rows alone."""
    kinds = {}
    for key in found:
        kinds.setdefault(key[:3], []).append(key)
    for what in ("from its own row", "from rows of other sizes alone"):
        within = known = stages = 0
        for key, runs in found.items():
            if not key[4] > 0:
                continue
            others = [k for k in kinds[key[:3]]
                      if what == "from its own row" or k != key]
            value = told(found, key, others)
            for seconds, _ in runs:
                if seconds < SHORTEST:
                    continue
                stages += 1
                if value is not None:
                    known += 1
                    within += seconds / 2 <= value <= 2 * seconds
        print(f"{what}: {within} of {known} stages within a factor of two "
              f"({100 * within / known:.0f} %), {stages - known} not known")
        yield within / known


def main():
    found = published(counted(sys.argv[1]))
    text = table(found)
    if "--check" not in sys.argv:
        with open(TABLE, "w") as f:
            f.write(text)
    with open(TABLE) as f:
        same = f.read() == text
    own, others = shares(found)
    if not same:
        print("durations.csv is not what the campaigns have; write it again")
    sys.exit(0 if same and own > 0.85 and others > 0.7 else 1)


main()
