"""Hostile returns of stages: estimates of other shapes, counts that are none,
ends that do not exist, names that no file can have, texts without end. Nothing
but the stage fails by that, and the store is read by every verb."""

from between import VERBS

# Over the problem and the methods of tests/suite/harness/fake_experiment.h.
HOSTILE = ["run", "--profile=hostile", "--trace", "--jobs=1", "--out=store"]
OTHERS = ["run", "--profile=smoke", "--trace", "--jobs=1", "--out=store"]
MORE = [["export", "store", "--format=csv"], ["export", "store",
        "--format=github"], ["export", "store", "--format=bencher"],
        ["list", "--profile=hostile"]]


def returns(attempt):
    fake = attempt.world.fake_program
    if not fake:
        attempt.skipped = "--fake names no program"
        return
    attempt.hits = 1
    way = {"PHYSINV_FAKE_RETURN": str(attempt.seed)}

    def run(*line, env=None):
        return attempt.run(*line, limit=20, program=fake, env=env)

    ended = run(*HOSTILE, env=way)
    failed = ended.code == 4
    if not attempt.expect(ended.code in (0, 4), f"the run: {ended.code}"):
        return
    for line in [v[0] for n, v in VERBS.items() if n not in (
            "gate", "compare")] + MORE + [["compare", "store", "store"]]:
        code = run(*line).code
        attempt.expect(code in ((0, 10) if failed else (0,)),
                       f"{' '.join(line)}: {code}")
    attempt.expect(run(*OTHERS).code == 0, "other cases do not run")
    attempt.expect(run(*HOSTILE, env=way).code == ended.code,
                   "the same command ends otherwise")
