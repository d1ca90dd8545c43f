"""Exit codes: every one that the help of a verb or a page of docs names for it is
seen to come, and the pages name those that the help does."""

import json
import os
import re
import sys
import tempfile

from program import BENCH, FAILED, check, expect, run

DOCS = os.path.abspath(sys.argv[2])

# What runs another program in its place: cli_test.py and install.pendulum have them.
OTHER_PROGRAMS = ("conformance", "kernels")
SELECTION = ["--profile=quick", "--filter=descend", "--tasks=2"]


def script(d, name, text):
    path = os.path.join(d, name)
    with open(path, "w") as f:
        f.write("#!/bin/bash\n" + text + "\n")
    os.chmod(path, 0o755)
    return path


def prepare(d):
    smoke = ["--profile=smoke", "--trace"]
    expect(0, [*smoke, "--out=good"], d)
    expect(0, [*smoke, "--out=short", "--set", "iterations=2"], d)
    expect(0, [*smoke, "--out=long", "--set", "iterations=100000"], d)
    expect(0, [*smoke, "--out=walk", "--filter=walk"], d)
    expect(0, [*smoke, "--out=stroll", "--filter=stroll"], d)
    expect(10, ["--profile=quick", "--time-budget=0.000001", "--out=part"], d)
    expect(0, ["baseline", "good", "--out=base.txt"], d)
    expect(0, ["report", "good", "--publish=kept/good"], d)
    run("--profile=bad", "--out=broken", cwd=d)
    run("report", "broken", "--publish=kept/broken", cwd=d)
    with open(os.path.join(d, "base.txt"), "rb") as f:
        text = f.read()
    with open(os.path.join(d, "torn.txt"), "wb") as f:
        f.write(text[:-100])
    script(d, "slow", f'PHYSINV_FAKE_PACE_MS=5 exec {BENCH} "$@"')


def slurm(d):
    """A queue that takes what is submitted and runs nothing."""
    tools = os.path.join(d, "bin")
    os.mkdir(tools)
    script(tools, "sbatch", "echo 7")
    script(tools, "squeue", "exit 0")
    env = {"PATH": tools + ":" + os.environ["PATH"],
           "XDG_CACHE_HOME": os.path.join(d, "cache")}
    for name, selection in (("empty", SELECTION),
                            ("done", SELECTION),
                            ("failed", ["--profile=bad", "--filter=throws",
                                        "--tasks=1"])):
        expect(0, ["submit", "--slurm=" + name, *selection], d, env=env)
        if name == "empty":
            continue
        with open(os.path.join(d, name, "submission.json")) as f:
            tasks = json.load(f)["tasks"]
        for k in range(len(tasks)):
            own = [f for f in selection if not f.startswith("--tasks")]
            run(*own, f"--cases={name}/tasks/{k}.txt",
                f"--out={name}/shards/{k}", cwd=d)
    return env


