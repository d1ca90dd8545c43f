#!/usr/bin/env python3
"""landscapes_table.py RESULTS PAGE [--write]: the tables of docs/solvers.md, what
each library does on each landscape, from a campaign that ran
`libraries/landscape-*` and its report. Exit code 1 if the page has other ones of
the same versions; --write renews those whose solvers were run.
"""

import collections
import csv
import json
import sys

TABLES = {
    "landscapes": [
        "bfgs", "lbfgsb", "gsl-bfgs2", "nlopt-lbfgs", "nlopt-slsqp",
        "nlopt-mma", "ceres-bfgs", "ceres-lbfgs", "dlib-bfgs", "dlib-lbfgs",
        "scipy-bfgs", "scipy-lbfgsb", "scipy-slsqp", "scipy-tnc"],
    "landscapes of R": ["r-bfgs", "r-lbfgsb", "r-nlminb", "r-ucminf"]}
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


def rows(results, methods):
    """A row for each landscape and way to end, with the methods that ended so."""
    for landscape, of in stages(results).items():
        words, groups = surprises(results, landscape), {}
        for method in methods:
            if method not in of:
                group, evaluations = ("not run", "", ""), ""
            else:
                stage = of[method]
                group = (ended(stage), loss_of(stage, landscape),
                         words.get(method, ""))
                evaluations = f" {stage.get('vjp', '')}"
            groups.setdefault(group, []).append(f"`{method}`{evaluations}")
        for (end, loss, text), who in sorted(
                groups.items(), key=lambda g: g[0][0] == "not run"):
            name = landscape.removeprefix("landscape-")
            yield f"| `{name}` | {end} | {loss} | {', '.join(who)} | {text} |\n"


def versions(results, methods):
    """GSL 2.7.1 and so on, of those that were run."""
    texts = set()
    for of in stages(results).values():
        for method in methods:
            if method in of:
                options = of[method]["physinv"]["options"]
                text = options.get("library", options.get("libraries", ""))
                texts.add(text.strip("'"))
    return ", ".join(sorted(texts - {""}))


def compare(name, kept, made):
    """Fails where the tables differ; of other versions they may."""
    if made[0] not in kept:
        print(f"{name}: the page is of other versions: {made[0]}")
    elif "".join(kept) != "".join(made):
        sys.exit("".join([f"{name}: the page has another table; --write renews "
                          "it\n", *(line for line in made if line not in kept)]))


def main(results, page, *flags):
    with open(page) as f:
        text = f.read()
    for name, methods in TABLES.items():
        begin, end = f"<!-- {name} -->\n\n", f"\n<!-- end of {name} -->\n"
        before, rest = text.split(begin)
        kept, after = rest.split(end)
        run_with = versions(results, methods)
        made = [f"Run with {run_with or 'nothing'}.\n", "\n",
                "| landscape | ended | loss | solvers, with their evaluations | "
                "surprises |\n", "| --- | --- | ---: | --- | --- |\n",
                *rows(results, methods)]
        if "--write" not in flags:
            compare(name, kept.splitlines(True), made)
        elif run_with:
            text = before + begin + "".join(made) + end + after
    if "--write" in flags:
        with open(page, "w") as f:
            f.write(text)


if __name__ == "__main__":
    main(*sys.argv[1:])
