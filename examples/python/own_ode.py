"""A simulator that is there already, as a problem: SciPy's solve_ivp on predators and prey,
u' = a u - b u v, v' = d u v - c v. Which rates explain what was counted? The Jacobian
comes from the equations of its sensitivities, solved along with it."""
import numpy as np
import physinv
from scipy.integrate import solve_ivp

TIMES = np.linspace(0.5, 3, 6)


def rates(t, state, a, b, c, d):
    """Of u, v and of d(u, v) / d(a, b, c, d)."""
    (u, v), s = state[:2], state[2:].reshape(2, 4)
    slope = np.array([a * u - b * u * v, d * u * v - c * v])
    by_state = np.array([[a - b * v, -b * u], [d * v, d * u - c]])
    by_rates = np.array([[u, -u * v, 0, 0], [0, 0, -v, u * v]])
    return np.concatenate([slope, (by_state @ s + by_rates).ravel()])


@physinv.experiment("predators", title="Predators and prey", n=8, iterations=100, updates=50,
                    batch=8, gtol=1e-7)
class Predators(physinv.Problem):
    start = [1.0, 1.0, 1.0, 1.0]
    unknowns = ("a, b, c, d", "1/s")
    side_input = "u(0), v(0)"

    def sample(self, seed, n):
        random = np.random.default_rng(seed)
        return random.uniform(0.6, 1.4, (n, 4)), random.uniform(0.5, 1.5, (n, 2))

    def solve(self, x, given):
        """(n, times, 2 + 8); NaN where the integration does not arrive."""
        out = np.full((len(x), len(TIMES), 10), np.nan)
        for i in range(len(x)):
            first = np.concatenate([given[i], np.zeros(8)])
            with np.errstate(all="ignore"):
                s = solve_ivp(rates, (0, TIMES[-1]), first, "DOP853", TIMES, args=x[i],
                              rtol=1e-10, atol=1e-10)
            if s.success:
                out[i] = s.y.T
        return out

    def forward(self, x, given):
        return self.vjp(x, given)[0]

    def vjp(self, x, given):
        both = self.solve(x, given)
        y, j = both[:, :, :2].reshape(len(x), -1), both[:, :, 2:].reshape(len(x), -1, 4)
        return y, lambda y_bar: np.einsum("nou,no->nu", j, y_bar)


if __name__ == "__main__":
    assert not physinv.conformance(Predators)
    physinv.run("quick", filter="^matrix/predators/(bfgs|lbfgsb|jpo)/", out="own_ode")
    for row in physinv.compare("own_ode"):
        print(f"{row['method']:8} {row['stage']:8} loss {row['loss']:8.2g}  solved {row['solved']:4.0%}")
