#!/usr/bin/env python3
"""Attacks the program: accidents, damage and hostile input.

  attack.py PROGRAM                      all of it, half an hour
  attack.py PROGRAM --short              a part of each kind, a minute
  attack.py PROGRAM --only KIND          one kind
  attack.py PROGRAM --fake FAKE          also what stages may leave, by the
                                         program over the fake experiment
  attack.py PROGRAM --only KIND --seed N one attempt, told in full

Attempt N of a kind is always the same but for the moments of kills. Seeds that once
found something are in seeds.txt and come first. Ends with a table; exit 1 if anything
was found.
"""

import argparse
import os
import sys
import tempfile
import time
import traceback

import between
import campaigns
import cluster
import disks
import files
import kills
import lines
import links
import locks
import returns
import shards
import special
import stores
from world import Attempt, World, say

# name -> function, attempts or hits, the same of --short
KINDS = {
    "kills": (kills.kills, 300, 5),
    "signals": (kills.signals, 100, 4),
    "between": (between.between, 350, 5),
    "returns": (returns.returns, 300, 6),
    "disks": (disks.disks, 80, 5),
    "locks": (locks.locks, 15, 2),
    "flips": (files.flips, 1000, 32),
    "resealed": (files.reseal, 1000, 32),
    "lines": (lines.lines, 300, 36),
    "odd-toml": (campaigns.odd_toml, 1000, 24),
    "cluster": (cluster.cluster, len(cluster.ALL), 6),
    "shards": (shards.shards, len(shards.ALL), 24),
    "links": (links.links, len(links.ALL_LINKS), 16),
    "strangers": (links.strangers, 100, 12),
    "special": (special.inputs, len(special.INPUTS), 16),
    "targets": (special.outputs, len(special.OUTPUTS), 12),
}
HERE = os.path.dirname(os.path.abspath(__file__))


def stored_seeds():
    found = {}
    with open(os.path.join(HERE, "seeds.txt")) as f:
        for line in f:
            words = line.split("#")[0].split()
            if words:
                found.setdefault(words[0], []).extend(map(int, words[1:]))
    return found


def seeds_of(kind, count, arguments):
    if arguments.seed is not None:
        return [arguments.seed]
    first = stored_seeds().get(kind, [])
    return list(dict.fromkeys(first + list(range(count))))


def one(world, kind, function, seed):
    attempt = Attempt(world, kind, seed)
    try:
        function(attempt)
        attempt.close()
    except Exception:
        attempt.findings.append("the attack failed: " + traceback.format_exc())
    return attempt


def tell(attempt, arguments):
    program = arguments.program
    for what in attempt.findings:
        say(f"FOUND {attempt.kind} {attempt.seed}: {what}")
    if attempt.findings:
        say(f"  repeat: {sys.argv[0]} {program} --only {attempt.kind} "
            f"--seed {attempt.seed}")
    if attempt.findings or arguments.seed is not None:
        for line in attempt.log:
            say("    " + line)


class Progress:
    """A line at most every half minute: what there is and how long it takes."""

    def __init__(self, kind, count):
        self.kind, self.count = kind, count
        self.begin = self.said = time.monotonic()

    def show(self, row):
        now = time.monotonic()
        if now - self.said < 30:
            return
        self.said = now
        left = (now - self.begin) * (self.count / max(row["hits"], 1) - 1)
        say(f"{self.kind}: {row['hits']} of {self.count} hits, "
            f"{row['findings']} findings, about {max(left, 0):.0f} s to go")


def attack(world, kind, arguments):
    function, all_of_them, few = KINDS[kind]
    count = arguments.count or (few if arguments.short else all_of_them)
    begin = time.monotonic()
    row = {"tries": 0, "hits": 0, "survived": 0, "findings": 0, "skipped": 0}
    reasons = set()
    progress = Progress(kind, count)
    for seed in seeds_of(kind, count, arguments):
        if row["hits"] >= count:  # kills hit several times each
            break
        attempt = one(world, kind, function, seed)
        tell(attempt, arguments)
        row["tries"] += 1
        row["hits"] += attempt.hits
        row["findings"] += len(attempt.findings)
        row["survived"] += 0 if attempt.findings else attempt.hits
        if attempt.skipped:
            row["skipped"] += 1
            reasons.add(attempt.skipped)
        progress.show(row)
    row["seconds"] = round(time.monotonic() - begin)
    row["why"] = "; ".join(sorted(reasons))
    return row


def print_table(rows):
    names = ("tries", "hits", "survived", "findings", "skipped", "seconds")
    say(f"{'kind':<10}" + "".join(f"{name:>10}" for name in names))
    for kind, row in rows.items():
        say(f"{kind:<10}" + "".join(f"{row[name]:>10}" for name in names) +
            (f"  ({row['why']})" if row["why"] else ""))


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--short", action="store_true")
    parser.add_argument("--only", choices=KINDS, action="append")
    parser.add_argument("--seed", type=int)
    parser.add_argument("--fake", default="",
                        help="physinv-bench-fake, for `returns`")
    parser.add_argument("--count", type=int, help="attempts of each kind")
    arguments = parser.parse_args()
    rows = {}
    with tempfile.TemporaryDirectory(prefix="attack-") as root:
        world = World(arguments.program, root, arguments.short, arguments.fake)
        stores.make(world)
        for kind in arguments.only or KINDS:
            rows[kind] = attack(world, kind, arguments)
    print_table(rows)
    sys.exit(1 if any(row["findings"] for row in rows.values()) else 0)


if __name__ == "__main__":
    main()
