#!/usr/bin/env python3
"""Problems under JAX: jit, grad against the pullback, errors in words."""

import sys
import unittest

try:
    import jax
    import numpy as np
except ImportError:
    print("skipped: jax is missing")
    sys.exit(77)

import physinv

jax.config.update("jax_enable_x64", True)
NAMES = ("jpo/robotic-arm", "jpo/billiards", "jpo/kuramoto-sivashinsky",
         "numerics/heat")


class Jax(unittest.TestCase):
    def test_gradients_are_pullbacks(self):
        for name in NAMES:
            p = physinv.problem(name)
            s = p.sample(seed=1, n=3, labelled=True)
            forward = physinv.jax(p)
            for dtype in (np.float64, np.float32):
                x, y, given = (a.astype(dtype) for a in s)

                def loss(x):
                    return 0.5 * ((forward(x, given) - 0.9 * y) ** 2).sum()

                found = jax.jit(jax.grad(loss))(x)
                self.assertEqual(found.dtype, dtype)
                there, tape = p.linearize(x, given)
                np.testing.assert_array_equal(jax.jit(forward)(x, given), there)
                wanted = tape.pullback(there - dtype(0.9) * y)
                np.testing.assert_allclose(
                    found, wanted, rtol=1e-5 if dtype == np.float32 else 1e-13,
                    atol=1e-6 * np.abs(wanted).max())

    def test_given_may_be_left_out(self):
        p = physinv.problem("jpo/robotic-arm")
        x = p.sample(n=2, labelled=True).x
        np.testing.assert_array_equal(physinv.jax(p)(x), p.forward(x))

    def test_second_derivatives_are_none_rather_than_zero(self):
        p = physinv.problem("jpo/billiards")
        s = p.sample(n=2, labelled=True)
        forward = physinv.jax(p)

        def loss(x):
            return forward(x, s.given).sum()

        one = np.ones_like(s.x)
        for ask in (lambda: jax.jvp(jax.grad(loss), (s.x,), (one,)),
                    lambda: jax.hessian(loss)(s.x),
                    lambda: jax.grad(lambda x: jax.grad(loss)(x).sum())(s.x),
                    lambda: jax.jvp(loss, (s.x,), (one,))):
            with self.assertRaises((TypeError, ValueError)):
                ask()

    def test_given_has_no_derivative(self):
        p = next(p for p in map(physinv.problem, physinv.problems())
                 if "vjp" in p.names and p.shape[2] > 0)
        s = p.sample(n=2, labelled=True)
        forward = physinv.jax(p)
        for argnums in (1, (0, 1)):
            with self.assertRaisesRegex(TypeError, "stop_gradient"):
                jax.grad(lambda x, given: forward(x, given).sum(),
                         argnums)(s.x, s.given)
        with self.assertRaisesRegex(TypeError, "x is int"):
            forward(np.ones(s.x.shape, int), s.given)

    def test_a_network_learns_through_the_physics(self):
        p = physinv.problem("jpo/robotic-arm")
        y = p.sample(seed=0, n=32).y
        forward = physinv.jax(p)
        key = jax.random.PRNGKey(0)
        weights = [0.5 * jax.random.normal(key, shape)
                   for shape in ((2, 32), (32, 4))]

        @jax.jit
        def step(weights):
            def loss(weights):
                x = jax.numpy.tanh(y @ weights[0]) @ weights[1]
                return 0.5 * ((forward(x) - y) ** 2).sum(1).mean()
            value, slopes = jax.value_and_grad(loss)(weights)
            return value, [w - 0.05 * g for w, g in zip(weights, slopes)]

        losses = []
        for _ in range(200):
            value, weights = step(weights)
            losses.append(float(value))
        self.assertLess(losses[-1], 0.5 * losses[0])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
