"""What a problem written in Python promises, checked one by one."""

import numpy as np

from physinv import _problems

_SAMPLES = 12
_STEP, _TOLERANCE = 1e-6, 1e-5
_ROUNDING = 1e-10


class Wrong(Exception):
    """Words of a check that failed."""


class Skip(Exception):
    """What a check would need."""


def conformance(problem):
    """Checks what a Problem, a class or an instance, promises. Returns a dict
    of check -> what is wrong, in words, empty if all is well; prints a line for
    each check. An exception of a function is what is wrong with it.

    Checked are: samples of one seed are the same again, of another one
    different; forward gives finite numbers, the same bits twice, leaves its
    arguments alone, and a batch gives what its samples give one by one, to
    rounding; vjp returns the y of forward and, as jvp and jacobian, agrees with
    central differences; vjp and jvp are adjoint; inverse lowers the loss. vjp
    is looked at where differences with two steps agree, as a problem may have
    kinks."""
    wrong = {}
    try:
        functions = _problems.Functions(_problems.as_problem(problem))
    except (ValueError, TypeError, NotImplementedError) as error:
        print(f"FAILED   definition: {error}")
        return {"definition": str(error)}
    for check in _CHECKS:
        name = check.__name__.strip("_").replace("_", " ")
        try:
            check(functions)
        except Skip as error:
            print(f"skipped  {name}: {error}")
            continue
        except Wrong as error:
            wrong[name] = str(error)
        except Exception as error:
            wrong[name] = f"{type(error).__name__}: {error}"
        print(f"FAILED   {name}: {wrong[name]}" if name in wrong
              else f"ok       {name}")
    return wrong


def _drawn(functions, n=_SAMPLES):
    each = [functions.sample(seed, 1) for seed in range(n)]
    return tuple(np.concatenate(parts) for parts in zip(*each))


def _forward(functions, x, given):
    y = np.asarray(functions.forward(x.copy(), given.copy()), float)
    expected = (len(x), functions.shape[1])
    if y.shape != expected:
        raise Wrong(f"forward returned {y.shape} for {len(x)} samples; "
                    f"expected {expected}")
    return y


def _vjp(functions, x, given, y_bar):
    if functions.vjp is None:
        raise Skip("the problem has no vjp")
    y, pullback = functions.vjp(x.copy(), given.copy())
    return np.asarray(y), np.asarray(pullback(y_bar))


def _directions(shape, seed):
    return np.random.default_rng(seed).normal(size=shape)


def _far(a, b, tolerance):
    """Samples in which a and b differ by more than their size allows."""
    size = np.maximum(np.abs(a).max(1), np.abs(b).max(1)) + 1e-300
    return np.flatnonzero(~(np.abs(a - b).max(1) <= tolerance * size))


def _first(far, a, b, names):
    i = far[0]
    k = int(np.argmax(np.abs(a[i] - b[i])))
    return (f"in {len(far)} of {len(a)} samples, first in sample {i}, entry "
            f"{k}: {names[0]} {a[i, k]:.9g}, {names[1]} {b[i, k]:.9g}")


def _sample_is_of_its_seed(functions):
    first, again, other = (functions.sample(seed, 1) for seed in (5, 5, 6))
    for name, a, b in zip(("x", "given"), first, again):
        if a.tobytes() != b.tobytes():
            raise Wrong(f"sample(5, 1) drew another {name} the second time; it "
                        "must draw from seed alone, such as with "
                        "numpy.random.default_rng(seed)")
    if first[0].tobytes() == other[0].tobytes() and \
            first[1].tobytes() == other[1].tobytes():
        raise Wrong("sample draws the same for seeds 5 and 6")
    x, given = functions.sample(5, 3)
    expected = (3, functions.shape[0]), (3, functions.shape[2])
    if (x.shape, given.shape) != expected:
        raise Wrong(f"sample(5, 3) drew {x.shape} and {given.shape}; "
                    f"expected {expected[0]} and {expected[1]}")


