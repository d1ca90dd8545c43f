"""Methods and campaigns side by side."""

import json

import numpy as np

from physinv import _campaign

# kSolvedByDefault of suite/results/solved_loss.h.
_SOLVED = 1e-6
_CONVERGED = ("gtol", "ftol")


def compare(campaign, *others, **flags):
    """One campaign: its methods compared, a dict for every experiment,
    n, method and stage: seeds, how many of them failed, problems, the median
    loss, shares of problems, medians of iterations of a problem and of seconds
    of a run. pandas.DataFrame takes it.

    `solved`: the share of problems whose loss is at most 1e-6, as in
    `physinv-bench compare`. `converged`: the share at which the method met a tolerance
    (status gtol or ftol), be it on a plateau. The problems of a run that failed have an
    infinite loss and count in both shares; iterations and seconds are of the
    other runs.

    Two or more: what `physinv-bench compare` says of them, as the dict of its
    --format=json; flags as keywords (by="method")."""
    if others:
        return json.loads(_campaign.verb("compare", campaign, *others,
                                         format="json", **flags))
    if flags:
        raise TypeError(f"compare of one campaign has no {', '.join(flags)}; "
                        "flags of physinv-bench compare need two campaigns")
    return methods_of(_campaign.open(campaign))


def methods_of(results):
    found = {}
    for stage in results.stages():
        key = tuple(stage[k] for k in ("experiment", "n", "method", "stage"))
        found.setdefault(key, []).append(stage)
    return [_row(results, key, stages) for key, stages in found.items()]


def _row(results, key, stages):
    """Numbers of all seeds, None where no seed has a result; a problem
    without a finite loss, or of a run that failed, has an infinite one."""
    ended = [s for s in stages if s["stop"] not in ("failed", "skipped")]
    each = [results.examples(s["case"], s["stage"]) for s in ended]
    lost = sum(s["n"] for s in stages if s not in ended)
    problems = lost + sum(len(e["loss"]) for e in each)
    row = dict(zip(("experiment", "n", "method", "stage"), key),
               seeds=len(stages), failed=len(stages) - len(ended),
               problems=problems, loss=None, solved=0.0, converged=0.0,
               iterations=None, seconds=None)
    if each:
        status = [one for e in each for one in e["status"]]
        loss = np.concatenate([*(e["loss"] for e in each),
                               np.full(lost, np.inf)])
        row["loss"] = _median([np.where(np.isfinite(loss), loss, np.inf)])
        row["solved"] = float((loss <= _SOLVED).sum()) / problems
        row["converged"] = sum(map(status.count, _CONVERGED)) / problems
        row["iterations"] = _median([e["iterations"] for e in each])
    seconds = [s["seconds"] for s in ended if s["seconds"] is not None]
    if seconds:
        row["seconds"] = _median([seconds])
    return row


def _median(arrays):
    return float(np.median(np.concatenate(arrays)))
