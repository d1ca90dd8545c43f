"""What failed, was skipped, diverged or was not run looks like a success in no
file: results.json, csv, tidy, github, bencher and Google's compare.py."""

import csv
import io
import json
import os
import sys
import tempfile

import jsonschema

from program import FAILED, check, expect, run

SCHEMAS = os.path.abspath(sys.argv[2])
sys.path.insert(0, os.path.join(os.path.dirname(SCHEMAS), "..", "tests",
                                "suite", "store"))
import check_compare  # noqa: E402

WALK = "fake/cubic/walk/n=4/seed=0/"
DESCEND = "fake/cubic/descend/n=4/seed=0/solve"
ENDS = {  # a plant: ends of fit and refine, exit codes of run and export
    "a fit that diverges": ({"fit": "diverged", "refine": "diverged"}, 0, 0),
    "a fit that throws": ({"fit": "failed: no fit today",
                           "refine": "skipped: fit failed"}, 4, 10)}


def campaign(d, out, plant=None, code=0, flags=()):
    p = run("--profile=smoke", "--filter=walk|descend", "--out=" + out,
            *flags, cwd=d,
            env={"PHYSINV_FAKE_PLANT": plant} if plant else None)
    check(p.returncode == code, f"{out}: {p.returncode} {p.stderr[:100]}")


def exported(d, out, form, code=0):
    p = run("export", out, "--format=" + form, cwd=d)
    lines = p.stderr.splitlines()
    check(p.returncode == code and len(lines) == (code != 0),
          f"export {out} {form}: {p.returncode} {p.stderr[:150]}")
    return p.stdout


def numbers_in(value):
    """Those of a JSON value with their keys."""
    if isinstance(value, dict):
        return [found for key, inner in value.items()
                for found in ([(key, inner)] if type(inner) in (int, float)
                              else numbers_in(inner))]
    return []


def results_json(d, out, ends):
    with open(os.path.join(SCHEMAS, "results-2.schema.json")) as f:
        schema = json.load(f)
    with open(os.path.join(d, out, "results.json")) as f:
        results = json.load(f)
    jsonschema.validate(results, schema)
    for entry in results["benchmarks"]:
        stage = entry["physinv"]["stage"]
        message = ends.get(stage)
        if message is None:
            check(entry["real_time"] > 0 and "error_occurred" not in entry,
                  f"{out} {stage} has a time")
            continue
        own = [n for n in numbers_in({**entry, "physinv": {}})
               if not n[0].endswith("_index")]
        times = [n for n in numbers_in(entry["physinv"])
                 if n[0].endswith("_ms") and n[1] == 0]
        check(entry["error_occurred"] is True and not own and
              entry["error_message"] == message and
              entry["physinv"]["times"] is None,
              f"{out} {stage} is an error without numbers: {own}")
        check(message == "diverged" or not times, f"no time of 0: {times}")


def csv_rows(text, ends, out):
    rows = {r["name"].rsplit("/", 1)[1]: r
            for r in csv.DictReader(io.StringIO(text))}
    for stage in ("fit", "refine", "solve"):
        row, message = rows[stage], ends.get(stage)
        kept = {k for k, v in row.items() if v} - {"name"}
        check(kept == {"error_occurred", "error_message"} and
              row["error_message"] == message if message else
              float(row["real_time"]) > 0 and not row["error_occurred"],
              f"{out} csv {stage}: {kept}")


KEYS = ["case", "experiment", "method", "n", "seed", "profile", "precision",
        "stage", "example"]
NUMBERS = ["loss", "iterations", "evaluations", "seconds", "cpu_seconds",
           "crowded"]


def tidy_rows(text, ends, out):
    """A row for each of four examples, whatever became of the stage."""
    lines = list(csv.reader(io.StringIO(text)))
    check(all(len(line) == len(lines[0]) for line in lines) and
          "\r" not in text, f"{out} tidy: as many cells in each line")
    rows = list(csv.DictReader(io.StringIO(text)))
    check(list(rows[0])[:9] == KEYS and all(r[k] for r in rows for k in KEYS),
          f"{out} tidy: keys are there")
    for stage in ("fit", "refine", "solve"):
        own = [r for r in rows if r["stage"] == stage]
        check([r["example"] for r in own] == list("0123") and
              {r["n"] for r in own} == {"4"}, f"{out} tidy {stage}: examples")
        message = ends.get(stage)
        for r in own:
            kept = {k for k in NUMBERS if r[k]}
            if message is None:
                check(kept | {"evaluations"} == set(NUMBERS) and float(r["loss"]) >= 0 and
                      r["status"] in ("gtol", "maxiter") and
                      float(r["seconds"]) > 0, f"{out} tidy {stage}: {r}")
            else:
                check(not kept and r["status"] == message.split(":")[0] and
                      r["message"] == message.partition(": ")[2],
                      f"{out} tidy {stage} shows no success: {r}")
    return rows


