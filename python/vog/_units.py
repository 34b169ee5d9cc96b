"""Units of astropy, pint and unyt (yt's): numbers without them for the library, results with them.

Volumes, particles and models have the units that their files state, or that they were made with. Models and pickles keep the texts.
"""
import functools
import os
import warnings
import weakref
from typing import Any, Callable, NamedTuple, Optional

import numpy as np

from . import _vog
from ._packages import described, need, root_package

_PACKAGES = ("astropy", "pint", "unyt")


class Units(NamedTuple):
    """Units of a volume or a model: objects of astropy, pint or unyt, or texts; None: not known."""

    density: Any = None
    length: Any = None


_known: "weakref.WeakKeyDictionary[Any, Units]" = weakref.WeakKeyDictionary()


def units_of(data: object) -> Units:
    """Units of a Volume, Levels, Gaussians or Points; of a list of volumes those of the first."""
    if isinstance(data, (list, tuple)) and data:
        data = data[0]
    if (given := _given_units(data)) is not None:
        return given
    if isinstance(data, _vog.Levels):
        data = data[0] if len(data) else None
    stated = getattr(data, "_units", ("", ""))
    return Units(_known_text(stated[1]), stated[0] or None)


def _given_units(data: object) -> Optional[Units]:
    """Units that data were made with; None: none."""
    try:
        return _known.get(data)
    except TypeError:  # what cannot be referenced weakly has none
        return None


@functools.lru_cache(maxsize=None)
def _known_text(unit: str) -> Optional[str]:
    """The text of a unit; None: empty, or no unit elsewhere: Hounsfield's, counts."""
    try:
        return unit if unit and parsed(unit, "units_of") else None
    except (ImportError, _vog.Error):
        return None


def set_units(data: Any, density: Any = None, length: Any = None) -> Any:
    """Sets the units of a Volume, Levels, Gaussians or Points, and returns it.

    density  unit of its densities: a text ('g/cm**3'), or a unit of astropy, pint or unyt; None: not known
    length   unit of world lengths: 'kpc'

    Numbers do not change. vog.projection gives its result units where the data have them, and vog.convert hands
    them on to the model. Labels and `units` of vog.render know their texts, which files keep.

    >>> volume = vog.set_units(vog.sample_cloud(64), "g / cm3", "kpc")
    >>> vog.units_of(vog.convert(volume, block=8))
    Units(density='g / cm3', length='kpc')
    """
    if not isinstance(data, (_vog.Volume, _vog.Levels, _vog.Gaussians, _vog.Points, _vog.Cells)):
        raise TypeError(f"set_units: got {described(data)}, expected a Volume, Levels, Gaussians, Points or Cells")
    for name, unit in (("density", density), ("length", length)):
        if not (unit is None or isinstance(unit, str) or _package_of_unit(unit)):
            raise TypeError(f"set_units: {name}: got {described(unit)}, expected a text or a unit of astropy, pint or unyt")
    _record(data, Units(density, length))
    return data


def _record(data: Any, units: Units) -> None:
    """Sets the units of data, and their texts, which labels, files and pickles have."""
    _known[data] = units
    for one in map(data.__getitem__, range(len(data))) if isinstance(data, _vog.Levels) else [data]:
        one._units = (_stated(units.length), _stated(units.density))


def _stated(unit: Any) -> str:
    """Text of a unit. Units of a simulation's code get numbers: '128 Mpc', else in CGS."""
    if unit is None or isinstance(unit, str):
        return unit or ""
    package = _package_of_unit(unit)
    if package == "astropy":
        return str(unit.to_string())
    if package == "pint":
        return f"{unit:~C}"
    if "code_" not in str(unit):
        return str(unit)
    one = need("unyt", "set_units").unyt_quantity(1.0, unit).in_cgs()
    for name in ("Mpc", "kpc", "pc", "AU", "km", "m") if str(one.units) == "cm" else ():
        if one.to(name).value >= 0.9:
            one = one.to(name)
            break
    return f"{float(one.value):.7g} {one.units}"


