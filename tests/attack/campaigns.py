"""Files of --config in any form that TOML and JSON have, and damaged ones: they
choose what the same flags on the command line choose, by Python's parsers."""

import json
import os

import damage
import sandbox
import stores

try:
    import tomllib
except ImportError:  # before Python 3.11
    tomllib = None

CASES = ["--benchmark_list_tests"]
# Texts that one parser or another would cut, unescape or expand.
FILTERS = ["billiards", "^jpo/billiards/", "^jpo/.*/n=\\d+/", "bfgs#c",
           "-\"bfgs\"", "-'bfgs'", "[a-z]+/bfgs", "-jpo", "bfgs,adam", "a\\.b",
           "\\bbfgs\\b", "-=", "-bfgs # not a comment", "%s", "${HOME}", "é|bfgs",
           "bfgs\n", "\tbfgs", "-[bfgs]", "true", "007", "1e3"]
FOLDERS = ["run#1", "a\\tb", "a b", "[x]", "'q'", '"q"', "été", "a=b", "a,b"]
STRANGE = ["profil", "Profile", "run", "help", "config", "a.b", "", "--profile",
           "out ", "filter[]", "FILTER", "list-flags", "é", "x" * 300]
ESCAPES = {"\\": "\\\\", "\"": "\\\"", "\n": "\\n", "\t": "\\t"}


def basic(rng, text):
    """Between quotes, now and then by numbers."""
    out = ""
    for c in text:
        if rng.random() < 0.1:
            out += f"\\u{ord(c):04x}" if rng.random() < 0.5 else (
                f"\\U{ord(c):08X}")
        else:
            out += ESCAPES.get(c, c)
    return f'"{out}"'


def quoted(rng, text):
    """In one of the four forms that TOML has."""
    form = rng.randrange(5)
    if form == 0 and "'" not in text and "\n" not in text:
        return f"'{text}'"
    if form == 1 and "'''" not in text and not text.endswith("'"):
        return f"'''\n{text}'''"
    if form == 2:
        return '""' + basic(rng, text) + '""'
    if form == 3:  # folded over lines
        inner = basic(rng, text)[1:-1]
        return f'"""\\\n   {inner}\\\n  """' if text.strip() == text else (
            f'"{inner}"')
    return basic(rng, text)


def number(rng, value):
    return rng.choice([str(value), f"+{value}", hex(value), f"0o{value:o}",
                       f"0b{value:b}"])


def listed(rng, words):
    gap = rng.choice([" ", "\n", "\n  # a # comment ]\n", "\r\n\t"])
    return (f"[{gap}" + f",{gap}".join(words) +
            rng.choice(["", ",", f",{gap}"]) + f"{gap}]")


def value_of(rng, key):
    if key == "filter":
        texts = [quoted(rng, rng.choice(FILTERS))
                 for _ in range(rng.randrange(1, 4))]
        return texts[0] if rng.random() < 0.3 else listed(rng, texts)
    if key == "seeds":
        return rng.choice([quoted(rng, "0-1"), quoted(rng, "0,2"), "0",
                           listed(rng, [number(rng, n) for n in (0, 1)])])
    if key == "jobs":
        return rng.choice([number(rng, 2), "1.5", "-1", "inf", "nan", "0",
                           "1_0", quoted(rng, "2"), "true"])
    if key in ("trace", "resume"):
        return rng.choice(["true", "false", "1", "7", quoted(rng, "yes"),
                           quoted(rng, "maybe"), "[true, false]"])
    if key == "profile":
        return quoted(rng, rng.choice(["smoke", "quick", "paper", "smokey"]))
    if key == "set":
        return listed(rng, [quoted(rng, rng.choice(["n=8", "seeds=0", "n"]))])
    return rng.choice([quoted(rng, "x"), "1979-05-27", "{a = 1}", "[[1]]", "[]",
                       '""', "1e400", '"\\u0000"', "99999999999999999999"])


