"""readers_test.py CASE.h5 METHOD: a case's file in other readers.

netCDF's ncdump lists the statuses with their words, Octave's load keeps them
without a warning, and, with PHYSINV_FULL and npm, jsfive and h5wasm read texts
without a zero at their ends. A reader that is missing is named.
"""

import os
import shutil
import subprocess
import sys
import tempfile

PATH, METHOD = os.path.abspath(sys.argv[1]), sys.argv[2]
WORDS = "gtol maxiter linesearch nonfinite ftol"
JAVASCRIPT = """
import fs from 'fs';
import {File} from 'jsfive';
import h5wasm from 'h5wasm/node';
const [path, method, words] = process.argv.slice(2);
const bytes = fs.readFileSync(path);
const five = new File(bytes.buffer.slice(bytes.byteOffset,
                                         bytes.byteOffset + bytes.length));
await h5wasm.ready;
const wasm = new h5wasm.File(path, 'r');
const stage = 'stages/' + five.get('stages').keys[0] + '/';
const status = [five.get(stage + 'status'), wasm.get(stage + 'status')];
const same = [five.attrs.method === method, wasm.attrs.method.value === method,
              status[0].attrs.flag_meanings === words,
              status[1].attrs.flag_meanings.value === words,
              String(status[0].value) === String(status[1].value),
              String(five.get(stage + 'loss').value) ===
                  String(wasm.get(stage + 'loss').value)];
console.log(same.join(' '));
process.exit(same.every(x => x) ? 0 : 1);
"""


def run(*command, **kwargs):
    return subprocess.run(command, capture_output=True, text=True, **kwargs)


def ncdump():
    p = run("ncdump", "-h", PATH)
    groups = p.stdout.count("group: \\0_") + p.stdout.count("group: \\1_")
    good = (p.returncode == 0 and not p.stderr and groups > 0 and
            p.stdout.count("int status(") == groups and
            p.stdout.count(f'status:flag_meanings = "{WORDS}"') == groups and
            p.stdout.count("status:flag_values = 0, 1, 2, 3, 4") == groups and
            f':method = "{METHOD}"' in p.stdout)
    return good, p.stdout + p.stderr


def octave():
    p = run("octave-cli", "--norc", "--eval",
            f"s = load('{PATH}'); g = fieldnames(s.stages); "
            "printf('statuses %d\\n', numel(s.stages.(g{1}).status));")
    return "statuses" in p.stdout and "warning" not in p.stderr, \
        p.stdout + p.stderr


def node():
    with tempfile.TemporaryDirectory() as d:
        if run("npm", "install", "--no-audit", "--no-fund", "jsfive@0.4",
               "h5wasm@0.10", cwd=d).returncode != 0:
            return True, "npm has no packages"
        script = os.path.join(d, "read.mjs")
        with open(script, "w") as f:
            f.write(JAVASCRIPT)
        p = run("node", script, PATH, METHOD, WORDS)
        return p.returncode == 0, p.stdout + p.stderr


def main():
    readers = [("ncdump", ncdump, "netcdf-bin"),
               ("octave-cli", octave, "octave")]
    if os.environ.get("PHYSINV_FULL"):
        readers.append(("npm", node, "npm"))
    asked, failed = [], False
    for name, read, package in readers:
        if not shutil.which(name):
            print(f"{name} is missing ({package})")
            continue
        asked.append(name)
        good, said = read()
        if not good:
            failed = True
            print(f"{name} reads it otherwise:\n{said[:600]}")
    print("read by", ", ".join(asked) or "none")
    sys.exit(1 if failed else 0 if asked else 77)


main()
