"""Problems written in Python, as experiments of campaigns."""

import inspect
import operator
import re
import time

import numpy as np

from physinv import _core, _methods

_FRAMEWORKS = (None, "torch", "jax")
_registered = {}


class Problem:
    """A problem of your own, y = F(x | given): find x from y.

        class Decay(physinv.Problem):
            start = [1.0, 0.5]             # where solvers begin: (unknowns,)

            def sample(self, seed, n):     # x, or x and given
                return np.random.default_rng(seed).uniform(0.1, 2, (n, 2))

            def forward(self, x, given):   # (n, observations)
                return x[:, :1] * np.exp(-x[:, 1:] * TIMES)

    Arrays are (n, features) of float64, a batch a call, and a sample's numbers
    depend on no other sample. Optional abilities are methods:

        vjp(x, given) -> y, pullback       pullback(y_bar) = J^T y_bar
        jvp(x, given, x_dot) -> y_dot      J x_dot; needs vjp or jacobian
        jacobian(x, given) -> J            (n, observations, unknowns)
        inverse(y, given, guess) -> x      F(x | given) near y, x near guess

    With a jacobian, vjp and jvp are products with it. `sample` draws from
    `seed` alone; campaigns draw one sample a seed (n = 1), so that a small set
    is the beginning of a large one.

    `class Decay(physinv.Problem, autodiff="torch")`: forward takes and returns
    tensors of PyTorch ("jax": arrays of JAX), and vjp and jacobian are taken by
    its autodiff. The other methods see NumPy's arrays.

    `unknowns`, `observations` and `side_input` may name the columns, with
    their unit: unknowns = ("angle, speed", "rad, rad/s")."""

    start = None
    unknowns = observations = side_input = ("", "1")
    autodiff = None

    def __init_subclass__(cls, autodiff=None, **others):
        super().__init_subclass__(**others)
        if autodiff not in _FRAMEWORKS:
            raise ValueError(f"autodiff={autodiff!r} of {cls.__name__}; "
                             "expected 'torch' or 'jax'")
        if autodiff is not None:
            cls.autodiff = autodiff

    def sample(self, seed, n):
        raise NotImplementedError("a problem must define sample(seed, n)")

    def forward(self, x, given):
        raise NotImplementedError("a problem must define forward(x, given)")


class Functions:
    """Those of a problem, on arrays of float64; None where it lacks one."""

    def __init__(self, problem):
        self.problem = problem
        self.start = _start_of(problem)
        self.forward = problem.forward
        self.vjp, self.jvp, self.jacobian, self.inverse = (
            getattr(problem, name, None)
            for name in ("vjp", "jvp", "jacobian", "inverse"))
        if problem.autodiff is not None:
            self._differentiate(problem)
        if self.jacobian is not None:
            self.vjp = self.vjp or self._vjp_of_jacobian
            self.jvp = self.jvp or self._jvp_of_jacobian
        if self.vjp is None:
            self.jvp = None
        self.shape = self._shape()

    def _differentiate(self, problem):
        if problem.autodiff == "torch":
            from physinv._torch_problem import functions
        else:
            from physinv._jax_problem import functions
        self.forward, vjp, jacobian = functions(problem.forward)
        self.vjp = self.vjp or vjp
        self.jacobian = self.jacobian or jacobian

    def _vjp_of_jacobian(self, x, given):
        j = np.asarray(self.jacobian(x, given))
        return self.forward(x, given), lambda y_bar: (
            np.einsum("nou,no->nu", j, y_bar))

    def _jvp_of_jacobian(self, x, given, x_dot):
        return np.einsum("nou,nu->no", np.asarray(self.jacobian(x, given)),
                         x_dot)

    def sample(self, seed, n):
        """x and given."""
        drawn = self.problem.sample(seed, n)
        x, given = drawn if isinstance(drawn, tuple) and len(drawn) == 2 else (
            drawn, np.empty((n, 0)))
        return np.asarray(x, float), np.asarray(given, float)

    def _shape(self):
        """Features of x, y and given, as a first sample has them."""
        x, given = self.sample(0, 1)
        unknowns = len(self.start)
        _expect("x of sample", x, (1, unknowns))
        if given.ndim != 2 or len(given) != 1:
            _expect("given of sample", given, (1, "features"))
        y = np.asarray(self.forward(x, given))
        if y.ndim != 2 or len(y) != 1 or y.shape[1] < 1:
            _expect("what forward returns", y, (1, "observations"))
        return unknowns, y.shape[1], given.shape[1]


def _expect(name, array, shape):
    if array.shape != shape:
        raise ValueError(f"{name} is {_text(array.shape)}; expected "
                         f"{_text(shape)}")


def _text(shape):
    return f"({', '.join(map(str, shape))})"


