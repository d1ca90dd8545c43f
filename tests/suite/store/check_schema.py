"""check_schema.py SCHEMA RESULTS...: valid as they are, invalid if spoiled."""

import copy
import json
import sys

try:
    import jsonschema
except ImportError:
    print("skipped: python3-jsonschema is not installed")
    sys.exit(77)


def error_in(results):
    return next(b for b in results["benchmarks"] if "error_occurred" in b)


def spoiled(results):
    """Copies of the results with one thing wrong each."""

    def change(edit):
        wrong = copy.deepcopy(results)
        edit(wrong)
        return wrong

    yield change(lambda r: r.pop("context"))
    yield change(lambda r: r.update(more=1))
    yield change(lambda r: r["benchmarks"][0].pop("loss_median"))
    yield change(lambda r: r["benchmarks"][0].update(unknown=1))
    yield change(lambda r: r["benchmarks"][0].update(time_unit="s"))
    yield change(lambda r: r["benchmarks"][0].update(real_time=None))
    yield change(lambda r: r["benchmarks"][0].update(error_occurred=True))
    yield change(lambda r: error_in(r).update(real_time=0.0))
    yield change(lambda r: error_in(r).update(loss_median=0.0))
    yield change(lambda r: error_in(r).pop("error_message"))
    yield change(lambda r: r["benchmarks"][0]["physinv"].update(stop="tired"))
    yield change(lambda r: r["context"]["physinv"].update(schema_version=1))


with open(sys.argv[1], encoding="utf-8") as file:
    schema = json.load(file)
jsonschema.Draft7Validator.check_schema(schema)
validator = jsonschema.Draft7Validator(schema)

for path in sys.argv[2:]:
    with open(path, encoding="utf-8") as file:
        results = json.load(file)
    assert results["benchmarks"], path
    for error in validator.iter_errors(results):
        sys.exit(f"{path}: {list(error.absolute_path)}: {error.message}")
    for i, wrong in enumerate(spoiled(results)):
        assert not validator.is_valid(wrong), f"{path}: spoiled {i} passes"
