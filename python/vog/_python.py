"""Check of the interpreter, which any Python 3 can read: the module is compiled for one version."""
import contextlib
import glob
import os
import sys

_LEAST = (3, 9)


def require_python(version=sys.version_info, folder=""):
    """Raises ImportError, in one line, if the module was built for another interpreter.

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


@contextlib.contextmanager
def own_libraries(folder=""):
    """Context in which the module's libraries find each other before those of the same names in the process.

    folder  of the package; empty: this one

    Only of a wheel, whose libraries lie beside the package in vog.libs: another package or the program itself (Blender, ParaView) may have
    made its Embree, TBB or OpenVDB visible to all, and mixed copies end in crashes. Not under LD_PRELOAD, whose malloc must be everyone's.
    """
    folder = folder or os.path.dirname(os.path.abspath(__file__))
    if not os.path.isdir(folder + ".libs") or "LD_PRELOAD" in os.environ or not hasattr(os, "RTLD_DEEPBIND"):
        yield
        return
    flags = sys.getdlopenflags()
    sys.setdlopenflags(flags | os.RTLD_DEEPBIND)
    try:
        yield
    finally:
        sys.setdlopenflags(flags)
