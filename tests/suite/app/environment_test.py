"""What the program is started in and with: streams that are closed or full,
limits of memory and processes, numbers beyond all bounds, its own help."""

import itertools
import json
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile

from program import BENCH, FAILED, check

SMOKE = ["--profile=smoke", "--jobs=2"]


def run(*args, **kwargs):
    kwargs = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **kwargs}
    return subprocess.run([BENCH, *args], text=True, timeout=60, **kwargs)


def fails(code, says, *args, **kwargs):
    p = run(*args, **kwargs)
    good = p.returncode == code and says in p.stderr and \
        p.stderr.count("\n") == 1
    check(good, f"{' '.join(args)[:80]} -> {p.returncode} {p.stderr[:200]}")


def closed(*descriptors):
    return lambda: [os.close(d) for d in descriptors]


def closed_streams(d):
    """Journal and lock hold what they should, whichever of 0 to 2 is closed."""
    for count in (1, 2, 3):
        for which in itertools.combinations(range(3), count):
            out = os.path.join(d, "closed" + "".join(map(str, which)))
            p = run(*SMOKE, "--out", out, preexec_fn=closed(*which),
                    stdin=subprocess.DEVNULL)
            check(p.returncode == (9 if 1 in which else 0),
                  f"runs without {which}: {p.returncode}")
            check(1 not in which or 2 in which or
                  "cannot write standard output" in p.stderr, "it is said")
            lock = open(os.path.join(out, "lock")).read()
            check(lock.isdigit(), f"lock holds a process: {lock[:40]!r}")
            p = run("verify", out)
            check("0 mismatches" in p.stdout, "store is whole " + p.stderr)
    p = run("--profile=huge", preexec_fn=closed(2))
    check(p.returncode == 2, f"an error without stderr -> {p.returncode}")
    for args in (["export", out], ["list"], ["--help"], ["--version"],
                 ["help", "run"], ["verify", out], ["report", out],
                 ["completion", "bash"], ["compare", out, out],
                 ["export", out, "--format=csv"]):
        fails(9, "standard output", *args, preexec_fn=closed(1))
    written = os.path.join(d, "exported.json")
    p = run("export", out, "--out=" + written, preexec_fn=closed(1))
    check(p.returncode == 0 and json.load(open(written)), "into a file")


def broken_streams(d):
    """The campaign continues, and says that its output could not be read."""
    out = os.path.join(d, "broken")
    with open("/dev/full", "w") as full:
        fails(9, "standard output", *SMOKE, "--out", out, stdout=full)
        check("0 stages to run" in run(*SMOKE, "--out", out,
                                       "--dry-run").stdout, "all has run")
        p = run("--profile=huge", stderr=full)
        check(p.returncode == 2, f"an error into a full disk {p.returncode}")
    reader, writer = os.pipe()
    os.close(reader)
    fails(9, "standard output", "list", stdout=writer, restore_signals=False,
          preexec_fn=lambda: signal.signal(signal.SIGPIPE, signal.SIG_IGN))


def memory_limit():
    resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))


def missing_threads(d):
    """Stacks of 1024 threads take more than 1 GiB of addresses."""
    if run("--version", preexec_fn=memory_limit).returncode != 0:
        print("skip missing threads: a sanitizer needs more addresses")
        return
    fails(9, "of 1024 threads could be started", *SMOKE, "--threads=1024",
          "--out", os.path.join(d, "threads"), preexec_fn=memory_limit)


def huge_numbers(d):
    """A line at once, instead of memory until there is none."""
    huge = (9223372036854775807, 18446744073709551615, 10**30)
    for number in huge:
        for flag in ("--seeds={}", "--seeds=1-{}", "--set=n={}",
                     "--set=iterations={}", "--jobs={}", "--threads={}",
                     "--shard=1/{}", "--shard={0}/{0}"):
            fails(2, "", "list" if "jobs" not in flag and "threads" not in flag
                  else "run", "--profile=smoke", flag.format(number))
    fails(2, "more than 100000 values", "list", "--seeds=" +
          ",".join(["0-99999"] * 1000))
    fails(2, "more than 100000 cases", "list", "--seeds=0-9999",
          "--set=n=1-10000")
    fails(2, "not positive", "--time-budget=1e999")
    fails(2, "not positive", "--time-budget=nan")
    p = run("list", "--json", "--profile=smoke", "--filter=walk",
            f"--seeds={2**53 - 1}")
    check(json.loads(p.stdout)[0]["seed"] == 2**53 - 1, "the largest seed")


def own_help(d):
    """What the help says can be done does something."""
    text = " ".join(run("run", "--help").stdout.split())
    check("smoke, quick, bad, hostile, slow, kernel; default: quick" in text,
          "profiles")
    example = re.search(r"\((--filter=\S+)\)", text).group(1)
    everything = len(json.loads(run("list", "--json").stdout))
    p = run("list", "--json", example)
    check(p.returncode == 0 and len(json.loads(p.stdout)) < everything,
          example + " takes something out")


with tempfile.TemporaryDirectory() as directory:
    os.chdir(directory)
    for test in (closed_streams, broken_streams, missing_threads,
                 huge_numbers, own_help):
        test(directory)
sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
