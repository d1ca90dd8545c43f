"""Problems for JAX."""

import jax
import numpy as np


def _called(function, features, x, *others):
    """A function of NumPy arrays, (samples, features) of x's precision."""
    shape = jax.ShapeDtypeStruct((x.shape[0], features), x.dtype)
    return jax.pure_callback(
        lambda *arrays: function(*map(np.asarray, arrays)), shape, x, *others)


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

    def backward(point, y_bar):
        return _called(pullback, unknowns, *point, y_bar), None

    with_given.defvjp(lambda *point: (with_given(*point), point), backward)

    def forward(x, given=None):
        if given is None:
            if side > 0:
                raise ValueError(f"{problem.name} needs given, (samples, {side})")
            given = np.empty((x.shape[0], 0), x.dtype)
        return with_given(x, given)

    return forward
