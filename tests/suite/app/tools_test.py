"""compare, plan, export, completion, submit, and other programs' habits on
run: what they say, exit codes, one clear line for bad input."""

import csv
import io
import json
import os
import subprocess
import sys
import tempfile

import jsonschema

from program import BENCH, FAILED, check, expect, run

SCHEMAS = os.path.abspath(sys.argv[2])


def json_of(p):
    try:
        return json.loads(p.stdout)
    except ValueError:
        return None


def compare(d):
    for seeds, out in (("0", "a"), ("0", "b"), ("0,1", "c")):
        expect(0, ["--profile=quick", "--seeds=" + seeds, "--out=" + out], d)
    expect(0, ["--profile=quick", "--seeds=0", "--set=precision=f64",
               "--out=f64"], d)
    p = expect(0, ["compare", "a", "b", "--fail-on=loss", "--fail-on=status",
                   "--fail-on=claims", "--fail-on=work", "--fail-on=missing"],
               d, "0 claims changed")
    rows = p.stdout.splitlines()[-1].split()
    check(rows[0] == rows[3], "the same campaign twice has the same bits")
    check(p.stdout.startswith("b against a: no method got better or worse") and
          f"{rows[0]} of {rows[0]} rows unchanged" in p.stdout and
          "What changed most" not in p.stdout, "rows that are equal are folded")
    p = expect(0, ["compare", "one=a", "two=f64", "--format=json"], d)
    table = json_of(p)
    check(table["labels"] == ["one", "two"], "labels")
    check(all(None not in r["sides"] for r in table["rows"]),
          "f32 and f64 of a case are the same run")
    check(any(r["sides"][1]["same_bits"] == 0 for r in table["rows"]),
          "other bits are seen")
    expect(5, ["compare", "c", "a", "--fail-on=missing"], d, "missing")
    rows = json_of(expect(0, ["compare", "a", "c", "--format=json"], d))["rows"]
    missing = [None in r["sides"] for r in rows]
    check(any(missing) and missing == sorted(missing),
          "what is missing comes last")
    p = expect(0, ["compare", "a", "c"], d, "Stages that a side lacks")
    lines = p.stdout.splitlines()
    at = next(k for k, x in enumerate(lines) if x.startswith("Stages that"))
    check(lines[at + 3].split()[0] == "fake/cubic" and
          not any("missing" in x for x in lines[:at]),
          "in one line per experiment, after the common runs")
    for by, seeds in (("method", {None}), ("n", {None}), ("seed", {0, 1})):
        rows = json_of(expect(0, ["compare", "a", "c", "--by=" + by,
                                  "--format=json"], d))["rows"]
        check({r["seed"] for r in rows} == seeds, f"--by={by}")
    p = expect(0, ["compare", "a", "c", "--format=csv"], d)
    rows = list(csv.DictReader(io.StringIO(p.stdout)))
    check(len(rows) > 1 and list(rows[0])[:5] ==
          ["experiment", "method", "n", "seed", "stage"] and
          all(r["n"].isdigit() and float(r["loss a"] or 0) >= 0 for r in rows),
          f"csv: {rows[0]}")
    expect(0, ["compare", "a", "f64", "--format=markdown"], d, "| ")
    expect(0, ["compare", "a", "f64", "--out=page"], d, "page/index.html")
    check(os.path.exists(os.path.join(d, "page", "compare", "tables",
                                      "changes.csv")), "the page's tables")
    expect(2, ["compare", "a"], d, "needs two or more folders")
    expect(2, ["compare", "a", "--by=commit"], d, "from one commit")
    expect(2, ["compare", "a", "nowhere"], d, "no results in 'nowhere'")
    expect(2, ["compare", "a", "b", "--by=colour"], d, "known values: method")
    expect(2, ["compare", "a", "b", "--format=xml"], d, "known values: text")
    expect(2, ["compare", "a", "b", "--fail-on=colour"], d, "known values: loss")
    expect(2, ["compare", "a", "b", "--factor=-1"], d, "positive")
    expect(0, ["--profile=smoke", "--filter=walk", "--out=w"], d)
    expect(0, ["--profile=smoke", "--filter=descend", "--out=v"], d)
    expect(3, ["compare", "w", "v"], d, "no run in common")


def plan(d):
    env = {"XDG_CACHE_HOME": os.path.join(d, "cache")}
    p = run("plan", "--profile=quick", cwd=d, env=env)
    check(p.returncode == 0 and "time unknown" in p.stdout,
          "plan: what no campaign took is not known")
    p = run("plan", "--profile=quick", "--exact", cwd=d, env=env)
    check(p.returncode == 0 and "of one core" in p.stdout, "plan --exact")
    check(p.stderr.startswith("measuring "), "--exact measures")
    p = run("plan", "--profile=quick", cwd=d, env=env)
    check(p.returncode == 0 and "of one core" in p.stdout,
          "plan: by what --exact measured")
    p = expect(0, ["plan", "--profile=quick", "--against=a", "--json"], d,
               env=env)
    costs = json_of(p)
    check(all(c["seconds"] > 0 and c["memory_bytes"] > 0 and c["disk_bytes"] > 0
              for c in costs), "known now: no word, and every cost")
    near = [c["disk_bytes"] / c["measured_disk_bytes"] for c in costs
            if "measured_disk_bytes" in c]
    check(near and all(0.3 < f < 3 for f in near), "disk as measured")
    expect(0, ["plan", "--profile=quick", "--workers"], d, "1000", env=env)
    expect(0, ["plan", "--profile=quick", "--against=a", "--plot=p.svg"], d,
           env=env)
    expect(2, ["plan", "--measured"], d, "--against")
    expect(2, ["plan", "--profile=huge"], d, "known profiles: smoke")
    expect(2, ["plan", "--against=nowhere"], d, "no results")
    expect(3, ["plan", "--filter=cubik"], d, "nearest")
    speeds = [f for f in os.listdir(os.path.join(d, "cache", "physinv"))]
    with open(os.path.join(d, "cache", "physinv", speeds[0]), "w") as f:
        f.write("{torn")
    p = run("plan", "--profile=quick", "--exact", cwd=d, env=env)
    check(p.returncode == 0 and "measuring" in p.stderr,
          "speeds that cannot be read are measured again")
    expect(2, ["--time-budget=3x"], d, "90, 90s, 10m or 2h")