def scenarios(d, env):
    """By verb and exit code: arguments, and variables of the environment."""
    gate = ["gate", "--baseline=base.txt"]
    plant = {"PHYSINV_FAKE_PLANT": "NaN in a loss"}
    other = {"PHYSINV_FAKE_PLANT": "another forward"}
    doubt = {"PHYSINV_FAKE_DOUBT": "1"}
    times = ["gate", "--profile=smoke", "--filter=descend",
             "--against=" + BENCH]
    longer = ["compare", "short", "long"]
    return {
        "run": {2: (["--profile=huge"],), 3: (["--filter=cubik"],),
                4: (["--profile=bad", "--out=bad"],),
                9: (["--out=/proc/nowhere"],),
                10: (["--profile=quick", "--out=late",
                      "--time-budget=0.000001"],)},
        "plan": {2: (["plan", "--measured"],),
                 3: (["plan", "--filter=cubik"],)},
        "report": {2: (["report", "nowhere"],),
                   7: (["report", "good", "--check"], doubt),
                   10: (["report", "part"],)},
        "reproduce": {2: (["reproduce"],),
                      3: (["reproduce", "none", "--campaigns=kept"],),
                      7: (["reproduce", "good", "--campaigns=kept"], doubt),
                      10: (["reproduce", "broken", "--campaigns=kept"],)},
        "verify": {2: (["verify", "nowhere"],), 4: (["verify", "good"], other),
                   10: (["verify", "part"],)},
        "gate": {2: (["gate", "--baseline=nowhere"],),
                 3: ([*gate, "--filter=no_such"],), 5: (gate, plant),
                 6: ([*times, "--head=./slow", "--budget=60"],),
                 8: ([*times, "--budget=0.000001", "--strict"],),
                 9: (["gate", "--baseline=torn.txt"],)},
        "compare": {0: (longer,),
                    2: (["compare", "good"],),
                    3: (["compare", "walk", "stroll"],),
                    5: ([*longer, "--fail-on=work"],),
                    6: ([*longer, "--fail-on=time"],)},
        "history": {2: (["history", "--baseline=/base.txt"],),
                    3: (["history", "--baseline=nowhere.txt"],)},
        "export": {2: (["export", "nowhere"],), 10: (["export", "part"],)},
        "completion": {2: (["completion", "csh"],)},
        "submit": {2: (["submit"],),
                   3: (["submit", "--slurm=none", "--filter=cubik"],),
                   9: (["submit", "--slurm=none", *SELECTION],
                       {"PATH": d})},
        "status": {0: (["status", "done"], env),
                   2: (["status", "nowhere"],),
                   4: (["status", "failed"], env),
                   9: (["status", "torn"],),
                   10: (["status", "empty"], env)},
    }


def in_help(verb, d):
    """Codes in sentences such as `Exit 4 if one differs, 10 if ...`."""
    text = " ".join(run(verb, "--help", cwd=d).stdout.split())
    codes = set()
    for sentence in re.split(r"[.;] ", text):
        said = re.search(r"\b[Ee]xit (?:code )?(\d+)(.*)", sentence)
        if said:
            codes |= {int(said[1])} | {
                int(c) for c in re.findall(r", (\d+) if\b", said[2])}
    return codes


def in_pages():
    """The table of docs/running.md, and what docs/gate.md says of the gate."""
    text = ""
    for page in ("running.md", "gate.md"):
        with open(os.path.join(DOCS, page)) as f:
            text += f.read()
    rows = text.split("| verb | exit codes other than 0 |")[1].split("\n\n")[0]
    said = {}
    for verbs, cell in re.findall(r"^\| ([a-z, ]+) \| (.*) \|$", rows, re.M):
        codes = {int(c) for part in re.findall(r"(?:^|; )(\d+(?: or \d+)*) ",
                                               cell)
                 for c in part.split(" or ")}
        said.update({verb: codes for verb in verbs.split(", ")})
    gate = re.search(r"Exit codes: 0 passed;([^.]*)\.", text)[1]
    said["gate"] = {int(c) for c in re.findall(r"\b(\d+)\s", gate)}
    return said


def main():
    with tempfile.TemporaryDirectory() as d:
        os.mkdir(os.path.join(d, "published"))
        os.mkdir(os.path.join(d, "torn"))
        with open(os.path.join(d, "torn", "submission.json"), "w") as f:
            f.write("{")
        prepare(d)
        shown = scenarios(d, slurm(d))
        for verb, codes in shown.items():
            for code, (args, *env) in codes.items():
                expect(code, args, d, env=env[0] if env else None)
        pages = in_pages()
        named = {verb: in_help(verb, d)
                 for verb in run("--list-verbs", cwd=d).stdout.split()
                 if verb not in OTHER_PROGRAMS}
        check(sum(map(len, named.values())) > 10, f"the help names {named}")
        for verb, codes in {**named, **pages}.items():
            seen = set(shown.get(verb, ()))
            codes = codes | named.get(verb, set())
            check(codes <= seen, f"{verb}: {codes} of help and pages come")
        for verb, codes in pages.items():
            check(named.get(verb, set()) - {0} <= codes,
                  f"{verb}: the pages name {named.get(verb)}")
        listed = {int(c) for c in re.findall(
            r"^ +(\d+)  ", run("--help", cwd=d).stdout, re.M)}
        check(set().union(*pages.values(), *named.values()) <= listed,
              f"--help lists {listed}")
    sys.exit(1 if FAILED else 0)


main()
