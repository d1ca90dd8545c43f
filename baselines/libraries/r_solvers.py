"""R's minimizers as methods in Python: a process of R per case asks for losses
and gradients, line by line (r_solvers.R)."""

import pathlib
import shutil
import subprocess

import numpy as np

from objective import Objective, box_of, outcome

# Its text, not its path: keys of stages have it.
PROGRAM = pathlib.Path(__file__).with_name("r_solvers.R").read_text()
METHODS = {"r-bfgs": "BFGS", "r-lbfgsb": "L-BFGS-B", "r-nlminb": "nlminb",
           "r-ucminf": "ucminf"}
BOUNDED = ("L-BFGS-B", "nlminb")
_VERSIONS = """cat("R", paste(R.version$major, R.version$minor, sep = "."))
if (requireNamespace("ucminf", quietly = TRUE))
  cat(", ucminf", format(packageVersion("ucminf")))"""


def methods():
    """What is installed: name, method, what the key has of its version."""
    if shutil.which("Rscript") is None:
        return
    said = subprocess.run(["Rscript", "--vanilla", "-e", _VERSIONS],
                          capture_output=True, text=True, check=True).stdout
    for name, method in METHODS.items():
        if method != "ucminf" or "ucminf" in said:
            yield name, method, {"library": said}


def _words(numbers, by=" "):
    return by.join(float(v).hex() for v in numbers)


def _numbers(words):
    return np.array([np.nan if w == "NA" else float.fromhex(w) for w in words])


def _solve_one(process, run, i, method, boxed):
    objective = Objective(run, i, box_of(run, i) if boxed else None)
    lowest = np.inf

    def say(*words):
        print(*words, file=process.stdin, flush=True)

    say(method, run.iterations, _words(run.start[i], ","),
        *(["none"] * 2 if objective.box is None else
          [_words(bound, ",") for bound in objective.box]))
    while (line := process.stdout.readline().split())[0] == "f":
        x = _numbers(line[1:])
        loss, gradient = objective(x)
        if loss < lowest and lowest < np.inf:  # it reports no iterates
            objective.accept(x)
        lowest = min(loss, lowest)
        say(_words([loss, *gradient]))
    status, message = line[1], " ".join(line[2:])
    loss, *x = _numbers(process.stdout.readline().split()[1:])
    if status == "error":
        finite = all(np.isfinite(v).all() for v in objective.seen.values())
        status, loss = "linesearch" if finite else "nonfinite", np.nan
    return objective.end(np.array(x), loss, status, message)


def solve(run, method, boxed=False):
    with subprocess.Popen(["Rscript", "--vanilla", "-e", PROGRAM], text=True,
                          stdin=subprocess.PIPE,
                          stdout=subprocess.PIPE) as process:
        return outcome([_solve_one(process, run, i, method, boxed)
                        for i in range(run.n)])
