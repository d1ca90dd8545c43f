"""No object of the suite takes an elementary function from the C library, whose bits
depend on the processor: suite/core/math.h has them all. What IEEE 754 rounds exactly
(sqrt, fma, floor, fmod, ...) is free.

    math_symbols_test.py BUILD COMPILER"""

import json
import pathlib
import re
import subprocess
import sys
import tempfile

FUNCTIONS = """acos acosh asin asinh atan atan2 atanh cbrt cos cosh erf erfc exp
    exp10 exp2 expm1 hypot j0 j1 jn lgamma lgamma_r log log10 log1p log2 pow sin
    sincos sinh tan tanh tgamma y0 y1 yn cabs cacos casin catan carg ccos cexp
    clog cpow csin csqrt ctan""".split()
NAMES = {name + size for name in FUNCTIONS for size in ["", "f", "l"]}
ROOMS = ["suite/", "problems/", "optimizers/", "baselines/", "reports/",
         "python/"]


def taken(objects):
    """Lines "object: name" of what these leave to the C library."""
    listed = subprocess.run(["nm", "-A", "-u", *objects], check=True, text=True,
                            capture_output=True).stdout
    found = [line.split() for line in listed.splitlines()]
    return [f"{words[0]} {words[-1]}" for words in found
            if words[-1].split("@")[0] in NAMES]


def objects_of(build):
    for entry in json.loads((build / "compile_commands.json").read_text()):
        path = re.search(r" -o (\S+)", entry["command"])[1]
        if (path.startswith(tuple(ROOMS)) and path.endswith(".o")
                and (build / path).exists()):
            yield build / path


def main():
    build, compiler = pathlib.Path(sys.argv[1]), sys.argv[2]
    with tempfile.TemporaryDirectory() as folder:
        planted = pathlib.Path(folder, "planted.o")
        subprocess.run(
            [compiler, "-O2", "-x", "c++", "-c", "-", "-o", planted], check=True,
            text=True, input="#include <complex>\n"
            "double f(double x, double y) { return std::hypot(x, y); }\n"
            "double f(std::complex<double> z) { return std::abs(z); }\n")
        assert taken([planted]) == [f"{planted}: cabs", f"{planted}: hypot"]
    objects = list(objects_of(build))
    assert len(objects) > 100, objects
    wrong = taken(objects)
    sys.exit("\n".join(["from the C library:", *wrong]) if wrong else 0)


main()
