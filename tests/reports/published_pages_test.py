"""published_pages_test.py PROGRAM SOURCES: what is published can be looked at.

report and compare open the campaigns that are kept with the sources, one
command makes the pages of all of them, and git's baselines are a history.
"""

import glob
import os
import re
import subprocess
import sys
import tempfile

from browser import WIDTHS, Browser, installed

PROGRAM, SOURCES = (os.path.abspath(p) for p in sys.argv[1:3])
CAMPAIGNS = os.path.join(SOURCES, "reports", "campaigns")
FAILED = []


def check(condition, what):
    if not condition:
        print("FAIL", what)
        FAILED.append(what)


def run(*arguments, cwd, env=None):
    return subprocess.run([PROGRAM, *arguments], cwd=cwd, capture_output=True,
                          text=True, env={**os.environ, **(env or {})})


def listing(folder):
    return sorted(os.listdir(folder))


def links(path):
    count = 0
    with open(path) as f:
        text = f.read()
    for target in re.findall(r'<a[^>]* href="([^"#]+)', text):
        if not target.startswith("https://"):
            count += 1
            there = os.path.join(os.path.dirname(path), target)
            check(os.path.exists(there), f"{path}: no {target}")
    return count


def figures():
    """As the program writes them: CairoSVG draws nothing of a height that is
    auto, Inkscape 1.2 no picture without xlink."""
    paths = [path for folder in ("campaigns/*/figures", "gallery") for path in
             glob.glob(os.path.join(SOURCES, "reports", folder, "*.svg"))]
    for path in paths:
        with open(path) as f:
            text = f.read()
        check("height:auto" not in text, f"{path}: a height that is auto")
        check(" href=" not in text, f"{path}: a picture without xlink")
    check(len(paths) > 100, f"{len(paths)} figures")


def pages_of_all(d):
    names = listing(CAMPAIGNS)
    p = run("results", "--campaigns=" + CAMPAIGNS, "--html=pages", cwd=d)
    check(p.returncode == 0, p.stderr)
    for name in names:
        check(os.path.exists(f"{d}/pages/{name}/index.html"), name)
    found = sum(links(page) for page in
                [f"{d}/pages/index.html", *glob.glob(f"{d}/pages/*/index.html")])
    check(found > 3 * len(names), f"{found} links")
    check(not os.path.exists(f"{d}/RESULTS.md"), "no RESULTS.md")
    print(f"{len(names)} campaigns, {found} links")
    if installed() and os.environ.get("PHYSINV_FULL"):
        with Browser() as browser:
            for page in ("index.html", names[0] + "/index.html"):
                for width in WIDTHS:
                    wide = browser.too_wide(f"{d}/pages/{page}", width)
                    check(wide <= 0, f"{page} is {wide} too wide for {width}")


def one_by_one(d):
    quick = os.path.join(CAMPAIGNS, "1-quick")
    before = listing(quick)
    p = run("report", quick, cwd=d)
    check(p.returncode == 2 and "--out=DIR" in p.stderr, p.stderr)
    p = run("report", quick, "--out=one", cwd=d)
    check(p.returncode == 0 and "figures are not stored" in p.stdout, p.stderr)
    check(os.path.exists(f"{d}/one/jpo-billiards/tables/table-1.csv"), "tables")
    drawn = os.path.join(CAMPAIGNS, "26-paper-jpo-robotic-arm")
    p = run("report", drawn, "--out=drawn", cwd=d)
    check(p.returncode == 0 and "the published ones" in p.stdout, p.stdout[-300:])
    with open(f"{d}/drawn/jpo-robotic-arm/index.html") as f:
        page = f.read()
    check("does not store the unknowns" in page, "why there is no picture")
    pictures = page.count("data:image/svg+xml;base64,")
    check(pictures == len(listing(os.path.join(drawn, "figures"))),
          f"{pictures} pictures")
    p = run("report", quick, "--check", "--out=one", cwd=d)
    check(p.returncode == 2 and "only --out" in p.stderr, p.stderr)
    other = os.path.join(CAMPAIGNS, "8-quick-numerics")
    p = run("compare", "a=" + quick, "b=" + other, "--out=both", cwd=d)
    check(p.returncode == 0, p.stderr)
    check("lines compared" in p.stdout and "b against a: " in p.stdout,
          p.stdout)
    p = run("compare", "a=" + quick, "b=" + quick, cwd=d)
    check(re.search(r"(\d+) lines compared, \1 with the same bits", p.stdout),
          p.stdout[-300:])
    check(listing(quick) == before, "a published campaign stays as it is")


def history(d):
    def git(*arguments):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b",
                        *arguments], cwd=d, check=True, capture_output=True)

    p = run("history", "--baseline=base.txt", cwd=d)
    check(p.returncode == 3 and "fewer than two versions" in p.stderr, p.stderr)
    git("init", "-q")
    for loss in (1, 2):
        with open(f"{d}/base.txt", "w") as f:
            f.write("physinv-bench baseline 1\nmachine one\nstages 1\n"
                    f"jpo/a/b/n=1/seed=0/fit results={loss} loss=1,{loss},3 "
                    "ms=1..2\n")
        git("add", "base.txt")
        git("commit", "-qm", f"Loss {loss}")
    p = run("history", "--baseline=base.txt", "--out=past", cwd=d)
    check(p.returncode == 0, p.stderr)
    with open(f"{d}/past/history/tables/commits.csv") as f:
        rows = f.read()
    check("Loss 2" in rows and "Loss 1" in rows, rows)
    check(os.path.exists(f"{d}/past/history/figures/losses.vl.json"), "figure")
    p = run("history", "--baseline=/base.txt", cwd=d)
    check(p.returncode == 2 and "is absolute" in p.stderr, p.stderr)
    # What git refuses, in its own words.
    p = run("history", "--baseline=base.txt", cwd=d,
            env={"GIT_TEST_ASSUME_DIFFERENT_OWNER": "1"})
    check(p.returncode == 3 and "dubious ownership" in p.stderr and
          p.stderr.rstrip().endswith(f"safe.directory {os.path.realpath(d)}"),
          p.stderr)
    # A shallow clone says where it ends.
    with open(f"{d}/base.txt", "a") as f:
        f.write("another 1\n")
    git("commit", "-qam", "Loss 3")
    for depth, code in ((1, 3), (2, 0)):
        git("clone", "-q", f"--depth={depth}", f"file://{d}", f"of{depth}")
        first = subprocess.run(
            ["git", "rev-parse", "--short", f"HEAD~{depth - 1}"], text=True,
            cwd=d, check=True, capture_output=True).stdout.strip()
        p = run("history", "--baseline=base.txt", cwd=f"{d}/of{depth}")
        text = p.stdout + p.stderr
        check(p.returncode == code and f"begins with commit {first} of " in text
              and "--unshallow" in text, (depth, p.returncode, text))
    with open(f"{d}/of2/results/history/history/tables/commits.csv") as f:
        check("Loss 3" in f.read(), "the part that is there")


def main():
    figures()
    for step in (pages_of_all, one_by_one, history):
        with tempfile.TemporaryDirectory() as d:
            step(d)
    sys.exit(f"{len(FAILED)} failed" if FAILED else 0)


main()
