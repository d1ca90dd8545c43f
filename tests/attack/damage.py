"""Changes of bytes and of JSON."""

import copy

HUGE = 2**64 - 1
DEEP = 200_000


def flip(rng, data):
    at = rng.randrange(len(data))
    return (data[:at] + bytes([data[at] ^ 1 << rng.randrange(8)]) +
            data[at + 1:]), f"bit of byte {at}"


def cut(rng, data):
    at = rng.randrange(len(data))
    return data[:at], f"cut at byte {at} of {len(data)}"


def lose(rng, data):
    at, size = rng.randrange(len(data)), rng.randrange(1, 600)
    return data[:at] + data[at + size:], f"{size} bytes from {at} on gone"


def zero(rng, data):
    """What a crash of the machine leaves of a page not yet written."""
    at = rng.randrange(len(data)) & ~511
    size = min(512, len(data) - at)
    return (data[:at] + bytes(size) + data[at + size:],
            f"{size} zeros from {at} on")


def repeat(rng, data):
    at, size = rng.randrange(len(data)), rng.randrange(1, 600)
    piece = data[at:at + size]
    return data[:at] + piece + data[at:], f"{len(piece)} bytes of {at} twice"


def grow(rng, data):
    tail = rng.randbytes(rng.randrange(1, 64))
    return data + tail, f"{len(tail)} bytes more"


def word(rng, data):
    """Eight bytes become another number, such as a length."""
    at = rng.randrange(max(1, len(data) - 8))
    value = rng.choice([0, 1, 2**31, 2**40, 2**62, 2**63, HUGE,
                        rng.randrange(2**64)])
    return (data[:at] + value.to_bytes(8, "little") + data[at + 8:],
            f"word {value} at byte {at}")


BYTES = (flip, flip, flip, cut, cut, lose, zero, repeat, grow)


def damage(rng, data):
    """Other bytes than these, and in words what was done."""
    while True:
        changed, words = rng.choice(BYTES)(rng, data)
        if changed != data:
            return changed, words


def places(value, path=()):
    """Every node below the root as a path."""
    if isinstance(value, dict):
        items = list(value.items())
    elif isinstance(value, list):
        items = list(enumerate(value))
    else:
        items = []
    for key, inner in items:
        yield (*path, key)
        yield from places(inner, (*path, key))


def at(value, path):
    for key in path:
        value = value[key]
    return value


def family(value):
    """The type that a reader expects; null may stand for a number."""
    if isinstance(value, bool):
        return "bool"
    if value is None or isinstance(value, int):
        return "int"
    if isinstance(value, dict):
        return "object"
    if isinstance(value, list):
        return "list"
    # A number with a fraction is a str of its own type.
    return "text" if type(value) is str else "number"


VALUES = [None, True, -1, 0, 7, 2**31, 2**63, HUGE, 10**30, "", "x", "..",
          "../../../outside/data.h5", "/", "a\nb", "a\0b", "\ud800",
          "x" * 70000, "<script>alert(1)</script>", "|", "\x1b[31m", [], {},
          [[]], [None], {"a": 1}, ["x"], [1, 2], {"": {}}]


def deepened(rng, text):
    """The text of a JSON object with a member of very many levels."""
    left, right = rng.choice(("[]", ('{"a":', "}")))
    return '{"deep":' + left * DEEP + "1" + right * DEEP + "," + text[1:]


def change(rng, value):
    """One node with another value, removed, doubled or deep. Returns the new
    value or text, the path, and the families of before and after."""
    everywhere = list(places(value))
    path = rng.choice(everywhere)
    value = copy.deepcopy(value)
    parent, key = at(value, path[:-1]), path[-1]
    before = family(parent[key])
    how = rng.random()
    if how < 0.1:
        del parent[key]
        return value, path, before, "gone"
    if how < 0.15 and isinstance(parent, list):
        parent.extend([copy.deepcopy(parent[key])] * rng.choice([1, 1000]))
        return value, path, before, "doubled"
    if how < 0.2 and isinstance(parent, dict):
        parent[rng.choice(["", "x", "..", "\n", "seed"])] = parent[key]
        return value, path, before, "one more"
    parent[key] = copy.deepcopy(rng.choice(VALUES))
    return value, path, before, family(parent[key])
