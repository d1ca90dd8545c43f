"""What sources may not leave to the compiler and the processor.

No expression reads or draws twice from one source: which of two arguments of a
call, or operands of an operator, comes first is the compiler's to decide, and
GCC decides otherwise on x86-64 than on aarch64. No number outside of tests is a
long double, whose digits the processor decides, or comes from the C library's
elementary functions, which a compiler may evaluate (suite/core/math.h).

    portable_sources_test.py SOURCE_DIR"""

import collections
import pathlib
import re
import sys

PRODUCT = ["suite", "problems", "optimizers", "baselines", "reports", "python",
           "examples"]
# What changes its object: draws, and steps of readers.
STEPS = r"(?:uniform|normal|bits|draw|next|read\w*|take\w*|pop\w*|skip\w*)"
METHOD = re.compile(rf"\b(\w+)(?:\.|->){STEPS}\(")
# A free function that draws or reads from what it is handed.
FUNCTION = re.compile(
    r"\b(?:draw|read|next|take|parse|get)\w*(?:<[^<>()]*>)?\((\w+)[,)]")
ELEMENTARY = re.compile(
    r"\bstd::(?:a?(?:sin|cos|tan)h?|atan2|cbrt|erfc?|exp2?|expm1|hypot|[lt]gamma"
    r"|log|log10|log1p|log2|pow)\(|\blong\s+double\b")
BRACKETS = {"(": 1, "[": 1, ")": -1, "]": -1}


def code_of(text):
    """Without comments, texts and characters."""
    return re.sub(r'//[^\n]*|"(?:\\.|[^"\\\n])*"|' r"'(?:\\.|[^'\\\n])'", "",
                  text)


def expressions(text):
    """What is between two of ; { } , outside of parentheses."""
    begin = depth = 0
    for at, c in enumerate(text):
        depth = max(0, depth + BRACKETS.get(c, 0))
        if c in ";{}" or (c == "," and depth == 0):
            yield text[begin:at]
            begin = at + 1
            if c != ",":
                depth = 0


def sources_of(root, rooms):
    for room in rooms:
        for path in sorted((root / room).rglob("*")):
            if path.suffix in [".h", ".cpp"]:
                yield path.relative_to(root), code_of(path.read_text())


def faults(text):
    for expression in expressions(text):
        # Behind a question mark, && and || one of two is evaluated, in order.
        if "?" in expression or "&&" in expression or "||" in expression:
            continue
        sources = collections.Counter(METHOD.findall(expression) +
                                      FUNCTION.findall(expression))
        if max(sources.values(), default=0) > 1:
            yield " ".join(expression.split())


def main():
    assert list(faults("x = f(s.uniform(), s.uniform());"))
    assert list(faults("x = s.normal() - 2 * s.normal();"))
    assert list(faults("return Pair(read_word(in), read_word(in));"))
    assert not list(faults("double a = s.normal(), b = s.normal();"))
    assert not list(faults("f(a.next(), b.next());"))
    assert ELEMENTARY.findall("std::pow(10, 2.5) + std::atanh(x)")
    assert not ELEMENTARY.findall("std::sqrt(x) + std::floor(y) + math::exp(z)")
    root = pathlib.Path(sys.argv[1])
    found = []
    for path, text in sources_of(root, [*PRODUCT, "tests"]):
        found += [f"{path}: order left to the compiler: {fault}"
                  for fault in faults(text)]
        if path.parts[0] in PRODUCT:
            found += [f"{path}: {use}" for use in ELEMENTARY.findall(text)]
    sys.exit("\n".join(found) if found else 0)


main()
