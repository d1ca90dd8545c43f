"""Efficiency of 1 to 1,000 workers, by the run times of stored campaigns:
efficiency.py [--cores=N] RESULTS.json[.gz]... Longest case first, as submit
splits; a case takes the threads that it was measured with, one as a rule, and a
worker of N cores runs N cases at a time. A case that several campaigns have
counts once, by its longest run."""

import argparse
import gzip
import heapq
import json


def seconds_of_cases(paths):
    cases = {}
    for path in paths:
        here = {}
        opened = gzip.open if path.endswith(".gz") else open
        with opened(path) as f:
            for b in json.load(f)["benchmarks"]:
                p = b["physinv"]
                # Version 1 had milliseconds, and a time where none counted.
                solving = (b.get("real_time") or 0) * \
                    (1e-6 if b["time_unit"] == "ns" else 1)
                ms = [solving, p["setup_ms"], p["warmup_ms"],
                      p.get("data_ms"), p["measure_ms"]]
                name = b["name"].rsplit("/", 1)[0]
                here[name] = here.get(name, 0) + sum(m or 0 for m in ms) / 1e3
        for name, seconds in here.items():
            cases[name] = max(cases.get(name, 0), seconds)
    return sorted(cases.values(), reverse=True)


def makespan(seconds, workers):
    load = [0.0] * workers
    for s in seconds:
        heapq.heapreplace(load, load[0] + s)
    return max(load)


parser = argparse.ArgumentParser()
parser.add_argument("--cores", type=int, default=1)
parser.add_argument("results", nargs="+")
args = parser.parse_args()
seconds = seconds_of_cases(args.results)
print(f"{len(seconds)} cases, {sum(seconds):.0f} s, longest {seconds[0]:.0f} s")
print("| workers | time | efficiency |\n| ---: | ---: | ---: |")
for workers in (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1000):
    cores = workers * args.cores
    t = makespan(seconds, cores)
    print(f"| {workers} | {t:.0f} s | {100 * sum(seconds) / t / cores:.1f} % |")
