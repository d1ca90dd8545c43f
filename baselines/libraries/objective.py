"""A problem of a campaign as a library in another language sees it."""

import collections

import numpy as np


class Objective:
    """Problem i of a run, and what was seen of it. `box`: lower and upper
    bounds, None for none."""

    def __init__(self, run, i, box=None):
        self.run, self.i, self.box = run, i, box
        self.seen, self.steps, self.outside = {}, 0, 0

    def __call__(self, x):
        loss, gradient = (a[0] for a in
                          self.run.loss_and_gradient(x[None], [self.i]))
        left = gradient
        if self.box is not None:
            self.outside += not (np.clip(x, *self.box) == x).all()
            left = x - np.clip(x - gradient, *self.box)
        self.seen[x.tobytes()] = loss, abs(left).max()
        if self.steps == 0:  # all begin with their start
            self.accept(x)
        return loss, gradient

    def accept(self, x):
        """x is the library's new iterate; what is beyond its limit is not reported."""
        if x.tobytes() in self.seen and self.steps <= self.run.iterations:
            self.run.accept(self.i, self.steps, x, self.seen[x.tobytes()][0])
            self.steps += 1

    def end(self, x, loss, status, message):
        """What the library returned, and what it called it: x, status, message
        and the arrays that the plug-in's solvers leave. x that was not evaluated
        is; x that is not finite is not a result: the problem ends at its start."""
        if np.isfinite(x).all() and x.tobytes() not in self.seen:
            self(x)
        at, left = self.seen.get(x.tobytes(), (np.nan, np.nan))
        lowest = min((one for one, _ in self.seen.values() if one == one),
                     default=np.nan)
        arrays = {"claims_success": status in ("gtol", "ftol"),
                  "returned_not_best": at > lowest,
                  "false_loss": at == at and loss == loss and loss != at,
                  "gradient_left": left}
        if self.box is not None:
            arrays["outside_box"] = self.outside
        if not (np.isfinite(x).all() and np.isfinite(loss)):
            x, status = self.run.start[self.i], "nonfinite"
        return x, status, message, arrays


def outcome(ends):
    """What a method returns, of what `end` gave for each problem."""
    xs, status, messages, arrays = zip(*ends)
    counts = collections.Counter(m for m in messages if m)
    return np.array(xs), {
        "status": list(status),
        "message": "; ".join(f"{k} x {m}" for m, k in sorted(counts.items())),
        "arrays": {name: [float(a[name]) for a in arrays] for name in arrays[0]}}


def box_of(run, i):
    """Landscapes have their bounds as side input."""
    return np.split(run.given[i], 2) if run.given.shape[1] else None