def _forward_is_finite(functions):
    x, given = _drawn(functions)
    lost = np.flatnonzero(~np.isfinite(_forward(functions, x, given)).all(1))
    if len(lost):
        raise Wrong(f"y of {len(lost)} of {len(x)} samples that sample drew is "
                    f"not finite, first of sample {lost[0]}: x = "
                    f"{x[lost[0]].tolist()}")


def _forward_gives_the_same_bits_twice(functions):
    x, given = _drawn(functions)
    if _forward(functions, x, given).tobytes() != \
            _forward(functions, x, given).tobytes():
        raise Wrong("forward gave other numbers for the same arguments, so results "
                    "would not be reproducible")


def _forward_leaves_its_arguments_alone(functions):
    x, given = _drawn(functions)
    before = x.copy(), given.copy()
    functions.forward(x, given)
    for name, a, b in zip(("x", "given"), before, (x, given)):
        if a.tobytes() != b.tobytes():
            raise Wrong(f"forward writes into {name}; it must change a copy")


def _a_batch_gives_what_its_samples_give(functions):
    x, given = _drawn(functions)
    together = _forward(functions, x, given)
    alone = np.concatenate([
        _forward(functions, x[i:i + 1], given[i:i + 1]) for i in range(len(x))])
    far = _far(together, alone, _ROUNDING)
    if len(far):
        raise Wrong("y depends on the other samples of its batch: "
                    + _first(far, together, alone, ("in a batch", "alone")))


def _vjp_returns_the_y_of_forward(functions):
    x, given = _drawn(functions)
    y = _forward(functions, x, given)
    there, _ = _vjp(functions, x, given, np.zeros_like(y))
    if there.shape != y.shape:
        raise Wrong(f"its y is {there.shape}; expected {y.shape}")
    far = _far(there, y, _ROUNDING)
    if len(far):
        raise Wrong(_first(far, there, y, ("vjp", "forward")))


def _difference(functions, x, given, x_dot, step):
    """J x_dot, and where it does not depend on the step: no kink is near."""
    def by(h):
        return (_forward(functions, x + h * x_dot, given)
                - _forward(functions, x - h * x_dot, given)) / (2 * h)
    y_dot, other = by(step), by(2 * step)
    size = np.abs(y_dot).max(1) + 1e-300
    return y_dot, np.abs(y_dot - other).max(1) <= 1e-4 * size + 1e-8


def _compare(functions, derivative, name):
    """derivative(x_dot) against differences along each unknown."""
    x, given = _drawn(functions)
    checked = 0
    for k in range(len(x[0])):
        x_dot = np.zeros_like(x)
        x_dot[:, k] = 1
        step = _STEP * max(1.0, float(np.abs(x[:, k]).max()))
        y_dot, smooth = _difference(functions, x, given, x_dot, step)
        a, b = derivative(x, given, x_dot)[smooth], y_dot[smooth]
        checked += len(a)
        scale = np.abs(y_dot).max() + np.abs(a).max(initial=0) + 1e-300
        far = np.flatnonzero(
            ~(np.abs(a - b).max(1) <= _TOLERANCE * scale + 1e-8))
        if len(far):
            raise Wrong(f"{name} by unknown {k} differs from differences: "
                        + _first(far, a, b, (name, "differences")))
    if not checked:
        raise Wrong("differences could not measure the derivative of forward "
                    "in any sample")


def _vjp_agrees_with_differences(functions):
    """By products with directions of y: y_bar . (J x_dot)."""
    shape = len(_drawn(functions)[0]), functions.shape[1]
    y_bar = _directions(shape, 1)

    def derivative(x, given, x_dot):
        _, x_bar = _vjp(functions, x, given, y_bar)
        if x_bar.shape != x.shape:
            raise Wrong(f"its pullback returned {x_bar.shape}; expected "
                        f"{x.shape}")
        return (x_bar * x_dot).sum(1, keepdims=True)

    class Projected:
        """forward along y_bar."""
        sample, shape, start = functions.sample, (*functions.shape[:1], 1), None

        @staticmethod
        def forward(x, given):
            y = _forward(functions, x, given)
            return (y_bar * y).sum(1, keepdims=True)

    _compare(Projected, derivative, "the slope of y_bar . y")


