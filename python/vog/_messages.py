"""Short errors of calls with wrong arguments: what was given and what is expected, and never the content of an array."""
import functools
import re
from typing import Any, Callable

from ._packages import described

_MARK = "incompatible "


def _short(text: str, name: str, args: "tuple[Any, ...]", named: "dict[str, Any]") -> str:
    """The first line, the signatures, and the arguments by type and shape."""
    head = text.split("\n\nInvoked with:")[0]
    call = head.split("(", 1)[0] or name
    if call == "__init__" and args:
        call, args = type(args[0]).__name__, args[1:]
    signatures = re.findall(r"^ +\d+\. (.*)$", head, re.M)
    given = [described(value) for value in args] + [f"{name}={described(value)}" for name, value in named.items()]
    return f"{call}: got ({', '.join(given)}), expected {' or '.join(signatures)}"


def _shortened(call: Callable[..., Any], name: str = "") -> Callable[..., Any]:
    @functools.wraps(call)
    def called(*args: Any, **named: Any) -> Any:
        try:
            return call(*args, **named)
        except TypeError as error:
            text = str(error)
            if _MARK not in text or "Invoked with:" not in text:
                raise
            raise TypeError(_short(text, name, args, named)) from None

    return called


def shorten(module: Any) -> None:
    """Shortens the errors of all functions and methods of a module of pybind11."""
    for name, value in list(vars(module).items()):
        if name.startswith("_"):
            continue
        if isinstance(value, type):
            if issubclass(value, BaseException) or not value.__module__.startswith("vog"):
                continue
            for method, function in list(vars(value).items()):
                if isinstance(function, property) and function.fset:
                    setattr(value, method, function.setter(_shortened(function.fset, method)))
                elif method in ("__init__", "__getitem__", "__call__") or not method.startswith("_"):
                    if isinstance(function, staticmethod):
                        setattr(value, method, staticmethod(_shortened(function.__func__)))
                    elif type(function).__name__ == "instancemethod":
                        setattr(value, method, _shortened(function))
        elif callable(value):
            setattr(module, name, _shortened(value))
