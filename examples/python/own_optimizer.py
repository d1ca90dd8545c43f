"""Your own optimizer on the billiards of the JPO paper: SciPy's BFGS from the best
of 64 random shots, as a method of the campaign. In how many problems does it end below
BFGS from the paper's start, compared with what the paper prints (own_optimizer.svg)?"""
import numpy as np, scipy
from matplotlib import pyplot
import physinv


@physinv.method("best-of-64", experiments="jpo/billiards")
def solve(run):
    ends, random = run.start, np.random.default_rng(run.seed)
    for i in range(run.n):
        shots = run.start[i] + random.normal(0, 0.5, (64, 2))
        trace = [shots[run.loss(shots, [i] * 64).argmin()]]
        f = lambda x: [a[0] for a in run.loss_and_gradient(x[None], [i])]
        end = scipy.optimize.minimize(f, trace[0], jac=True, method="BFGS", callback=trace.append)
        for k, x in enumerate(trace + [end.x]):
            run.accept(i, k, x, f(x)[0])
        ends[i] = end.x
    return ends


r = physinv.run("smoke", filter="^jpo/billiards/(bfgs|best-of-64)/n=128/", out="own_optimizer")
mine, bfgs = (np.concatenate([r.examples(s["case"])["loss"] for s in r.stages() if s["method"] == m])
              for m in ("best-of-64", "bfgs"))
bars = {"SciPy, best of 64 (here)": 100 * np.mean(mine < bfgs)}
bars |= {f"{v['quantity'].split('/')[1]} (paper, {v['where']})": v["value"]
         for v in physinv.published("jpo/billiards") if v["quantity"].endswith("/better")}
pyplot.barh(*zip(*bars.items())), pyplot.xlabel("% of problems that end below BFGS")
pyplot.tight_layout(), pyplot.savefig("own_optimizer.svg")
