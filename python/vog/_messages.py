"""Short errors for wrong arguments: what was given and what is expected, never the content of an array."""
import difflib
import functools
import re
from typing import Any, Callable, Iterable, Sequence

from ._packages import described

_MARK = "incompatible "

# What messages of the library call by the options of the command, as calls have it.
_FLAGS = [
    (re.compile(r"--(clip-negative|skip-nonfinite|level-set-to-fog)"), lambda found: found[1].replace("-", "_") + "=True"),
    (
        re.compile(r"--(units|grid|columns|radius)( (?!chooses\b|names\b)[a-zX]\w*)?"),  # with its value, or with the verb of a sentence
        lambda found: found[1] + "=" + (repr(found[2][1:]) if found[2] else "..."),
    ),
    (re.compile(r", or --memory, with which.*"), lambda found: ""),
    (re.compile(r"vog convert VOLUME -o model.ply --field \S+"), lambda found: "vog.convert(volume, fields=...)"),
]


def refuse_unknown(call: str, given: "Iterable[str]", known: "Sequence[str]") -> None:
    """A TypeError for a keyword that a call lacks, with the nearest one that it has."""
    for key in given:
        if key not in known:
            near = "".join(f", nearest '{one}'" for one in difflib.get_close_matches(key, known, 1))
            raise TypeError(f"{call}: unknown keyword '{key}'{near}, expected {', '.join(known)}")


def spoken(text: str) -> str:
    """A message or warning of the library, without options of the command."""
    for flag, argument in _FLAGS:
        text = flag.sub(argument, text)
    return text


def _short(text: str, name: str, args: "tuple[Any, ...]", named: "dict[str, Any]") -> str:
    """The first line, the signatures, and the arguments by type and shape."""
    head = text.split("\n\nInvoked with:")[0]
    call = head.split("(", 1)[0] or name
    if call == "__init__" and args:
        call, args = type(args[0]).__name__, args[1:]
    signatures = re.findall(r"^ +\d+\. (.*)$", head, re.M)
    given = [described(value) for value in args] + [f"{name}={described(value)}" for name, value in named.items()]
    return f"{call}: got ({', '.join(given)}), expected {' or '.join(signatures)}"


def _shortened(call: Callable[..., Any], failure: "type[Exception]", name: str = "") -> Callable[..., Any]:
    @functools.wraps(call)
    def called(*args: Any, **named: Any) -> Any:
        try:
            return call(*args, **named)
        except failure as error:
            if "--" not in str(error):
                raise
            raise failure(spoken(str(error))) from None
        except TypeError as error:
            text = str(error)
            if _MARK not in text or "Invoked with:" not in text:
                raise
            raise TypeError(_short(text, name, args, named)) from None

    return called


def _without_constructor(kind: type) -> Callable[..., Any]:
    makers = [f"{kind.__name__}.{name}" for name, function in vars(kind).items() if isinstance(function, staticmethod) and name[0] != "_"]

    @functools.wraps(kind.__init__)  # type: ignore[misc]
    def refused(self: Any, *args: Any, **named: Any) -> None:
        raise TypeError(f"{kind.__name__}: has no constructor; use {' or '.join(makers) or 'what calls of vog return'}")

    return refused


def shorten(module: Any) -> None:
    """Shortens the errors of all functions and methods of a module of pybind11, and names their arguments as calls do."""
    for name, value in list(vars(module).items()):
        if name.startswith("_"):
            continue
        if isinstance(value, type):
            if issubclass(value, BaseException) or not value.__module__.startswith("vog"):
                continue
            if type(value.__init__).__name__ == "wrapper_descriptor":
                setattr(value, "__init__", _without_constructor(value))
            for method, function in list(vars(value).items()):
                if isinstance(function, property) and function.fset:
                    setattr(value, method, function.setter(_shortened(function.fset, module.Error, method)))
                elif method in ("__init__", "__getitem__", "__call__") or not method.startswith("_"):
                    if isinstance(function, staticmethod):
                        setattr(value, method, staticmethod(_shortened(function.__func__, module.Error)))
                    elif type(function).__name__ == "instancemethod":
                        setattr(value, method, _shortened(function, module.Error))
        elif callable(value):
            setattr(module, name, _shortened(value, module.Error))
