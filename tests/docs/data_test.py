#!/usr/bin/env python3
"""data_test.py PROGRAM SOURCES WORK: docs/data.md names what the files have, no
more and no less, with the right shapes."""

import glob
import json
import os
import re
import shutil
import subprocess
import sys

try:
    import h5py
except ImportError:
    print("skipped: python3-h5py is missing")
    sys.exit(77)

PROGRAM, SOURCES, WORK = sys.argv[1:4]
FILTER = "^jpo/robotic-arm/|^hig/toy-gamma-1/(adam|hig)/"


def page():
    with open(os.path.join(SOURCES, "docs/data.md")) as f:
        return f.read()


def names(section, first):
    """Names in the first column of the table whose head begins so."""
    table = section.split(f"| {first}", 1)[1].split("\n\n")[0]
    found = []
    for row in table.splitlines()[2:]:
        found += re.findall(r"`([^`]+)`", row.split("|")[1])
    return set(found)


def data_sets(path):
    """Name, as the page has it, to the shapes of all that go by it."""
    found = {}

    def visit(name, item):
        if isinstance(item, h5py.Dataset):
            name = re.sub(r"^stages/\d+_\w+", "stages/<position>_<stage>", name)
            name = re.sub(r"arrays/\w+$", "arrays/<name>", name)
            found.setdefault(name, []).append(item.shape)
    with h5py.File(path) as f:
        f.visititems(visit)
        attributes = {"case": set(f.attrs), "data": set(f["data"].attrs),
                      "stages": set().union(*(set(s.attrs) for s in
                                              f["stages"].values()))}
    return found, attributes


def shapes_are(path, shapes):
    n, unknowns = shapes["data/y"][0][0], None
    stage = "stages/<position>_<stage>/"
    for x in shapes[stage + "x"]:
        unknowns = x[1]
        yield x[0] <= n
    for name in ("loss", "iterations", "evaluations"):
        yield all(s == (1, n) for s in shapes[stage + name])
    yield all(s == (n,) for s in shapes[stage + "status"])
    for i, (p,) in enumerate(shapes[stage + "curve/iteration"]):
        yield shapes[stage + "curve/seconds"][i] == (p,)
        yield shapes[stage + "curve/evaluations"][i] == (p,)
        yield shapes[stage + "curve/loss"][i][0] == p
        yield shapes[stage + "curve/x"][i][0] == p
        yield shapes[stage + "curve/x"][i][1] % unknowns == 0


def main():
    shutil.rmtree(WORK, ignore_errors=True)
    subprocess.run([PROGRAM, "--profile=smoke", "--filter=" + FILTER,
                    "--out=" + WORK], check=True, stdout=subprocess.DEVNULL)
    sections = {s.split("\n")[0]: s
                for s in re.split(r"^## ", page(), flags=re.M)[1:]}
    hdf5, results, plan, tidy = (sections[name] for name in (
        "`cases/<case>.h5`", "`results.json`", "`plan.json`", "Tidy tables"))
    wrong, seen = [], set()

    def same(what, said, found):
        for name in sorted(said ^ found):
            side = "is not there" if name in said else "is not told"
            wrong.append(f"docs/data.md, {what}: {name} {side}")

    for path in glob.glob(WORK + "/cases/*.h5"):
        shapes, attributes = data_sets(path)
        seen |= set(shapes)
        if not all(shapes_are(path, shapes)):
            wrong.append(f"{path}: other shapes than the page says")
        same("attributes", {"case", "hash", "key"},
             set().union(*attributes.values()))
    same("HDF5", names(hdf5, "data set"), seen)
    with open(WORK + "/results.json") as f:
        keys = set().union(*(set(e["physinv"])
                             for e in json.load(f)["benchmarks"]))
    same("results.json", names(results, "key of `physinv`"), keys)
    with open(WORK + "/plan.json") as f:
        same("plan.json", names(plan, "key |"), set(json.load(f)))
    text = subprocess.run([PROGRAM, "export", WORK, "--format=tidy"],
                          check=True, capture_output=True, text=True).stdout
    columns = set(text.splitlines()[0].split(","))
    same("tidy tables", names(tidy, "column |"), columns)
    print("\n".join(wrong) or f"{len(seen)} data sets, {len(keys)} keys, "
          f"{len(columns)} columns")
    sys.exit(bool(wrong))


main()