def is_quantity(value: object) -> bool:
    """Whether a value is a number or array with a unit, of a package that is known here."""
    return root_package(value) in _PACKAGES and (hasattr(value, "magnitude") or hasattr(value, "to_value"))


def _package_of_unit(unit: object) -> Optional[str]:
    package = root_package(unit)
    return package if package in _PACKAGES and not is_quantity(unit) else None


def unit_of(quantity: Any) -> Any:
    """Unit of a Quantity."""
    return quantity.unit if root_package(quantity) == "astropy" else quantity.units


def in_double(quantity: Any) -> Any:
    """A Quantity in double precision: factors between units exceed the range of float32."""
    numbers = np.asarray(getattr(quantity, "magnitude", getattr(quantity, "value", quantity)), dtype=float)
    return type(quantity)(numbers if numbers.ndim else float(numbers), unit_of(quantity))


def value_in(quantity: Any, unit: Any, name: str) -> Any:
    """Number or array of a Quantity in a unit.

    Raises vog.Error where the two do not measure the same.
    """
    quantity = in_double(quantity)
    try:
        if root_package(quantity) == "pint":
            return quantity.to(unit).magnitude
        return quantity.to_value(unit)
    except Exception as error:
        # pint and unyt have exceptions of their own for dimensions; their texts name the units alone.
        if not any(word in type(error).__name__ for word in ("Unit", "Dimension", "Conversion")):
            raise
        raise _vog.Error(f"{name}: unit {unit_of(quantity)}, expected one that converts to {unit}") from None


def _plain(value: Any, unit: Any, name: str) -> "tuple[Any, Any]":
    """(Number or array without a unit, unit): in `unit`, or its own where that is None. A list of Quantities counts."""
    if isinstance(value, (list, tuple)) and any(map(is_quantity, value)):
        if not all(map(is_quantity, value)):
            raise _vog.Error(f"{name}: numbers with and without units, expected all with one")
        unit = unit_of(value[0]) if unit is None else unit
        return [float(value_in(item, unit, name)) for item in value], unit
    if not is_quantity(value):
        return value, None
    unit = unit_of(value) if unit is None else unit
    return value_in(value, unit, name), unit


def _lattice(voxel_size: Any, origin: Any) -> "tuple[Any, Any, Any]":
    """(voxel_size, origin, unit of length), the first two without units."""
    size, unit = _plain(voxel_size, None, "voxel_size")
    if origin is None:
        return size, None, unit
    place, own = _plain(origin, unit, "origin")
    if (own is None) != (unit is None) and np.any(np.asarray(place, dtype=float) != 0):
        have, lack = ("voxel_size", "origin") if own is None else ("origin", "voxel_size")
        raise _vog.Error(f"{lack}: has no unit, but {have} has one ({unit if own is None else own}), expected both or none")
    return size, place, unit


_Made = Callable[..., Any]


def _with_units(make: _Made, name: str, first: Callable[[Any], "tuple[Any, Any]"], lattice: bool) -> _Made:
    """The static method of a class, which then takes Quantities for its first argument, `name`, voxel_size and origin."""

    @functools.wraps(make)
    def made(*args: Any, **named: Any) -> Any:
        names = ("voxel_size", "origin")
        given = dict(zip(names, args[1:3])) if lattice else {}
        given.update({each: named[each] for each in names if lattice and each in named})
        length = None
        if lattice and any(value is not None for value in given.values()):
            size, place, length = _lattice(given.get("voxel_size"), given.get("origin"))
            plain = {"voxel_size": size, "origin": place}
            args = args[:1] + tuple(plain[each] for each in names[: max(0, len(args) - 1)]) + args[3:]
            named = {**named, **{each: plain[each] for each in names if each in named}}
        density = None
        if args:
            value, density = first(args[0])
            args = (value, *args[1:])
        elif name in named:
            named[name], density = first(named[name])
        result = make(*args, **named)
        if density is not None or length is not None:
            _record(result, Units(density, length) if lattice else Units(None, density))
        return result

    return made


def _array(value: Any) -> "tuple[Any, Any]":
    return _plain(value, None, "array")


