"""Defects planted in the program over the fake experiment, its data and its
baseline: each is caught, with the right exit code."""

import json
import os
import re
import shutil
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, "..", "suite", "app"))
from program import BENCH, FAILED, check, crc32c  # noqa: E402

COUNT = os.path.abspath(sys.argv[2]) if len(sys.argv) > 2 else None
CAN_COUNT = COUNT is not None and shutil.which("valgrind") is not None


def run(*args, cwd, plant="", **env):
    quiet = {k: v for k, v in os.environ.items() if not k.startswith("GITHUB")}
    return subprocess.run(
        [BENCH, *args], cwd=cwd, text=True, capture_output=True, timeout=300,
        env={**quiet, "PHYSINV_FAKE_PLANT": plant,
             "PHYSINV_COUNT": COUNT or "nowhere", **env})


def expect(code, args, cwd, says="", **kwargs):
    """The exit code, at most one line of errors, and words that are said."""
    p = run(*args, cwd=cwd, **kwargs)
    lines = p.stderr.splitlines()
    good = p.returncode == code and len(lines) == (1 if code else 0)
    check(good and says in p.stdout + p.stderr,
          f"{kwargs.get('plant', '')}: {' '.join(args)} -> {p.returncode} "
          f"{p.stderr.strip()[:150]}")
    return p


def rewrite(d, name, change, base="base.txt"):
    """Another baseline with a right checksum."""
    body = open(os.path.join(d, base)).read().rsplit("checksum", 1)[0]
    changed = change(body)
    assert changed != body
    with open(os.path.join(d, name), "w") as f:
        f.write(f"{changed}checksum {crc32c(changed.encode()).decode()}\n")


GATE = ["gate", "--baseline=base.txt"]


def made(d):
    """A baseline is made from a traced campaign of this build alone."""
    expect(0, ["--profile=smoke", "--out=untraced"], d)
    expect(2, ["baseline", "untraced", "--out=base.txt"], d, "--trace")
    expect(2, ["baseline", "nowhere", "--out=base.txt"], d, "no results")
    expect(0, ["--profile=smoke", "--trace", "--out=r"], d)
    expect(0, ["baseline", "r/results.json", "--out=base.txt"], d, "6 stages")
    text = open(os.path.join(d, "base.txt")).read()
    check(text.count(" digits=3 ") == 1, "an ulp moves all that looks at data")
    expect(10, ["--profile=quick", "--time-budget=0.000001", "--out=q"], d)
    expect(10, ["baseline", "q", "--out=q.txt"], d, "not run")
    check(not os.path.exists(os.path.join(d, "q.txt")), "no half a baseline")


def passes(d):
    p = expect(0, [*GATE, "--json=g.json"], d, "accuracy: 6 same")
    found = json.load(open(os.path.join(d, "g.json")))
    check(found["exit_code"] == 0 and len(found["findings"]) == 6, "JSON")
    check("::error" not in p.stdout, "no annotations outside of GitHub")
    expect(0, [*GATE, "--filter=walk"], d, "accuracy: 2 same")
    expect(0, [*GATE, "--results=r"], d, "accuracy: 6 same")


def defects(d):
    for plant, code, says in (
            ("ulp in a constant", 5, "other bits, although this build must"),
            ("ulp in the data", 5, "other bits, although this build must"),
            ("more work", 5, "vjp 40 -> 44"),
            ("NaN in a loss", 5, "losses that are not finite 0 -> 1"),
            ("a case removed", 5, "missing")):
        expect(code, GATE, d, says, plant=plant)
    expect(0, [*GATE, "--allow-work"], d, "6 same", plant="more work")
    expect(5, [*GATE, "--filter=stroll"], d, "2 missing",
           plant="a case removed")
    expect(3, [*GATE, "--filter=no_such"], d, "no case of base.txt matches")
    summary = os.path.join(d, "summary.md")
    p = expect(5, GATE, d, plant="NaN in a loss", GITHUB_ACTIONS="true",
               GITHUB_STEP_SUMMARY=summary)
    check("::error title=accuracy worse::fake/cubic/descend" in p.stdout,
          "annotations")
    check("gate: failed" in open(summary).read(), "Markdown")


def other_baselines(d):
    whole = open(os.path.join(d, "base.txt"), "rb").read()
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 4
    open(os.path.join(d, "flipped.txt"), "wb").write(flipped)
    expect(9, ["gate", "--baseline=flipped.txt"], d, "checksum is wrong")
    open(os.path.join(d, "cut.txt"), "wb").write(whole[:-100])
    expect(9, ["gate", "--baseline=cut.txt"], d, "checksum is wrong")
    rewrite(d, "compiler.txt", lambda t: t.replace("\nbuild ", "\nbuild X", 1))
    compiler = ["gate", "--baseline=compiler.txt"]
    expect(0, compiler, d, "6 same")
    expect(5, compiler, d, "must reproduce them", plant="ulp in a constant")
    rewrite(d, "other.txt", lambda t: t.replace("\nbits ", "\nbits X", 1))
    other = ["gate", "--baseline=other.txt"]
    expect(0, other, d, "from other libraries or flags")
    expect(0, other, d, "3 within", plant="ulp in a constant")
    expect(5, other, d, "not finite 0 -> 1", plant="NaN in a loss")
    rewrite(d, "empty.txt",
            lambda t: t.split("stages ")[0] + "stages 0\n")
    expect(2, ["gate", "--baseline=empty.txt"], d, "it has no stages")


