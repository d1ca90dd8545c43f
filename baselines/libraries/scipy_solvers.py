#!/usr/bin/env python3
"""SciPy's minimizers beside those of the plug-in of other libraries:

    PYTHONPATH=build/release/python baselines/libraries/scipy_solvers.py \\
        build/release/libraries.so quick filter=^libraries/billiards/

runs a profile of `libraries/*` and `studies/whose-bfgs-*` with all their methods
and with scipy-bfgs, scipy-lbfgsb, scipy-slsqp and scipy-tnc; what follows are
flags of physinv.run. Defaults are SciPy's, but the limit of iterations (TNC has
one of evaluations) and, of BFGS, gtol are those of the experiment's own BFGS.
"""

import collections
import functools
import sys

import numpy as np
import physinv
from scipy.optimize import minimize

METHODS = {"scipy-bfgs": "BFGS", "scipy-lbfgsb": "L-BFGS-B",
           "scipy-slsqp": "SLSQP", "scipy-tnc": "TNC"}
LIMITS = {"billiards": 1000, "wave-packet": 1000, "robotic-arm": 1000,
          "kuramoto-sivashinsky": 200, "navier-stokes": 100}
# What OptimizeResult.status means; every other one is a failed line search.
_STATUS = {"BFGS": {0: "gtol", 1: "maxiter"},
           "L-BFGS-B": {0: "gtol", 1: "maxiter"},
           "SLSQP": {0: "gtol", 9: "maxiter"},
           "TNC": {0: "gtol", 1: "gtol", 2: "gtol", 3: "maxiter"}}


class Objective:
    """Problem i of a run as a library sees it, and what was seen of it. `box`:
    lower and upper bounds, None for none."""

    def __init__(self, run, i, box=None):
        self.run, self.i, self.box = run, i, box
        self.seen, self.steps, self.outside = {}, 0, 0

    def __call__(self, x):
        loss, gradient = (a[0] for a in
                          self.run.loss_and_gradient(x[None], [self.i]))
        left = gradient
        if self.box is not None:
            self.outside += not (np.clip(x, *self.box) == x).all()
            left = x - np.clip(x - gradient, *self.box)
        self.seen[x.tobytes()] = loss, abs(left).max()
        if self.steps == 0:  # all begin with their start
            self.accept(x)
        return loss, gradient

    def accept(self, x):
        if x.tobytes() in self.seen:
            self.run.accept(self.i, self.steps, x, self.seen[x.tobytes()][0])
            self.steps += 1

    def end(self, x, loss, success):
        """The arrays that the plug-in's solvers leave."""
        at, left = self.seen.get(x.tobytes(), (np.nan, np.nan))
        lowest = min((loss for loss, _ in self.seen.values() if loss == loss),
                     default=np.nan)
        arrays = {"claims_success": success, "returned_not_best": at > lowest,
                  "false_loss": at == at and loss == loss and loss != at,
                  "gradient_left": left}
        return arrays if self.box is None else \
            {**arrays, "outside_box": self.outside}


def outcome(ends):
    """What a method returns, of (x, status, message, arrays) for each problem."""
    xs, status, messages, arrays = zip(*ends)
    counts = collections.Counter(messages)
    return np.array(xs), {
        "status": list(status),
        "message": "; ".join(f"{k} x {m}" for m, k in sorted(counts.items())),
        "arrays": {name: [float(a[name]) for a in arrays] for name in arrays[0]}}


def box_of(run, i):
    """Landscapes have their bounds as side input."""
    return np.split(run.given[i], 2) if run.given.shape[1] else None


def _solve_one(run, i, method, boxed):
    objective = Objective(run, i, box_of(run, i) if boxed else None)
    options = {"maxfun" if method == "TNC" else "maxiter": run.iterations}
    if method == "BFGS":
        options["gtol"] = run.gtol
    end = minimize(objective, run.start[i], jac=True, method=method,
                   callback=objective.accept, options=options,
                   bounds=objective.box and list(zip(*objective.box)))
    ended = _STATUS[method].get(int(end.status), "linesearch")
    arrays = objective.end(end.x, end.fun, ended == "gtol")
    if not (np.isfinite(end.x).all() and np.isfinite(end.fun)):
        return run.start[i], "nonfinite", end.message, arrays
    return end.x, ended, end.message, arrays


def _solve(run, method, boxed=False):
    return outcome([_solve_one(run, i, method, boxed) for i in range(run.n)])


def experiments():
    """Those of the plug-in with the limit of their BFGS, and whether they have
    bounds. On two landscapes the plug-in itself ends the evaluations."""
    known = physinv.problems()
    for problem, limit in LIMITS.items():
        for prefix in ("libraries/", "studies/whose-bfgs-"):
            if prefix + problem in known:
                yield prefix + problem, limit, False
    for name in known:
        if name.startswith("libraries/landscape-") and \
                not name.endswith(("-exception", "-one-evaluation")):
            limit = 1 if name.endswith("-one-iteration") else 1000
            yield name, limit, physinv.problem(name).shape[2] > 0


def main(plugin, profile="quick", *flags):
    physinv.load_plugin(plugin)
    for experiment, limit, boxed in experiments():
        for name, method in METHODS.items():
            if not boxed or method != "BFGS":
                physinv.method(name, experiment, iterations=limit)(
                    functools.partial(_solve, method=method, boxed=boxed))
    flags = dict(flag.split("=", 1) for flag in flags)
    flags.setdefault("filter", "^(libraries|studies/whose-bfgs[a-z-]*)/")
    physinv.run(profile, **flags)


if __name__ == "__main__":
    main(*sys.argv[1:])
