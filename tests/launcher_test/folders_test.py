"""What ./bench builds for a filter: the program over one folder of experiments
where it can choose no others, else all; and what such a program is made of: all
sources that its own include, and none of other problems. The list of folders
names every function that registers.

    folders_test.py PROGRAM SOURCES BUILD"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

PROGRAM, SOURCES, BUILD = (pathlib.Path(p).resolve() for p in sys.argv[1:4])
WRONG = []

ONE = {  # arguments -> folder
    "--filter=billiards": "jpo/billiards",
    "run --filter=billiards --no-report --fresh -j2": "jpo/billiards",
    "--filter=jpo/billiards --profile=paper": "jpo/billiards",
    "--filter=^jpo/billiards/": "jpo/billiards",
    "--filter=jpo/billiards/(jpo|bfgs)/ --seeds=0-3": "jpo/billiards",
    "--filter=oscillators": "hig/oscillators",
    "--filter=hig/oscillators/": "hig/oscillators",
    "--filter=sip/sine": "sip/sine",
    "--filter=matrix/heat": "matrix/cells",
}
ALL = """

list --filter=billiards
report results/quick
run billiards
--filter=
--filter=nonsense
--filter=wave-packet
--filter=hig/oscillators
--filter=studies/billiards
--filter=jpo
--filter=jpo/
--filter=sine
--filter=b.lliards
--filter=-billiards
--filter=jpo/billiards|heat
--filter=jpo/billiards/jpo|heat
--filter=(jpo/billiards)|heat
--filter=jpo/billiards/(jpo|heat
--filter=jpo/billiards/?
--filter=billiards --filter=heat
--filter=billiards --all
--filter=billiards --profile=study
--filter=billiards --plugin=a.so
--filter=billiards --config=a.toml
--filter=billiards --out=""".split("\n")


def check(good, *what):
    if not good:
        WRONG.append(what)


def folders_of(lines, folder, **environment):
    """Folder and filter that ./bench takes for these arguments, each."""
    script = ('root=$1; source "$root/cmake/folder_of.sh"; set -euo pipefail; '
              'while read -ra words; do find_folder "${words[@]}"; '
              'echo "$folder $filter"; done')
    done = subprocess.run(["bash", "-c", script, "-", SOURCES], text=True,
                          input="\n".join(lines) + "\n", cwd=folder, check=True,
                          capture_output=True, env={**os.environ, **environment})
    return [line.split(" ", 1) for line in done.stdout.split("\n")[:-1]]


def names(*arguments):
    done = subprocess.run([PROGRAM, "list", "--format=json", *arguments],
                          capture_output=True, text=True)
    return {c["name"]: c["experiment"] for c in json.loads(done.stdout or "[]")}


def listed():
    """Layers and names of experiments by folder."""
    text = (SOURCES / "suite/cases/common/experiments.def").read_text()
    rows = re.findall(r'^FOLDER\("(.*?)", "(.*?)", "(.*?)"', text, re.M)
    return {path: (layers.split(), names.split())
            for path, layers, names in reversed(rows)}  # the first line counts


def functions_listed():
    """What a folder's sources define is what its lines name."""
    text = (SOURCES / "suite/cases/common/experiments.def").read_text()
    named, defined = set(), set()
    for path, space, functions in re.findall(
            r'^FOLDER\("(.*?)", ".*?", ".*?", ([\w:]+), (.*)\)$', text, re.M):
        named |= {(path, space, f) for f in functions.split(", ")}
    for source in (SOURCES / "suite/cases").glob("*/*/*.cpp"):
        path = str(source.parent.relative_to(SOURCES / "suite/cases"))
        if path.endswith("/common"):
            continue
        for space, function in re.findall(
                r"^namespace physinv::([\w:]+) \{|^void (add_\w+)\(Registry&",
                source.read_text(), re.M):
            inside = space or inside
            if function:
                defined.add((path, inside, function))
    check(len(defined) > 80, "functions that register:", len(defined))
    check(named == defined, "listed or defined alone:", sorted(named ^ defined))


def words_of(cases):
    """What may be typed: names of experiments, and parts of those of cases."""
    return {part for name in cases for part in name.split("/")
            if "=" not in part} | set(cases.values())


def chosen_alone(profile, texts, folder):
    """No other program would choose more."""
    cases = names(f"--profile={profile}")
    texts = sorted(texts)
    lines = [f"--filter={text} --profile={profile}" for text in texts]
    found = []
    for text, (one, expression) in zip(texts, folders_of(lines, folder)):
        if not one:
            continue
        found.append(text)
        own = {n for n, e in cases.items() if re.search(expression, n)}
        check(own or profile != "paper", text, "chooses nothing")
        prefixes = listed()[one][1]
        for name in own:
            check(any(cases[name] == p or p[-1] == "*" and
                      cases[name].startswith(p[:-1]) for p in prefixes),
                  text, profile, "chooses", name, "which is not in", one)
        if "/" not in text:  # a word
            check(own == set(names(f"--profile={profile}", f"--filter={text}")),
                  text, profile, "means other cases than", expression)
    return found


def results_count(folder):
    cases = pathlib.Path(folder) / "results/quick/cases"
    cases.mkdir(parents=True)
    (cases / "jpo+billiards+bfgs+n=8+seed=0.h5").touch()
    check(folders_of(["--filter=billiards"], folder)[0][0] == "jpo/billiards",
          "results of billiards")
    (cases / "sip+heat+sip+n=8+seed=0.h5").touch()
    check(folders_of(["--filter=billiards"], folder)[0][0] == "",
          "other results")
    check(folders_of(["--filter=billiards --out=new"], folder)[0][0] ==
          "jpo/billiards", "elsewhere")


def included(path, known):
    """Sources that a source reaches; a header stands for that of its name."""
    found, left = set(), [path]
    while left:
        one = left.pop()
        if one in found or not (SOURCES / one).exists():
            continue
        found.add(one)
        if one not in known:
            known[one] = re.findall(r'^\s*#\s*include "([^"]+)"',
                                    (SOURCES / one).read_text(), re.M)
        for header in known[one]:
            left += [header, re.sub(r"\.h$", ".cpp", header)]
    return {s for s in found if s.endswith(".cpp")}


def compiled():
    """Sources of each object of the build, joined ones too."""
    sources = {}
    for command in json.loads((BUILD / "compile_commands.json").read_text()):
        path = pathlib.Path(command["file"])
        text = re.findall(r'#include "([^"]+)"', path.read_text()) if (
            path.suffix == ".cxx") else [str(path)]
        output = re.search(r" -o (\S+)", command["command"])[1]
        sources[output] = {os.path.relpath(s, SOURCES) for s in text}
    return sources


def sources_of(program, sources):
    inputs = subprocess.run(["ninja", "-C", BUILD, "-t", "inputs", program],
                            capture_output=True, text=True, check=True)
    return set().union(*(sources.get(i, set())
                         for i in inputs.stdout.split("\n")))


def made_of(sources):
    known = {}
    for folder in listed():
        has = sources_of("physinv-" + folder.replace("/", "-"), sources)
        wanted = set()
        for path in (SOURCES / "suite/cases" / folder).glob("*.cpp"):
            wanted |= included(str(path.relative_to(SOURCES)), known)
        for path in sorted(wanted - has):
            check(False, folder, "lacks the layer of", path)
        problems = {p.split("/")[1] for p in has - wanted
                    if p.startswith("problems/")} - {
                        p.split("/")[1] for p in wanted}
        check(not problems, folder, "has problems that it does not include",
              problems)
    half, whole = (len(sources_of(program, sources)) for program in
                   ("physinv-jpo-billiards", "physinv-bench"))
    check(half < 0.65 * whole, "jpo/billiards is made of", half, "of", whole)


with tempfile.TemporaryDirectory() as directory:
    for line, (folder, _) in zip(ONE, folders_of(ONE, directory)):
        check(folder == ONE[line], line, folder)
    for line, (folder, _) in zip(ALL, folders_of(ALL, directory)):
        check(folder == "", line, folder)
    check(folders_of(["--filter=billiards"], directory,
                     BENCHMARK_FILTER="heat")[0][0] == "", "BENCHMARK_FILTER")
    texts = chosen_alone("paper", words_of(names("--profile=paper")), directory)
    check(len(texts) > 40, texts, "choose one folder")
    for profile in ("smoke", "quick"):
        chosen_alone(profile, {t for t in texts if "/" not in t}, directory)
    results_count(directory)
functions_listed()
made_of(compiled())
sys.exit("\n".join(" ".join(map(str, w)) for w in WRONG) or 0)
