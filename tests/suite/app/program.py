"""Runs the program for the tests of the command line."""

import json
import os
import subprocess
import sys

BENCH = os.path.abspath(sys.argv[1])
FAILED = []


def run(*args, cwd, env=None, **kwargs):
    published = {"PHYSINV_PUBLISHED_DIR": os.path.join(cwd, "published")}
    return subprocess.run([BENCH, *args], cwd=cwd, text=True,
                          capture_output=True, timeout=120,
                          env={**os.environ, **published, **(env or {})},
                          **kwargs)


def check(condition, what):
    print("ok  " if condition else "FAIL", what)
    if not condition:
        FAILED.append(what)


def expect(code, args, cwd, says="", env=None, **kwargs):
    """The exit code, and for errors exactly one line that `says` it."""
    p = run(*args, cwd=cwd, env=env, **kwargs)
    lines = p.stderr.splitlines()
    good = p.returncode == code
    if code:
        good = good and len(lines) == 1 and says in lines[0] \
            and lines[0].startswith("physinv-bench: ")
    else:
        good = good and not lines and says in p.stdout
    check(good, f"{' '.join(args)} -> {p.returncode} {p.stderr.strip()[:150]}")
    return p


def crc32c(data):
    """As the suite seals its files."""
    r = 0xffffffff
    for byte in data:
        r ^= byte
        for _ in range(8):
            r = (r >> 1) ^ (0x82f63b78 if r & 1 else 0)
    return b"%08x" % (r ^ 0xffffffff)


TIMES = ("time", "date", "seconds", "_ms", "finished", "rss", "crowded",
         "clocks", "warmup", "setup", "revision")


def without(v, names):
    """What is left of a JSON value without the keys that hold such a name."""
    if isinstance(v, dict):
        return {k: without(w, names) for k, w in v.items()
                if not any(n in k for n in names)}
    return [without(w, names) for w in v] if isinstance(v, list) else v


def results(out, but=TIMES):
    """The results of a campaign, times apart."""
    with open(os.path.join(out, "results.json")) as f:
        return without(json.load(f)["benchmarks"], but)
