"""The first minute: what a run says before, while and after it; filters
without a flag; tables as wide as the terminal; help.

  first_test.py PROGRAM  (over the fake experiment)
"""

import fcntl
import json
import os
import pty
import re
import struct
import subprocess
import sys
import tempfile
import termios
import time

from program import BENCH, FAILED, check, expect, run


def lines_of_terminal(d, width, *args):
    """What the program writes to a terminal of so many columns."""
    head, tail = pty.openpty()
    fcntl.ioctl(tail, termios.TIOCSWINSZ,
                struct.pack("HHHH", 50, width, 0, 0))
    env = {k: v for k, v in os.environ.items() if k not in ("COLUMNS", "CI")}
    p = subprocess.Popen([BENCH, *args], cwd=d, stdout=tail, env={
        **env, "TERM": "dumb",
        "PHYSINV_PUBLISHED_DIR": os.path.join(d, "published")})
    os.close(tail)
    text = b""
    while True:
        try:
            part = os.read(head, 65536)
        except OSError:  # the last writer has gone
            break
        if not part:
            break
        text += part
    os.close(head)
    check(p.wait(timeout=60) == 0, f"{' '.join(args)} on {width} columns")
    return text.decode().split("\r\n")


def says_what_it_does(d):
    p = expect(0, ["--profile=smoke", "--jobs=2", "--out=said"], d)
    lines = p.stdout.splitlines()
    check(lines[0].startswith(
        "fake/cubic: 4 cases of profile smoke, 2 workers"), lines[0])
    end = lines[[k for k, x in enumerate(lines)
                 if x.startswith("results: ")][-1] + 1:]
    check(end[0] == "Cubic (fake/cubic)" and len(end) <= 8 + 2,
          f"{len(end)} lines of one experiment")
    check(any(x.startswith("page: said/report/index.html") for x in end),
          "the page is named")
    check(os.path.exists(os.path.join(d, "said/report/index.html")),
          "and written")
    check("loss" not in "\n".join(end), "no loss without a unit")
    p = expect(0, ["--profile=smoke", "--out=said"], d)
    check("4 have results in said" in p.stdout.splitlines()[0],
          "what is there is said")


def says_less(d):
    p = expect(0, ["--profile=smoke", "--out=q", "-q", "-j", "2"], d)
    check("[1/6]" not in p.stdout and "results: q" in p.stdout, "-q")
    p = expect(0, ["--profile=smoke", "--out=bare", "--no-report"], d)
    check(not os.path.exists(os.path.join(d, "bare/report")) and
          "page:" not in p.stdout, "--no-report")
    expect(0, ["--profile=smoke", "--out=bare"], d,
           env={"PHYSINV_NO_REPORT": "1"})
    expect(0, ["--profile=smoke", "--out=bare", "--shard=1/2"], d)
    check(not os.path.exists(os.path.join(d, "bare/report")),
          "nor does a shard")


def a_page_that_fails(d):
    """The results of the run come before, and are not lost."""
    env = {"PHYSINV_PUBLISHED_DIR": "/nowhere"}
    expect(2, ["--profile=smoke", "--out=unpublished"], d, "no directory",
           env=env)
    expect(0, ["verify", "unpublished"], d, "0 mismatches")
    expect(4, ["--profile=bad", "--out=bad"], d, "stages failed", env=env)
    os.makedirs(os.path.join(d, "occupied"))
    with open(os.path.join(d, "occupied/report"), "w") as f:
        f.write("mine")
    expect(9, ["--profile=smoke", "--out=occupied"], d, "report")
    with open(os.path.join(d, "occupied/report")) as f:
        check(f.read() == "mine", "what is not the suite's stays")


def filters_without_a_flag(d):
    def names(*args):
        p = run("run", "--profile=smoke", "--benchmark_list_tests", *args,
                cwd=d)
        return [x.split("/")[2] for x in p.stdout.split()]

    check(names("walk") == ["walk"], "run walk")
    check(names("walk", "descend") == ["descend", "walk"], "two unite")
    check(names("walk", "--filter=descend") == ["descend", "walk"],
          "with --filter, too")
    check(names("cubic", "--filter=-walk") == ["descend", "stroll", "diverge"],
          "and what is taken out stays out")
    p = expect(0, ["list", "walk", "--profile=smoke", "--json"], d)
    check(len(json.loads(p.stdout)) == 1, "list walk")
    p = run("plan", "--profile=smoke", "walk", cwd=d,
            env={"XDG_CACHE_HOME": os.path.join(d, "cache")})
    check(p.returncode == 0 and "1 cases: " in p.stdout, "plan walk")
    expect(3, ["run", "walk", "stray"], d, "matches 'stray'; nearest: ")
    expect(2, ["walkk"], d, "run walkk")


def recorded(d):
    """Results tell by regular expressions what was chosen."""
    expect(0, ["run", "walk", "--profile=smoke", "--out=recorded"], d)
    with open(os.path.join(d, "recorded/results.json")) as f:
        chosen = json.load(f)["context"]["options"]["filter"]
    check(chosen == ["walk"], f"the filter is recorded: {chosen}")


