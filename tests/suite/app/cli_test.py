"""Exit codes and messages of the command line; bits for every way to run."""

import json
import os
import signal
import subprocess
import sys
import tempfile
import time

from program import BENCH, FAILED, check, expect, run


def results(path):
    """results.json without what may differ between runs."""
    with open(os.path.join(path, "results.json")) as f:
        r = json.load(f)
    drop = ("time", "date", "seconds", "_ms", "finished", "rss", "crowded",
            "clocks", "bytes", "threads", "revision", "warmup", "setup")

    def clean(v):
        if isinstance(v, dict):
            return {k: clean(w) for k, w in v.items()
                    if not any(d in k for d in drop)}
        return [clean(w) for w in v] if isinstance(v, list) else v

    return [clean(b) for b in r["benchmarks"]]


def bad_input(d):
    expect(2, ["--no-such"], d, "unknown flag --no-such")
    expect(2, ["--profil=smoke"], d, "did you mean --profile")
    expect(2, ["runn"], d, "did you mean run")
    expect(3, ["run", "stray"], d, "stray")
    expect(2, ["report", "results", "stray"], d, "stray")
    expect(2, ["--filter=(x"], d, "regular expression")
    expect(3, ["--filter=cubik"], d, "fake/cubic")
    expect(2, ["--profile=huge"], d, "known profiles: smoke")
    expect(2, ["--set", "speed=3"], d, "known keys: n, seeds")
    expect(2, ["--set", "n"], d, "key=value")
    expect(2, ["--set", "n=-3"], d)
    expect(2, ["--set", "n=four"], d)
    expect(2, ["--set", "methods=magic"], d, "walk")
    expect(2, ["--set", "precision=f16"], d, "f32, f64")
    expect(2, ["--seeds=3-1"], d)
    expect(2, ["--jobs=0"], d)
    expect(2, ["--time-budget=-1"], d)
    for shard in ("3", "0/2", "3/2", "1/x"):
        expect(2, ["--shard=" + shard], d)
    expect(2, ["report", "nowhere"], d, "no results")
    expect(2, ["report"], d)
    expect(2, ["verify", "nowhere"], d)
    expect(2, ["merge", "out", "nowhere"], d)
    os.mkdir(os.path.join(d, "empty"))
    expect(2, ["verify", "empty"], d)
    expect(2, ["merge", "out", "empty"], d)
    expect(9, ["--profile=smoke", "--out=/proc/nowhere"], d)
    open(os.path.join(d, "file"), "w").close()
    expect(9, ["--profile=smoke", "--out=file/below"], d)
    expect(9, ["kernels"], d, "physinv-kernels")
    expect(9, ["conformance"], d, "build the target physinv-conformance")
    expect(2, ["conformance", "--gtest_fiter=x"], d, "of GoogleTest: break_on")


def good_input(d):
    expect(0, ["--help"], d, "exit codes")
    expect(0, ["--version"], d, "compiler")
    expect(0, ["run", "--help"], d, "--time-budget")
    expect(0, ["list", "--profile=smoke"], d, "fake/cubic/walk/n=4/seed=0")
    expect(0, ["list", "--validate"], d, "methods are valid")
    for edited, stale in (("suite/core/method.h", 6), ("problems/new.cpp", 0)):
        expect(0, ["list", "--profile=smoke", "--edit=" + edited], d,
               f"an edit of {edited} invalidates {stale} of 6 stages")
    p = expect(0, ["list", "--json", "--profile=smoke"], d)
    check(len(json.loads(p.stdout)) == 4, "list --json lists four cases")
    expect(0, ["--dry-run", "--profile=smoke"], d, "6 stages to run")
    check(not os.path.exists(os.path.join(d, "results")), "dry run is dry")
    expect(0, ["--profile=smoke"], d, "results: results/smoke")
    p = expect(0, ["--profile=smoke", "--dry-run"], d, "0 stages to run")
    expect(0, ["run", "--profile=smoke"], d, "0 stages run, 6 reused")
    expect(0, ["verify", "results/smoke"], d, "0 mismatches")
    expect(0, ["report", "results/smoke", "--check"], d, "index.html")
    expect(7, ["report", "results/smoke", "--check"], d, "R1",
           env={"PHYSINV_FAKE_DOUBT": "1"})
    expect(0, ["report", "results/smoke"], d,
           env={"PHYSINV_FAKE_DOUBT": "1"})
    expect(4, ["--profile=bad", "--jobs=2"], d, "fail")
    p = expect(10, ["--profile=quick", "--time-budget=0.000001"], d,
               "18 of 18 cases not run")
    check("out of time: 18 cases not run" in p.stdout, "time budget")
    for args in (["verify"], ["report"], ["report", "--check"]):
        expect(10, [*args, "results/quick"], d, "18 cases not run")


