"""How files are sealed, so that a change can be put behind the seal.

  lines     8 hexadecimal digits, a space, JSON: the journal
  head      8 hexadecimal digits before the rest: checkpoints
  trailer   physinv: and 8 digits behind the rest: arrays of cases
  last      a last line `checksum` and 8 digits: baselines
  json      a member `checksum` of a JSON object: the plan and its like

A file is taken apart into parts, which are text of JSON or bytes, and is put
together again; without a change the same bytes come out.
"""

import json
import re


def _table():
    table = []
    for byte in range(256):
        for _ in range(8):
            byte = byte >> 1 ^ (0x82f63b78 if byte & 1 else 0)
        table.append(byte)
    return table


_TABLE = _table()


def crc32c(data):
    crc = 0xffffffff
    for byte in data:
        crc = crc >> 8 ^ _TABLE[(crc ^ byte) & 0xff]
    return crc ^ 0xffffffff


def digits(data):
    return b"%08x" % crc32c(data)


class Number(str):
    """A number as it is written, whose digits shall stay."""


def load(text):
    return json.loads(text, parse_float=Number)


def dump(value, indent=None, depth=0):
    """Compact (as the checksums take it) or indented; keys are sorted."""
    if isinstance(value, Number):
        return str(value)
    if not isinstance(value, (dict, list)) or not value:
        return json.dumps(value, ensure_ascii=False)
    line = "" if indent is None else "\n" + " " * indent * (depth + 1)
    colon = ":" if indent is None else ": "
    if isinstance(value, dict):
        inner = [json.dumps(k, ensure_ascii=False) + colon +
                 dump(value[k], indent, depth + 1) for k in sorted(value)]
    else:
        inner = [dump(v, indent, depth + 1) for v in value]
    left, right = "{}" if isinstance(value, dict) else "[]"
    end = "" if indent is None else "\n" + " " * indent * depth
    return left + line + ("," + line).join(inner) + end + right


def _encoded(value, indent=None):
    # Half a surrogate pair is not UTF-8; the program puts a mark in its place.
    return dump(value, indent).encode(errors="replace")


class Lines:
    def parts(self, data):
        return [load(line[9:]) for line in data.splitlines()]

    def join(self, parts):
        texts = [p if isinstance(p, bytes) else _encoded(p) for p in parts]
        return b"".join(digits(t) + b" " + t + b"\n" for t in texts)


class Head:
    def parts(self, data):
        head, rest = data[9:].split(b"\n", 1)
        return [load(head), rest]

    def join(self, parts):
        head = parts[0] if isinstance(parts[0], bytes) else _encoded(parts[0])
        text = b" " + head + b"\n" + parts[1]
        return digits(text) + text


class Trailer:
    def parts(self, data):
        return [data[:-16]]

    def join(self, parts):
        return parts[0] + b"physinv:" + digits(parts[0])


class Last:
    def parts(self, data):
        return [data[:data.rindex(b"checksum ")]]

    def join(self, parts):
        return parts[0] + b"checksum " + digits(parts[0]) + b"\n"


class Json:
    """Sealed if it has a member `checksum`, else open."""

    def parts(self, data):
        return [load(data)]

    def join(self, parts):
        value = parts[0]
        if isinstance(value, bytes):
            return value
        if isinstance(value, dict) and "checksum" in value:
            rest = {k: v for k, v in value.items() if k != "checksum"}
            value["checksum"] = digits(_encoded(rest)).decode()
        return _encoded(value, 1) + b"\n"


SEALS = {"journal": Lines(), "checkpoint": Head(), "case": Trailer(),
         "baseline": Last()}


def seal_of(kind):
    return SEALS.get(kind) or Json()


def is_whole(kind, data):
    """The parts put together again are the file, spaces of JSON apart."""
    seal = seal_of(kind)
    again = seal.join(seal.parts(data))
    if isinstance(seal, Json):
        return load(again) == load(data)
    return re.sub(rb"\s", b"", again) == re.sub(rb"\s", b"", data)
