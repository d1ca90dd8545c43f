"""Stages that go on from the middle: killed, damaged, run again."""

import glob
import os
import signal
import subprocess
import sys
import tempfile
import time

from program import BENCH, FAILED, check, results


def start(out, *flags, pace="40"):
    return subprocess.Popen(
        [BENCH, "run", "--profile=smoke", "--filter=/descend/", "--jobs=1",
         "--trace", "--checkpoint=0.001", *flags, "--out", out],
        env={**os.environ, "PHYSINV_FAKE_PACE_MS": pace},
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def finish(process):
    text, _ = process.communicate(timeout=120)
    check(process.returncode == 0, f"exit code {process.returncode}")
    return text


def states(out):
    return sorted(p for p in glob.glob(os.path.join(out, "checkpoints", "*"))
                  if not p.endswith(".tmp"))


def killed_inside(out):
    """Kills a campaign once a stage has laid its state down."""
    process = start(out)
    end = time.time() + 60
    while not states(out) and process.poll() is None and time.time() < end:
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    check(len(states(out)) == 1, "one stage is half done")
    return states(out)[0]


with tempfile.TemporaryDirectory() as d:
    whole = os.path.join(d, "whole")
    finish(start(whole, pace="0"))
    check(not states(whole), "what has finished leaves no state")

    out = os.path.join(d, "killed")
    killed_inside(out)
    text = finish(start(out, pace="0"))
    check("going on with fake/cubic/descend" in text, "goes on, and says so")
    check("from iteration" in text and "from iteration 0" not in text,
          "from the middle")
    check(results(out) == results(whole), "same results as uninterrupted")
    check(not states(out), "no state is left")

    out = os.path.join(d, "damaged")
    state = killed_inside(out)
    with open(state, "r+b") as f:
        f.seek(-3, os.SEEK_END)
        f.write(b"\x55")
    text = finish(start(out, pace="0"))
    check("is damaged (its stage starts again)" in text, "damage is said")
    check("going on with" not in text, "nothing goes on from it")
    check(results(out) == results(whole), "same results as uninterrupted")

    out = os.path.join(d, "fresh")
    state = killed_inside(out)
    other = os.path.join(out, "checkpoints", "0" * 32)
    with open(state, "rb") as f, open(other, "wb") as g:
        g.write(f.read())
    text = finish(start(out, "--fresh", pace="0"))
    check("going on with" not in text, "--fresh starts again")
    check(states(out) == [other], "and leaves the states of others")
    check(results(out) == results(whole), "same results as uninterrupted")

    p = subprocess.run([BENCH, "run", "--checkpoint=often", "--out", d],
                       capture_output=True, text=True)
    check(p.returncode == 2 and "--checkpoint=often" in p.stderr,
          "a bad period is refused")

sys.exit(f"{len(FAILED)} failed" if FAILED else 0)
