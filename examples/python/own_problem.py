"""Your own problem in PyTorch: a damped pendulum is seen eight times; how did it
start, and how strong is the damping? Runs eight methods on it and prints their table
(the page: own_problem/report/index.html)."""
import sys

import numpy as np
import physinv

try:
    import torch
except ImportError:
    sys.exit("own_problem.py needs PyTorch: apt install python3-torch")

SIGHTS, STEPS, H = 8, 10, 0.05  # seen every 10 steps of 0.05 s


@physinv.experiment("pendulum", title="Damped pendulum", n=16, iterations=200, updates=500)
class Pendulum(physinv.Problem, autodiff="torch"):
    """theta'' = -w^2 sin(theta) - c theta', by the semi-implicit Euler method."""
    start = [0.5, 0.0, 0.1]
    unknowns = ("angle, angular velocity, damping", "rad, rad/s, 1/s")
    observations = ("angle(sight)", "rad")
    side_input = ("frequency", "rad/s")

    def sample(self, seed, n):
        random = np.random.default_rng(seed)
        return random.uniform([-2, -1, 0], [2, 1, 0.5], (n, 3)), random.uniform(0.8, 1.2, (n, 1))

    def forward(self, x, given):
        (angle, speed, damping), seen = x.T, []
        for k in range(SIGHTS * STEPS):
            speed = speed - H * (given[:, 0] ** 2 * torch.sin(angle) + damping * speed)
            angle = angle + H * speed
            if (k + 1) % STEPS == 0:
                seen.append(angle)
        return torch.stack(seen, 1)


if __name__ == "__main__":
    assert not physinv.conformance(Pendulum)
    physinv.run("quick", filter="^matrix/pendulum/(bfgs|lbfgsb|gd|jpo|supervised|na|adam|hig)/",
                out="own_problem")
    for row in physinv.compare("own_problem"):
        print(f"{row['method']:12} {row['stage']:8} loss {row['loss']:8.2g}  solved {row['solved']:4.0%}")