def _jvp_agrees_with_differences(functions):
    if functions.jvp is None:
        raise Skip("the problem has no jvp")
    _compare(functions, lambda x, given, x_dot: np.asarray(
        functions.jvp(x.copy(), given.copy(), x_dot)), "jvp")


def _jacobian_agrees_with_differences(functions):
    if functions.jacobian is None:
        raise Skip("the problem has no jacobian")

    def derivative(x, given, x_dot):
        j = np.asarray(functions.jacobian(x.copy(), given.copy()))
        expected = (len(x), functions.shape[1], functions.shape[0])
        if j.shape != expected:
            raise Wrong(f"it is {j.shape}; expected (samples, observations, "
                        f"unknowns) = {expected}")
        return np.einsum("nou,nu->no", j, x_dot)

    _compare(functions, derivative, "jacobian")


def _vjp_and_jvp_are_adjoint(functions):
    """The dot-product test: y_bar . (J x_dot) = (J^T y_bar) . x_dot."""
    if functions.jvp is None:
        raise Skip("the problem has no jvp")
    x, given = _drawn(functions)
    y_bar = _directions((len(x), functions.shape[1]), 2)
    x_dot = _directions(x.shape, 3)
    _, x_bar = _vjp(functions, x, given, y_bar)
    y_dot = np.asarray(functions.jvp(x.copy(), given.copy(), x_dot))
    a = (x_bar * x_dot).sum(1, keepdims=True)
    b = (y_bar * y_dot).sum(1, keepdims=True)
    size = (np.abs(x_bar * x_dot).sum(1) + np.abs(y_bar * y_dot).sum(1))
    far = np.flatnonzero(~(np.abs(a - b)[:, 0] <= 1e-10 * size + 1e-300))
    if len(far):
        raise Wrong(_first(far, a, b, ("(J^T y_bar) . x_dot",
                                       "y_bar . (J x_dot)")))


def _vjp_gives_the_same_bits_twice(functions):
    x, given = _drawn(functions)
    y_bar = _directions((len(x), functions.shape[1]), 4)
    if _vjp(functions, x, given, y_bar)[1].tobytes() != \
            _vjp(functions, x, given, y_bar)[1].tobytes():
        raise Wrong("the pullback gave other numbers for the same arguments")


def _inverse_lowers_the_loss(functions):
    if functions.inverse is None:
        raise Skip("the problem has no inverse")
    x, given = _drawn(functions)
    y = _forward(functions, x, given)
    guess = np.repeat(functions.start[None], len(x), 0)
    found = np.asarray(functions.inverse(y.copy(), given.copy(), guess.copy()))
    if found.shape != x.shape:
        raise Wrong(f"it returned {found.shape}; expected {x.shape}")
    before, after = (((_forward(functions, at, given) - y) ** 2).sum(1)
                     for at in (guess, found))
    high = np.flatnonzero(~(after <= before))
    if len(high):
        i = high[0]
        raise Wrong(f"of {len(high)} of {len(x)} samples F(x) is further from y "
                    f"than F(guess), first of sample {i}: |F(x) - y|^2 = "
                    f"{after[i]:.3g}, was {before[i]:.3g}")


_CHECKS = (
    _sample_is_of_its_seed, _forward_is_finite,
    _forward_gives_the_same_bits_twice, _forward_leaves_its_arguments_alone,
    _a_batch_gives_what_its_samples_give, _vjp_returns_the_y_of_forward,
    _vjp_agrees_with_differences, _vjp_gives_the_same_bits_twice,
    _jvp_agrees_with_differences, _jacobian_agrees_with_differences,
    _vjp_and_jvp_are_adjoint, _inverse_lowers_the_loss)
