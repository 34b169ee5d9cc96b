"""The stub file matches the module: names by mypy's stubtest, parameters by the docstrings, types by use."""
import ast
import inspect
import os
import pathlib
import re
import subprocess
import sys
import textwrap

import pytest

import vog
from conftest import SOURCE
from vog import _vog

STUB = pathlib.Path(_vog.__file__).with_name("_vog.pyi")


def runtime_signatures():
    """{'Camera.orbit': 'data, azimuth=, ...'} of every function, from the first line of its docstring."""
    found = {}

    def add(name, function):
        if name.rsplit(".", 1)[-1].startswith("_") and not name.endswith("__init__"):
            return
        first = (function.__doc__ or "").split("\n", 1)[0]
        if first.startswith("Initialize self"):
            return  # no constructor
        match = re.match(r"\w+\((.*)\)(?: -> .*)?$", first)
        if not match and inspect.isfunction(function):  # a function of Python's
            match = re.match(r"\((.*)\)(?: -> .*)?$", str(inspect.signature(function)))
        assert match, f"{name}: no signature in {first!r}"
        tree = ast.parse(f"def f({re.sub(r'<[^>]*>|Union', 'x', match.group(1))}): ...").body[0]
        found[name] = parameters(tree.args)

    for name, item in vars(_vog).items():
        if inspect.isclass(item) and not name.startswith("_"):
            for member, function in vars(item).items():
                if isinstance(function, staticmethod):
                    add(f"{name}.{member}", function.__func__)
                elif inspect.isroutine(function):
                    add(f"{name}.{member}", function)
        elif inspect.isroutine(item):
            add(name, item)
    return found


def parameters(args):
    """Names in order; '=' behind those with a default; '*' where only keywords follow."""
    positional = [a.arg for a in args.args]
    with_default = set(positional[len(positional) - len(args.defaults) :])
    words = [name + "=" * (name in with_default) for name in positional]
    if args.vararg or args.kwonlyargs:
        words.append("*")
    words += [a.arg + "=" * (d is not None) for a, d in zip(args.kwonlyargs, args.kw_defaults)]
    return ", ".join(words)


def stub_signatures():
    found = {}
    for item in ast.parse(STUB.read_text()).body:
        if isinstance(item, ast.FunctionDef):
            found[item.name] = parameters(item.args)
        if isinstance(item, ast.ClassDef):
            for member in item.body:
                if isinstance(member, ast.FunctionDef) and not any(
                    isinstance(d, ast.Name) and d.id == "property" or isinstance(d, ast.Attribute)
                    for d in member.decorator_list
                ):
                    found[f"{item.name}.{member.name}"] = parameters(member.args)
    return found


def test_parameters_are_those_of_the_stub():
    stub, runtime = stub_signatures(), runtime_signatures()
    assert len(runtime) > 40
    for name, words in runtime.items():
        assert stub.get(name) == words, name


def type_of(key):
    """Type of a keyword of requests, by its row of the schema."""
    takes, _, _, choices, *_ = _vog._request_schema()[key]
    if key == "tf":
        return "_Map"
    if key == "extinction":
        return "_Extinction"
    if choices or takes in ("NAME", "UNIT", "TEXT"):
        return "str"
    if takes in ("", "0|1"):
        return "bool"
    if takes in ("N", "OCTAVES"):
        return "int"
    if takes == "COLOUR":
        return "Union[str, _Vector]"
    if key == "layers":
        return "Sequence[dict[str, Any]]"
    if "COLOUR" in takes:
        return "Sequence[Any]"
    if "," in takes:
        return "Union[str, ArrayLike]" if re.search("[a-z]", takes) else "ArrayLike"
    assert takes.isupper() and takes.isalpha(), f"{key}: no type for {takes}"
    return "float"


def keyword_lines(types, indent):
    words = ", ".join(f"{key}:~Optional[{kind.replace(' ', '~')}]~=~..." for key, kind in types.items()) + ","
    return textwrap.indent(textwrap.fill(words, 136), " " * indent).replace("~", " ") + "\n"