def accounts(d):
    """Data, evaluation, bookkeeping and waiting are listed separately."""
    p = expect(0, ["--profile=smoke", "--out=accounts"], d)
    parts = ("data ", "evaluation ", "bookkeeping ", "waiting for the disk ")
    line = next(x for x in p.stdout.splitlines() if " stages run, " in x)
    check(all(part in line for part in parts), line)
    with open(os.path.join(d, "accounts/results.json")) as f:
        context = json.load(f)["context"]
    names = ("data_ms", "evaluation_ms", "bookkeeping_ms", "waiting_ms")
    check(all(0 <= context[name] < context["wall_ms"] * os.cpu_count()
              for name in names), str({n: context[n] for n in names}))
    check(0 < context["evaluation_ms"] < context["stages_cpu_ms"],
          "evaluation is a part of the stages")
    expect(0, ["report", "accounts"], d)
    with open(os.path.join(d, "accounts/report/index.html")) as f:
        page = f.read()
    check("evaluation ms" in page and "stages cpu ms" in page,
          "the report tells evaluation")


def damaged(d):
    """A corrupt journal is named, a torn last line does no harm."""
    journal = os.path.join(d, "results/smoke/journal.jsonl")
    whole = open(journal, "rb").read()
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 1
    open(journal, "wb").write(flipped)
    for args in (["--profile=smoke"], ["verify", "results/smoke"],
                 ["report", "results/smoke"]):
        expect(9, args, d, "journal")
    flipped = bytearray(whole)
    flipped[-20] ^= 1
    open(journal, "wb").write(flipped)
    for args in (["--profile=smoke"], ["verify", "results/smoke"],
                 ["report", "results/smoke"],
                 ["merge", "m", "results/smoke"]):
        expect(9, args, d, "line 7")
    open(journal, "wb").write(whole[:-20])
    for args in (["verify", "results/smoke"], ["report", "results/smoke"],
                 ["merge", "m", "results/smoke"]):
        p = expect(10, args, d, " not run (first fake/cubic/")
        check("line 7" in p.stdout, "the torn line is named")
    expect(0, ["--profile=smoke"], d, "1 stages run, 5 reused")
    expect(0, ["verify", "results/smoke"], d, "0 mismatches")
    case = os.path.join(d, "results/smoke/cases")
    case = os.path.join(case, sorted(os.listdir(case))[0])
    os.remove(case)
    for args in (["verify", "results/smoke"], ["report", "results/smoke"],
                 ["report", "results/smoke", "--check"]):
        expect(10, args, d, "stages lost their arrays (first ")
    expect(0, ["--profile=smoke"], d, "stages run")


