#!/usr/bin/env python3
"""overhead.py [OUT]: what a call from Python costs in addition to its computation. To
be run on a quiet machine, with the package in PYTHONPATH; no test runs it.

Exits with 1 where a call takes 2 us in addition to what it computes, or the calls of a
step 1 % of a step of our JPO on 128 problems of billiards, which computes the same."""

import sys
import tempfile
import timeit

import numpy as np

import physinv

CALL, SHARE = 2e-6, 0.01
CALLS_OF_A_STEP = ("linearize", "pullback")  # of physinv.torch


def seconds(call, count=1000, times=50):
    """The shortest of stretches that fit into what a busy core gives at once."""
    return min(timeit.repeat(call, number=count, repeat=times)) / count


def calls(p, n):
    """One of each kind, on n samples."""
    s = p.sample(seed=0, n=n, labelled=True)
    tape, y_bar = p.linearize(s.x, s.given)[1], np.zeros_like(s.y)
    return {"forward": lambda: p.forward(s.x, s.given),
            "linearize": lambda: p.linearize(s.x, s.given),
            "pullback": lambda: tape.pullback(y_bar),
            "loss": lambda: p.loss(s.y, s.y),
            "loss_gradient": lambda: p.loss_gradient(s.y, s.y)}


def step_of_jpo(out):
    r = physinv.run("quick", filter="^jpo/billiards/jpo/n=128/seed=0$", jobs=1,
                    set="iterations=200", no_report=True, out=out)
    fit = next(s for s in r.stages() if s["stage"] == "fit")
    return fit["cpu_seconds"] / fit["iterations"]


def main():
    billiards = physinv.problem("jpo/billiards")
    # Of one sample of two numbers, all is overhead.
    bare = {name: seconds(call) for name, call in calls(
        physinv.problem("physgrad/scaling"), 1).items()}
    for n in (1, 128):
        for name, call in calls(billiards, n).items():
            print(f"billiards, n = {n:3}: {name:14} {1e6 * seconds(call):6.2f} us")
    for name, time in bare.items():
        print(f"beside computing: {name:14} {1e6 * time:6.2f} us")
    with tempfile.TemporaryDirectory() as folder:
        step = step_of_jpo(sys.argv[1] if len(sys.argv) > 1 else folder)
    share = sum(bare[name] for name in CALLS_OF_A_STEP) / step
    print(f"a step of JPO on 128: {1e6 * step:.0f} us, of which the calls would be "
          f"{100 * share:.2f} %")
    return int(max(bare.values()) > CALL or share > SHARE)


if __name__ == "__main__":
    sys.exit(main())