def _blocks(pairs: Any) -> "tuple[Any, Any]":
    """Blocks without units, all in the unit of the first."""
    unit, plain = None, []
    for n, pair in enumerate(pairs):
        if isinstance(pair, (list, tuple)) and len(pair) == 2:
            value, own = _plain(pair[1], unit, "blocks")
            if n and (own is None) != (unit is None):
                raise _vog.Error("blocks: arrays with and without units, expected all with one")
            unit, pair = own, (pair[0], value)
        plain.append(pair)
    return plain, unit


def _convert(convert: _Made) -> _Made:
    @functools.wraps(convert)
    def converted(*args: Any, **named: Any) -> Any:
        model = convert(*args, **named)
        data = args[0] if args else named.get("data")
        # The unit of length alone: density is of the particles' value per volume.
        units = _given_units(data[0] if isinstance(data, (list, tuple)) and data else data) or Units()
        if isinstance(data, _vog.Points):
            units = Units(None, units.length)
        if any(unit is not None for unit in units):
            _known[model] = units
        return model

    return converted


def _save(save: Callable[..., None]) -> Callable[..., None]:
    """The method save of volumes, with a warning where the file drops units."""

    @functools.wraps(save)
    def saved(self: Any, file: Any, *args: Any, fields: Any = None, **named: Any) -> None:
        save(self, file, *args, fields=fields, **named)
        units = [*units_of(self), *(field.get("unit") for field in (fields or {}).values() if isinstance(field, dict))]
        if os.fspath(file).lower().endswith(".nvdb") and any(unit is not None and str(unit) for unit in units):
            warnings.warn(f"save: {os.fspath(file)}: .nvdb keeps no units; .vdb does", stacklevel=2)

    return saved


def accept_quantities() -> None:
    """Makes from_numpy and from_blocks accept Quantities, convert hand units on, and save name those that a file drops."""
    module: Any = _vog
    for owner, call, name, first in (
        (module.Volume, "from_numpy", "array", _array),
        (module.Volume, "from_blocks", "blocks", _blocks),
        (module.Points, "from_numpy", "position", _array),
    ):
        lattice = owner is module.Volume
        setattr(owner, call, staticmethod(_with_units(getattr(owner, call), name, first, lattice)))
    module.convert = _convert(module.convert)
    for owner in (module.Volume, module.Levels):
        owner.save = _save(owner.save)


def with_unit(array: Any, unit: Any, call: str) -> Any:
    """An array with a unit: of the unit's own package; a text: of astropy, else of pint."""
    if isinstance(unit, str):
        unit = parsed(unit, call)
    package = _package_of_unit(unit)
    if package == "pint":
        return array * unit
    return need("unyt", call).unyt_array(array, unit) if package == "unyt" else need("astropy.units", call).Quantity(array, unit)


def parsed(text: str, call: str, like: Any = None) -> Any:
    """Unit of a text, by the package of `like`; None: by astropy, else by pint."""
    package = _package_of_unit(like) if like is not None else None
    if package == "pint":
        return like._REGISTRY.Unit(text)
    if package == "unyt":
        return need("unyt", call).Unit(text, registry=like.registry)
    try:
        units = need("astropy.units", call)
    except ImportError as error:
        try:
            pint = need("pint", call)
        except ImportError:
            raise ImportError(
                f"{call}: units need the Python package astropy or pint, neither is installed: pip install astropy", name=error.name
            ) from None
        try:
            return pint.get_application_registry().Unit(text)
        except pint.errors.UndefinedUnitError:
            raise _vog.Error(f"{call}: unit '{text[:60]}', expected one that pint knows") from None
    try:
        return units.Unit(text)
    except ValueError:
        raise _vog.Error(f"{call}: unit '{text[:60]}', expected one that astropy knows: 'kpc', 'g / cm2'") from None


def product(density: Any, length: Any, power: int, call: str) -> Any:
    """Unit density * length**power; units that are texts are read by the other's package."""
    if isinstance(density, str):
        density = parsed(density, call, length if not isinstance(length, str) else None)
    if isinstance(length, str):
        length = parsed(length, call, density)
    return density * length**power
