"""Words of classes and instances, for _key."""

import copyreg
import enum
import functools
import sys
import types

import numpy as np

from physinv import _core, _key_code, _libraries

_DESCRIPTORS = (types.GetSetDescriptorType, types.MemberDescriptorType,
                types.MethodDescriptorType, types.WrapperDescriptorType,
                types.ClassMethodDescriptorType)
_NOT_OF_CLASSES = {
    "__dict__", "__weakref__", "__module__", "__doc__", "__qualname__",
    "__annotations__", "__annotate__", "__annotate_func__",
    "__annotations_cache__", "__firstlineno__", "__static_attributes__",
    "_abc_impl"}
_DRAWING = (np.random.Generator, np.random.RandomState, np.random.BitGenerator)
_IN_C = ("ctypes", "_ctypes", "_cffi_backend")


def put_class(walk, value):
    top = _libraries.of_module(value.__module__)
    walk.say("class", value.__qualname__)
    if top is not None:
        walk.libraries.add(top)
        walk.say(top, value.__module__)
        for base in value.__mro__:
            for name, member in sorted(vars(base).items()):
                if _libraries.is_users(member):
                    walk.say("member", name)
                    walk.visit(member, f"{value.__name__}.{name}")
        return
    _key_code.put_binary(walk, sys.modules.get(value.__module__))
    walk.visit(type(value), "its metaclass")
    for base in value.__bases__:
        walk.visit(base, base.__name__)
    for name, member in list(vars(value).items()):
        if name not in _NOT_OF_CLASSES:
            walk.say("member", name)
            walk.visit(member, f"{value.__name__}.{name}")
    walk.attempt(vars(value).get("__annotations__"), "__annotations__")


def put_object(walk, value):
    kind = type(value)
    if kind is types.BuiltinFunctionType:
        _put_builtin(walk, value)
    elif kind in (types.MethodType, types.MethodWrapperType):
        walk.say("method", value.__name__)
        walk.visit(value.__self__, "__self__")
        walk.visit(getattr(value, "__func__", None), value.__name__)
    elif kind in (staticmethod, classmethod) or \
            kind.__name__ == "instancemethod":  # of pybind11's classes
        walk.say(kind.__name__)
        walk.visit(value.__func__, "__func__")
    elif kind is property:
        walk.say("property")
        walk.items("functions", [value.fget, value.fset, value.fdel])
    elif kind is functools.cached_property:
        walk.say("cached_property")
        walk.visit(value.func, "func")
    elif kind in _DESCRIPTORS:
        walk.say("descriptor", value.__name__)
        walk.visit(value.__objclass__, value.__objclass__.__name__)
    elif kind is _core.Problem:
        walk.libraries.add(_libraries.PHYSINV)
        walk.say("problem", repr(value.name), repr(value.options))
    elif _libraries.of_module(kind.__module__) is None:
        _put_instance(walk, value)
    else:
        walk.libraries.add(_libraries.of_module(kind.__module__))
        _put_library_instance(walk, value)


def _put_builtin(walk, value):
    owner = value.__self__
    walk.say("builtin", value.__qualname__)
    of_module = owner is None or isinstance(owner, types.ModuleType) or \
        type(owner).__name__ == "PyCapsule"  # as pybind11 has it
    if not of_module:
        walk.visit(owner, "__self__")
        return
    name = value.__module__ or getattr(owner, "__name__", "")
    top = _libraries.of_module(name)
    if top:
        walk.libraries.add(top)
        walk.say(top, name)
    elif not _key_code.put_binary(walk, sys.modules.get(name)):
        walk.refuse(value, "its file is unknown")


def _native_base(cls):
    """The class that decides how instances are stored: written in C."""
    heap = 1 << 9
    return next(base for base in cls.__mro__ if not base.__flags__ & heap)


def _slots(value):
    names = {name for base in type(value).__mro__
             for name, member in vars(base).items()
             if isinstance(member, types.MemberDescriptorType)}
    return {name: getattr(value, name) for name in sorted(names)
            if name != "__dict__" and hasattr(value, name)}


