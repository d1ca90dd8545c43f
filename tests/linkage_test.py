"""What runs cases links no FFTW, which is under the GPL: neither as a shared
library nor inside. What compares with it does.

    linkage_test.py PROGRAM... --with PROGRAM..."""

import re
import subprocess
import sys


def links_fftw(program):
    needed = subprocess.run(["ldd", program], check=True, text=True,
                            capture_output=True).stdout
    symbols = subprocess.run(["nm", program], check=True, text=True,
                             capture_output=True).stdout
    return "libfftw" in needed or bool(re.search(r"\bfftwf?_\w", symbols))


def main():
    split = sys.argv.index("--with")
    wrong = [p for p in sys.argv[1:split] if links_fftw(p)]
    wrong += [p for p in sys.argv[split + 1:] if not links_fftw(p)]
    sys.exit(f"FFTW in the wrong programs: {wrong}" if wrong else 0)


main()
