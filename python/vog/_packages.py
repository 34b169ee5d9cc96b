"""Optional packages: imported inside the call that needs them, with the remedy where they are absent."""
import importlib
from typing import Any

# Names for pip and for Debian's apt, where they are not the module's.
_PIP = {"vtkmodules": "vtk", "openpmd_api": "openpmd-api"}
_DEBIAN = {
    "astropy": "python3-astropy", "matplotlib": "python3-matplotlib", "pint": "python3-pint", "xarray": "python3-xarray", "nibabel": "python3-nibabel",
    "tifffile": "python3-tifffile", "vtkmodules": "python3-vtk9", "yt": "python3-yt", "h5py": "python3-h5py", "pydicom": "python3-pydicom", "zarr": "python3-zarr",
}  # fmt: skip


def need(name: str, call: str) -> Any:
    """Module of an optional package.

    name  dotted name of the module: 'astropy.units'
    call  function that needs it, for the message

    Raises ImportError, in one line with the command that installs the package.
    """
    package = name.split(".")[0]
    try:
        importlib.import_module(package)
    except ModuleNotFoundError as error:
        if error.name != package:
            raise  # the package is there, but lacks another one
        debian = f", or apt install {_DEBIAN[package]}" if package in _DEBIAN else ""
        raise ImportError(
            f"{call}: the Python package {_PIP.get(package, package)} is not installed, expected it for this call: "
            f"pip install {_PIP.get(package, package)}{debian}",
            name=package,
        ) from None
    return importlib.import_module(name)


def root_package(value: object) -> str:
    """Package that a value's type comes from: 'astropy', 'numpy'."""
    return type(value).__module__.split(".")[0]


def described(value: object) -> str:
    """Short text of any value, for messages: its type, of arrays and containers the shape, and never the content."""
    kind = type(value).__name__
    if value is None or isinstance(value, (bool, int, float)):
        return repr(value)[:40]
    if isinstance(value, str):
        return repr(value if len(value) <= 60 else value[:57] + "...")
    shape = getattr(value, "shape", None)
    if isinstance(shape, tuple):
        return f"{kind} of shape {shape}"
    if isinstance(value, (list, tuple, dict, set)):
        return f"{kind} of {len(value)}"
    return kind
