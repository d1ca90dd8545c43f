"""Methods and campaigns side by side."""

import json

import numpy as np

from physinv import _campaign

# kSolvedLoss of suite/evidence/rank_test.h.
_SOLVED = 1e-12


def compare(campaign, *others, **flags):
    """One campaign: its methods beside each other, a dict for every experiment,
    n, method and stage: seeds, problems, the median loss, shares of problems,
    medians of iterations of a problem and of seconds of a run.
    pandas.DataFrame takes it.

    `solved`: the share of problems whose loss is below 1e-12, as in the tables
    of the report. `converged`: the share at which the method met its tolerance
    (status gtol), be it on a plateau. Problems of seeds that failed count in
    both shares, and in nothing else.

    Two or more: what `physinv-bench compare` says of them, as the dict of its
    --format=json; flags as keywords (by="method")."""
    if others:
        return json.loads(_campaign.verb("compare", campaign, *others,
                                         format="json", **flags))
    if flags:
        raise TypeError(f"compare of one campaign has no {', '.join(flags)}; "
                        "two campaigns take flags of physinv-bench compare")
    return methods_of(_campaign.open(campaign))


def methods_of(results):
    found = {}
    for stage in results.stages():
        key = tuple(stage[k] for k in ("experiment", "n", "method", "stage"))
        found.setdefault(key, []).append(stage)
    return [_row(results, key, stages) for key, stages in found.items()]


def _row(results, key, stages):
    """Numbers of the seeds that came to a result; None where none did."""
    ended = [s for s in stages if s["stop"] not in ("failed", "skipped")]
    each = [results.examples(s["case"], s["stage"]) for s in ended]
    problems = len(stages) * stages[0]["n"]
    row = dict(zip(("experiment", "n", "method", "stage"), key),
               seeds=len(stages), problems=problems, loss=None, solved=0.0,
               converged=0.0, iterations=None, seconds=None)
    if each:
        status = [one for e in each for one in e["status"]]
        losses = np.concatenate([e["loss"] for e in each])
        row["loss"] = _median([losses])
        row["solved"] = float((losses < _SOLVED).sum()) / problems
        row["converged"] = status.count("gtol") / problems
        row["iterations"] = _median([e["iterations"] for e in each])
    seconds = [s["seconds"] for s in ended if s["seconds"] is not None]
    if seconds:
        row["seconds"] = _median([seconds])
    return row


def _median(arrays):
    return float(np.median(np.concatenate(arrays)))
