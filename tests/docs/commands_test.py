#!/usr/bin/env python3
"""commands_test.py PROGRAM SOURCES: every ./bench line of the pages is run.

It runs where a reader's would: campaigns of the names that the pages use are
there, small ones. What would run for minutes is asked what it would run, plans
but the plainest are of one experiment; what needs a cluster, a second build or a
whole gate has tests of its own.
"""

import os
import shutil
import subprocess
import sys
import tempfile

from documented import commands, pages

PROGRAM, SOURCES = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
CAMPAIGNS = {  # those that the pages read: the flags of what replaces them
    **dict.fromkeys(("results/paper", "results/quick", "results/old",
                     "results/new", "results/a", "results/b", "results/base",
                     "results/first", "base"), ()),
    "head": ("--set=iterations=2",)}
ELSEWHERE = {  # verb or flag -> the test that runs it
    "submit": "slurm", "status": "slurm", "gate": "gate.project",
    "=^libraries/": "libraries", "=^studies/whose-bfgs": "libraries",
    "conformance": "install.pendulum", "--plugin": "install.pendulum",
    "history": "history"}
# Losses of fewer iterations are worse, as the page says.
CODES = {("compare", "--fail-on=loss"): 5}


def run(arguments, folder):
    return subprocess.run([PROGRAM, *arguments], cwd=folder, text=True,
                          capture_output=True, timeout=300,
                          stdin=subprocess.DEVNULL,
                          env={**os.environ, "XDG_CACHE_HOME":
                               os.path.join(os.path.abspath(folder), "cache")})


def prepare(folder):
    # Some write there.
    for name in ("reports", "docs"):
        shutil.copytree(os.path.join(SOURCES, name), os.path.join(folder, name))
    shutil.copy(os.path.join(SOURCES, "README.md"), folder)
    os.mkdir(os.path.join(folder, "results"))
    first = {}
    for name, flags in CAMPAIGNS.items():
        if flags in first:
            shutil.copytree(first[flags], os.path.join(folder, name))
            continue
        done = run(["--profile=smoke", "--filter=jpo/billiards/", "--trace",
                    "--no-report", "--out", name, *flags], folder)
        assert done.returncode == 0, done.stderr
        first[flags] = os.path.join(folder, name)


def as_run(arguments):
    """The same, where it would take minutes without its work."""
    verb = arguments[0] if arguments and arguments[0][0] != "-" else "run"
    told = {"--help", "--version", "-V", "--dry-run"}
    if verb in ("run", "reproduce") and not told & set(arguments):
        return [*arguments, "--dry-run"]
    if verb == "kernels":
        return [*arguments, "--benchmark_min_time=0.001"]
    if verb == "plan" and len(arguments) > 2:  # else 8 seconds of measuring
        return [*arguments, "--filter=jpo/billiards/"]
    if verb == "results" and "--html" not in " ".join(arguments):
        return None  # writes into the sources: results_page
    return arguments


def elsewhere(arguments):
    return any(a.split("=")[0] in ELSEWHERE or
               "toys/decay" in a or  # that a reader writes: docs/extending.md
               any(part in a for part in ELSEWHERE if part[0] == "=")
               for a in arguments)


def code_of(arguments):
    for words, code in CODES.items():
        if set(words) <= set(arguments):
            return code
    return 0


def main():
    lines, left = {}, 0  # what is run, once: the pages that say it
    for name, text in pages(SOURCES):
        for arguments in commands(text):
            own = None if elsewhere(arguments) else as_run(arguments)
            if own is None:
                left += 1
                continue
            lines.setdefault(tuple(own), set()).add(name)
    wrong, ran = [], 0
    with tempfile.TemporaryDirectory() as folder:
        prepare(folder)
        for own, names in sorted(lines.items()):
            done = run(own, folder)
            ran += 1
            said = (done.stdout + done.stderr).strip()
            if done.returncode != code_of(own) or not said:
                wrong.append(f"{', '.join(sorted(names))}: './bench "
                             f"{' '.join(own)}' ends with {done.returncode}: "
                             f"{done.stderr.strip()[-300:]}")
    if ran < 25:
        wrong.append(f"only {ran} commands run")
    print("\n".join(wrong) or f"{ran} commands run, {left} elsewhere")
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