def losses_in_full(d, out, rows):
    """Every digit, as results.json has it."""
    with open(os.path.join(d, out, "results.json")) as f:
        entries = json.load(f)["benchmarks"]
    for entry in entries:
        losses = [float(r["loss"]) for r in rows
                  if r["case"] + "/" + r["stage"] == entry["name"]]
        times = {float(r["seconds"]) for r in rows
                 if r["case"] + "/" + r["stage"] == entry["name"]}
        check(max(losses) == entry["loss_max"] and
              abs(times.pop() * 1e9 / entry["real_time"] - 1) < 1e-12 and
              not times, f"{entry['name']}: loss and time of results.json")


def alerts(before, after, threshold=2):
    """As github-action-benchmark finds them."""
    old = {b["name"]: b["value"] for b in before}
    found = []
    for b in after:
        value, was = b["value"], old.get(b["name"])
        if was is None or (was == 0 and value == 0):
            continue
        if was == 0 or value / was > threshold:
            found.append(b["name"])
    return found


def github(before, after, ends, out):
    with open(os.path.join(SCHEMAS,
                           "github-action-benchmark.schema.json")) as f:
        jsonschema.validate(after, json.load(f))
    found = {name for name in alerts(before, after)
             if name.endswith(" error")}  # times of a busy machine may, too
    check(found == {WALK + stage + " error" for stage in ends},
          f"{out}: github alarms of {found}")
    check(not [b for b in after if b["name"].split()[0][len(WALK):] in ends and
               not b["name"].endswith(" error")], f"{out}: and nothing else")


def bencher(text, ends, out):
    with open(os.path.join(SCHEMAS,
                           "bencher-metric-format.schema.json")) as f:
        jsonschema.validate(text, json.load(f))
    for stage in ("fit", "refine"):
        measures = text[WALK + stage]
        # A static threshold, upper boundary 0.
        alarm = measures["error"]["value"] > 0
        check(alarm == (stage in ends) and
              (set(measures) == {"error"}) == alarm,
              f"{out} bencher {stage}: {measures}")


def compare_py(d, first, second, ends):
    if not os.path.exists(check_compare.TOOL):
        print("skipped: libbenchmark-tools is not installed")
        return
    for a, b in ((first, second), (second, first)):
        for name in ("results.json", "export.json"):
            text = check_compare.compared(os.path.join(d, a, name),
                                          os.path.join(d, b, name))
            check("Time" in text and DESCEND in text and
                  not any(WALK + stage in text for stage in ends),
                  f"compare.py {a} {b} {name} has no line of {set(ends)}")


def ends(d):
    campaign(d, "ok")
    good = {form: exported(d, "ok", form)
            for form in ("json", "csv", "tidy", "github", "bencher")}
    with open(os.path.join(d, "ok", "export.json"), "w") as f:
        f.write(good["json"])
    results_json(d, "ok", {})
    csv_rows(good["csv"], {}, "ok")
    losses_in_full(d, "ok", tidy_rows(good["tidy"], {}, "ok"))
    bencher(json.loads(good["bencher"]), {}, "ok")
    check(alerts(json.loads(good["github"]), json.loads(good["github"])) == [],
          "no alarm without a change")
    for i, (plant, (wrong, code, export)) in enumerate(ENDS.items()):
        out = f"bad{i}"
        campaign(d, out, plant, code)
        results_json(d, out, wrong)
        with open(os.path.join(d, out, "export.json"), "w") as f:
            f.write(exported(d, out, "json", export))
        csv_rows(exported(d, out, "csv", export), wrong, out)
        tidy_rows(exported(d, out, "tidy", export), wrong, out)
        github(json.loads(good["github"]),
               json.loads(exported(d, out, "github", export)), wrong, out)
        bencher(json.loads(exported(d, out, "bencher", export)), wrong, out)
        compare_py(d, "ok", out, wrong)