def _start_of(problem):
    if problem.start is None:
        raise ValueError("a problem must define start, where solvers begin: one "
                         "number for each unknown")
    start = np.array(problem.start, float)
    if start.ndim != 1 or not start.size or not np.isfinite(start).all():
        raise ValueError(f"start={problem.start!r}; expected a finite number "
                         "for each unknown")
    return start


def as_problem(problem):
    """An instance of the user's class."""
    if inspect.isclass(problem) and issubclass(problem, Problem):
        problem = problem()
    if not isinstance(problem, Problem):
        raise TypeError(f"{problem!r} is not a physinv.Problem")
    return problem


def registered():
    """Names of the experiments, each with what is skipped and why."""
    return dict(_registered)


def skipped(name):
    """Methods that the experiment of a Problem, "matrix/decay", leaves out, each
    with what is missing: {"sip": "no inverse"}. ValueError for another one."""
    if name not in _registered:
        raise ValueError(f"{name!r} is not an experiment from Python; known "
                         f"experiments: {', '.join(_registered) or 'none'}")
    return dict(_registered[name])


def _count(name, key, value):
    try:
        count = operator.index(value)
    except TypeError:
        count = None
    if count is None or isinstance(value, bool) or not 1 <= count <= 10 ** 9:
        raise ValueError(f"{key}={value!r} of the experiment {name}; expected "
                         "a whole number of at least 1")
    return count


def _settings(name, given):
    if not isinstance(name, str) or not re.fullmatch("[a-z0-9_-]{1,100}", name):
        raise ValueError("an experiment's name must have at most 100 "
                         f"characters of [a-z0-9_-]; {name!r} does not")
    hidden = given["hidden"]
    if isinstance(hidden, str) or not np.iterable(hidden):
        raise ValueError(f"hidden={hidden!r} of the experiment {name}; expected "
                         "the features of each layer, such as (64, 64)")
    counts = {key: _count(name, key, given[key])
              for key in ("n", "iterations", "updates", "batch")}
    gtol = float(given["gtol"])
    if not gtol > 0:
        raise ValueError(f"gtol={gtol} of the experiment {name}; expected a "
                         "positive number")
    title = given["title"] or name.replace("-", " ").capitalize()
    return dict(counts, gtol=gtol, title=str(title),
                hidden=[_count(name, "hidden", one) for one in hidden])


def _operations(functions):
    """So many of a sample's forward pass, for estimates of the time left: one
    a nanosecond."""
    x, given = functions.sample(0, 1)
    begin = time.perf_counter()
    functions.forward(x, given)
    return max(1.0, 1e9 * (time.perf_counter() - begin))


def _described(problem, name):
    names = getattr(problem, name)
    if isinstance(names, str):
        names = (names, "1")
    text, unit = names
    return str(text), str(unit)


def experiment(name, *, title=None, gtol=1e-8, hidden=(64, 64, 64), n=32,
               iterations=1000, updates=1000, batch=32):
    """Makes a Problem, a class or an instance, the experiment matrix/<name>:

        @physinv.experiment("decay")
        class Decay(physinv.Problem):
            ...

        physinv.run("quick", filter="matrix/decay", out="results/decay")

    It has bfgs, lbfgsb, gd, jpo, supervised and na, and all methods of the
    matrix (adam, sip, hig, ...), each where the problem has what it needs;
    physinv.skipped("matrix/decay") says why the others are left out, as the
    report does. Profiles are smoke, quick and standard.

    gtol: norm of a gradient (largest entry) that ends a solver. hidden: layers
    of all networks. n: problems of a case (smoke: 4). iterations: of networks
    on the case's problems. updates and batch: of the matrix, on fresh samples.

    The key of its results has the hash of the class and of all that it refers
    to, attributes of the instance included, as for methods. It is an experiment
    of this process: `physinv.run` runs it, `physinv.verb` reports it. Again
    under a name that is there, it takes its place."""
    settings = _settings(name, dict(
        title=title, gtol=gtol, hidden=hidden, n=n, iterations=iterations,
        updates=updates, batch=batch))

    def add(problem):
        instance = as_problem(problem)
        functions = Functions(instance)
        without = _core.add_problem(
            name,
            dict(shape=functions.shape, start=functions.start,
                 operations=_operations(functions), sample=functions.sample,
                 forward=functions.forward, vjp=functions.vjp,
                 jvp=functions.jvp, jacobian=functions.jacobian,
                 inverse=functions.inverse),
            dict(unknowns=_described(instance, "unknowns"),
                 observations=_described(instance, "observations"),
                 given=_described(instance, "side_input")),
            settings,
            lambda: _methods.words_of_problem(name, instance))
        _registered[f"matrix/{name}"] = dict(without)
        return problem

    return add
