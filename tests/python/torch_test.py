#!/usr/bin/env python3
"""Problems under PyTorch: gradcheck of every problem with a vjp, one forward
pass and one pullback a step, a network trained through the physics."""

import sys
import unittest

try:
    import torch
except ImportError:
    print("skipped: python3-torch is missing")
    sys.exit(77)

import physinv

LARGEST = 200  # unknowns, for differences


def tensors(p, n):
    s = p.sample(seed=1, n=n, labelled=True)
    return [torch.from_numpy(a) for a in (s.x, s.y, s.given)]


class Torch(unittest.TestCase):
    def test_gradcheck(self):
        checked = set()
        for name in physinv.problems():
            p = physinv.problem(name)
            # A flow has kinks closer than the step of a difference.
            if "vjp" not in p.names or p.shape[0] > LARGEST or \
                    "navier-stokes" in name:
                continue
            key = (p.shape, tuple(p.options.items()))
            if key in checked:
                continue
            checked.add(key)
            with self.subTest(name):
                x, _, given = tensors(p, 2)
                x.requires_grad_()
                self.assertTrue(torch.autograd.gradcheck(
                    lambda x: physinv.torch(p)(x, given), (x,),
                    eps=1e-7, atol=1e-5, rtol=1e-4))
        self.assertGreater(len(checked), 8)

    def test_a_step_is_one_forward_and_one_pullback(self):
        p = physinv.problem("jpo/robotic-arm")
        x, y, _ = tensors(p, 3)
        calls = []

        class Tape:
            def __init__(self, tape):
                self.tape = tape

            def pullback(self, y_bar):
                calls.append("pullback")
                return self.tape.pullback(y_bar)

        class Counted:
            names, name = p.names, p.name

            @staticmethod
            def linearize(x, given):
                calls.append("linearize")
                y, tape = p.linearize(x, given)
                return y, Tape(tape)

        x.requires_grad_()
        (physinv.torch(Counted)(x) - y).square().sum().backward()
        self.assertEqual(calls, ["linearize", "pullback"])

    def test_errors_have_words(self):
        p = physinv.problem("jpo/robotic-arm")
        with self.assertRaisesRegex(TypeError, "float32 or float64"):
            physinv.torch(p)(torch.zeros(1, 4, dtype=torch.int64))

    def test_a_network_learns_through_the_physics(self):
        torch.manual_seed(0)
        p = physinv.problem("jpo/robotic-arm")
        s = p.sample(seed=0, n=32)
        y = torch.from_numpy(s.y).float()
        net = torch.nn.Sequential(torch.nn.Linear(2, 32), torch.nn.Tanh(),
                                  torch.nn.Linear(32, 4))
        adam = torch.optim.Adam(net.parameters(), 1e-2)
        forward, losses = physinv.torch(p), []
        for _ in range(200):
            adam.zero_grad()
            loss = 0.5 * (forward(net(y)) - y).square().sum(1).mean()
            loss.backward()
            adam.step()
            losses.append(loss.item())
        self.assertLess(losses[-1], 1e-2 * losses[0])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
