#!/usr/bin/env python3
"""three_figures.py RESULTS FIGURES.png: a figure from a campaign's tidy table,
one from a case's HDF5 file, one from Python, ten lines each. RESULTS is made
if it is not there: JPO's billiards at the smallest size. docs/data.md has the
columns, attributes and arrays."""

import collections
import csv
import glob
import os
import sys

import h5py
import numpy as np

import physinv


def from_tidy_csv(path, axes):
    """Shares of examples below a loss; one that failed is below none."""
    losses = collections.defaultdict(list)
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            name = f"{row['method']} {row['stage']}"
            losses[name].append(float(row["loss"] or "inf"))
    for name, own in losses.items():
        axes.plot(sorted(own), np.arange(1, len(own) + 1) / len(own), label=name)
    axes.set(xscale="log", xlabel="loss", ylabel="share of examples")


def from_hdf5(path, axes):
    """Losses of a case along its stages."""
    with h5py.File(path) as file:
        for name, stage in file["stages"].items():
            seconds, loss = stage["curve/seconds"], stage["curve/loss"]
            assert loss.attrs["axes"] == b"points,samples"
            axes.plot(seconds[:], np.median(loss, axis=1), label=name)
            unit = seconds.attrs["unit"].decode()
        title = file.attrs["case"].decode() + "\ndoi:" + file.attrs["doi"].decode()
    axes.set(yscale="log", xlabel=f"solving [{unit}]", ylabel="median loss",
             title=title)


def from_python(directory, axes):
    """What a loss costs, an example a point."""
    table = physinv.open(directory).tidy()
    for method in np.unique(table["method"]):
        own = (table["method"] == method) & (table["evaluations"] > 0)
        if own.any():
            axes.plot(table["evaluations"][own], table["loss"][own], ".",
                      label=method)
    axes.set(yscale="log", xlabel="evaluations", ylabel="loss")


def main(results, picture):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    if not os.path.isdir(results):
        physinv.run("smoke", filter="^jpo/billiards/", out=results)
    table = os.path.join(results, "tidy.csv")
    physinv.verb("export", results, format="tidy", out=table)
    case = sorted(glob.glob(results + "/cases/jpo+billiards+jpo+*.h5"))[0]
    figure, axes = pyplot.subplots(1, 3, figsize=(15, 4.5))
    from_tidy_csv(table, axes[0])
    from_hdf5(case, axes[1])
    from_python(results, axes[2])
    for one in axes:
        one.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(picture)


if __name__ == "__main__":
    main(*sys.argv[1:3])
