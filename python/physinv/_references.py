"""What a function's code refers to by name."""

import dis
import types

_GLOBAL = ("LOAD_GLOBAL", "LOAD_NAME", "LOAD_FROM_DICT_OR_GLOBALS")
_FREE = ("LOAD_DEREF", "LOAD_CLASSDEREF", "LOAD_FROM_DICT_OR_DEREF")
_ATTRIBUTE = ("LOAD_ATTR", "LOAD_METHOD")
_BETWEEN = ("EXTENDED_ARG", "CACHE")


def codes(code):
    """A function's code and that of all functions and classes in it."""
    yield code
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from codes(constant)


def _attributes(instructions, at):
    names = []
    for instruction in instructions[at:]:
        if instruction.opname not in _ATTRIBUTE:
            break
        names.append(instruction.argval)
    return tuple(names)


def names(code):
    """Of every name that is global (True) or of an enclosing function (False),
    the attributes that the code asks it for: {(True, "np"): {("linalg",
    "solve")}}. () stands for a use of the value itself."""
    found = {}
    for one in codes(code):
        instructions = [i for i in dis.get_instructions(one)
                        if i.opname not in _BETWEEN]
        for at, i in enumerate(instructions):
            after = instructions[min(at + 1, len(instructions) - 1)]
            if (after.opname, after.argval) == ("STORE_NAME", "__module__"):
                continue  # the name of its module, in the body of a class
            if i.opname in _GLOBAL or i.opname in _FREE:
                key = i.opname in _GLOBAL, i.argval
                found.setdefault(key, set()).add(
                    _attributes(instructions, at + 1))
    return found


def attributes(code):
    """All attributes that the code asks any object for."""
    return {i.argval for one in codes(code) for i in dis.get_instructions(one)
            if i.opname in _ATTRIBUTE}


def imports(code):
    """Of every import statement: (module, level, names or None)."""
    found = set()
    for one in codes(code):
        instructions = [i for i in dis.get_instructions(one)
                        if i.opname not in _BETWEEN]
        for at, i in enumerate(instructions):
            if i.opname == "IMPORT_NAME":
                level, names = (j.argval for j in instructions[at - 2:at])
                found.add((i.argval, level, names))
    return sorted(found, key=repr)