def test_keywords_are_those_of_the_schemas():
    text = wanted = STUB.read_text()
    conversion, schema = _vog._conversion_schema(), _vog._request_schema()
    for call, indent in ((vog.convert, 4), (vog.render, 4), (vog.Picture.recolor, 8), (vog.export_html, 4)):
        keys = [key for key, one in inspect.signature(call).parameters.items() if key in schema and key != "size" and one.default is None] if call is not vog.convert else []
        lines = keyword_lines({key: type_of(key) for key in keys} or conversion, indent)
        wanted = re.sub(
            rf"(def {call.__name__}\((?:[^)]*\n)? *\*,\n)((?: *(?:method|fields|labels|progress|report|title|description|levels|camera|steps|precise|url): [^\n]*\n)*).*?(?= *\) -> )",
            lambda found: found[1] + found[2] + lines, wanted, count=1, flags=re.S,
        )
    if os.environ.get("VOG_WRITE_STUB"):
        (SOURCE / "python" / "vog" / "_vog.pyi").write_text(wanted)
    assert text == wanted, "VOG_WRITE_STUB=1 writes the stub"


def test_every_public_thing_is_documented():
    for name in _vog.__all__:
        item = getattr(vog, name)
        assert (item.__doc__ or "").strip(), name
        for member, value in vars(item).items() if inspect.isclass(item) else ():
            if not member.startswith("_"):
                text = value.__func__.__doc__ if isinstance(value, staticmethod) else value.__doc__
                lines = (text or "").strip().split("\n")
                # pybind11 puts the signature first.
                assert lines[0] and (isinstance(value, property) or len(lines) > 2 or name == "TransferFunction"), (
                    f"{name}.{member}"
                )


def test_help_names_the_package_and_no_internals():
    text = vog.render.__doc__ + vog.Picture.save.__doc__ + vog.convert.__doc__ + vog.Gaussians.__init__.__doc__
    assert "vog.Picture" in text and "_vog" not in text and "::" not in text


def test_stubtest_finds_every_name(tmp_path):
    pytest.importorskip("mypy", reason="needs mypy (apt install mypy)")
    done = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "vog", "--concise"],
        cwd=tmp_path, capture_output=True, text=True,
    )
    # Differences of all pybind11 classes that stubs leave out: metaclass, pickling, construction.
    ours = [
        line
        for line in done.stdout.splitlines()
        if not re.search(r"metaclass differs|\.__(getstate|setstate|init|hash|array)__ ", line)
        # Calls of Python whose **request stands for the keywords that the stub of vog._vog lists.
        and not re.search(r"^vog\.(_picture|_projection)\.(render|recolor) is inconsistent", line)
        # Modules with types of their own, whose names of typing are no types when they run.
        and not re.search(r"^vog\.(_files|_grids|_load|_messages|_picture|_projection|_readers|_show|_units|_vtk_files|report)\.\w+(@\d+)? is not (a type|present at runtime)", line)
    ]
    assert done.stdout and not ours, "\n".join(ours) + done.stderr


def test_users_code_checks(tmp_path):
    pytest.importorskip("mypy", reason="needs mypy (apt install mypy)")
    (tmp_path / "good.py").write_text(
        """from typing import Any

import numpy as np
import vog

volume = vog.Volume.from_numpy(np.ones((8, 8, 8)), voxel_size=(1, 2, 3), origin=[0, 0, 0])
model: vog.Gaussians = vog.convert([volume, volume], block=4)[::2] + vog.convert(volume, lod=1)
model.density *= 2
picture = vog.render(model, vog.Camera.paper_view(model), (64, 32), extinction="auto", tf=vog.TransferFunction("jet"))
psnr: float = vog.compare(picture.depth, picture).psnr_db + vog.compare(picture.image, picture.depth.shade()).ssim
array: np.ndarray[Any, Any] = np.asarray(picture.recolor(tf="viridis", background=(1, 1, 1), color_bar=True).image)
again: vog.Picture = vog.Scene(model).render(**picture.request)
scale: "vog.Scale | None" = vog.render(volume, show="maximum", range=(0, 1), clip=np.zeros((2, 3))).scale
with vog.threads(2):
    vog.Points.from_numpy(np.zeros((3, 3)), attributes={"mass": [1, 2, 3]}).save("points.csv")
"""
    )
    (tmp_path / "bad.py").write_text(
        """import vog

vog.convert(3)
vog.convert(vog.sample_cloud(), blocks=4)
vog.render(vog.sample_cloud(), value_range=(0, 1))
depth: vog.Image = vog.render(vog.sample_cloud())
"""
    )

    def check(name):
        return subprocess.run(
            [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), name],
            cwd=tmp_path, capture_output=True, text=True,
        )

    good, bad = check("good.py"), check("bad.py")
    assert good.returncode == 0, good.stdout + good.stderr
    assert "Found 4 errors" in bad.stdout, bad.stdout
