"""Check of the interpreter, which any Python 3 can read: the module is compiled for one version."""
import glob
import os
import sys

_LEAST = (3, 9)


def require_python(version=sys.version_info, folder=""):
    """Raises ImportError, in one line, where the interpreter is not the one that the module is built for.

    version  of the interpreter
    folder   of the package; empty: this one
    """
    import importlib.machinery

    here = "Python %d.%d (%s)" % (version[0], version[1], sys.executable)
    if tuple(version[:2]) < _LEAST:
        raise ImportError("vog: %s, expected Python %d.%d or later" % (here, _LEAST[0], _LEAST[1]))
    folder = folder or os.path.dirname(os.path.abspath(__file__))
    built = [os.path.basename(path) for path in sorted(glob.glob(os.path.join(folder, "_vog.*")))]
    built = [name for name in built if name.endswith((".so", ".pyd", ".dylib"))]
    usable = ["_vog" + suffix for suffix in importlib.machinery.EXTENSION_SUFFIXES]
    if built and not set(built) & set(usable):
        raise ImportError("vog: %s, but the package in %s is built for another: %s, expected %s" % (here, folder, ", ".join(built), usable[0]))