def _put_instance(walk, value):
    """Of a class of the user's: class, attributes, and what else it is."""
    walk.say("instance")
    cls = type(value)
    walk.visit(cls, cls.__name__)
    native = _native_base(cls)
    if native in (list, tuple, set, frozenset, dict, str, bytes, int, float,
                  complex):
        walk.visit(_plain(native, value), native.__name__)
    elif native is np.ndarray:
        walk.visit(value.view(np.ndarray), "its numbers")
    elif native is not object and not issubclass(cls, enum.Enum):
        _put_reduced(walk, value)
    walk.members({**_slots(value), **getattr(value, "__dict__", {})})


def _plain(native, value):
    """The content alone, whatever methods the user's class has."""
    if native is dict:
        return dict(dict.items(value))
    if native in (list, tuple, set, frozenset):
        return native(native.__iter__(value))
    if native in (str, bytes):
        return native.__getitem__(value, slice(None))
    if native is complex:
        return complex(*complex.__getnewargs__(value))
    return native.__add__(native(), value) if native is int else \
        float.fromhex(float.hex(value))


def _put_library_instance(walk, value):
    kind = type(value)
    package = kind.__module__.split(".")[0]
    if package in _IN_C:
        walk.refuse(value, "it is code or data at an address")
    if _is_global(walk, value):
        return
    if isinstance(value, _DRAWING):
        walk.refuse(value, "its numbers depend on those that were drawn "
                    "before; make it in the method, from run.seed")
    if issubclass(kind, getattr(sys.modules.get("jax"), "Array", ())):
        walk.say("array of JAX", str(getattr(value, "weak_type", "")))
        walk.visit(np.asarray(value), "its numbers")
    elif kind.__name__ == "_lru_cache_wrapper" or (
            package in ("jax", "jaxlib", "numba")
            and hasattr(value, "__wrapped__")):
        walk.say("wrapped", kind.__module__, kind.__qualname__)
        if hasattr(value, "cache_clear"):
            value.cache_clear()  # it may hold what came from other values
        for name in ("__wrapped__", "fun", "fwd", "bwd", "jvp",
                     "targetoptions"):
            walk.visit(getattr(value, name, None), name)
    else:
        _put_reduced(walk, value)


def _is_global(walk, value):
    """Of the module of its class, a library's."""
    module = type(value).__module__
    for name, one in vars(sys.modules.get(module, types)).items():
        if one is value:
            walk.say("global", module, name)
            return True
    return False


def _put_reduced(walk, value):
    """What pickle would keep of it."""
    reduce = copyreg.dispatch_table.get(type(value))
    try:
        parts = reduce(value) if reduce else value.__reduce_ex__(4)
    except Exception as error:
        walk.refuse(value, f"it has no stable text ({error})")
    if isinstance(parts, str):
        _put_named(walk, value, parts)
        return
    make, arguments, state, items, pairs = (*parts, None, None, None)[:5]
    walk.say("object")
    walk.visit(make, "type")
    walk.items("arguments", arguments)
    walk.visit(state, "state")
    walk.items("items", list(items or ()))
    walk.items("pairs", list(pairs or ()))


def _put_named(walk, value, name):
    """An object that pickle names."""
    homes = [getattr(value, "__module__", None), type(value).__module__,
             *sorted((m for m in list(sys.modules) if _libraries.of_module(m)
                      and _libraries.named(m, name) is value),
                     key=lambda m: (len(m), m))]
    home = next((m for m in homes if m and _libraries.named(m, name) is value),
                None)
    if home is None and type(value).__module__ == "typing":
        walk.say("name", name)  # of a type variable
        return
    if home is None:
        walk.refuse(value, "its module is unknown")
    top = _libraries.of_module(home)
    walk.say("global", home if top else "", name)
    if top:
        walk.libraries.add(top)
    else:
        _key_code.put_binary(walk, sys.modules[home])
