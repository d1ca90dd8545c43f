#!/usr/bin/env python3
"""The rules that physinv.jax gives to JAX, called as JAX calls them, without
JAX: what they return, and what they refuse."""

import sys
import types
import unittest
from collections import namedtuple

try:
    import numpy as np
except ImportError:
    print("skipped: numpy is missing")
    sys.exit(77)

Primal = namedtuple("Primal", "value perturbed")


class SymbolicZero:
    """Replaces JAX's."""


class CustomVjp:
    """Keeps the rules."""

    def __init__(self, function):
        self.function = function
        CustomVjp.last = self

    def __call__(self, *arguments):
        return self.function(*arguments)

    def defvjp(self, ahead, backward, symbolic_zeros=False):
        assert symbolic_zeros
        self.ahead, self.backward = ahead, backward


def stand_in():
    jax = types.ModuleType("jax")
    jax.custom_vjp = CustomVjp
    jax.custom_derivatives = types.SimpleNamespace(SymbolicZero=SymbolicZero)
    jax.ShapeDtypeStruct = namedtuple("ShapeDtypeStruct", "shape dtype")

    def pure_callback(function, wanted, *arrays):
        result = function(*arrays)
        assert (result.shape, result.dtype) == wanted, (result, wanted)
        return result

    jax.pure_callback = pure_callback
    return jax


sys.modules["jax"] = stand_in()
import physinv  # noqa: E402

P = next(p for p in map(physinv.problem, physinv.problems())
         if "vjp" in p.names and p.shape[2] > 0)


class Rules(unittest.TestCase):
    def setUp(self):
        self.s = P.sample(n=2, labelled=True)
        self.forward = physinv.jax(P)
        self.rules = CustomVjp.last

    def test_gradients_are_pullbacks(self):
        x, _, given = self.s
        y, point = self.rules.ahead(Primal(x, True), Primal(given, False))
        there, tape = P.linearize(x, given)
        self.assertTrue(np.array_equal(y, there))
        self.assertTrue(np.array_equal(self.forward(x, given), there))
        x_bar, by_given = self.rules.backward(point, y)
        self.assertTrue(np.array_equal(x_bar, tape.pullback(y)))
        self.assertIsNone(by_given)
        self.assertEqual(self.rules.backward(point, SymbolicZero()),
                         (None, None))

    def test_given_has_no_derivative(self):
        x, _, given = self.s
        for perturbed in (True, False):
            with self.assertRaisesRegex(TypeError, "stop_gradient"):
                self.rules.ahead(Primal(x, perturbed), Primal(given, True))

    def test_other_numbers_are_refused(self):
        x, _, given = self.s
        for name, arguments in (("x", (x + 1j, given)),
                                ("x", (x.astype(int), given)),
                                ("x", (x.tolist(), given)),
                                ("given", (x, given + 1j))):
            with self.assertRaisesRegex(TypeError, f"^{name} is .*float32 or"):
                self.forward(*arguments)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
