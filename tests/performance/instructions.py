"""Instructions per fused product of the hottest kernels, by compiler.

    python3 tests/performance/instructions.py [SYSROOT]

compiles the kernels' sources for x86-64-v3 by g++ and, given the root of an
arm64 Debian, for aarch64 by g++ and clang++, and counts in their machine code.
A kernel's loops are innermost ones: from the target of a jump back to the jump.
One of N lanes is N fused products. Nothing runs, so no speed is measured.
"""

import collections
import os
import re
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(__file__))) or "."
COMMON = ["-std=c++20", "-O3", "-DNDEBUG", "-ffp-contract=off", "-w", "-c",
          "-DEIGEN_DONT_PARALLELIZE", "-DEIGEN_DONT_VECTORIZE",
          "-I" + ROOT,
          "-isystem", "/usr/include/eigen3"]
ARM = ["-march=armv8-a+crc", "-mtune=neoverse-n1"]

Kernel = collections.namedtuple("Kernel", "title source symbol products loops")
# The symbol on x86-64 and on aarch64, where tiles have other sizes; the
# products that a turn of the loop makes; how many such loops (both ways
# through a matrix).
KERNELS = [
    Kernel("dense layer, float", "suite/nn/gemm", (
        r"4tileIfDv8_fLi6ELi2ELb1ELb1E",) * 2, (96, 96), 1),
    Kernel("dense layer, double", "suite/nn/gemm", (
        r"4tileIdDv4_dLi6ELi2ELb1ELb1E", r"4tileIdDv4_dLi4ELi2ELb1ELb1E"),
           (48, 32), 1),
    Kernel("dense layer, one vector, float", "suite/nn/gemm", (
        r"4tileIfDv8_fLi12ELi1ELb1ELb1E", r"4tileIfDv8_fLi8ELi1ELb1ELb1E"),
           (96, 64), 1),
    Kernel("thin layer, float", "suite/nn/gemm", (
        r"9thin_rowsIf.*E1_EE",) * 2, (32, 32), 1),
    Kernel("convolution, float", "suite/nn/conv_kernels", (
        r"4tileIfLi4ELi3E",) * 2, (96, 96), 1),
    Kernel("convolution, double", "suite/nn/conv_kernels", (
        r"4tileIdLi4ELi3E",) * 2, (48, 48), 1),
    Kernel("weights of a convolution, float", "suite/nn/conv_weights", (
        r"weight_tileIfDv8_fLi4ELi3ELb1E",) * 2, (96, 96), 1),
    Kernel("the same, rows of several vectors", "suite/nn/conv_weights", (
        r"weight_tileIfDv8_fLi4ELi3ELb0E",) * 2, (96, 96), 1),
    Kernel("symmetric product", "suite/linalg/symmetric_update", (
        r"add_product",) * 2, (128, 128), 2),
    Kernel("rank update", "suite/linalg/symmetric_update", (
        r"RankUpdateclE",) * 2, (48, 48), 1),
    Kernel("tall QR, columns of a panel", "suite/linalg/tall_qr", (
        r"13triangularizeE",) * 2, (64, 64), 1),
    Kernel("two combinations of a panel", "suite/linalg/tridiagonalize", (
        r"21subtract_combinations|14Tridiagonalize5panel",) * 2, (64, 64), 1),
]


def functions(path, tool):
    """Instructions of each function: address, name, operands."""
    text = subprocess.run([tool, "-d", "--no-show-raw-insn", path], check=True,
                          capture_output=True, text=True).stdout
    found, name = {}, None
    for line in text.splitlines():
        if head := re.match(r"[0-9a-f]+ <(.*)>:$", line):
            name = head[1]
            found[name] = []
        elif body := re.match(r" *([0-9a-f]+):\t(\S+)\s*(.*)$", line):
            found[name].append((int(body[1], 16), body[2], body[3]))
    return found


def products(name, operands):
    """Fused products of an instruction."""
    if re.match(r"vfn?m(add|sub)\d+[ps][sd]$", name):
        if name[-2] == "s":
            return 1
        size = 32 if "%ymm" in operands else 16
        return size // (8 if name.endswith("d") else 4)
    if name in ("fmla", "fmls"):
        lanes = re.match(r"v\d+\.(\d+)[sd]", operands)
        return int(lanes[1]) if lanes else 1
    return int(name in ("fmadd", "fmsub", "fnmadd", "fnmsub"))


def loops(code):
    """(products, instructions) of innermost loops."""
    back = []
    for at, name, operands in code:
        target = re.search(r"\b([0-9a-f]+) <", operands)
        if re.match(r"(j\w+|b(\.\w+)?|cbn?z|tbn?z)$", name) and target:
            if int(target[1], 16) <= at:
                back.append((int(target[1], 16), at))
    for begin, end in back:
        if any(o != (begin, end) and begin <= o[0] and o[1] <= end
               for o in back):
            continue
        body = [c for c in code if begin <= c[0] <= end]
        yield sum(products(n, o) for _, n, o in body), len(body)


def count(kernel, code, side):
    """Instructions per product, the mean of its loops; None if not found."""
    sizes = sorted(size for name, body in code.items()
                   if re.search(kernel.symbol[side], name)
                   for made, size in loops(body)
                   if made == kernel.products[side])[:kernel.loops]
    if len(sizes) < kernel.loops:
        return None
    return sum(sizes) / len(sizes) / kernel.products[side]


def columns(sysroot):
    yield "x86-64-v3, g++", ["g++", "-march=x86-64-v3"], "objdump", 0
    if sysroot:
        root, dump = "--sysroot=" + sysroot, "aarch64-linux-gnu-objdump"
        yield ("aarch64, clang++", ["clang++", "--target=aarch64-linux-gnu",
                                    root, *ARM], dump, 1)
        yield ("aarch64, g++", ["aarch64-linux-gnu-g++", root, *ARM], dump, 1)


def main():
    rows = {kernel.title: [] for kernel in KERNELS}
    titles = []
    with tempfile.TemporaryDirectory() as folder:
        for title, compiler, dump, side in columns(*sys.argv[1:2] or [""]):
            titles.append(title)
            code = {}
            for source in sorted({kernel.source for kernel in KERNELS}):
                out = os.path.join(folder, "code.o")
                subprocess.run([*compiler, *COMMON, "-o", out,
                                os.path.join(ROOT, source + ".cpp")],
                               check=True)
                code[source] = functions(out, dump)
            for kernel in KERNELS:
                rows[kernel.title].append(
                    count(kernel, code[kernel.source], side))
    print("| kernel | " + " | ".join(titles) + " |")
    print("| --- |" + " ---: |" * len(titles))
    for title, values in rows.items():
        texts = []
        for value in values:
            text = "not found" if value is None else f"{value:.3f}"
            if value is not None and len(texts) > 0 and values[0]:
                text += f" ({value / values[0]:.2f})"
            texts.append(text)
        print(f"| {title} | " + " | ".join(texts) + " |")


if __name__ == "__main__":
    main()
