#!/usr/bin/env python3
"""data_test.py PROGRAM SOURCES WORK: docs/data.md names what the files have, no
more and no less, with the right shapes."""

import csv
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

import files

PROGRAM, SOURCES, WORK = sys.argv[1:4]
FILTER = "^jpo/robotic-arm/|^hig/toy-gamma-1/(adam|hig)/|^jpo/billiards/bfgs/"


def page():
    with open(os.path.join(SOURCES, "docs/data.md")) as f:
        return f.read()


def data_sets(path):
    """Name, as the page has it, to the shapes of all of this name; names of attributes
    with their places; what is wrong with them."""
    found, attributes, wrong = {}, set(), []

    def note(place, item):
        attributes.update((name, place) for name in item.attrs)

    def visit(name, item):
        name = re.sub(r"^stages/\d+_[\w-]+", "stages/<position>_<stage>", name)
        if not isinstance(item, h5py.Dataset):
            note({"data": "`data`"}.get(name, "stage"), item)
            return
        note("data set", item)
        axes = item.attrs.get("axes", b"").decode()
        if axes and len(axes.split(",")) != item.ndim:
            wrong.append(f"{path} {name}: {axes} of {item.shape}")
        if not axes and "/arrays/" not in name:
            wrong.append(f"{path} {name}: no axes")
        names = item.attrs.get("names", b"").decode()
        if names and "(" not in names and item.shape[-1] and \
                len(names.split(", ")) != item.shape[-1]:
            wrong.append(f"{path} {name}: {names} of {item.shape}")
        name = re.sub(r"arrays/\w+$", "arrays/<name>", name)
        found.setdefault(name, []).append(item.shape)
        if name.endswith(">/status"):
            words = item.attrs["flag_meanings"].decode().split()
            ends = dict(zip(words, item.attrs["flag_values"].tolist()))
            if item.dtype != "<i4" or h5py.check_enum_dtype(item.dtype) or \
                    ends != {"gtol": 0, "maxiter": 1, "linesearch": 2,
                             "nonfinite": 3, "ftol": 4}:
                wrong.append(f"{path} {name}: {item.dtype} {ends}")
    with h5py.File(path) as f:
        note("file", f)
        f.visititems(visit)
        if f.attrs["schema"] != 3 or f.attrs["n"] != len(f["data/y"]):
            wrong.append(f"{path}: schema or n")
    return found, attributes, wrong


def told_attributes(section):
    """Pairs of a name and a place from the table of attributes."""
    return {(name, place.strip())
            for cells in files.table(section, "attribute")
            for name in re.findall(r"`([^`]+)`", cells[0])
            for place in cells[1].split(",")}


def shapes_are(path, shapes):
    n, unknowns = shapes["data/y"][0][0], None
    stage = "stages/<position>_<stage>/"
    for x in shapes[stage + "x"]:
        unknowns = x[1]
        yield x[0] <= n
    for name in ("loss", "iterations", "evaluations", "status"):
        yield all(s == (n,) for s in shapes[stage + name])
    for i, (p,) in enumerate(shapes[stage + "curve/iteration"]):
        yield shapes[stage + "curve/seconds"][i] == (p,)
        yield shapes[stage + "curve/evaluations"][i] == (p,)
        yield shapes[stage + "curve/loss"][i][0] == p
        yield shapes[stage + "curve/x"][i][0] == p
        yield shapes[stage + "curve/x"][i][2] == unknowns


BESIDE = (" paper spread", " paper", " spread", " of", " note")


def is_number(cell):
    try:
        float(cell)
    except ValueError:
        return False
    return True


