#!/usr/bin/env python3
"""landscapes_table.py RESULTS PAGE [--write]: the table of docs/solvers.md, what
each library does on each landscape, from a campaign that ran
`libraries/landscape-*` and its report. Exit code 1 if the page has another one
of the same versions; --write renews it.
"""

import collections
import csv
import json
import re
import sys

BEGIN, END = "<!-- landscapes -->\n", "<!-- end of landscapes -->\n"
METHODS = ["bfgs", "lbfgsb", "gsl-bfgs2", "nlopt-lbfgs", "nlopt-slsqp",
           "nlopt-mma", "ceres-bfgs", "ceres-lbfgs", "dlib-bfgs", "dlib-lbfgs",
           "scipy-bfgs", "scipy-lbfgsb", "scipy-slsqp", "scipy-tnc"]
SURPRISES = {"gradient left": "success claimed, gradient left",
             "not best": "lower point evaluated", "false loss": "false loss",
             "budget spent": "budget spent", "outside box": "outside of the box"}


def stages(results):
    """The stages of each landscape by method."""
    found = collections.defaultdict(dict)
    with open(results + "/results.json") as f:
        for stage in json.load(f)["benchmarks"]:
            _, experiment, method = stage["name"].split("/")[:3]
            if experiment.startswith("landscape-"):
                found[experiment][method] = stage
    return found


def surprises(results, landscape):
    """Of each method, in words."""
    path = f"{results}/report/libraries-{landscape}/tables/ends.csv"
    with open(path) as f:
        return {row["method"]: ", ".join(
            text for column, text in SURPRISES.items()
            if row[column] not in ("", "0"))
            for row in csv.DictReader(f)}


def loss_of(stage, landscape):
    """In units of the landscape's scale."""
    loss = stage.get("loss_mean")
    if loss is None:
        return "not finite"
    scale = landscape.removeprefix("landscape-scale-")
    loss /= float(scale) if scale != landscape else 1
    return "< 1e-12" if 0 <= loss < 1e-12 else f"{loss:.2g}"


def ended(stage):
    """gtol; of a stage that failed, that."""
    statuses = stage["physinv"].get("statuses", {})
    return next((f"`{s}`" for s, count in statuses.items() if count),
                stage["physinv"]["stop"])


def rows(results):
    """A row for each landscape and way to end, with those who ended so."""
    for landscape, of in stages(results).items():
        words, groups = surprises(results, landscape), {}
        for method in METHODS:
            if method not in of:
                group, evaluations = ("not run", "", ""), ""
            else:
                stage = of[method]
                group = (ended(stage), loss_of(stage, landscape),
                         words.get(method, ""))
                evaluations = f" {stage['forward'] + stage['vjp']}"
            groups.setdefault(group, []).append(f"`{method}`{evaluations}")
        for (end, loss, text), who in sorted(
                groups.items(), key=lambda g: g[0][0] == "not run"):
            name = landscape.removeprefix("landscape-")
            yield f"| `{name}` | {end} | {loss} | {', '.join(who)} | {text} |\n"


def versions(results):
    """GSL 2.7.1 and so on, of all that were run."""
    texts = set()
    for of in stages(results).values():
        for stage in of.values():
            options = stage["physinv"]["options"]
            texts.add(options.get("library", options.get("libraries", "")))
    return ", ".join(sorted(texts - {""}))


def table(results):
    return (f"Run with {versions(results)}.\n\n"
            "| landscape | ended | loss | solvers, with their evaluations | "
            "surprises |\n| --- | --- | ---: | --- | --- |\n"
            + "".join(rows(results)))


def main(results, page, *flags):
    with open(page) as f:
        text = f.read()
    made = BEGIN + "\n" + table(results) + "\n" + END
    kept = re.search(re.escape(BEGIN) + ".*" + re.escape(END), text, re.S)
    if "--write" in flags:
        with open(page, "w") as f:
            f.write(text.replace(kept[0], made))
    elif made.splitlines()[2] not in kept[0]:
        print(f"{page} is of other versions than this: {made.splitlines()[2]}")
    elif kept[0] != made:
        old = set(kept[0].splitlines())
        new = [line for line in made.splitlines() if line not in old]
        sys.exit("\n".join([f"{page} has another table; --write renews it:",
                            *new]))


if __name__ == "__main__":
    main(*sys.argv[1:])
