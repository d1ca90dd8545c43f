#!/usr/bin/env python3
"""beside_pytorch.py PEERS: times of this suite next to PyTorch programs of the same
experiments, as the table of docs/performance.md.

PEERS is a folder of programs <id>_torch.py, each of which prints one JSON object with
the seconds of its methods. Both sides make the same updates (rows.py), in turn, on one
core and one thread; of so many times each the fastest counts. Drawing of training
examples is in neither. To be run by a Python that has torch.

Operations are those that the suite declares (./bench list --format=json), the limit is
machine/fma of the same minute, bytes are counted from shapes (nets.py).
"""

import argparse
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import time

from rows import ROWS, SETS

HERE = os.path.dirname(os.path.abspath(__file__))
BUILD = {"avx512": "release", "avx2": "v3"}
# OpenBLAS 0.3.21 takes SSE3 on processors that are newer than itself.
TORCH = {"avx512": {"ATEN_CPU_CAPABILITY": "avx512", "OPENBLAS_CORETYPE": "SkylakeX"},
         "avx2": {"ATEN_CPU_CAPABILITY": "avx2", "ONEDNN_MAX_CPU_ISA": "AVX2",
                  "OPENBLAS_CORETYPE": "Haswell"}}
CLOCKS = ("cpu", "wall")
# The C library keeps its memory: a first touch of a page may cost more than the sums.
KEPT = {"MALLOC_MMAP_MAX_": "0", "MALLOC_TRIM_THRESHOLD_": str(1 << 32),
        "MALLOC_TOP_PAD_": str(1 << 26)}
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def output(command, environment=None):
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True)
    if done.returncode != 0:
        sys.exit(f"status {done.returncode} of {' '.join(command)}")
    return done.stdout


class Machine:
    """Both sides on one core."""

    def __init__(self, options):
        build = os.path.join(HERE, "../../build", BUILD[options.isa])
        self.program = os.path.join(build, "physinv-bench")
        self.kernels = os.path.join(build, "physinv-kernels")
        self.on_core = ["taskset", "-c", str(options.core)]
        self.peers = options.peers
        self.own = {k: v for k, v in os.environ.items()
                    if not k.startswith("OPENBLAS_")} | KEPT
        self.torch = self.own | dict.fromkeys(THREADS, "1") | TORCH[options.isa]

    def limit(self):
        """FLOP/s in float and in double."""
        said = json.loads(output(self.on_core + [
            self.kernels, "--benchmark_filter=^machine/fma", "--benchmark_min_time=0.1",
            "--benchmark_format=json"]))
        return [b["FLOPS"] for b in said["benchmarks"]]

    def ours(self, row):
        """Seconds and operations of what the row is about."""
        experiment, method, stage = row.ours.rsplit("/", 2)
        selection = [f"--profile={row.profile}", f"--filter=^{experiment}/{method}/",
                     f"--seeds={row.seeds}"]
        selection += [f"--set={key}={value}" for key, value in row.settings.items()]
        last = int(row.seeds[-1])
        with tempfile.TemporaryDirectory() as out:
            output(self.on_core + [self.program, "run", *selection, "--quiet", "--jobs=1",
                                   "--no-report", f"--out={out}"], self.own)
            with open(os.path.join(out, "results.json")) as file:
                stages = [b for b in json.load(file)["benchmarks"]
                          if b["physinv"]["stage"] == stage
                          and b["physinv"]["seed"] == last]
        cases = json.loads(output([self.program, "list", *selection, "--format=json"]))
        return {"wall": sum(b["real_time"] for b in stages) * 1e-9,
                "cpu": sum(b["cpu_time"] for b in stages) * 1e-9,
                "operations": sum(s["operations"] for c in cases for s in c["stages"]
                                  if s["name"] == stage and c["seed"] == last),
                "double": stages[0]["physinv"]["precision"] == "f64"}

    def theirs(self, rows):
        """Of rows of one run."""
        peer, *flags = rows[0].theirs.split()
        said = json.loads(output(self.on_core + [
            sys.executable, os.path.join(HERE, "peer.py"),
            os.path.join(self.peers, peer + "_torch.py"), "--threads=1", *flags],
            self.torch).splitlines()[-1])
        methods = said.get("methods") or {r["method"]: r for r in said["results"]}
        found = [methods[row.key] for row in rows]
        return [f.get("seconds") or f["wall_s"] for f in found]


# ---- measurements ------------------------------------------------------------


def measure(options, rows, store):
    """Group by group, as one run of a PyTorch program may have several rows."""
    machine, start = Machine(options), time.monotonic()
    groups = {}
    for row in rows:
        groups.setdefault(row.theirs, []).append(row)
    for group in groups.values():
        known = [store.setdefault(options.isa, {}).setdefault(row.name, [])
                 for row in group]
        while min(map(len, known)) < options.times:
            if time.monotonic() - start > options.within:
                return
            once(machine, group, known)
            with open(options.resume, "w") as file:
                json.dump(store, file, indent=1)