def bad_input(d):
    expect(2, ["gate"], d, "--baseline=FILE")
    expect(2, ["gate", "--baseline=nowhere"], d, "no baseline 'nowhere'")
    expect(2, ["gate", "--baseline=r/results.json"], d, "is not a baseline")
    expect(2, [*GATE, "--profile=quick"], d, "has the profile smoke")
    expect(2, [*GATE, "--results=nowhere"], d, "no results")
    expect(2, [*GATE, "--against=nowhere"], d, "is not a program")
    expect(2, [*GATE, "--against=" + BENCH, "--head=nowhere"], d,
           "--head=nowhere is not a program")
    expect(2, [*GATE, "--budget=-1"], d)
    expect(2, ["gate", "--update", "--against=" + BENCH], d, "--baseline")
    expect(2, [*GATE, "--filter=(x"], d, "regular expression")
    expect(2, [*GATE, "--no-such"], d, "unknown flag")
    expect(2, ["baseline"], d)
    expect(9, ["baseline", "r", "--out=/proc/nowhere/b.txt"], d)
    expect(3, ["baseline", "r", "--out=x.txt", "--count=no_such"], d)


def update(d):
    shutil.copy(os.path.join(d, "base.txt"), os.path.join(d, "new.txt"))
    new = ["gate", "--baseline=new.txt"]
    expect(0, [*new, "--filter=descend", "--update"], d, "-> 44",
           plant="more work")
    expect(0, [*new, "--filter=descend"], d, "1 same", plant="more work")
    expect(0, [*new, "--filter=descend"], d, "vjp 44 -> 40")
    expect(0, [*new, "--update"], d, "renewed new.txt: 6 stages")

    def lines(name):
        return [w for w in open(os.path.join(d, name)).read().split("\n")
                if w.startswith("fake/")]
    check([w.split(" ms=")[0] for w in lines("new.txt")] ==
          [w.split(" ms=")[0] for w in lines("base.txt")],
          "an update back gives the same lines")


def of_another_processor(d):
    """Stages are held to the bits; counts stay as they were recorded."""
    text = open(os.path.join(d, "base.txt")).read()
    name = re.search(r"^(fake/\S*descend\S*)/\w+ ", text, re.M).group(1)
    counted = f"instructions 1 callgrind s390x\n{name} 7\n"
    rewrite(d, "counted.txt",
            lambda t: t.replace("\nbuild ", "\nbuild GNU 1 ") + counted)
    gate = ["gate", "--baseline=counted.txt"]
    says = "instruction counts were recorded on s390x and are not compared on"
    p = expect(0, [*gate, "--json=other.json"], d, says)
    check("accuracy: 6 same" in p.stdout, "bits are held")
    check(p.stdout.count("recorded on s390x") == 1, "in one line")
    found = json.load(open(os.path.join(d, "other.json")))["findings"]
    check([(f["verdict"], f["numbers"]["recorded_by"]) for f in found
           if f["check"] == "instructions"] ==
          [("not compared", "callgrind s390x")], "JSON says it")
    expect(5, gate, d, says, plant="ulp in a constant")
    expect(8, [*gate, "--strict"], d, says)
    expect(0, [*gate, "--update"], d,
           "6 stages; the instruction counts of callgrind s390x are unchanged")
    text = open(os.path.join(d, "counted.txt")).read()
    check(counted in text and "\nbuild GNU 1 " in text,
          "with the build that they are of")


def clock_of_two_processors(d):
    other = os.path.join(d, "of_s390x")
    with open(other, "w") as f:
        f.write(f"""#!/bin/bash
[[ $1 == --version ]] || exec {BENCH} "$@"
echo physinv-bench 1; echo "instruction set  s390x"
""")
    os.chmod(other, 0o755)
    expect(2, ["gate", "--profile=kernel", "--against=" + other], d,
           "times of different processors are not compared")


def instructions(d):
    kernel = ["gate", "--baseline=kernel.txt"]
    expect(0, ["--profile=kernel", "--trace", "--out=k"], d)
    if not CAN_COUNT:
        print("skip instructions: no valgrind, or no program for it")
        return
    expect(0, ["baseline", "k", "--out=kernel.txt", "--count=descend"], d)
    expect(0, kernel, d, "instructions: 1 equal")
    p = expect(6, kernel, d, "slower", plant="a kernel slower by 10 %")
    print("\n".join(w for w in p.stdout.splitlines() if "slower" in w))
    rewrite(d, "other_kernel.txt", lambda t: t.replace("build ", "build X", 1),
            "kernel.txt")
    expect(0, ["gate", "--baseline=other_kernel.txt"], d, "another build")
    expect(0, [*kernel, "--no-count"], d, plant="a kernel slower by 10 %")
    for strict, code in ((["--strict"], 8), ([], 0)):
        expect(code, [*kernel, *strict], d, "not counted",
               PHYSINV_COUNT="nowhere")


