"""The command vog for any file that Python reads: python -m vog COMMAND FILE ... loads it and runs the command on a converted copy.

--grid names the density and --field further arrays. --measure volume carries values of any sign as fields, without a density. --at time=3
takes another time, or any index beside x, y and z, and --load KEY=VALUE is a keyword of vog.load. Without a command, and with info, the
arrays of the file are listed. All other options are those of `vog COMMAND --help`.
"""
import contextlib
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import warnings
from typing import Any, List

from ._grids import Grids, density_of, write_scan
from ._load import DICOM, OME, YT, kind_of, load, read, reading
from ._vtk_files import arrays_of, dataset, leaves_of, read_vtk
from ._vog import Cells, Error, Gaussians, Levels, Volume, convert, memory_limit


def _command() -> str:
    """Path of the command: this package's, else the one on the PATH."""
    own = os.path.join(os.path.dirname(os.path.abspath(__file__)), "bin", "vog")
    found = own if os.path.exists(own) else shutil.which("vog")
    if not found:
        sys.exit("vog: the command vog is neither in this package nor on the PATH, expected it there (docs/install.md)")
    return found


def _is_input(words: "List[str]", n: int) -> bool:
    """Whether a word names a file that vog itself does not read, and no file to write."""
    outputs = ("-o", "--output", "--values-out", "--depth-out")
    there = os.path.exists(words[n]) or ("://" in words[n] and ".zarr" in words[n])
    return not words[n].startswith("-") and words[n - 1] not in outputs and there and kind_of(words[n]) is not None


def _name(text: str) -> str:
    """Name of an array as names of grids and fields may be: of letters, digits, _ and -."""
    return re.sub(r"[^\w-]+", "_", text).strip("_")


_COMPONENT = re.compile(r"\.(x|y|z|magnitude)$")
# Keywords of vog.load for --load, and the kinds of their values.
_KEYWORDS: Any = {"level": int, "voxel_size": lambda text: [float(x) for x in text.split(",")] if "," in text else float(text), "thickness": float, "unit": str}


def _number(option: str, kind: Any, text: Any) -> Any:
    """The value of an option as a number of a kind; None where it is not given."""
    try:
        return None if text is None else kind(text)
    except ValueError:
        raise Error(f"{option} {text}: write {'a whole number' if kind is int else 'a number'}") from None


class Options:
    """Options of a command line that say what is read."""

    def __init__(self, words: "List[str]") -> None:
        self.words = words
        self.grid = next(iter(self.values("--grid")), "")
        # T=temperature and velocity.x name the arrays temperature and velocity; by the name that the field has.
        pairs = [text.partition("=") for text in self.values("--field")]
        self.fields = {_name(_COMPONENT.sub("", new)): _COMPONENT.sub("", array or new) for new, _, array in pairs}
        self.ones = "volume" in self.values("--measure")
        self.rules: Any = {"skip_nonfinite": "--skip-nonfinite" in words, "clip_negative": "--clip-negative" in words}
        pairs = [text.partition("=") for text in self.values("--at")]
        self.given: Any = {"at": {axis: _number("--at " + axis, int, index) for axis, _, index in pairs}} if pairs else {}
        for key, _, text in (text.partition("=") for text in self.values("--load")):
            if key not in _KEYWORDS:
                raise Error(f"--load {key}: no keyword to load with; it takes {', '.join(_KEYWORDS)}, such as --load level=0")
            self.given[key] = _number("--load " + key, _KEYWORDS[key], text)

    def values(self, option: str) -> "List[str]":
        pairs = zip(self.words, self.words[1:] + [""])
        return [after if word == option else word.split("=", 1)[1] for word, after in pairs if word == option or word.startswith(option + "=")]

    def drop(self, *options: str) -> None:
        """Empties words of options that the file has met; main() leaves them out."""
        for n, word in enumerate(self.words):
            if word in options:
                self.words[n : n + 2] = ["", ""]
            elif word.split("=", 1)[0] in options:
                self.words[n] = ""


def _list(path: str, given: "dict[str, Any]") -> None:
    """Prints the arrays of a file, and a command to try."""
    kind, place = kind_of(path)  # type: ignore[misc]
    data = leaves_of(dataset(place, given.get("at", {}))) if kind.read is read_vtk else read(place, kind, "", given)
    print(f"{path}: {kind.what}")
    names: "List[str]" = []
    vectors: "List[str]" = []
    if isinstance(data, list):  # blocks of a mesh
        for leaf in data:
            for what, values in (("points", leaf.GetPointData()), ("cells", leaf.GetCellData())):
                here = {name: array for name, array in arrays_of(values).items() if name not in names}
                print(*(f"  {name}  at {what}\n" for name in here), sep="", end="")
                names += here
                vectors += [name for name, array in here.items() if array.ndim > 1]
        if not names:
            raise Error(f"{path}: no arrays of numbers at points or in cells")
    elif isinstance(data, Grids):
        for name in data.names:
            unit = data.unit(name)
            print(f"  {name}" + (f"  {unit}" if unit else ""))
        names, vectors = list(data.names), list(data.vectors)
    else:
        names = list(dict.fromkeys(name[1] for name in getattr(data, "field_list", ()) if name[0] not in ("io", "all")))
        print(f"  {', '.join(names)}" if names else f"  {data!r}")
    name = next((name for name in names if name not in vectors), None)
    choice = "" if not names or "density" in map(str.lower, names) else f" --grid {shlex.quote(name or names[0])}"
    print(f"\nTry:\n  python3 -m vog {'render' if name or not names else 'convert'} {shlex.quote(path)}{choice}{'' if name or not names else ' --measure volume -o model.ply'}")


