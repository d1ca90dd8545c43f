"""`reproduce` runs published campaigns again: every one of them by cases that are
registered, and a cheap one to the published verdicts.

    reproduce_test.py PROGRAM SOURCES"""

import os
import re
import subprocess
import sys
import tempfile

PROGRAM, SOURCES = (os.path.abspath(p) for p in sys.argv[1:3])
CAMPAIGNS = SOURCES + "/reports/campaigns"
CHEAP, OF_TWO_PAPERS = "27-paper-jpo-clipping", "24-paper-physgrad-alignment"


def reproduce(code, *arguments, cwd, campaigns=CAMPAIGNS):
    done = subprocess.run(
        [PROGRAM, "reproduce", "--campaigns=" + campaigns, *arguments],
        cwd=cwd, capture_output=True, text=True)
    assert done.returncode == code, (arguments, done)
    return done.stdout + done.stderr


with tempfile.TemporaryDirectory() as d:
    planned = reproduce(0, *sorted(os.listdir(CAMPAIGNS)), "--dry-run", cwd=d)
    assert "no longer registered" not in planned, planned
    assert "load their plug-in" in planned, planned  # studies/whose-bfgs-...
    assert f"{len(os.listdir(CAMPAIGNS))} campaigns" in planned, planned
    assert "give either" in reproduce(2, cwd=d)
    assert "no campaign 'none'" in reproduce(3, "none", cwd=d)
    assert not os.listdir(d), os.listdir(d)

    few = d + "/few"
    os.mkdir(few)
    for name in CHEAP, OF_TWO_PAPERS:
        os.symlink(f"{CAMPAIGNS}/{name}", f"{few}/{name}")
    of_paper = reproduce(0, "--paper=physgrad", "--dry-run", cwd=d,
                         campaigns=few)
    assert OF_TWO_PAPERS in of_paper and CHEAP not in of_paper, of_paper
    assert "jpo/" not in of_paper, of_paper
    assert "known papers: jpo, physgrad" in reproduce(
        3, "--paper=none", cwd=d, campaigns=few)

    made = reproduce(0, CHEAP, "--out=again", "--jobs=1", cwd=d)
    same, of = re.search(r"(\d+) of (\d+) claims have", made).groups()
    assert same == of != "0", made
    assert os.path.isfile(d + "/again/RESULTS.md")
    assert "\n0 stages run" in reproduce(
        0, CHEAP, "--out=again", "--jobs=1", cwd=d)

    # Campaigns run here have today's keys; without time nothing is published.
    assert re.search(r" (\d+)/\1 ", reproduce(
        0, CHEAP, "--dry-run", cwd=d, campaigns="again/campaigns"))
    late = reproduce(10, CHEAP, OF_TWO_PAPERS, "--time-budget=0.000001",
                     "--out=late", cwd=d)
    assert "2 campaigns are incomplete" in late, late
    assert not os.path.exists(d + "/late/campaigns")
    assert "--time-budget" in reproduce(
        2, CHEAP, "--time-budget=soon", cwd=d)
