"""Physics inverse problems with exact adjoints, and the suite that measures
how they are solved.

    import physinv

    p = physinv.problem("jpo/billiards")   # physinv.problems() lists them
    s = p.sample(seed=0, n=128)            # s.x, s.y, s.given
    y, tape = p.linearize(s.x, s.given)    # forward that remembers
    x_bar = tape.pullback(y_bar)           # J^T y_bar
    p.names                                # what this problem can do

Arrays are (samples, features) in C order, float32 or float64, and not copied.
A call of one precision answers in it; losses are double. A sample that
diverges is NaN in its own row. Errors are ValueError and TypeError with the
suite's words. The lock of the interpreter is free while a problem computes.

    physinv.torch(p)(x, given)             # differentiable by autograd
    physinv.run("smoke", filter="jpo/billiards", out="results/smoke")
    r = physinv.open("results/smoke")      # r.stages(), r.examples(), r.curve()

    @physinv.method("mine", experiments="jpo/*")  # a case like any other
    def solve(run): ...
"""

from collections import namedtuple as _namedtuple

from physinv import _core
from physinv._campaign import ProgramError, open, program, run, verb
from physinv._methods import method

__all__ = ["Problem", "ProgramError", "Samples", "method", "open", "problem",
           "problems", "program", "run", "torch", "verb", "version"]

Problem = _core.Problem
Samples = _namedtuple("Samples", "x y given")
Samples.__doc__ = """Inverse problems: unknowns x (no columns where the solution
is not known), observations y and side input given, each (samples, features)."""


def problem(name):
    """The problem of the experiment `name`, such as "sip/heat"."""
    return _core.problem(name)


def problems():
    """Names of all experiments, each of which has a problem."""
    return _core.problems()


def version():
    """Version, compiler, flags and libraries of this build, some lines."""
    return _core.version_text()


def _sample(self, seed=0, n=1, first=0, labelled=False):
    """Inverse problems first .. first + n - 1 of a seed, in double, the same as
    in campaigns; small sets are the beginnings of large ones. `labelled`: pairs
    (x, y) of the separate set that methods learn from."""
    return Samples(*self._sample(seed, n, first, labelled))


Problem.sample = _sample


def torch(problem):
    """F as a function of tensors, (x, given=None) -> y, for autograd: one
    forward pass, and one pullback for a gradient by x."""
    from physinv._torch import differentiable
    return differentiable(problem)
