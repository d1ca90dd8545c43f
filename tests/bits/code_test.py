"""What may not be in code that computes numbers:

fused operations that no source has: GCC 12 makes some of c a - s b, c b + s a
although contraction is off.

And what may not be in the loops that take most of the time: sums that went to
the stack for want of registers, and structs that were copied through it in
pieces of 16 bytes.

And what is for wide registers in the last program, if it is for narrow ones.

PROGRAM... [--narrow]"""

import re
import subprocess
import sys

NOBODY_WROTE = re.compile(r"\bvfn?m(addsub|subadd)")
WROTE = re.compile(r"\bvfn?m(add|sub)[0-9]")

# Functions whose loops of at least so many fused operations (products, where
# nothing is fused) keep their sums in registers, in each program.
HELD = {
    r"linalg::\(anonymous namespace\)::add_product\(": 8,
    r"RankUpdate::operator\(\)\(": 12,
    r"StructuredGram::Sweep::block\(": 12,
    r"Tridiagonalize::panel\(": 4,
    r"Tridiagonalize::multiply_panel\(": 12,
    r"nn::\(anonymous namespace\)::weight_tile<": 12,
}
# Functions whose loops copy nothing in pieces.
WHOLE = {
    r"anonymous namespace\)::pull_group<(float|double)>\(": 40,
    r"anonymous namespace\)::differentiate<(float|double)>\(": 80,
}
# Vectors to or from the frame: sums and temporaries without a register.
STACK = re.compile(r"%[xyz]mm.*(\(%rsp|-0x[0-9a-f]+\(%rbp\))|"
                   r"(\(%rsp|-0x[0-9a-f]+\(%rbp\)).*%[xyz]mm")
PIECE = re.compile(r"^vmov(dq[au]|[au]p).*(%xmm.*\(%r[sb]p|\(%r[sb]p.*%xmm)")
JUMP = re.compile(r"^j\w+\s+([0-9a-f]+)")


def loops(code):
    """Innermost loops of a function: [(address, instruction)]."""
    place = {address: i for i, (address, _) in enumerate(code)}
    ranges = []
    for i, (address, text) in enumerate(code):
        jump = JUMP.match(text)
        if jump and int(jump[1], 16) <= address:
            begin = place.get(int(jump[1], 16))
            if begin is not None:
                ranges.append((begin, i))
    for begin, end in ranges:
        if not any((b, e) != (begin, end) and begin <= b and e <= end
                   for b, e in ranges):
            yield [text for _, text in code[begin:end + 1]]


def badly_made(functions):
    """What loops of HELD and WHOLE do with the stack, and what was not found."""
    complaints = []
    for table, pattern, what in ((HELD, STACK, "vectors on the stack"),
                                 (WHOLE, PIECE, "pieces of 16 bytes")):
        for name, least in table.items():
            seen = 0
            for function, code in functions.items():
                if not re.search(name, function):
                    continue
                for body in loops(code):
                    if sum(bool(WROTE.search(t)) for t in body) < least:
                        continue
                    seen += 1
                    bad = sum(bool(pattern.search(t)) for t in body)
                    if bad:
                        complaints.append(f"{function}: a loop with {bad} "
                                          f"{what}")
            if not seen:
                complaints.append(f"no loop of {least} fused operations in "
                                  f"what {name} names")
    return complaints


def found(program):
    """The functions that hold an operation that no source has, how many do fma,
    the code of those that are looked at, and what is for wide registers."""
    code = subprocess.Popen(["objdump", "-dC", "--no-show-raw-insn", program],
                            stdout=subprocess.PIPE, text=True)
    looked_at = re.compile("|".join([*HELD, *WHOLE]))
    function, functions, fma, kept, lines = "", set(), 0, {}, None
    wide = []
    for line in code.stdout:
        if line.endswith(">:\n"):
            function = line.split("<", 1)[1][:-3]
            lines = None
            if looked_at.search(function):
                # A name may stand for parts that the compiler took apart.
                lines = kept.setdefault(f"{function} {line.split()[0]}", [])
            continue
        if "vf" in line:
            if NOBODY_WROTE.search(line):
                functions.add(function)
            elif WROTE.search(line):
                fma += 1
        if "mm" in line and ("%zmm" in line or "%ymm16" in line or
                             "%xmm16" in line):
            wide.append(line)
        if lines is not None and ":\t" in line:
            address, text = line.split(":\t", 1)
            lines.append((int(address, 16), text.strip()))
    assert code.wait() == 0, program
    return functions, fma, kept, wide


def main():
    programs = sys.argv[1:]
    narrow = "--narrow" in programs
    if narrow:
        programs.remove("--narrow")
    wrong = 0
    for program in programs:
        functions, fma, kept, wide = found(program)
        print(f"{program}: {fma} fused operations, {len(functions)} functions "
              f"with some that nobody wrote, {len(wide)} wide registers")
        print("".join(f"  {f}\n" for f in sorted(functions)), end="")
        complaints = badly_made(kept)
        print("".join(f"  {c}\n" for c in complaints), end="")
        wrong += len(functions) + (fma < 1000) + len(complaints)
        if narrow and program == programs[-1]:
            print("".join(wide[:5]), end="")
            wrong += len(wide)
    sys.exit(bool(wrong))


main()