def a_campaign_file(d):
    """Flags from a file; those of the command line go before them."""
    def write(name, text):
        with open(os.path.join(d, name), "w") as f:
            f.write(text)

    def listed(*args):
        return run("run", "--benchmark_list_tests", *args, cwd=d).stdout.split()

    chosen = {"profile": "smoke", "filter": ["walk", "descend"], "jobs": 1,
              "trace": True, "out": "filed"}
    write("campaign.json", json.dumps(chosen))
    write("campaign.toml", 'profile = "smoke"\nfilter = ["walk", "descend"]\n'
          "jobs = 1\n")
    names = ["fake/cubic/descend/n=4/seed=0", "fake/cubic/walk/n=4/seed=0"]
    for name in ("campaign.json", "campaign.toml"):
        check(listed("--config=" + name) == names, name)
        check(len(listed("--config=" + name, "--filter=stroll")) == 1,
              name + " gives way")
    expect(0, ["--config", "campaign.json"], d, "2 cases of profile smoke, 1 w")
    with open(os.path.join(d, "filed/results.json")) as f:
        options = json.load(f)["context"]["options"]
    check(json.loads(options["config"]) == chosen and options["trace"],
          "its text is recorded")
    for text, says in (('{"profil": "smoke"}', "profil"),
                       ('{"profile": ""}', "--profile= is empty"),
                       ('{"profile": {"a": 1}}', "must be text"),
                       ('{"jobs": 0}', "whole number"),
                       ('{"dry-run": 7}', "not a boolean"),
                       ('{"profile"', "valid JSON"), ("profile", "valid TOML")):
        write("wrong", text)
        expect(2, ["--config=wrong"], d, says)
    expect(2, ["--config=nowhere"], d, "not a file of at most")
    expect(2, ["--config=/dev/zero"], d, "not a file of at most")


def a_budget_is_kept(d):
    """A stage that would run for a minute ends with the budget."""
    begin = time.time()
    p = expect(10, ["--profile=slow", "--filter=sleep", "--out=slept",
                    "--time-budget=4"], d, "2 of 2 cases not run within")
    seconds = time.time() - begin
    # What is not for cases comes off it: the start, pages, and a wait for stages that
    # cannot save their state.
    check(2.5 < seconds < 8, f"a budget of 4 s took {seconds:.1f} s")
    check("out of time: 2 cases" in p.stdout, "they are named")
    expect(0, ["--profile=smoke", "--out=soon", "--time-budget=100"], d,
           "[6/6]")
    p = expect(0, ["--profile=smoke", "--out=soon", "--time-budget=0.000001"],
               d)
    check("not written within the time budget: the numbers and the page; run "
          "./bench report soon" in p.stdout, "no time for a page")


def a_plan_soon(d):
    """Whatever a method does when it is tried, there is an answer, and soon."""
    for profile in ("bad", "slow", "quick"):
        begin = time.time()
        p = run("plan", "--profile=" + profile, cwd=d,
                env={"XDG_CACHE_HOME": os.path.join(d, "new")})
        seconds = time.time() - begin
        check(p.returncode == 0 and seconds < 20,
              f"plan of {profile}: {p.returncode} after {seconds:.1f} s")
        check(re.search(r"^fake/cubic .*\n\d+ cases: ", p.stdout, re.M),
              "by experiment, with a sum")
    p = run("plan", "--profile=quick", "--exact", "--each", cwd=d,
            env={"XDG_CACHE_HOME": os.path.join(d, "new")})
    check(p.stdout.count("/seed=") == 19 and "?" not in p.stdout,
          "--each and --exact")


def nearest(d):
    p = expect(2, ["--set=methods=walc"], d, "unknown method 'walc'")
    words = p.stderr.strip().split("nearest: ")[1].split(", ")
    check(words[0] == "walk" and len(words) == 5, f"the nearest five: {words}")
    p = expect(3, ["--filter=fake/kubic"], d, "nearest: fake/cubic")
    check(len(p.stderr.split("nearest: ")[1].split(", ")) <= 5, "five names")


def help_and_version(d):
    whole = expect(0, ["--help"], d).stdout
    check(expect(0, ["help"], d).stdout == whole, "help")
    check(expect(0, ["help", "plan"], d).stdout ==
          expect(0, ["plan", "--help"], d).stdout, "help plan")
    expect(2, ["help", "plam"], d, "did you mean plan")
    expect(2, ["help", "plan", "list"], d, "takes one verb")
    check(expect(0, ["-V"], d).stdout == expect(0, ["--version"], d).stdout,
          "-V")


def as_wide_as_the_terminal(d):
    smoke = ("--profile=smoke", "--out=wide")
    for args in (("list", "--profile=smoke"), ("--dry-run", *smoke), smoke,
                 ("--dry-run", *smoke), ("plan", "--profile=smoke"),
                 ("plan", "--profile=smoke", "--each")):
        for width in (40, 80, 120):
            lines = lines_of_terminal(d, width, *args)
            tables = [x for x in lines if not re.match(
                r".* (stages|cases)( to)?[ :,]|page: |results: |measuring|done |\[",
                x)]
            longest = max(len(x) for x in tables)
            check(longest <= width, f"{args[0]}: {longest} of {width} columns")
    whole = run("list", "--profile=smoke", cwd=d).stdout
    check("fake/cubic/descend/n=4/seed=0" in whole and "…" not in whole,
          "a pipe gets all")


def claims(d):
    p = expect(0, ["list", "--claims", "--format=json"], d)
    check(isinstance(json.loads(p.stdout), list), "claims as JSON")
    check(p.stdout == expect(0, ["list", "--claims", "--json"], d).stdout,
          "--json is the same")
    expect(0, ["list", "--claims", "--format=markdown"], d, "| of | id |")
    expect(2, ["list", "--claims", "--format=xml"], d, "known values: markdown")
    expect(2, ["list", "--format=markdown"], d, "known values: text")


with tempfile.TemporaryDirectory() as directory:
    os.mkdir(os.path.join(directory, "published"))
    for test in (says_what_it_does, says_less, a_page_that_fails,
                 filters_without_a_flag, recorded, a_campaign_file,
                 a_budget_is_kept, a_plan_soon, nearest, help_and_version,
                 as_wide_as_the_terminal, claims):
        test(directory)
sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