def damaged_plan(d):
    """One wrong byte is an error, a plan of an older version is not."""
    path = os.path.join(d, "results/smoke/plan.json")
    readers = (["verify", "results/smoke"], ["report", "results/smoke"])
    whole = open(path, "rb").read()
    open(path, "wb").write(whole.replace(b"fake/cubic/walk",
                                         b"fake/cubic/wolk", 1))
    for args in (*readers, ["merge", "m", "results/smoke"],
                 ["--profile=smoke"]):
        expect(9, args, d, "plan.json is damaged")
    os.remove(path)
    for args in readers:
        expect(10, args, d, "plan.json is missing")
    expect(2, ["merge", "m", "results/smoke"], d, "plan.json is missing")
    expect(0, ["--profile=smoke"], d, "0 stages run, 6 reused")
    plan = json.load(open(path))
    for key in ("checksum", "recipes", "keys"):
        del plan[key]
    json.dump({**plan, "schema_version": 1}, open(path, "w"))
    for args in (*readers, ["merge", "old", "results/smoke"]):
        expect(0, args, d, "written by an older version")
    expect(0, ["--profile=smoke"], d, "0 stages run, 6 reused")
    p = expect(0, ["verify", "results/smoke"], d, "6 of 6 stages")
    check("older" not in p.stdout, "a run renews the plan")


def fresh(d):
    """--fresh touches what is selected, nothing else."""
    out = ["--profile=smoke", "--out=part"]
    expect(0, out, d)
    before = results(os.path.join(d, "part"))
    expect(0, [*out, "--filter=walk", "--fresh"], d, "2 stages run, 0 reused")
    check(results(os.path.join(d, "part")) == before, "fresh keeps the others")
    expect(0, [*out], d, "0 stages run, 6 reused")
    expect(0, ["verify", "part"], d, "6 of 6 stages")


def incomplete(d):
    """What is missing has an exit code; what is there is kept."""
    quick = ["--profile=quick"]
    for i in (1, 2):
        expect(0, [*quick, f"--shard={i}/2", f"--out=h{i}"], d)
    expect(0, [*quick, "--shard=2/2", "--set", "iterations=5", "--out=h5"], d)
    expect(2, ["merge", "h", "h1", "h5"], d, "with different options")
    check(not os.path.exists(os.path.join(d, "h")), "nothing was merged")
    expect(2, ["merge", "h1", "h2"], d, "cannot be OUT")
    expect(2, ["merge", "h1", "h1", "h2"], d, "both OUT and a shard")
    p = expect(10, ["merge", "h", "h1"], d, "9 cases not run")
    check("merged 1 into h" in p.stdout, "what is there was merged")
    expect(10, ["report", "h", "--check"], d, "9 cases not run")
    expect(10, ["verify", "h"], d, "9 cases not run")
    expect(0, ["merge", "h", "h1", "h2"], d, "merged 2")
    expect(0, ["report", "h", "--check"], d, "1 gating claims judged: 1 reproduced")
    only = ["--profile=smoke", "--filter=walk", "--out=only"]
    expect(0, only, d)
    expect(10, ["report", "only", "--check"], d, "no gating claim")
    expect(0, ["report", "only"], d)
    expect(4, ["--profile=bad", "--out=bad"], d)
    expect(10, ["verify", "bad"], d, "stages failed (first ")
    expect(10, ["report", "bad"], d, "stages failed (first ")
    page = os.path.join(d, "bad/report/fake-cubic/tables/failed_runs.csv")
    with open(page) as f:
        failed = f.read()
    check("no solution today" in failed and "out of memory" in failed,
          "the page names runs that failed, and why")


def known_failures(d):
    """A miss that states its cause, or is named, is good; another is not."""
    doubt = {"PHYSINV_FAKE_DOUBT": "1"}
    cause = {"PHYSINV_FAKE_CAUSE": "in doubt"}
    args = ["report", "part", "--check"]
    expect(7, args, d, "R1", env=doubt)
    expect(0, args, d, "not reproduced, as expected: fake/cubic R1: in doubt",
           env={**doubt, **cause})
    expect(0, args, d, "reproduced, although its cause says: fake/cubic R1: in d",
           env=cause)
    named = [*args, "--expected=fake/cubic R1"]
    expect(0, named, d, "not reproduced, as expected: fake/cubic R1: descend",
           env=doubt)
    expect(0, named, d, "reproduced, although not expected: fake/cubic R1")
    expect(2, [*args, "--expected=fake/cubic R1, fake/cubic R2"], d,
           "no claim 'fake/cubic R2'")


