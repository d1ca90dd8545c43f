"""The hash of all that a function's numbers come from.

A function is its bytecode, constants, defaults and attributes, and the values
of all names that it refers to: globals, variables of enclosing functions,
attributes of modules. What of these is the user's own is followed in turn:
functions, classes with their bases, instances with their attributes, and of
modules the names that are used (all of them where a module itself is used as a
value). Of what is a library's, the name and the library's version count.

Values are written by type and content: numbers by repr, arrays and tensors by
dtype, shape, strides and bytes, sets in sorted order, objects of libraries by
what pickle would keep of them. What has no such text is refused."""

import hashlib
import sys
import types

import numpy as np

PLAIN = (bool, int, float, complex, str, bytes, type(None), type(Ellipsis),
         type(NotImplemented), range)


class Refused(ValueError):
    """Something that a function refers to cannot be followed."""


class Forbidden(Refused):
    """It is a function of a library, of which it is not known what it finds."""


def source_key(value, name):
    """Hash of a function, or of another value, and the libraries that it comes
    from: (32 hexadecimal digits, set of names). `name` begins the path that
    Refused states, such as "solve -> helper -> LOCK"."""
    walk = Walk()
    try:
        walk.visit(value, name)
    except Refused:
        raise
    except Exception as error:  # of code of the user's that the walk calls
        raise Refused(f"{' -> '.join(walk.path)} cannot be followed: "
                      f"{type(error).__name__}: {error}") from error
    return walk.digest(), walk.libraries


def digest_of(data):
    return hashlib.sha256(data).hexdigest()[:32]


class Walk:
    """Visits objects and writes words that distinguish them."""

    def __init__(self, numbers=None, path=()):
        self.words = []
        self.libraries = set()
        self.path = list(path)
        self.numbers = dict(numbers or {})
        self.kept = []  # so that no other object gets the same id

    def digest(self):
        text = "\n".join(self.words)
        return digest_of(text.encode("utf-8", "backslashreplace"))

    def say(self, *words):
        self.words.append(" ".join(words))

    def refuse(self, value, why, error=Refused):
        kind = type(value)
        name = kind.__qualname__ if kind.__module__ == "builtins" else (
            f"{kind.__module__}.{kind.__qualname__}")
        raise error(f"{' -> '.join(self.path)} ({name}) cannot be followed: "
                    f"{why}")

    def visit(self, value, name):
        self.path.append(name)
        try:
            self._put(value)
        except RecursionError:
            raise Refused(f"{' -> '.join(self.path[:3])} -> ... cannot be "
                          "followed: it is nested too deeply") from None
        self.path.pop()

    def attempt(self, value, name):
        """False, and nothing is said, where the value is refused."""
        before = len(self.words), dict(self.numbers), len(self.path)
        try:
            self.visit(value, name)
        except Forbidden:
            raise
        except Refused:
            del self.words[before[0]:], self.path[before[2]:]
            self.numbers = before[1]
            return False
        return True

    def _alone(self, value):
        """A digest that does not depend on what is visited before or after it
        in the same set."""
        walk = Walk(self.numbers, self.path)
        walk.visit(value, f"{value!r:.40}")
        self.kept.append(walk)
        self.libraries |= walk.libraries
        return walk.digest()

    def _again(self, value):
        """Objects have a number each, so that cycles end and it counts whether
        two names mean the same object."""
        number = self.numbers.get(id(value))
        if number is not None:
            self.say("again", str(number))
            return True
        self.numbers[id(value)] = len(self.numbers)
        self.kept.append(value)
        return False

    def _put(self, value):
        # By type(), as what replaces another object has its __class__.
        kind = type(value)
        if kind in PLAIN:
            self.say(kind.__name__, hex(value) if kind is int else repr(value))
        elif kind is tuple:
            self.items("tuple", value)
        elif kind is frozenset:
            self._set(value)
        elif kind is types.CodeType:
            _key_code.put_code(self, value)
        else:
            _key_code.forbid(self, value)
            if not self._again(value):
                self._put_object(value)

    def _put_object(self, value):
        kind = type(value)
        if kind is list:
            self.items("list", value)
        elif kind is set:
            self._set(value)
        elif kind in (dict, types.MappingProxyType):
            self._dict(value)
        elif kind is types.FunctionType:
            _key_code.put_function(self, value)
        elif issubclass(kind, types.ModuleType):
            _key_code.put_module(self, value)
        elif issubclass(kind, type):
            _key_objects.put_class(self, value)
        elif kind is np.ndarray:
            self._array(value)
        elif issubclass(kind, getattr(sys.modules.get("torch"), "Tensor", ())):
            self._tensor(value)
        else:
            _key_objects.put_object(self, value)

    def items(self, word, values):
        self.say(word, str(len(values)))
        for k, value in enumerate(values):
            self.visit(value, f"[{k}]")

    def members(self, values):
        """Named values, in their order."""
        self.say("members", str(len(values)))
        for name, value in list(values.items()):
            self.say("member", repr(name))
            self.visit(value, f".{name}")

    def _set(self, values):
        each = sorted(self._alone(value) for value in values)
        self.say(type(values).__name__, *each)

    def _dict(self, values):
        self.say("dict", str(len(values)))
        for key, value in list(values.items()):
            name = f"[{key!r:.40}]" if type(key) in PLAIN else "[key]"
            self.visit(key, name)
            self.visit(value, name)

    def _array(self, value):
        self.say("array", repr(np.lib.format.dtype_to_descr(value.dtype)),
                 repr(value.shape), repr(value.strides))
        if value.dtype.hasobject:
            self.items("objects", value.ravel().tolist())
        else:
            self.say(digest_of(value.tobytes()))

    def _tensor(self, value):
        self.libraries.add("torch")
        self.say("tensor", str(value.dtype), repr(tuple(value.shape)),
                 str(value.device), str(value.requires_grad))
        try:
            self.say(repr(value.stride()))
            there = value.detach().cpu()
            if str(there.dtype) == "torch.bfloat16":
                there = there.view(sys.modules["torch"].int16)
            self.say(digest_of(there.numpy().tobytes()))
        except (RuntimeError, TypeError) as error:
            self.refuse(value, f"it has no bytes ({error})")
        self.visit(value.grad if value.is_leaf else None, ".grad")
        self.visit(type(value), type(value).__name__)
        self.members(vars(value))


from physinv import _key_code, _key_objects  # noqa: E402  which take a Walk