def not_run(d):
    """A stage and a case that are asked for and have no record."""
    names = {WALK + "fit", WALK + "refine",
             DESCEND}
    expect(0, ["--profile=smoke", "--filter=walk|descend", "--out=part"], d)
    before = json.loads(exported(d, "part", "github"))
    path = os.path.join(d, "part", "journal.jsonl")
    with open(path) as f:
        lines = f.readlines()
    with open(path, "w") as f:
        f.writelines(line for line in lines
                     if "descend" not in line and '"refine"}' not in line and
                     '"stage":"refine"' not in line)
    missing = names - {WALK + "fit"}
    after = json.loads(exported(d, "part", "github", 10))
    check(set(alerts(before, after)) == {n + " error" for n in missing},
          f"what was not run alarms {alerts(before, after)}")
    entries = json.loads(exported(d, "part", "json", 10))["benchmarks"]
    check({b["name"] for b in entries if b.get("error_message") == "not run"}
          == missing, "and is an error in json")
    check({r["name"] for r in csv.DictReader(io.StringIO(
        exported(d, "part", "csv", 10))) if r["error_message"] == "not run"}
          == missing, "and in csv")
    rows = list(csv.DictReader(io.StringIO(exported(d, "part", "tidy", 10))))
    gone = {r["case"] + "/" + r["stage"]: r for r in rows
            if r["status"] == "not run"}
    check(set(gone) == missing and
          not any(r[k] for r in gone.values() for k in NUMBERS) and
          len([r for r in rows if r["stage"] == "refine"]) == 4,
          f"and in tidy: {set(gone)}")
    p = run("export", "part", "--out=kept.json", cwd=d)
    check(p.returncode == 10 and
          len(json.load(open(os.path.join(d, "kept.json")))["benchmarks"]) == 3,
          "what there is is written")


def repetitions(d):
    """Medians are in results.json, as in every export."""
    campaign(d, "again", flags=("--benchmark_repetitions=4",))
    with open(os.path.join(d, "again", "results.json")) as f:
        entries = json.load(f)["benchmarks"]
    github = {b["name"]: b for b in json.loads(exported(d, "again", "github"))}
    for entry in entries:
        wall = sorted(entry["physinv"]["times"]["wall"])
        median = (wall[1] + wall[2]) / 2
        check(entry["repetitions"] == len(wall) == 4 and
              abs(entry["real_time"] / median - 1) < 1e-12 and
              abs(github[entry["name"] + " time"]["value"] / median * 1e6 - 1)
              < 1e-12, f"{entry['name']}: median of four")
    campaign(d, "again")
    with open(os.path.join(d, "again", "results.json")) as f:
        check(json.load(f)["benchmarks"] == entries,
              "a later run leaves the repetitions of what it reuses")


def own_runs(d):
    """Profile and threads are those of each stage's run."""
    expect(0, ["--profile=smoke", "--filter=walk", "--jobs=1", "--out=mixed"],
           d)
    expect(0, ["--profile=quick", "--filter=descend", "--jobs=1", "--threads=2",
               "--out=mixed"], d)
    entries = json.loads(exported(d, "mixed", "json"))["benchmarks"]
    found = {(b["physinv"]["method"], b["physinv"]["profile"], b["threads"],
              b["physinv"]["timed_on"]["threads"]) for b in entries}
    check(found == {("walk", "smoke", 1, 1), ("descend", "quick", 2, 2)},
          f"profiles and threads: {found}")
    expect(0, ["report", "mixed"], d)
    with open(os.path.join(d, "mixed", "report", "report.md")) as f:
        text = f.read()
    check("quick: 6 stages, smoke: 2 stages" in text, "the report says so")
    p = expect(0, ["--profile=smoke", "--filter=walk", "--out=mixed",
                   "--dry-run"], d)
    check(p.stdout.count("profile smoke") == 2, "and --dry-run")


def main():
    with tempfile.TemporaryDirectory() as d:
        os.mkdir(os.path.join(d, "published"))
        for test in (ends, not_run, repetitions, own_runs):
            test(d)
    sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)


main()
