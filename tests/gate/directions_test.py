"""60 planted changes through compare and gate: ten kinds, in one of many seeds
or in all runs of a method, for the worse and, with the sides exchanged, for the
better. Which stages are named, in which direction, with which exit code."""

import json
import os
import shutil
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, "..", "suite", "app"))
from program import FAILED, check, expect, run  # noqa: E402

ASPECTS = ("loss", "status", "claims", "work", "time", "missing")
FAIL_ON = [f"--fail-on={aspect}" for aspect in ASPECTS]
COSTS = {"work", "time"}  # no gain of a stage that ends worse, either

# What compare calls worse, from the base to the change and back, and what gate
# says: worse, better, same. Where nothing but the last bits is another, gate may
# find the losses smaller. Without a median that is finite losses are larger.
KINDS = {
    "larger losses": ({"loss"}, set(), "worse", "better"),
    "an ulp in x": (set(), set(), "worse", "worse"),
    "ulp in a constant": (set(), set(), "worse", "worse"),
    "NaN in a loss": ({"status", *COSTS}, set(), "worse", "better"),
    "no finite loss": ({"loss", "status", *COSTS}, set(), "worse", "better"),
    "an exception": ({"loss", "status", *COSTS}, set(), "worse", None),
    "it converges": (set(), {"status"}, "better", "worse"),
    "gtol": (set(), {"status"}, "worse", "worse"),
    "more work": ({"work"}, set(), "worse", "better"),
    "slower": ({"time"}, set(), "same", "same"),
}
# In which runs: a filter, and the stages it is of.
PLACES = {
    "descend/n=4/seed=1$": {("descend", "solve", 4, 1)},
    "walk/n=9/seed=2$": {("walk", "refine", 9, 2)},
    "stroll/": {("stroll", "refine", n, s) for n in (4, 9) for s in range(3)},
}


def rows_of(p):
    return json.loads(p.stdout)["rows"]


def is_named(row):
    """Other bits, end or work, or a time of the worst pair that is another."""
    a, b = row["sides"]
    times = row["against_first"][0]["worst"]["raised_time_ratio"]
    return (b["same_bits"] < b["stages"] or a["ends"] != b["ends"] or
            a["counts"] != b["counts"] or not 2 / 3 < (times or 1) < 3 / 2)


def compared(d, what, sides, worse, places):
    """Both pooled and not: one of many runs is not lost in a median."""
    code = 0 if not worse else 6 if worse == {"time"} else 5
    for by in ("seed", "method"):
        p = run("compare", *sides, "--by=" + by, "--format=json", *FAIL_ON,
                cwd=d)
        told = {a for a in ASPECTS if f"{a} (" in p.stderr}
        check(p.returncode == code and
              (told == worse or told == worse | {"loss"} and
               "NaN" in what) and
              len(p.stderr.splitlines()) == (1 if code else 0),
              f"{what}: compare --by={by} -> {p.returncode} {told} "
              f"{p.stderr.strip()[:300]}")
        if by == "method" and what.startswith("slower") and "back" in what:
            continue  # a faster stage is not a worst pair
        named = [r for r in rows_of(p) if is_named(r)]
        wanted = {w if by == "seed" else (*w[:2], None, None) for w in places}
        check({(r["method"], r["stage"], r["n"], r["seed"]) for r in named}
              == wanted, f"{what}: {by}: these stages and no others")
        if by == "method" and "status" in worse:
            worst = named[0]["against_first"][0]["worst"]
            check((worst["n"], worst["seed"]) in {w[2:] for w in places} and
                  worst["end"] == "worse", f"{what}: the worst pair")


def gated(d, what, sides, plant, verdict, place, stages):
    """The base is that of the whole campaign; back, of the place alone."""
    if verdict is None:  # a campaign with failures is not a baseline
        expect(10, ["baseline", sides[0], "--out=no.txt"], d, "failed")
        return
    whole = sides[0] == "base"
    if not whole:
        expect(0, ["baseline", sides[0], "--out=now.txt"], d,
               env={"PHYSINV_FAKE_PLANT": plant})
    p = run("gate", f"--baseline={sides[0]}.txt", "--results=" + sides[1],
            "--json=gate.json", *([] if whole else ["--filter=" + place]),
            cwd=d)
    with open(os.path.join(d, "gate.json")) as f:
        found = json.load(f)
    named = {f["name"]: f for f in found["findings"] if f["verdict"] != "same"}
    wanted = set() if verdict == "same" else {
        f"fake/cubic/{m}/n={n}/seed={s}/{stage}" for m, stage, n, s in stages}
    verdicts = {f["verdict"] for f in named.values()}
    possible = {"worse", "better"} if "ulp" in plant else {verdict} & {
        "worse", "better"}
    check(p.returncode == (5 if "worse" in verdicts else 0) and
          set(named) == wanted and verdicts <= possible and
          all(f[f["verdict"]] for f in named.values()),
          f"{what}: gate -> {p.returncode} {p.stdout[:600]}")
    if plant == "an ulp in x":
        check(all(1e-17 < f["relative_change"]["x"] < 1e-15
                  for f in named.values()) and
              "largest relative change" in p.stdout and "in x of" in p.stdout,
              f"{what}: its size: {found['largest_change']}")


def main(d):
    os.mkdir(os.path.join(d, "published"))
    quick = ["--profile=quick", "--trace"]
    expect(0, [*quick, "--out=base"], d)
    expect(0, ["baseline", "base", "--out=base.txt"], d)
    changes = 0
    for kind, (there, back, gate_there, gate_back) in KINDS.items():
        for place, stages in PLACES.items():
            shutil.copytree(os.path.join(d, "base"), os.path.join(d, "now"),
                            ignore=shutil.ignore_patterns("disturbed"))
            p = run(*quick, "--out=now", "--fresh", "--filter=" + place, cwd=d,
                    env={"PHYSINV_FAKE_PLANT": kind})
            check(p.returncode == (4 if kind == "an exception" else 0), kind)
            what = f"{kind} in {place}"
            compared(d, what, ("base", "now"), there, stages)
            compared(d, what + ", back", ("now", "base"), back, stages)
            gated(d, what, ("base", "now"), kind, gate_there, place, stages)
            gated(d, what + ", back", ("now", "base"), kind, gate_back, place,
                  stages)
            changes += 2
            shutil.rmtree(os.path.join(d, "now"))
    check(changes == 60, "60 changes")


with tempfile.TemporaryDirectory() as directory:
    main(directory)
sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