def once(machine, group, known):
    limit, ours = machine.limit(), [machine.ours(row) for row in group]
    theirs = [machine.theirs(rows) for rows in zip(*[row.lengths() for row in group])]
    for k, row in enumerate(group):
        known[k].append({"limit": limit, "ours": ours[k],
                         "theirs": [seconds[k] for seconds in theirs]})
        pair = Pair(row, known[k], "cpu")
        print(f"{row.name}: {pair.ours:.3g} s, {pair.theirs:.3g} s", file=sys.stderr)


class Pair:
    """A row's fastest runs by one clock."""

    def __init__(self, row, runs, clock):
        self.row = row
        one = min((run["ours"] | {"limit": run["limit"]} for run in runs),
                  key=lambda ours: ours[clock])
        lengths = [min(seconds[clock] for seconds in length)
                   for length in zip(*[run["theirs"] for run in runs])]
        self.ours = one[clock] / row.per
        self.theirs = (lengths[-1] - sum(lengths[:-1])) / row.per
        self.ratio = self.theirs / self.ours
        flop = one["operations"] / row.per
        self.flop = flop / row.updates if row.counted else None
        self.share = flop / self.ours / one["limit"][one["double"]] \
            if row.counted else None
        self.at_the_limit = self.ratio / self.share if row.net else self.ratio
        self.bytes = row.net and row.net.numbers() * (8 if one["double"] else 4)
        self.rate = row.net and self.bytes * row.updates / self.ours


# ---- the table ---------------------------------------------------------------

HEAD = ("experiment", "row", "ours, ms", "PyTorch, ms", "ratio", "GFLOP", "of the limit",
        "ratio at the limit", "MB", "GB/s", "AVX2: ours, ms", "PyTorch, ms", "ratio")


def text(number, unit=1.0):
    if number is None:
        return ""
    number /= unit
    return f"{number:.0f}" if number >= 1000 else f"{float(f'{number:.3g}'):g}"


def times(pair):
    return [text(pair.ours, 1e-3), text(pair.theirs, 1e-3), text(pair.ratio)] \
        if pair else ["", "", ""]


def line(row, wide, narrow, is_first):
    counts = [""] * 5
    if wide and row.counted:
        counts = [text(wide.flop, 1e9), f"{100 * wide.share:.0f} %",
                  text(wide.at_the_limit if row.net else None), text(wide.bytes, 1e6),
                  text(wide.rate, 1e9)]
    return [row.experiment if is_first else "", row.label, *times(wide), *counts,
            *times(narrow)]


def print_table(store, rows, clock):
    pairs = {isa: {row.name: Pair(row, store[isa][row.name], clock) for row in rows
                   if store.get(isa, {}).get(row.name)} for isa in BUILD}
    print("| " + " | ".join(HEAD) + " |")
    print("| --- | --- |" + " ---: |" * (len(HEAD) - 2))
    last = None
    for row in rows:
        cells = line(row, *[pairs[isa].get(row.name) for isa in BUILD],
                     row.experiment != last)
        last = row.experiment
        print("| " + " | ".join(cells) + " |")
    for isa in BUILD:
        for label, within in SETS.items():
            print_means(isa, label, [p for p in pairs[isa].values() if within(p.row)])


def print_means(isa, label, pairs):
    """And what it were with every network at the limit."""
    def mean(ratios):
        return math.exp(sum(map(math.log, ratios)) / len(ratios))
    if pairs:
        print(f"{isa}, {label}: {len(pairs)} rows, {mean([p.ratio for p in pairs]):.3g}, "
              f"with networks at the limit {mean([p.at_the_limit for p in pairs]):.3g}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("peers", metavar="PEERS", help="folder of <id>_torch.py")
    parser.add_argument("--isa", choices=BUILD, default="avx512")
    parser.add_argument("--rows", default="", help="expression of 'experiment: row'")
    parser.add_argument("--times", type=int, default=3, help="of each side")
    parser.add_argument("--core", type=int, default=0)
    parser.add_argument("--clock", choices=CLOCKS, default="cpu")
    parser.add_argument("--resume", default="beside_pytorch.json",
                        help="measurements, to go on with")
    parser.add_argument("--within", type=float, default=math.inf,
                        help="begin no more after so many seconds")
    options = parser.parse_args()
    store = {}
    if os.path.exists(options.resume):
        with open(options.resume) as file:
            store = json.load(file)
    measure(options, [r for r in ROWS if re.search(options.rows, r.name)], store)
    print_table(store, ROWS, options.clock)


if __name__ == "__main__":
    main()