def habits(d):
    p = expect(0, ["--profile=smoke", "--benchmark_list_tests=true"], d)
    names = p.stdout.split()
    check(len(names) == 4, "four cases are listed")
    check(not os.path.exists(os.path.join(d, "results", "smoke")),
          "listing runs nothing")
    parts = []
    for k in range(3):
        parts += run("--profile=smoke", "--benchmark_list_tests", cwd=d, env={
            "GTEST_TOTAL_SHARDS": "3", "GTEST_SHARD_INDEX": str(k)}
            ).stdout.split()
    check(sorted(parts) == sorted(names), "shards of GoogleTest are all cases")
    p = run("--profile=smoke", "--benchmark_list_tests", cwd=d,
            env={"BENCHMARK_FILTER": "-walk"})
    check(p.stdout.split() == [n for n in names if "walk" not in n],
          "BENCHMARK_FILTER, negated")
    p = run("--profile=smoke", "--out=r", "--benchmark_repetitions=3",
            "--benchmark_format=json", "--benchmark_out=r.csv",
            "--benchmark_out_format=csv", cwd=d)
    entries = json_of(p)["benchmarks"]
    own = [e for e in entries if e["run_type"] == "iteration"]
    check({e["repetition_index"] for e in own} == {0, 1, 2}, "repetitions")
    check({e.get("aggregate_name") for e in entries}
          == {None, "mean", "median", "stddev", "cv", "error"}, "their spread")
    expect(0, ["--profile=smoke", "--out=s"], d)
    p = expect(0, ["compare", "r", "s"], d)
    rows = p.stdout.splitlines()[-1].split()
    check(rows[0] == rows[3], "repetitions leave the results as they are")
    with open(os.path.join(d, "r.csv")) as f:
        check(f.readline().startswith("name,iterations,real_time"), "csv")
    for form, schema in (("github", "github-action-benchmark"),
                         ("bencher", "bencher-metric-format")):
        with open(os.path.join(SCHEMAS, schema + ".schema.json")) as f:
            jsonschema.validate(json_of(expect(
                0, ["export", "r", "--format=" + form], d)), json.load(f))
        check(True, "schema of " + form)
    expect(2, ["--benchmark_filtr=x"], d, "did you mean --benchmark_filter")
    expect(3, ["--benchmark_filter=cubik"], d, "fake/cubic")
    expect(2, ["--benchmark_format=jsn"], d, "did you mean json")
    expect(2, ["--benchmark_repetitions=0"], d)
    expect(2, ["--cases=nowhere"], d, "no file 'nowhere'")
    expect(2, [], d, "set both", env={"GTEST_TOTAL_SHARDS": "2"})
    expect(2, [], d, "expected 0 to 1",
           env={"GTEST_TOTAL_SHARDS": "2", "GTEST_SHARD_INDEX": "2"})
    expect(2, [], d, "whole number", env={"BENCHMARK_REPETITIONS": "few"})
    expect(2, ["export", "nowhere"], d, "no results")
    expect(2, ["export", "r", "--format=xml"], d, "known values: json")


def completion(d):
    for shell in ("bash", "zsh", "fish"):
        expect(0, ["completion", shell], d, "--list-verbs")
    script = f"""source <({BENCH} completion bash)
        COMP_WORDS=({BENCH} compare --fai) COMP_CWORD=2
        _physinv_bench
        echo "${{COMPREPLY[@]}}"
        COMP_WORDS=({BENCH} comp) COMP_CWORD=1
        _physinv_bench
        echo "${{COMPREPLY[@]}}" """
    p = subprocess.run(["bash", "-c", script], text=True, capture_output=True,
                       timeout=60)
    check(p.stdout.split() == ["--fail-on", "compare", "completion"],
          f"bash completes flags and verbs: {p.stdout.split()} {p.stderr}")
    expect(2, ["completion", "csh"], d, "bash, zsh, fish")


def cluster(d):
    expect(9, ["submit", "--slurm=c"], d, "Slurm is not installed", env={"PATH": d})
    expect(2, ["submit"], d, "--slurm=DIR")
    expect(2, ["submit", "--slurm=c", "--shard=1/2"], d, "use --shard only with run")
    expect(2, ["status", "nowhere"], d, "no submitted campaign")
    os.mkdir(os.path.join(d, "torn"))
    with open(os.path.join(d, "torn", "submission.json"), "w") as f:
        f.write("{")
    expect(9, ["status", "torn"], d, "damaged")


def main():
    with tempfile.TemporaryDirectory() as d:
        os.mkdir(os.path.join(d, "published"))
        for test in (compare, plan, habits, completion, cluster):
            test(d)
    sys.exit(1 if FAILED else 0)


main()
