"""Efficiency of 1 to 1,000 workers, by the run times of stored campaigns:
efficiency.py RESULTS.json[.gz]... Longest case first, as submit splits."""

import gzip
import heapq
import json
import sys


def seconds_of_cases(paths):
    cases = {}
    for path in paths:
        opened = gzip.open if path.endswith(".gz") else open
        with opened(path) as f:
            for b in json.load(f)["benchmarks"]:
                p = b["physinv"]
                # Version 1 had milliseconds, and a time where none counted.
                solving = (b.get("real_time") or 0) * \
                    (1e-6 if b["time_unit"] == "ns" else 1)
                ms = [solving, p["setup_ms"], p["warmup_ms"],
                      p.get("data_ms"), p["measure_ms"]]
                name = path + b["name"].rsplit("/", 1)[0]
                cases[name] = cases.get(name, 0) + sum(m or 0 for m in ms) / 1e3
    return sorted(cases.values(), reverse=True)


def makespan(seconds, workers):
    load = [0.0] * workers
    for s in seconds:
        heapq.heapreplace(load, load[0] + s)
    return max(load)


seconds = seconds_of_cases(sys.argv[1:])
print(f"{len(seconds)} cases, {sum(seconds):.0f} s, longest {seconds[0]:.0f} s")
print("| workers | time | efficiency |\n| ---: | ---: | ---: |")
for workers in (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1000):
    t = makespan(seconds, workers)
    print(f"| {workers} | {t:.0f} s | {100 * sum(seconds) / t / workers:.1f} % |")
