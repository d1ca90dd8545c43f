"""Words of functions and modules, for _key."""

import importlib
import importlib.util
import sys
import types

from physinv import _key, _libraries, _references

_TEXT = "what it finds is known only when it runs"
_FILE = ("a file's content is not in the key; read it outside of the method, "
         "into a variable that the method uses")
_SET = ("what is set there is not in the key; take it into a variable that the "
        "method uses")
_REFUSED = [
    *(("builtins", name, _TEXT)
      for name in ("eval", "exec", "compile", "globals", "__import__")),
    ("importlib", "import_module", _TEXT), ("importlib", "__import__", _TEXT),
    ("sys", "modules", _TEXT), ("sys", "_getframe", _TEXT),
    ("inspect", "currentframe", _TEXT), ("inspect", "stack", _TEXT),
    ("builtins", "input", _TEXT), ("sys", "stdin", _TEXT),
    ("builtins", "open", _FILE), ("os", "open", _FILE),
    *(("numpy", name, _FILE)
      for name in ("load", "loadtxt", "genfromtxt", "fromfile", "memmap")),
    ("torch", "load", _FILE), ("h5py", "File", _FILE),
    ("pandas", "read_csv", _FILE), ("scipy.io", "loadmat", _FILE),
    ("os", "environ", _SET), ("os", "getenv", _SET)]
_READING = {"open", "read_text", "read_bytes"}  # of pathlib.Path, gzip, ...


def forbid(walk, value):
    """Refuses functions that find what no name in the code shows."""
    for module, name, why in _REFUSED:
        there = sys.modules.get(module)
        if there is not None and value is vars(there).get(name, walk):
            walk.refuse(value, why, _key.Forbidden)


def put_code(walk, code):
    """Without names of files, numbers of lines, and comments."""
    walk.say("code", code.co_code.hex(), str(code.co_flags),
             str(code.co_argcount), str(code.co_posonlyargcount),
             str(code.co_kwonlyargcount), repr(code.co_names),
             repr(code.co_varnames), repr(code.co_freevars),
             repr(code.co_cellvars),
             getattr(code, "co_exceptiontable", b"").hex())
    walk.items("constants", code.co_consts)


def put_function(walk, value):
    top = _libraries.of_file(value.__code__.co_filename)
    if top is None:
        walk.say("function", repr(value.__name__))
        put_code(walk, value.__code__)
        _put_names(walk, value)
        _put_imports(walk, value)
    else:
        walk.libraries.add(top)
        walk.say("function", top, value.__module__ or "",
                 value.__code__.co_name)
        home = value.__globals__.get("__name__", "")
        if _libraries.named(home, value.__qualname__) is value:
            return
        registry = getattr(value, "registry", None)
        if home == "functools" and registry:  # of singledispatch
            walk.visit(registry, "registry")
            return
        put_code(walk, value.__code__)
        for name, cell in _cells(value).items():
            _put_cell(walk, cell, name)
    walk.visit(value.__defaults__, "defaults")
    walk.visit(value.__kwdefaults__, "defaults")
    walk.members(value.__dict__)


def _cells(function):
    return dict(zip(function.__code__.co_freevars, function.__closure__ or ()))


def _put_cell(walk, cell, name, uses=((),)):
    walk.say("variable", name)
    try:
        value = cell.cell_contents
    except ValueError:
        walk.say("nothing")
        return
    _put_used(walk, value, name, uses)


def _put_names(walk, function):
    """All that the user's code refers to."""
    for name in sorted(_READING & _references.attributes(function.__code__)):
        walk.refuse(function, f".{name}: {_FILE}")
    cells = _cells(function)
    builtin = function.__globals__.get("__builtins__", {})
    if isinstance(builtin, types.ModuleType):
        builtin = vars(builtin)
    used = _references.names(function.__code__)
    for name, cell in cells.items():
        _put_cell(walk, cell, name, used.get((False, name), {()}))
    for (is_global, name), uses in sorted(used.items()):
        if not is_global:
            continue
        walk.say("name", name)
        for scope in (function.__globals__, builtin):
            if name in scope:
                _put_used(walk, scope[name], name, uses)
                break
        else:
            walk.say("nothing")


