"""Stages that continue from the middle: killed, damaged, run again."""

import glob
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from program import BENCH, FAILED, check, crc32c, results


def start(out, *flags, pace="40", plant=""):
    return subprocess.Popen(
        [BENCH, "run", "--profile=smoke", "--filter=/descend/", "--jobs=1",
         "--trace", "--checkpoint=0.001", *flags, "--out", out],
        env={**os.environ, "PHYSINV_FAKE_PACE_MS": pace,
             "PHYSINV_FAKE_PLANT": plant},
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def finish(process):
    text, _ = process.communicate(timeout=120)
    check(process.returncode == 0, f"exit code {process.returncode}")
    return text


def states(out):
    return sorted(p for p in glob.glob(os.path.join(out, "checkpoints", "*"))
                  if not p.endswith(".tmp"))


def killed_inside(out):
    """Kills a campaign once a stage has saved its state."""
    process = start(out)
    end = time.time() + 60
    while not states(out) and process.poll() is None and time.time() < end:
        time.sleep(0.002)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    check(len(states(out)) == 1, "one stage is half done")
    return states(out)[0]


def matrix(rows, columns):
    numbers = [rows.to_bytes(8, "little"), columns.to_bytes(8, "little")]
    return b"".join(numbers + [b"\0" * 8] * rows * columns)


def forgeries(state):
    """Headers of wrong types, and states whose parts are of other sizes."""
    with open(state, "rb") as f:
        head, parts = f.read()[8:].split(b"\n", 1)
    whole = json.loads(head)
    for key in whole:
        for other in (None, -1, 1e300, [], {}):
            yield json.dumps({**whole, key: other}).encode() + b"\n" + parts
    yield json.dumps({**whole, "iteration": "x"}).encode() + b"\n" + parts
    for other in (b"", b"[]", b"7", b"{", b"[" * 100000):
        yield other + b"\n" + parts
    yield head  # without an end
    for size in (0, 1, 7, 8, len(parts) // 2, len(parts) - 1):
        yield head + b"\n" + parts[:size]
    # Estimates and gradients are first, 2 x 4 each.
    rest = parts[2 * len(matrix(2, 4)):]
    for rows, columns in ((2, 3), (2, 5), (1, 4), (0, 0), (2, 0)):
        yield head + b"\n" + 2 * matrix(rows, columns) + rest
    for number in (-1, 1 << 62, 1 << 40):
        for at in (0, 8):
            yield head + b"\n" + parts[:at] + \
                number.to_bytes(8, "little", signed=True) + parts[at + 8:]


def forged(d, whole):
    """Each is given up, and the stage has the result that it should."""
    out = os.path.join(d, "forged")
    state = killed_inside(out)
    original = os.path.join(d, "original")
    shutil.copytree(out, original)
    count = 0
    for text in forgeries(state):
        shutil.rmtree(out)
        shutil.copytree(original, out)
        text = b" " + text.lstrip(b" ")
        with open(state, "wb") as f:
            f.write(crc32c(text) + text)
        process = start(out, pace="0")
        process.communicate(timeout=60)
        if process.returncode != 0 or states(out) or \
                results(out) != results(whole):
            check(False, f"{text[:60]} -> {process.returncode}")
        count += 1
    check(count > 30, f"{count} forged states end well")


def crash(d, whole):
    """A state that ends its worker does so once."""
    out = os.path.join(d, "crash")
    killed_inside(out)
    text = finish(start(out, pace="0", plant="a crash when going on"))
    check("cannot resume from its checkpoint" in text and "it starts again" in text,
          "says so")
    check(results(out) == results(whole), "same results as uninterrupted")


with tempfile.TemporaryDirectory() as d:
    whole = os.path.join(d, "whole")
    finish(start(whole, pace="0"))
    check(not states(whole), "what has finished leaves no state")

    out = os.path.join(d, "killed")
    killed_inside(out)
    text = finish(start(out, pace="0"))
    check("resuming fake/cubic/descend" in text, "goes on, and says so")
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
    check("resuming " not in text, "nothing goes on from it")
    check(results(out) == results(whole), "same results as uninterrupted")

    forged(d, whole)
    crash(d, whole)

    out = os.path.join(d, "fresh")
    state = killed_inside(out)
    other = os.path.join(out, "checkpoints", "0" * 32)
    with open(state, "rb") as f, open(other, "wb") as g:
        g.write(f.read())
    text = finish(start(out, "--fresh", pace="0"))
    check("resuming " not in text, "--fresh starts again")
    check(states(out) == [other], "and leaves the states of others")
    check(results(out) == results(whole), "same results as uninterrupted")

    p = subprocess.run([BENCH, "run", "--checkpoint=often", "--out", d],
                       capture_output=True, text=True)
    check(p.returncode == 2 and "--checkpoint=often" in p.stderr,
          "a bad period is refused")

sys.exit(f"{len(FAILED)} failed" if FAILED else 0)