def document(rng):
    lines = []
    keys = rng.sample(["filter", "seeds", "jobs", "trace", "resume", "profile",
                       "set"], rng.randrange(1, 6))
    if rng.random() < 0.2:
        keys.append(rng.choice(STRANGE))
    for key in keys:
        name = key if key.isalnum() and key.isascii() else quoted_key(rng, key)
        lines.append(f"{name}{rng.choice(['=', ' = '])}{value_of(rng, key)}" +
                     rng.choice(["", " # a comment = \"x\"", "  "]))
    if rng.random() < 0.1:
        lines.insert(rng.randrange(len(lines) + 1),
                     rng.choice(["[run]", "[[run]]", "a.b = 1", "= 1", "x"]))
    return rng.choice(["\n", "\r\n"]).join(lines) + rng.choice(["", "\n"])


def quoted_key(rng, key):
    return basic(rng, key)


def as_typed(all_flags):
    """The same flags as words; None where a file cannot say it."""
    words = []
    for key, value in all_flags.items():
        values = value if isinstance(value, list) else [value]
        texts = []
        for v in values:
            if not isinstance(v, (str, int, float, bool)):
                return None
            texts.append(str(v).lower() if isinstance(v, bool) else str(v))
        if not texts or "" in texts or any("\0" in t for t in texts):
            return None
        if key == "seeds":
            texts = [",".join(texts)]
        elif key != "filter" and key != "set" and len(texts) > 1:
            return None
        words += [f"--{key}={t}" for t in texts]
    return None if any(key in STRANGE for key in all_flags) else words


def once(pairs):
    """An object without repeated names."""
    if len(dict(pairs)) < len(pairs):
        raise ValueError("a name stands twice")
    return dict(pairs)


def parsed(name, data):
    """By Python's parser; None if it is not a document."""
    try:
        text = data.decode("utf-8").removeprefix("\ufeff")
        if name.endswith(".json"):
            return json.loads(text, object_pairs_hook=once)
        return tomllib.loads(text)
    except (ValueError, RecursionError):
        return None


def chosen(attempt, name, data):
    """The file chooses what its flags choose, or ends with 2."""
    flags = parsed(name, data)
    words = as_typed(flags) if isinstance(flags, dict) else None
    ended = attempt.run("run", f"--config={name}", *CASES)
    if words is None:
        attempt.expect(ended.code == 2 and len(ended.err.splitlines()) == 1,
                       f"what is no file of flags ends {ended.code}")
        return
    typed = attempt.run("run", *words, *CASES)
    attempt.expect((ended.code, ended.out) == (typed.code, typed.out),
                   f"{ended.code} by the file, {typed.code} by {words}")


def results_go_where_it_says(attempt):
    folder = attempt.rng.choice(FOLDERS)
    profile, cases = (word.split("=", 1)[1] for word in stores.SMALL[:2])
    text = (f"profile = '{profile}'\nout = {quoted(attempt.rng, folder)}\n"
            f"filter = [ # a few cases\n  '{cases}', ]\n")
    sandbox.write(attempt.path("c.toml"), text)
    attempt.note(text)
    ended = attempt.run("run", "--config=c.toml", limit=20)
    attempt.expect(ended.code == 0, f"exit {ended.code}")
    there = sorted(os.listdir(attempt.folder))
    attempt.expect(there == sorted(["c.toml", folder]),
                   f"results are in {there}, not in {folder!r}")


def odd_toml(attempt):
    if tomllib is None:
        attempt.skipped = "Python has no tomllib before 3.11"
        return None
    attempt.hits, rng = 1, attempt.rng
    if attempt.seed % 12 == 11:
        return results_go_where_it_says(attempt)
    name, data = "c.toml", document(rng).encode()
    if attempt.seed % 4 == 3:
        name = "c.json"
        flags = parsed("c.toml", data)
        data = json.dumps(flags, default=str, indent=1).encode()
    if rng.random() < 0.3:
        data = b"\xef\xbb\xbf" + data
    if rng.random() < 0.3:
        data, words = damage.damage(rng, data)
        attempt.note(words)
    sandbox.write(attempt.path(name), data)
    attempt.note(repr(data)[:500])
    return chosen(attempt, name, data)