def _limited(options: Options) -> Any:
    """The command's limit of memory, for what is read before it."""
    given = re.fullmatch(r"([\d.]+)([kKMGT]?)i?B?", next(iter(options.values("--memory")), ""))
    folder = next((word.split("=", 1)[1] for word in options.values("--set") if word.startswith("scratch=")), "")
    return memory_limit(float(given[1]) * 1024.0 ** " KMGT".index(given[2].upper() or " "), folder) if given else contextlib.nullcontext()


def _renamed(word: str) -> str:
    """heat=T.x, or --field=heat=T.x, as the model has it, whose field is called heat: heat.x."""
    option, new, array = re.fullmatch(r"(--field=|)(?:([^=]*)=)?(.*)", word).groups()  # type: ignore[union-attr]
    component = _COMPONENT.search(array)
    return option + (array if new is None else new + (component[0] if component else ""))


def _written(path: str, folder: str, options: Options) -> "List[str]":
    """Files of vog's own with the arrays of a file that the options name."""
    stem = os.path.join(folder, _name(os.path.basename(os.path.normpath(path)).split(".")[0]) or "data")
    kind, place = kind_of(path)  # type: ignore[misc]
    if kind in (OME, DICOM) and not options.fields and not options.ones:
        # With a limit of memory the finest level goes through a file, slab by slab.
        level = {"level": 0} if kind is OME and options.values("--memory") else {}
        data = read(place, kind, options.grid, {**level, **options.given})
        write_scan(stem + ".nrrd", data, density_of(data.names, options.grid, path))
        options.drop("--grid")
        return [stem + ".nrrd"]
    wanted = {**({_name(options.grid): options.grid} if options.ones and options.grid else {}), **options.fields}
    data, fields = load(path, "volume" if options.ones else options.grid, fields=wanted, **options.given, **options.rules)
    if isinstance(data, Cells):
        if options.words[0] == "evaluate":
            raise Error(f"{path}: the command evaluates voxels, not meshes; in Python vog.evaluate(vog.load(...), folder) does")
        # Commands know models, of which convert keeps a budget; an error is met here.
        data = convert(data, **{name: _number("--" + name, kind, next(iter(options.values("--" + name)), None)) for name, kind in (("budget", int), ("error", float))})
        options.drop("--error", "--grid", "--measure", *([] if options.values("--show") or options.words[0] == "render" else ["--field"]))
        options.words = [_renamed(word) if "--field" in (before, word[:7]) else word for before, word in zip(["", *options.words], options.words)]
    if not isinstance(data, (Levels, Volume)):
        data.save(stem + ".ply" if isinstance(data, Gaussians) else stem + ".csv")
        return [stem + (".ply" if isinstance(data, Gaussians) else ".csv")]
    levels = [data[n] for n in range(len(data))] if isinstance(data, Levels) else [data]
    files = []
    for n, volume in enumerate(levels):
        volume.name = _name(volume.name)
        files.append(f"{stem}_L{n}.vdb" if len(levels) > 1 else f"{stem}.vdb")
        own = {}
        for name, field in fields.items():
            value, unit = (field["value"], field["unit"]) if isinstance(field, dict) else (field, "")
            own[_name(wanted[name])] = {"value": value[n] if len(levels) > 1 else value, "unit": unit}
        volume.save(files[-1], fields={name: field for name, field in own.items() if name != volume.name} or None)
    if not options.grid:
        options.words += ["--grid", levels[0].name]
    return files


# What messages of Python call by its keywords, as the command has it.
_OPTIONS: Any = [
    (r"\b(clip|skip)_(negative|nonfinite)(=True)?", r"--\1-\2"), (r"density='volume'", "--measure volume"), (r"fields=\[...\]", "--field NAME"),
    (r"expected the name of one", "expected --grid with one"), (r"\bload: ", ""), (r"\bat=\{'([^']*)': (\w+)\}", r"--at \1=\2"),
    (r"(?<!--load )\b(level|voxel_size|thickness|unit)=(?=(\w*))", lambda found: f"--load {found[1]}=" + ("" if found[2] else "...")),
]  # fmt: skip


def _spoken(text: str) -> str:
    for pattern, option in _OPTIONS:
        text = re.sub(pattern, option, text)
    return text


def main(words: "List[str]") -> int:
    """Runs the command on converted copies of files that vog itself does not read; returns its exit code."""
    warnings.showwarning = lambda message, *_: print(f"vog: note: {_spoken(str(message).splitlines()[0])}", file=sys.stderr)
    inputs = [n for n in range(len(words)) if _is_input(words, n)]
    try:
        if inputs and (inputs[0] == 0 or words[0] == "info"):
            for n in inputs:
                with reading(words[n]):
                    _list(words[n], Options(list(words)).given)
            return 0
        with tempfile.TemporaryDirectory(prefix="vog-") as folder:
            options = Options(list(words))
            options.drop(*(["--at", "--load"] if inputs else []))
            made = {}
            for n in inputs:
                with _limited(options), reading(words[n]):
                    made[n] = _written(words[n], folder, options)
            line = [file for n, word in enumerate(options.words) for file in made.get(n, [word] if word else [])]
            for option in ("--grid", "--field") if inputs else ():
                for n in range(1, len(line)):
                    if line[n - 1] == option:
                        line[n] = "=".join(re.sub(r"[^\w.*-]+", "_", part).strip("_") for part in line[n].split("="))
            return subprocess.call([_command(), *line])
    except (Error, ImportError, OSError) as error:
        print("vog: " + _spoken(str(error)), file=sys.stderr)
    except KeyboardInterrupt:
        return 130
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
