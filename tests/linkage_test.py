"""What runs cases links no FFTW and no GSL, which are under the GPL: neither as
shared libraries nor inside. What compares with FFTW links it, and the plug-in of
other libraries' solvers links GSL (tests/libraries/libraries_test.py).

    linkage_test.py PROGRAM... --with PROGRAM..."""

import re
import subprocess
import sys


def links(program):
    """Of FFTW and GSL those that the program links."""
    needed = subprocess.run(["ldd", program], check=True, text=True,
                            capture_output=True).stdout
    symbols = subprocess.run(["nm", program], check=True, text=True,
                             capture_output=True).stdout
    return {name for name, symbol in (("fftw", r"\bfftwf?_\w"),
                                      ("gsl", r"\bgsl_\w"))
            if "lib" + name in needed or re.search(symbol, symbols)}


def main():
    split = sys.argv.index("--with")
    wrong = [p for p in sys.argv[1:split] if links(p)]
    wrong += [p for p in sys.argv[split + 1:] if links(p) != {"fftw"}]
    sys.exit(f"libraries under the GPL in the wrong programs: {wrong}" if wrong else 0)


main()