def hostile_baselines(d):
    """Sealed, and yet of what no baseline holds."""
    def with_digits(digits):
        return lambda body: re.sub(r"digits=-?\d+", f"digits={digits}", body,
                                   count=1)
    for digits in (2147483647, -2147483648, 13, -1):
        rewrite(d, "digits.txt", with_digits(digits))
        expect(2, ["gate", "--baseline=digits.txt"], d,
               f"digits={digits} is neither from 0 to 12 nor none")
    for field in ("trajectory", "results", "stop", "status", "loss", "digits",
                  "ms"):
        rewrite(d, "lacks.txt",
                lambda t: re.sub(rf" {field}=\S*", "", t, count=1))
        expect(2, ["gate", "--baseline=lacks.txt"], d, f"has no {field}")
        rewrite(d, "twice.txt", lambda t: re.sub(
            rf" ({field}=\S*)", r" \1 \1", t, count=1))
        expect(2, ["gate", "--baseline=twice.txt"], d, f"{field} twice")
    for field in ("profile", "bits", "build", "numerics", "machine", "date"):
        rewrite(d, "lacks.txt",
                lambda t: re.sub(rf"\n{field} .*", "", t, count=1))
        expect(2, ["gate", "--baseline=lacks.txt"], d, f"it has no {field}")
    stage = re.search("fake/.*\n", open(os.path.join(d, "base.txt")).read())
    rewrite(d, "twice.txt", lambda t: t.replace(
        stage[0], stage[0] * 2).replace("stages 6", "stages 7"))
    expect(2, ["gate", "--baseline=twice.txt"], d, "appears twice")
    for pattern, says in (("(" * 10000 + ")" * 10000, "of 20000 characters"),
                          ("(x", "filter='(x' is not a regular expression"),
                          ("(.*)*(.*)*(.*)*QQ", "")):
        rewrite(d, "filter.txt", lambda body: body.replace(
            "\nbuild ", f"\nfilter {pattern}\nbuild ", 1))
        p = run("gate", "--baseline=filter.txt", cwd=d)
        check(p.returncode in ((2,) if says else (0, 3, 5)) and says in p.stderr
              and len(p.stderr.splitlines()) <= 1,
              f"filter {pattern[:9]} -> {p.returncode} {p.stderr[:200]}")
    p = expect(2, ["baseline", "r", "--out=c.txt", "--count=(x"], d,
               "--count='(x' is not a regular expression")
    check(not p.stdout, "before anything is run")
    os.mkfifo(os.path.join(d, "fifo"))
    expect(9, GATE, d, "cannot write",
           GITHUB_STEP_SUMMARY=os.path.join(d, "fifo"))


def clock(d):
    """Against itself nothing is slower; without time nothing is decided."""
    gate = ["gate", "--profile=kernel", "--against=" + BENCH]
    expect(8, [*gate, "--budget=0.000001", "--strict"], d, "inconclusive")
    expect(0, [*gate, "--budget=0.000001"], d,
           "warning: the timing comparison decided 0 of 1 cases")
    expect(0, [*gate, "--budget=2", "--within=30"], d, "timed against")
    p = expect(0, [gate[0], "--profile=smoke", "--filter=diverge|descend",
                   "--against=" + BENCH, "--budget=0.2"], d, "1 not timed")
    check("failed, was skipped or diverged" in p.stdout, "who diverges")
    expect(9, [gate[0], "--profile=smoke", "--against=/bin/false"], d,
           "/bin/false exited with 1")
    endless = os.path.join(d, "endless")
    with open(endless, "w") as f:
        f.write("#!/bin/sh\nexec yes\n")
    os.chmod(endless, 0o755)
    for flag in ("--against=", "--head="):
        other = [] if flag == "--against=" else ["--against=" + BENCH]
        for program, says in (("/bin/true", "/bin/true does not print a list"),
                              (endless, "was killed: more than"),
                              ("/bin/sleep", "exited with 1")):
            expect(9, [*gate[:2], *other, flag + program], d, says)
    other = os.path.join(d, "other")
    with open(other, "w") as f:
        f.write(f"""#!/bin/bash
[[ $1 != list ]] || exec {BENCH} "$@"
for a; do [[ $a != --out=* ]] || out=${{a#--out=}}; done
mkdir -p "$out" && echo '{{"benchmarks": 5}}' >"$out/results.json"
""")
    os.chmod(other, 0o755)
    expect(9, [*gate[:2], "--against=" + other], d, "is damaged")


with tempfile.TemporaryDirectory() as directory:
    for test in (made, passes, defects, other_baselines, bad_input, update,
                 of_another_processor, instructions, hostile_baselines, clock,
                 clock_of_two_processors):
        test(directory)
sys.exit(f"{len(FAILED)} failed: {FAILED}" if FAILED else 0)
