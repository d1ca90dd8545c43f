#!/usr/bin/env python3
"""SciPy's minimizers beside those of the plug-in of other libraries:

    PYTHONPATH=build/release/python baselines/libraries/scipy_solvers.py \\
        build/release/libraries.so quick filter=^libraries/billiards/

runs a profile of `libraries/*` and `studies/whose-bfgs-*` with all their methods
and with scipy-bfgs, scipy-lbfgsb, scipy-slsqp and scipy-tnc; what follows are
flags of physinv.run. Defaults are SciPy's, but the limit of iterations (TNC has
one of evaluations) and, of BFGS, gtol are those of the experiment's own BFGS.
"""

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


def _solve_one(run, i, method):
    seen, steps = {}, [0]

    def loss(x):
        values, gradients = run.loss_and_gradient(x[None], [i])
        seen[x.tobytes()] = values[0]
        return values[0], gradients[0]

    def step(x):
        if x.tobytes() in seen:
            run.accept(i, steps[0], x, seen[x.tobytes()])
            steps[0] += 1

    options = {"maxfun" if method == "TNC" else "maxiter": run.iterations}
    if method == "BFGS":
        options["gtol"] = run.gtol
    step(run.start[i])
    end = minimize(loss, run.start[i], jac=True, method=method, callback=step,
                   options=options)
    if not (np.isfinite(end.x).all() and np.isfinite(end.fun)):
        return run.start[i], "nonfinite"
    return end.x, _STATUS[method].get(int(end.status), "linesearch")


def _solve(run, method):
    ends = [_solve_one(run, i, method) for i in range(run.n)]
    return np.array([x for x, _ in ends]), {"status": [s for _, s in ends]}


def main(plugin, profile="quick", *flags):
    physinv.load_plugin(plugin)
    for problem, limit in LIMITS.items():
        for prefix in ("libraries/", "studies/whose-bfgs-"):
            if prefix + problem not in physinv.problems():
                continue
            for name, method in METHODS.items():
                physinv.method(name, prefix + problem, iterations=limit)(
                    functools.partial(_solve, method=method))
    flags = dict(flag.split("=", 1) for flag in flags)
    flags.setdefault("filter", "^(libraries|studies/whose-bfgs[a-z-]*)/")
    physinv.run(profile, **flags)


if __name__ == "__main__":
    main(*sys.argv[1:])
