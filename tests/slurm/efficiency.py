"""Efficiency of 1 to 1,000 workers, by the run times of stored campaigns:
efficiency.py [--cores=N] [--parallel=[PREFIX:]P]... RESULTS.json[.gz]...
Longest case first, as submit splits; a case takes the threads that it was
measured with, one as a rule, and a worker of N cores runs N cases at a time. A
case that several campaigns have counts once, by its longest run.

With --parallel, a second table: once no case of a worker waits, its free cores
go to its running cases, as with run --share-cores. More threads speed up the
share P of a case (Amdahl); a PREFIX of names has its own P, the last that fits
counts. What saving a state and continuing from it takes is left out."""

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
    return cases


def share_of(name, shares):
    fitting = [p for prefix, p in shares if name.startswith(prefix)]
    return fitting[-1] if fitting else 0.0


class Running:
    def __init__(self, seconds, share):
        self.left, self.share, self.threads = seconds, share, 1

    def speed(self):
        return 1 / (1 - self.share + self.share / self.threads)

    def need(self):
        return self.left / self.threads


def time_of_worker(cases, cores, shares):
    """Of (seconds, name), longest first; seconds that all of them take."""
    waiting = iter(cases)
    running = [Running(s, share_of(name, shares))
               for _, (s, name) in zip(range(cores), waiting)]
    now = 0.0
    while running:
        free = cores - sum(r.threads for r in running)
        able = [r for r in running if r.share > 0]
        for _ in range(free if able else 0):
            max(able, key=Running.need).threads += 1
        step = min(r.left / r.speed() for r in running)
        now += step
        for r in running:
            r.left -= step * r.speed()
        running = [r for r in running if r.left > 1e-9]
        free = cores - sum(r.threads for r in running)
        running += [Running(s, share_of(name, shares))
                    for _, (s, name) in zip(range(free), waiting)]
    return now


def makespan(cases, workers, cores, shares):
    load = [(0.0, w) for w in range(workers)]
    own = [[] for _ in range(workers)]
    for seconds, name in cases:
        least, w = load[0]
        own[w].append((seconds, name))
        heapq.heapreplace(load, (least + seconds, w))
    return max(time_of_worker(mine, cores, shares) for mine in own if mine)


def parallel(text):
    prefix, _, share = text.rpartition(":")
    return prefix, float(share)


parser = argparse.ArgumentParser()
parser.add_argument("--cores", type=int, default=1)
parser.add_argument("--parallel", type=parallel, action="append", default=[])
parser.add_argument("results", nargs="+")
args = parser.parse_args()
cases = sorted(((s, name) for name, s in seconds_of_cases(args.results).items()),
               reverse=True)
total = sum(s for s, _ in cases)
print(f"{len(cases)} cases, {total:.0f} s, longest {cases[0][0]:.0f} s")
for title, shares in [("", [])] + [("free cores shared", args.parallel)] * \
        bool(args.parallel):
    print(title and f"\n{title}:")
    print("| workers | time | efficiency |\n| ---: | ---: | ---: |")
    for workers in (1, 2, 4, 8, 16, 32, 64, 128, 256, 512, 1000):
        t = makespan(cases, workers, args.cores, shares)
        share = 100 * total / t / workers / args.cores
        print(f"| {workers} | {t:.0f} s | {share:.1f} % |")
