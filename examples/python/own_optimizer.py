"""SciPy's BFGS on the billiards of the JPO paper, beside the suite's: the same
128 problems, final losses of both as a picture (own_optimizer.svg)."""
import numpy as np
from matplotlib import pyplot
from scipy.optimize import minimize

import physinv

CASE = "jpo/billiards/bfgs/n=128/seed=0"
ours = physinv.run("smoke", filter=f"^{CASE}$", out="own_optimizer").examples(CASE)
p = physinv.problem("jpo/billiards")
s = p.sample(seed=0, n=128)


def loss(x, i):
    y, tape = p.linearize(x[None], s.given[i:i + 1])
    y_bar = p.loss_gradient(y, s.y[i:i + 1])
    return p.loss(y, s.y[i:i + 1])[0], tape.pullback(y_bar)[0]


ends = [minimize(loss, p.start, args=(i,), jac=True, method="BFGS") for i in range(128)]
for label, losses in (("ours", ours["loss"]), ("SciPy", [r.fun for r in ends])):
    pyplot.plot(np.sort(np.maximum(losses, 1e-16)), label=label)
pyplot.yscale("log"), pyplot.xlabel("problems solved"), pyplot.ylabel("loss"), pyplot.legend()
pyplot.savefig("own_optimizer.svg")
