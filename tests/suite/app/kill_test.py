"""kill -9 at random moments of a campaign, each followed by a resume.

  kill_test.py PROGRAM [COUNT] [FLAGS...]

No finished stage is lost or run twice, and the end equals that of an
uninterrupted campaign, times apart.
"""

import json
import os
import random
import signal
import subprocess
import sys
import tempfile
import time

from program import BENCH, TIMES, results

COUNT = int(sys.argv[2]) if len(sys.argv) > 2 else 5
FLAGS = sys.argv[3:] or ["--profile=smoke", "--jobs=2"]
PACE = {**os.environ, "PHYSINV_FAKE_PACE_MS": "5"}


def start(out):
    return subprocess.Popen([BENCH, "run", *FLAGS, "--trace", "--out", out],
                            env=PACE, stdout=subprocess.PIPE, text=True)


def finish(process, what):
    text, _ = process.communicate(timeout=600)
    if process.returncode != 0:
        sys.exit(f"{what}: exit code {process.returncode}")
    return text


def journal(out):
    """(case, stage) of every complete line with a result, in order."""
    try:
        with open(os.path.join(out, "journal.jsonl"), "rb") as f:
            text = f.read()
    except FileNotFoundError:
        return []
    found = []
    for line in text.split(b"\n")[1:-1]:
        record = json.loads(line[9:])["record"]
        found.append((record["case"], record["stage"]))
    return found


random.seed(int(os.environ.get("PHYSINV_KILL_SEED", "1")))
with tempfile.TemporaryDirectory() as d:
    whole = os.path.join(d, "whole")
    begin = time.time()
    finish(start(whole), "uninterrupted")
    duration = time.time() - begin
    expected = results(whole, (*TIMES, "bytes"))
    midway = 0
    for i in range(COUNT):
        out = os.path.join(d, f"killed{i}")
        moment = random.uniform(0, 1.1 * duration)
        process = start(out)
        time.sleep(moment)
        process.send_signal(signal.SIGKILL)
        process.communicate()
        before = journal(out)
        text = finish(start(out), f"resumed after {moment:.3f} s")
        after = journal(out)
        midway += 0 < len(before) < len(after)
        if after[:len(before)] != before:
            sys.exit(f"lost a stage, killed after {moment:.3f} s")
        if len(set(after)) != len(after):
            sys.exit(f"ran a stage twice, killed after {moment:.3f} s")
        if results(out, (*TIMES, "bytes")) != expected:
            sys.exit(f"other results, killed after {moment:.3f} s: {out}")
    print(f"{COUNT} kills within {duration:.2f} s, {midway} with some stages "
          "done: nothing lost, nothing twice, results equal")
