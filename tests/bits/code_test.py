"""What may not be in code that computes numbers:

fused operations that nobody wrote: GCC 12 makes some of c a - s b, c b + s a
although contraction is off; functions of the C library that it chooses by the
processor (suite/core/math.h has others).

PROGRAM... --libraries LIBRARY..."""

import re
import subprocess
import sys

NOBODY_WROTE = re.compile(r"\bvfn?m(addsub|subadd)")
WROTE = re.compile(r"\bvfn?m(add|sub)[0-9]")


def found(program):
    """The functions that hold such an instruction, and how many do fma."""
    code = subprocess.Popen(["objdump", "-dC", "--no-show-raw-insn", program],
                            stdout=subprocess.PIPE, text=True)
    function, functions, fma = "", set(), 0
    for line in code.stdout:
        if line.endswith(">:\n"):
            function = line.split("<", 1)[1][:-3]
        elif NOBODY_WROTE.search(line):
            functions.add(function)
        elif WROTE.search(line):
            fma += 1
    assert code.wait() == 0, program
    return functions, fma


def chosen(library):
    """Functions whose bits glibc lets the processor decide, in itself or in
    what it calls, and the library asks for."""
    symbols = subprocess.run(["nm", "--undefined-only", library], check=True,
                             capture_output=True, text=True).stdout
    return set(re.findall(r" U ((?:exp|log|pow|sin|cos|tan|sincos|atan|atan2|"
                          r"exp2|log2|sinh|cosh|tanh|expm1|log1p|erf|erfc|"
                          r"lgamma|tgamma)f?)$", symbols, re.MULTILINE))


def main():
    split = sys.argv.index("--libraries")
    wrong = 0
    for program in sys.argv[1:split]:
        functions, fma = found(program)
        print(f"{program}: {fma} fused operations, {len(functions)} functions "
              "with some that nobody wrote")
        print("".join(f"  {f}\n" for f in sorted(functions)), end="")
        wrong += len(functions) + (fma < 1000)
    for library in ";".join(sys.argv[split + 1:]).split(";"):
        names = chosen(library)
        if names:
            print(f"{library}: {', '.join(sorted(names))} of the C library")
        wrong += len(names)
    sys.exit(bool(wrong))


main()
