#!/usr/bin/env python3
"""SciPy's minimizers, and R's, with those of the plug-in of other libraries:

    PYTHONPATH=build/release/python baselines/libraries/scipy_solvers.py \\
        build/release/libraries.so quick filter=^libraries/billiards/

runs a profile of `libraries/*` and `studies/whose-bfgs-*` with all their methods
and with scipy-bfgs, scipy-lbfgsb, scipy-slsqp and scipy-tnc, and where there is
Rscript with those of r_solvers.py; what follows are flags of physinv.run.
Defaults are SciPy's and R's, but the limit of iterations (of evaluations for TNC
and ucminf) and, of SciPy's BFGS, gtol are those of the experiment's own BFGS.
"""

import functools
import sys

import physinv
import r_solvers
from objective import Objective, box_of, outcome
from scipy.optimize import minimize

METHODS = {"scipy-bfgs": "BFGS", "scipy-lbfgsb": "L-BFGS-B",
           "scipy-slsqp": "SLSQP", "scipy-tnc": "TNC"}
LIMITS = {"billiards": 1000, "wave-packet": 1000, "robotic-arm": 1000,
          "kuramoto-sivashinsky": 200, "navier-stokes": 100}
# What OptimizeResult.status means; every other one is a failed line search.
_STATUS = {"BFGS": {0: "gtol", 1: "maxiter"},
           "L-BFGS-B": {0: "gtol", 1: "maxiter"},
           "SLSQP": {0: "gtol", 9: "maxiter"},
           "TNC": {0: "gtol", 1: "ftol", 2: "gtol", 3: "maxiter"}}


def status_of(method, end):
    """Which tolerance L-BFGS-B reached is only in its message."""
    if method == "L-BFGS-B" and end.message.startswith("CONVERGENCE: REL"):
        return "ftol"
    return _STATUS[method].get(int(end.status), "linesearch")


def _solve_one(run, i, method, boxed):
    objective = Objective(run, i, box_of(run, i) if boxed else None)
    options = {"maxfun" if method == "TNC" else "maxiter": run.iterations}
    if method == "BFGS":
        options["gtol"] = run.gtol
    end = minimize(objective, run.start[i], jac=True, method=method,
                   callback=objective.accept, options=options,
                   bounds=objective.box and list(zip(*objective.box)))
    return objective.end(end.x, end.fun, status_of(method, end), end.message)


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
    known = [(name, functools.partial(_solve, method=method),
              method != "BFGS", {}) for name, method in METHODS.items()]
    known += [(name, functools.partial(r_solvers.solve, method=method),
               method in r_solvers.BOUNDED, version)
              for name, method, version in r_solvers.methods()]
    for experiment, limit, boxed in experiments():
        for name, solve, bounded, version in known:
            if bounded or not boxed:
                physinv.method(name, experiment, iterations=limit, **version)(
                    functools.partial(solve, boxed=boxed))
    flags = dict(flag.split("=", 1) for flag in flags)
    flags.setdefault("filter", "^(libraries|studies/whose-bfgs[a-z-]*)/")
    physinv.run(profile, **flags)


if __name__ == "__main__":
    main(*sys.argv[1:])
