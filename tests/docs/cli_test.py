#!/usr/bin/env python3
"""cli_test.py PROGRAM SOURCES [--write]: docs/cli.md has the output of --help;
--write renews it."""

import os
import subprocess
import sys

PROGRAM, SOURCES = sys.argv[1:3]
PAGE = os.path.join(SOURCES, "docs", "cli.md")
HEAD = """# Command line

This page has the output of `./bench VERB --help` for all verbs. `./bench` builds the
program and passes its arguments on. `tests/docs/cli_test.py PROGRAM . --write` writes this
page, and a test compares it with the program. [Running](running.md) explains the flags.
"""


def output(*arguments):
    env = {k: v for k, v in os.environ.items()
           if not k.startswith(("PHYSINV_", "BENCHMARK_", "GTEST_"))}
    done = subprocess.run([PROGRAM, *arguments], capture_output=True, text=True,
                          check=True, env={**env, "COLUMNS": "80"})
    return "\n".join(line.rstrip() for line in done.stdout.splitlines()).strip()


def page():
    verbs = [verb for verb in output("--list-verbs").split()
             if verb != "kernels"]
    text = HEAD + "\n```text\n" + output("--help") + "\n```\n"
    for verb in verbs:
        text += (f"\n## {verb}\n\n```text\n" + output(verb, "--help") +
                 "\n```\n")
    return text + """
## kernels

All flags of Google Benchmark: `./bench kernels --help`.
"""


def main():
    made = page()
    if "--write" in sys.argv[3:]:
        with open(PAGE, "w") as f:
            f.write(made)
        return
    with open(PAGE) as f:
        kept = f.read()
    if made != kept:
        a, b = made.splitlines(), kept.splitlines()
        at = next((k for k, (x, y) in enumerate(zip(a, b)) if x != y),
                  min(len(a), len(b)))
        sys.exit(f"docs/cli.md is not what --help says, line {at + 1}: "
                 f"{a[at:at + 1]}; make it again with --write")
    print(f"{len(made.splitlines())} lines are what --help says")


main()
