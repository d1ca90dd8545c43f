#!/usr/bin/env python3
"""torch_test.py WORK: problems under PyTorch. gradcheck of every problem with a
vjp, one forward pass and one pullback a step, a network that is trained through
the physics and ends on the curve of our JPO."""

import shutil
import subprocess
import sys
import unittest

try:
    import numpy as np
    import torch
except ImportError:
    print("skipped: python3-torch is missing")
    sys.exit(77)

import physinv

WORK = sys.argv[1]
LARGEST = 200  # unknowns whose every difference is looked at
# The parent has threads of OpenMP, its workers are forks.
FORKED = """
import sys
import physinv, torch

def compute():
    a = torch.ones(512, 512)
    (a.exp() @ a).sum()

@physinv.method("forked", experiments="jpo/robotic-arm", needs="vjp",
                iterations=2)
def solve(run):
    compute()
    threads = torch.get_num_threads()
    assert threads == int(sys.argv[2]), threads
    while run.proceed(run.start):
        pass
    return run.start

torch.set_num_threads(2)
compute()
r = physinv.run("smoke", filter="^jpo/robotic-arm/forked/", out=sys.argv[1],
                threads=int(sys.argv[2]), no_report=True)
print([(s["stop"], s["message"]) for s in r.stages()], torch.get_num_threads())
compute()
"""


def with_given():
    return next(p for p in map(physinv.problem, physinv.problems())
                if "vjp" in p.names and p.shape[2] > 0)


def tensors(p, n):
    s = p.sample(seed=1, n=n, labelled=True)
    return [torch.from_numpy(a) for a in (s.x, s.y, s.given)]


class Torch(unittest.TestCase):
    def test_gradcheck(self):
        checked = set()
        for name in physinv.problems():
            p = physinv.problem(name)
            if "vjp" not in p.names:
                continue
            key = (p.shape, tuple(p.options.items()))
            if key in checked:
                continue
            checked.add(key)
            with self.subTest(name):
                x, _, given = tensors(p, 2)
                x.requires_grad_()
                # Of many unknowns along a random direction; a flow has kinks
                # closer than the step of many differences.
                fast = p.shape[0] > LARGEST or "navier-stokes" in name
                self.assertTrue(torch.autograd.gradcheck(
                    lambda x: physinv.torch(p)(x, given), (x,),
                    eps=1e-7, atol=1e-5, rtol=1e-4, fast_mode=fast))
        self.assertGreater(len(checked), 40)

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
        p = with_given()
        x, _, given = tensors(p, 2)
        for wrong in (given + 1j, given.numpy()):
            with self.assertRaisesRegex(TypeError, "given is .*float32 or"):
                physinv.torch(p)(x, wrong)

    def test_second_derivatives_are_none_rather_than_zero(self):
        p = physinv.problem("jpo/billiards")
        x, y, given = tensors(p, 2)
        forward = physinv.torch(p)
        x.requires_grad_()

        def loss(x):  # linear in y as well: no second derivative by y
            return forward(x, given).sum()

        with self.assertRaisesRegex(NotImplementedError, "first derivatives"):
            torch.autograd.functional.hessian(loss, x)
        with self.assertRaisesRegex(NotImplementedError, "first derivatives"):
            torch.autograd.functional.hvp(loss, x, x)
        with self.assertRaisesRegex(NotImplementedError, "first derivatives"):
            slope, = torch.autograd.grad(loss(x), x, create_graph=True)
            (loss(x) + slope.square().sum()).backward()
        with self.assertRaises(NotImplementedError):
            torch.autograd.gradgradcheck(lambda x: forward(x, given), (x,))

    def test_given_has_no_derivative(self):
        p = with_given()
        x, _, given = tensors(p, 2)
        given.requires_grad_()
        with self.assertRaisesRegex(TypeError, "given.detach"):
            physinv.torch(p)(x, given)
        with torch.no_grad():
            y = physinv.torch(p)(x, given)
        self.assertTrue(torch.equal(y, physinv.torch(p)(x, given.detach())))

    def test_workers_of_a_parent_with_threads(self):
        script = WORK + "-forked.py"
        with open(script, "w") as f:
            f.write(FORKED)
        for threads in ("1", "2"):
            out = f"{WORK}-forked-{threads}"
            shutil.rmtree(out, ignore_errors=True)
            done = subprocess.run([sys.executable, script, out, threads],
                                  capture_output=True, text=True, timeout=120)
            self.assertIn("[('iterations', '')] 2", done.stdout + done.stderr)

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

    def test_the_curve_of_our_jpo(self):
        """From the same weights, by the same rule, through our adjoint."""
        @physinv.method("torch-jpo", experiments="jpo/robotic-arm",
                        needs=("vjp", "network"), version=torch.__version__)
        def solve(run):
            net, start = run.network(), torch.tensor(run.start)
            y = torch.tensor(run.observations)
            assert "mlp" in net["description"]
            assert np.array_equal(net["inputs"], run.observations)
            weights = [torch.tensor(w, requires_grad=True)
                       for w in net["weights"].values()]
            forward = physinv.torch(physinv.problem("jpo/robotic-arm"))
            adam = torch.optim.Adam(weights, 1e-3, eps=1e-7)

            def estimate():
                h = torch.tensor(net["inputs"])
                for k in range(0, len(weights), 2):
                    h = h @ weights[k].T + weights[k + 1]
                    h = h.relu() if k + 2 < len(weights) else h
                return start + net["output_scale"] * h

            def clip(gradient):
                norm = gradient.norm(dim=1, keepdim=True)
                return gradient * (norm.quantile(0.9) / norm).clamp(max=1)

            while run.proceed((x := estimate()).detach().numpy()):
                adam.zero_grad()
                x.register_hook(clip)
                (0.5 * (forward(x) - y).square().sum()).backward()
                adam.step()
            return x.detach().numpy()

        shutil.rmtree(WORK, ignore_errors=True)
        r = physinv.run("smoke", filter="^jpo/robotic-arm/(jpo|torch-jpo)/",
                        set=["precision=f64", "iterations=50"], out=WORK)
        cases = {s["method"]: s["case"] for s in r.stages()}
        theirs = r.curve(cases["torch-jpo"])
        ours = r.curve(cases["jpo"], "fit")
        self.assertTrue(np.array_equal(theirs["iteration"], ours["iteration"]))
        off = np.abs(theirs["loss"] - ours["loss"]).max(1) / ours["loss"].max(1)
        print(f"{len(off)} points of both curves differ by at most "
              f"{off.max():.1e}, the first by {off[0]:.1e}")
        self.assertLess(off[0], 1e-12)
        self.assertLess(off.max(), 1e-12)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