def same_bits(d):
    quick = ["--profile=quick", "--trace"]
    expect(0, [*quick, "--jobs=1", "--out=one"], d)
    base = results(os.path.join(d, "one"))
    check(len(base) >= 30, f"{len(base)} entries")
    for name, flags in {"two": ["--jobs=2"], "seven": ["--jobs=7"],
                        "threads": ["--threads=2", "--jobs=1"]}.items():
        expect(0, [*quick, *flags, "--out=" + name], d)
        check(results(os.path.join(d, name)) == base, "same bits: " + name)
    for i in (1, 2, 3):
        expect(0, [*quick, f"--shard={i}/3", f"--out=s{i}"], d)
    expect(0, ["merge", "merged", "s3", "s1", "s2"], d)
    check(results(os.path.join(d, "merged")) == base, "same bits: merged")
    expect(0, ["verify", "merged"], d, "0 mismatches")


def interrupted(d):
    """SIGINT keeps what has finished; the next run continues."""
    for number, jobs in ((signal.SIGINT, "1"), (signal.SIGTERM, "2")):
        out = f"slow{jobs}"
        p = subprocess.Popen(
            [BENCH, "--profile=slow", "--jobs=" + jobs, "--out=" + out],
            cwd=d, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(1)
        p.send_signal(number)
        begin = time.time()
        text, _ = p.communicate(timeout=30)
        check(p.returncode == 130 and time.time() - begin < 5,
              f"{number.name} ends it with {p.returncode}")
        check("2 cases not run" in text and "2 stages run" in text,
              "it says what is kept")
        expect(0, ["--profile=slow", "--filter=descend", "--out=" + out], d,
               "2 reused")


def crowded(d):
    """A run that waits for a core has more wall time than CPU time; it is said once,
    and kept."""
    env = {"PHYSINV_FAKE_PACE_MS": "5"}
    p = expect(0, ["--profile=smoke", "--out=crowded", "--filter=descend"], d,
               "1 of 1 stages were crowded", env=env)
    check(p.stdout.count("crowded (") == 1, "once")
    with open(os.path.join(d, "crowded", "results.json")) as f:
        entries = json.load(f)["benchmarks"]
    check([e["physinv"]["crowded"] for e in entries] == [True],
          "results.json marks it")
    expect(0, ["report", "crowded"], d, "1 of 1 stages were crowded")
    with open(os.path.join(d, "crowded", "report", "report.md")) as f:
        check("- crowded: 1 of 1 stages" in f.read(), "the report marks it")


def no_space(d):
    """A full disk (a small tmpfs, if we may mount one)."""
    disk = os.path.join(d, "disk")
    os.mkdir(disk)
    mount = ["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk]
    if subprocess.run(mount, capture_output=True).returncode != 0:
        print("skip full disk: no mount")
        return
    try:
        expect(9, ["--profile=quick", "--out=disk/r"], d)
        subprocess.run(["mount", "-o", "remount,size=16m", disk], check=True)
        p = expect(0, ["--profile=quick", "--out=disk/r"], d)
        check(" 0 reused" not in p.stdout, "what fitted was kept")
        expect(0, ["verify", "disk/r"], d, "0 mismatches")
    finally:
        subprocess.run(["umount", disk], check=False)


with tempfile.TemporaryDirectory() as directory:
    os.mkdir(os.path.join(directory, "published"))
    for test in (bad_input, good_input, accounts, damaged, damaged_plan,
                 fresh, incomplete, known_failures, same_bits, interrupted,
                 crowded, no_space):
        test(directory)
sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
