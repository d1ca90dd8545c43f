"""A campaign that the program over one folder of experiments began is resumed by
the program over all, and the other way round: the same keys and bits, and a page
with the same claims.

    folder_test.py PROGRAM PROGRAM-OF-JPO-BILLIARDS"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

WHOLE, PART = (os.path.abspath(p) for p in sys.argv[1:3])
RUN = ["--profile=smoke", "--filter=^jpo/billiards/", "--jobs=1"]


def run(program, *arguments):
    done = subprocess.run([program, *arguments], capture_output=True, text=True)
    assert done.returncode == 0, (program, arguments, done)
    return done.stdout


def stages(text):
    counts = re.search(r"^(\d+) stages run, (\d+) reused", text, re.M)
    return tuple(map(int, counts.groups()))


def records(out):
    """What is recorded of each stage but its times."""
    text = json.loads((out / "results.json").read_text())
    return {s["name"]: (s["physinv"]["key"], s["physinv"]["counts"],
                        s["loss_mean"], s["loss_max"])
            for s in text["benchmarks"]}


def verdicts(program, out):
    """On the page that a run writes which finds all stages finished."""
    run(program, *RUN, f"--out={out}")
    pages = json.loads((out / "report/claims.json").read_text())
    return [s["claims"] for s in pages["sections"]
            if s["experiment"] == "jpo/billiards"][0]


with tempfile.TemporaryDirectory() as directory:
    of_whole, of_part = (pathlib.Path(directory) / n for n in ("whole", "part"))
    ran, reused = stages(run(WHOLE, *RUN, f"--out={of_whole}"))
    assert ran > 5 and reused == 0, (ran, reused)
    assert stages(run(PART, *RUN, f"--out={of_part}")) == (ran, 0)
    assert records(of_whole) == records(of_part)
    assert stages(run(WHOLE, *RUN, f"--out={of_part}")) == (0, ran)
    assert stages(run(PART, *RUN, f"--out={of_whole}")) == (0, ran)
    claims = verdicts(WHOLE, of_part)
    assert len(claims) > 10 and claims == verdicts(PART, of_part), claims
    names = re.findall(r"[a-z]+/[a-z-]+/",
                       run(PART, "--profile=smoke", "--dry-run", "--fresh",
                           f"--out={of_part}"))
    assert set(names) == {"jpo/billiards/"}, names

    # No run of gd decides a claim; that on numbers of parameters needs none.
    alone = pathlib.Path(directory) / "gd"
    run(WHOLE, "--profile=smoke", "--filter=^jpo/billiards/gd/",
        f"--out={alone}")
    check = subprocess.run([WHOLE, "report", str(alone), "--check"],
                           capture_output=True, text=True)
    assert check.returncode == 10, check
    assert "these runs decide no gating claim" in check.stderr, check
