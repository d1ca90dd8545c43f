#!/usr/bin/env python3
"""own_overhead.py: what a call of a problem in Python costs in a campaign, compared
with the same function called by SciPy's BFGS alone, in CPU time. To be run on a quiet
machine, with the package in PYTHONPATH and SciPy; no test runs it.

Exits with 1 where a gradient of 1 ms takes more than 1.2 times as long."""

import sys
import tempfile
import time

import numpy as np
from scipy.optimize import minimize

import physinv

MOST, WANTED = 1.2, 1e-3


class Waves(physinv.Problem):
    """y_j = mean over k of sin(f_jk . x)."""
    start = [0.3, -0.2, 0.1]
    count = 1000

    def __init__(self):
        self.f = np.random.default_rng(1).normal(size=(4, self.count, 3))

    def sample(self, seed, n):
        return np.random.default_rng(seed).normal(0, 0.5, (n, 3))

    def forward(self, x, given):
        return np.sin(np.tensordot(x, self.f, (1, 2))).mean(2)

    def vjp(self, x, given):
        phase = np.tensordot(x, self.f, (1, 2))

        def pullback(y_bar):
            slope = np.cos(phase) * y_bar[:, :, None] / self.count
            return np.tensordot(slope, self.f, ((1, 2), (0, 1)))
        return np.sin(phase).mean(2), pullback


def loss_and_gradient(problem, target):
    given = np.empty((1, 0))

    def of(x):
        y, pullback = problem.vjp(x[None], given)
        return 0.5 * np.sum((y - target) ** 2), pullback(y - target)[0]
    return of


def sized():
    """A Waves whose gradient takes 1 ms."""
    while True:
        problem = Waves()
        of = loss_and_gradient(problem, np.zeros((1, 4)))
        took = min(timed(lambda: of(np.array(Waves.start))) for _ in range(20))
        if 0.9 * WANTED < took < 1.1 * WANTED:
            return problem
        Waves.count = max(10, round(Waves.count * WANTED / took))


def timed(call):
    begin = time.process_time()
    call()
    return time.process_time() - begin


def by_scipy(problem, p):
    """CPU seconds of a call, over all seeds."""
    seconds = calls = 0
    for seed in range(10):
        of = loss_and_gradient(problem, p.sample(seed=seed, n=1).y)
        begin = time.process_time()
        found = minimize(of, Waves.start, jac=True, method="BFGS",
                         options=dict(gtol=1e-8))
        seconds += time.process_time() - begin
        calls += found.nfev
    return seconds / calls


def by_campaign(folder):
    r = physinv.run("quick", filter="^matrix/waves/bfgs/", out=folder, jobs=1,
                    seeds=range(10), no_report=True, fresh=True)
    ended = r.stages()
    calls = sum(r.examples(s["case"])["evaluations"].sum() for s in ended)
    return sum(s["cpu_seconds"] for s in ended) / calls


def main():
    problem = sized()
    physinv.experiment("waves", n=1)(problem)
    p = physinv.problem("matrix/waves")
    with tempfile.TemporaryDirectory() as folder:
        pairs = [(by_scipy(problem, p), by_campaign(folder)) for _ in range(5)]
    alone, ours = (min(times) for times in zip(*pairs))
    print(f"a gradient, by SciPy's BFGS alone: {1e3 * alone:.3f} ms; in a "
          f"campaign: {1e3 * ours:.3f} ms, {ours / alone:.3f} times")
    return int(ours > MOST * alone)


if __name__ == "__main__":
    sys.exit(main())