def _put_used(walk, value, name, uses):
    if not issubclass(type(value), types.ModuleType):
        walk.visit(value, name)
        return
    for names in sorted(uses):
        _put_attribute(walk, value, name, names)


def _put_attribute(walk, module, name, names):
    """module.a.b, as the code asks for it."""
    if not names:
        walk.visit(module, name)
        return
    name = f"{name}.{names[0]}"
    walk.say("attribute", names[0])
    top = _libraries.of_module(module.__name__)
    if top:
        walk.visit(module, name)
    try:
        value = getattr(module, names[0])
    except AttributeError:
        walk.say("nothing")
        return
    if issubclass(type(value), types.ModuleType):
        _put_attribute(walk, value, name, names[1:])
    elif top is None:
        walk.visit(value, name)
    else:
        _put_of_library(walk, value, name)


def _put_of_library(walk, value, name):
    """Of an object that a library keeps under this name, its class: what it
    holds is the library's matter. Values, functions and classes are visited, as
    the user may have put others there."""
    kind = type(value)
    visited = (*_key.PLAIN, types.FunctionType, types.BuiltinFunctionType)
    if _libraries.is_users(value):
        walk.visit(value, name)
        return
    if kind in visited or issubclass(kind, type):
        if walk.attempt(value, name):
            return
    walk.path.append(name)
    forbid(walk, value)
    walk.path.pop()
    walk.say("object", kind.__module__, kind.__qualname__)


def _put_imports(walk, function):
    package = function.__globals__.get("__package__") or ""
    names = {name for code in _references.codes(function.__code__)
             for name in code.co_names}
    for name, level, chosen in _references.imports(function.__code__):
        walk.say("import", str(level), name)
        if level and package:
            name = importlib.util.resolve_name("." * level + name, package)
        module = _imported(name)
        if module is None:
            walk.say("nothing")
        elif chosen is None or "*" in chosen:
            for one in (sys.modules[name.split(".")[0]], module):
                walk.visit(one, name)
                _put_patches(walk, one, names)
        else:
            for one in sorted(chosen):
                if hasattr(module, "__path__") and not hasattr(module, one):
                    _imported(f"{name}.{one}")
                _put_attribute(walk, module, name, (one,))


def _imported(name):
    """The module that an import statement means; None where that fails."""
    try:
        return importlib.import_module(name)
    except Exception:
        return None


def put_module(walk, value):
    """Of a library's: its name, and what the user put there."""
    top = _libraries.of_module(value.__name__)
    walk.say("module")
    if top is not None:
        walk.libraries.add(top)
        walk.say(top, value.__name__)
        _put_patches(walk, value, ())
        return
    if put_binary(walk, value):
        return
    for name, member in list(vars(value).items()):
        if name == "__getattr__" or not (
                name.startswith("__") and name.endswith("__")):
            walk.say("member", name)
            walk.visit(member, name)


def _put_patches(walk, module, names):
    """Functions of the user's in a library's module, and in those modules in it
    that the code names."""
    if _libraries.of_module(module.__name__) is None:
        return
    for name, value in sorted(vars(module).items()):
        if _libraries.is_users(value):
            walk.say("member", name)
            walk.visit(value, f"{module.__name__}.{name}")
        elif name in names and type(value) is types.ModuleType:
            _put_patches(walk, value, names - {name})


def put_binary(walk, module):
    """A module of the user's own that a compiler made: its file."""
    path = module and _libraries.file_of(module)
    if not path or not path.endswith((".so", ".pyd")):
        return False
    with open(path, "rb") as file:
        walk.say("binary", _key.digest_of(file.read()))
    return True
