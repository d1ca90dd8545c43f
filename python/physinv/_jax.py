"""Problems for JAX."""

import jax
import numpy as np


def _called(function, features, x, *others):
    """A function of NumPy arrays, (samples, features) of x's precision. JAX has
    no derivative of it: second derivatives are a ValueError of pure_callback."""
    shape = jax.ShapeDtypeStruct((x.shape[0], features), x.dtype)
    return jax.pure_callback(
        lambda *arrays: function(*map(np.asarray, arrays)), shape, x, *others)


def _refuse(name, array):
    dtype = np.dtype(getattr(array, "dtype", object))
    if dtype not in (np.float32, np.float64):
        raise TypeError(f"{name} is {dtype}; expected float32 or float64")


def differentiable(problem):
    if "vjp" not in problem.names:
        raise TypeError(f"{problem.name} provides {'|'.join(problem.names)}, "
                        "no vjp, which grad needs")
    unknowns, observations, side = problem.shape

    def pullback(x, given, y_bar):
        return problem.linearize(x, given)[1].pullback(y_bar)

    @jax.custom_vjp
    def with_given(x, given):
        return _called(problem.forward, observations, x, given)

    def ahead(x, given):
        """Of each argument its value, and whether a derivative by it is asked
        for."""
        if given.perturbed:
            raise TypeError(
                "a derivative by given was requested, but only derivatives "
                "by x exist; pass jax.lax.stop_gradient(given)")
        return with_given(x.value, given.value), (x.value, given.value)

    def backward(point, y_bar):
        if isinstance(y_bar, jax.custom_derivatives.SymbolicZero):
            return None, None
        return _called(pullback, unknowns, *point, y_bar), None

    with_given.defvjp(ahead, backward, symbolic_zeros=True)

    def forward(x, given=None):
        _refuse("x", x)
        if given is None:
            if side > 0:
                raise ValueError(f"{problem.name} needs given, (samples, {side})")
            given = np.empty((x.shape[0], 0), x.dtype)
        _refuse("given", given)
        return with_given(x, given)

    return forward