def tables(folder):
    """Of a report's CSV, what is wrong, and the columns next to it."""
    wrong, beside = [], set()
    paths = glob.glob(folder + "/report/*/tables/*.csv")
    for path in paths:
        with open(path, newline="") as f:
            head, *rows = list(csv.reader(f))
        if len(set(head)) != len(head):
            wrong.append(f"{path}: two columns of one name")
        if any(len(row) != len(head) for row in rows):
            wrong.append(f"{path}: rows of another length than the head")
        for k, name in enumerate(head):
            own = re.sub(r" \[[^]]*\]$", "", name)
            suffix = next((s for s in BESIDE if own.endswith(s)), "")
            if suffix:
                beside.add("q" + suffix)
            cells = [row[k] for row in rows if row[k]]
            numbers = [is_number(c) for c in cells]
            if suffix not in (" of", " note") and any(numbers) and \
                    not all(numbers) and k > 0:
                wrong.append(f"{path}: {name} has words and numbers")
            if any(c in ("–", "nan", "inf") for c in cells):
                wrong.append(f"{path}: {name} has what is missing as a word")
    with open(folder + "/report/jpo-robotic-arm/tables/results.csv") as f:
        if f.readline().split(",")[:3] != ["n", "method", "refined"]:
            wrong.append("results.csv: keys are not columns of their own")
    return len(paths), wrong, beside


def main():
    shutil.rmtree(WORK, ignore_errors=True)
    published = WORK + "-published"
    shutil.rmtree(published, ignore_errors=True)
    for _ in range(2):  # the second plan finds results
        subprocess.run([PROGRAM, "--profile=smoke", "--filter=" + FILTER,
                        "--benchmark_repetitions=2", "--out=" + WORK],
                       check=True, stdout=subprocess.DEVNULL)
    sections = {s.split("\n")[0]: s
                for s in re.split(r"^## ", page(), flags=re.M)[1:]}
    hdf5, results, plan, tidy, report = (sections[name] for name in (
        "`cases/<case>.h5`", "`results.json`", "`plan.json`", "Tidy tables",
        "Tables of a report"))
    wrong, seen, noted = [], set(), set()

    def same(what, said, found):
        for name in sorted(said ^ found):
            side = "is not there" if name in said else "is not told"
            wrong.append(f"docs/data.md, {what}: {name} {side}")

    for path in glob.glob(WORK + "/cases/*.h5"):
        shapes, attributes, bad = data_sets(path)
        seen |= set(shapes)
        noted |= attributes
        wrong += bad
        if not all(shapes_are(path, shapes)):
            wrong.append(f"{path}: other shapes than the page says")
    same("attributes", told_attributes(hdf5), noted)
    same("HDF5", files.names(hdf5, "data set"), seen)
    with open(WORK + "/results.json") as f:
        keys = set().union(*(set(e["physinv"])
                             for e in json.load(f)["benchmarks"]))
    same("results.json", files.names(results, "key of `physinv`"), keys)
    with open(WORK + "/plan.json") as f:
        same("plan.json", files.names(plan, "key"), set(json.load(f)))
    text = subprocess.run([PROGRAM, "export", WORK, "--format=tidy"],
                          check=True, capture_output=True, text=True).stdout
    columns = set(text.splitlines()[0].split(","))
    same("tidy tables", files.names(tidy, "column"), columns)
    subprocess.run([PROGRAM, "report", WORK, "--publish", published],
                   stdout=subprocess.DEVNULL, check=True)
    wrong += [f"docs/data.md, files: {one}" for one in
              files.differences(sections["Files"], WORK, published)]
    wrong += files.all_keys(sections, WORK, published)
    count, bad, beside = tables(WORK)
    wrong += bad
    told = files.names(report, "column")
    # Several seeds and settings are another campaign's.
    same("tables of a report", {"q paper", "q note"} & told,
         {"q paper", "q note"} & beside)
    same("tables of a report", beside & told, beside)
    print("\n".join(wrong) or f"{len(seen)} data sets, {len(noted)} "
          f"attributes, {len(keys)} keys, {len(columns)} columns, "
          f"{count} tables")
    sys.exit(bool(wrong))


main()
