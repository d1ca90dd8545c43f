"""Physics inverse problems with exact adjoints, and the suite that measures
how they are solved.

    import physinv

    p = physinv.problem("jpo/billiards")   # physinv.problems() lists them
    s = p.sample(seed=0, n=128)            # s.x, s.y, s.given
    y, tape = p.linearize(s.x, s.given)    # forward that remembers
    y_bar = p.loss_gradient(y, s.y)        # d loss / d y
    x_bar = tape.pullback(y_bar)           # d loss / d x = J^T y_bar
    p.names                                # what this problem can do

A problem y = F(x | given) has unknowns x, side input given and observations y,
each an array (samples, features): p.shape says how many features. A step of
gradient descent on all 128 at once is x = x - 0.1 * x_bar.

- Arrays are float32 or float64 in C order and are read without a copy; others
  are converted, but for complex and masked ones. A call answers in the
  precision of its first array, losses are double.
- A sample that diverges is NaN in its own row, and no error. What a problem
  lacks is a TypeError, a wrong shape a ValueError; both say what is right.
- x, y and given have the units that the header of a problem states
  (problems/<name>/<name>.h; most are dimensionless), times are seconds.
- The lock of the interpreter is free while a problem computes; threads may
  share a problem.

Learning through a problem, with PyTorch:

    forward = physinv.torch(p)             # x, given -> y, for autograd
    loss = (forward(net(features), given) - target).square().sum()
    loss.backward()                        # one forward pass, one pullback

Campaigns, which physinv-bench runs and this package reads:

    r = physinv.run("smoke", filter="jpo/billiards", out="results/smoke")
    r = physinv.open("results/smoke")      # one that was run before
    r.stages(), r.examples(case), r.curve(case), r.tidy(), r.plot("fig4a")
    physinv.compare("results/smoke")       # compares its methods
    physinv.compare("results/a", "results/b")
    physinv.published("jpo/billiards")     # what the paper prints

Your own method, as a case like any other:

    @physinv.method("momentum", experiments="jpo/*", needs="vjp")
    def solve(run):
        x, v = run.start, 0
        while run.proceed(x):              # counts, keeps the clock
            _, gradient = run.loss_and_gradient(x)
            v = 0.9 * v - 0.01 * gradient
            x = x + v
        return x

    physinv.run("smoke", filter="jpo/billiards/(bfgs|momentum)")

Your own problem, as an experiment like any other (help(physinv.Problem)):

    @physinv.experiment("decay")
    class Decay(physinv.Problem):
        start = [1.0, 0.5]

        def sample(self, seed, n):
            return np.random.default_rng(seed).uniform(0.1, 2, (n, 2))

        def forward(self, x, given):
            return x[:, :1] * np.exp(-x[:, 1:] * TIMES)

    physinv.conformance(Decay)             # what is wrong with it, in words
    physinv.run("quick", filter="matrix/decay", out="results/decay")
"""

import operator as _operator
import os as _os
from collections import namedtuple as _namedtuple

from physinv._built import core as _load_core

_core = _load_core()
from physinv._campaign import (ProgramError, Results, open, program, published,
                               run, verb)
from physinv._compare import compare
from physinv._conformance import conformance
from physinv._methods import method
from physinv._problems import Problem, experiment, skipped

__all__ = ["Problem", "ProgramError", "RegisteredProblem", "Results", "Run",
           "Samples", "arrays", "compare", "conformance", "experiment", "jax",
           "load_plugin", "method", "open", "problem", "problems", "program",
           "published", "run", "skipped", "torch", "verb", "version"]

RegisteredProblem = _core.Problem
Run = _core.Run
Samples = _namedtuple("Samples", "x y given")
Samples.__doc__ = """Inverse problems: unknowns x (no columns where the solution
is not known), observations y and side input given, each (samples, features)."""


def problem(name):
    """The problem of the experiment `name`, such as "sip/heat"."""
    return _core.problem(name)


def problems():
    """Names of all experiments, each of which has a problem."""
    return _core.problems()


def arrays():
    """What stages leave in examples(...)["arrays"]: dicts of name, axes (of the
    case's file), unit, meaning, and the array with which a name means this."""
    return _core.arrays()


def load_plugin(file):
    """Adds what a plug-in of physinv_add_plugin registers, here and to verbs;
    those that PHYSINV_PLUGINS names are there from the start. ValueError for one
    of another build, for a name that is there already, and for what is none."""
    _core.load_plugins([f"--plugin={file}"])


def version():
    """Version, compiler, flags and libraries of this build, some lines."""
    return _core.version_text()


def _count(name, value, least):
    try:
        count = _operator.index(value)
    except TypeError:
        count = None
    if count is None or not least <= count < 2 ** 63:
        raise ValueError(f"{name}={value!r}; expected a whole number of "
                         f"at least {least}")
    return count


def _sample(self, seed=0, n=1, first=0, labelled=False):
    """Inverse problems first .. first + n - 1 of a seed, in double, the same as
    in campaigns; small sets are the beginnings of large ones. `labelled`: pairs
    (x, y) of the separate set that methods learn from."""
    return Samples(*self._sample(
        _count("seed", seed, 0), _count("n", n, 1), _count("first", first, 0),
        bool(labelled)))


_sample.__name__ = _sample.__qualname__ = "sample"
RegisteredProblem.sample = _sample


def torch(problem):
    """F as a function of tensors, (x, given=None) -> y, for autograd: one
    forward pass, and one pullback for a gradient by x. Tensors of float32 or
    float64, (samples, features), on the CPU. Second derivatives are a
    NotImplementedError, a derivative by given is a TypeError."""
    from physinv._torch import differentiable
    return differentiable(problem)


def jax(problem):
    """F as a function of JAX arrays, (x, given=None) -> y, for jit and grad, by
    pure_callback. A gradient by x linearizes again, as JAX keeps arrays and no
    tapes: two forward passes and one pullback. float64 takes jax_enable_x64.
    Second derivatives are an error, and a derivative by given is one."""
    from physinv._jax import differentiable
    return differentiable(problem)


if _os.environ.get("PHYSINV_PLUGINS"):
    _core.load_plugins([])
