"""Each binding with every kind of argument: it ends in a result or in an exception of one clear line, never in a crash."""
import re
import subprocess
import sys

from conftest import SOURCE

# Runs in a process of its own: a crash ends that one, and its last line says where.
SCRIPT = r'''
import ast, faulthandler, functools, inspect, pathlib, sys, warnings
import numpy as np
import vog
from vog import _vog
faulthandler.enable()
warnings.simplefilter("ignore")
rng = np.random.default_rng(1)
array = rng.random((8, 8, 8)).astype("f4")
volume = vog.Volume.from_numpy(array, voxel_size=0.5)
fine = vog.Volume.from_numpy(array, voxel_size=0.25, origin=(-0.125,) * 3)
levels = vog.Levels([volume, fine])
model = vog.convert(volume, block=4)
points = vog.Points.from_numpy(rng.random((20, 3)), attributes={"mass": np.ones(20)})
camera = vog.Camera.orbit(volume)
picture = vog.render(model, size=16)
depth, image = picture.depth, picture.image
maps = vog.render(model, size=16, show="mean", field="density")
light = vog.render(model, size=16, show="volume")
tf = vog.TransferFunction("viridis")
volume.save("a.vdb"), model.save("a.ply"), model.save("a.vogz"), points.save("a.xyz"), depth.save("a.exr"), image.save("a.png")
tf.save("a.json"), camera.save("c.json")

class Odd:
    def __len__(self): return 3
    def __getitem__(self, n): raise RuntimeError("odd")
    def __float__(self): raise RuntimeError("odd")
    def __fspath__(self): return 5

cyclic = []
cyclic.append(cyclic)
KINDS = {
    "none": None, "true": True, "zero": 0, "minus": -1, "two": 2, "half": 0.5, "nan": float("nan"), "inf": float("inf"), "huge": 10**30,
    "complex": 1j, "empty text": "", "text": "nothing", "auto": "auto", "own": "density", "zero byte": "a\0b", "bytes": b"nothing", "path": pathlib.Path("a.vdb"),
    "folder": pathlib.Path("."), "list": [], "numbers": [1, 2, 3], "pair": (1, 2), "six": [0, 0, 0, 1, 1, 1], "box": [[0, 0, 0], [2, 2, 2]], "texts": ["a", "b"],
    "mixed": [1, "a", None], "cyclic": cyclic, "dict": {}, "fields": {"density": array}, "bad fields": {"density": 3}, "number key": {1: array},
    "vectors": {"v": rng.random((8, 8, 8, 3))}, "levels fields": {"density": [array, array]}, "file field": {"density": "density"},
    "0-d": np.float64(2), "0-d array": np.array(2.0), "row": np.arange(3.0), "rows": np.zeros((0, 3)), "cube": array, "ints": array.astype(int),
    "objects": np.array([None, 1], dtype=object), "texts array": np.array(["a"]), "complex array": np.array([1j]), "dates": np.array(["2020-01-01"], dtype="M8[D]"),
    "masked": np.ma.masked_array(array, array > 0.5), "big end": array.astype(">f8"), "strided": np.zeros((16, 16, 16))[::2, ::-2, ::2],
    "structured": np.zeros(3, dtype=[("a", "f4")]), "read only": np.broadcast_to(np.float32(1), (8, 8, 8)), "nan array": np.full((8, 8, 8), np.nan),
    "volume": volume, "levels": levels, "volumes": [volume, fine], "model": model, "points": points, "field": model.fields["density"],
    "camera": camera, "depth": depth, "image": image, "picture": picture, "maps": maps, "light": light, "tf": tf, "function": lambda *_: None, "raises": lambda *_: 1 / 0, "type": int,
    "class": vog.Volume, "object": object(), "odd": Odd(), "generator": (n for n in range(3)), "range": range(3), "set": {1}, "slice": slice(0, 2), "module": sys,
}
# What a parameter has where another one is tried.
USUAL = {
    "data": volume, "model": model, "models": model, "volume": volume, "volumes": [volume], "file": None, "files": "a.vdb", "folder": "out", "reference": depth,
    "image": depth, "array": array, "blocks": [((0, 0, 0), array)], "position": rng.random((5, 3)), "depth": np.zeros((4, 4)), "colors": np.zeros((4, 3)), "colormap": "viridis",
    "name": "n", "color": [[0, 0, 0, 0], [1, 1, 1, 1]], "tf": "viridis", "v": 0.5, "eye": (0, 0, 5), "mean": [[0, 0, 0]], "scale": [[1, 1, 1]], "density": [1],
    "index": 0, "count": 1, "other": model, "budget": 3, "value": 1, "voxel_size": 0.5,
}
FILES = {"Volume": "a.vdb", "Levels": "a.vdb", "Points": "a.xyz", "Gaussians": "a.ply", "DepthImage": "a.exr", "Image": "a.png", "TransferFunction": "a.json", "Camera": "c.json"}
SAVED = {**{name: "saved" + file[1:] for name, file in FILES.items()}, "Picture": "saved.npy", "export_html": "saved.html", "export_splats": "saved.ply"}
OBJECTS = {"Volume": volume, "Levels": levels, "Points": points, "Gaussians": model, "DepthImage": depth, "Image": image, "TransferFunction": tf,
           "Camera": camera, "Picture": maps, "threads": vog.threads(1), "Field": model.fields["density"]}
SLOW = {"sample_cloud", "sample_explosion", "sample_head", "sample_fire", "sample_levels", "evaluate", "convert measure", "convert refine_seconds"}  # calls, or parameters of one
# By itself a conversion draws 12 views of 256 x 256 pixels to measure its error, 0.7 s of CPU: only for the parameters of WITHOUT.
REQUIRED = {"voxelize": {"voxel_size": 0.5}, "convert": {"block": 4}}
WITHOUT = {name: {"block"} for name in ("data", "budget", "error", "lod")}
THROWN = (vog.Error, TypeError, ValueError, LookupError, OSError, ImportError, AttributeError, OverflowError, ArithmeticError, RuntimeError, MemoryError)

def members():
    """(name, callable, parameters, first of class) of the module, by its stub."""
    stub = ast.parse(pathlib.Path(_vog.__file__).with_name("_vog.pyi").read_text())
    for item in stub.body:
        if getattr(item, "name", "_").startswith("_"): continue
        functions = [(None, item)] if isinstance(item, ast.FunctionDef) else [(item.name, f) for f in getattr(item, "body", []) if isinstance(f, ast.FunctionDef)]
        for owner, function in functions:
            kinds = {d.id if isinstance(d, ast.Name) else getattr(d, "attr", "") for d in function.decorator_list}
            if "property" in kinds or (function.name.startswith("_") and function.name not in ("__init__", "__getitem__", "__add__", "__call__", "__eq__")):
                continue
            a = function.args
            named = [x.arg for x in a.args]
            static = "staticmethod" in kinds
            if owner and not static: named = named[1:]
            needed = named[: len(named) - len(a.defaults)] if a.defaults else named
            needed = list(needed) + [x.arg for x, d in zip(a.kwonlyargs, a.kw_defaults) if d is None]
            target = getattr(vog, owner or function.name)
            if owner and function.name != "__init__": target = getattr(target if static else OBJECTS.get(owner), function.name, None)
            if target is None: continue
            if "setter" in kinds:
                yield f"{owner}.{function.name}=", (lambda o, n: lambda value: setattr(OBJECTS[o], n, value))(owner, function.name), ["value"], ["value"], owner
                continue
            yield (f"{owner}.{function.name}" if owner else function.name), target, named + [x.arg for x in a.kwonlyargs], needed, owner
    # Functions of Python: all keywords of T and volumes; for the other quantities the keywords that they read in their own way.
    keywords = list(inspect.signature(vog.render).parameters)
    some = ["field", "fields", "tf", "range", "units"]
    def draw(**given): return vog.render(**{"size": 8, **given})
    yield "Scene", lambda **given: vog.Scene(**given).render(size=8), ["data", "fields"], ["data"], None
    yield "Scene.render", lambda **given: vog.Scene(model).render(**{"size": 8, **given}), ["camera", "size", "progress"], [], None
    for data, show, named in ((model, "T", keywords), (model, "volume", keywords[3:]), (model, "mean", some), (model, "maximum", some), (model, "column", some),
                              (volume, "T", ["step", "samples", "fields"]), (volume, "mean", some), (volume, "volume", some)):
        base = {"data": data, "show": show, **({"field": "density"} if show == "mean" else {})}
        yield f"render {show}", functools.partial(draw, **base), named, [], None

def usual(name, parameter, owner):
    if parameter == "file":
        short = name.rsplit(".", 1)[-1]
        return FILES.get(owner, "a.vdb") if short == "load" else SAVED.get(owner or name, "saved.vdb") if short != "grid_names" else "a.vdb"
    if name in ("compare", "compare_shaded", "difference_map"): return {"tf": "viridis"}.get(parameter, picture)
    if owner == "Camera" and parameter == "data": return model  # keeps where its mass is: a volume looks for it in each call
    if name == "evaluate" and parameter == "data": return None  # a whole evaluation takes minutes
    if name == "Image.from_numpy": return np.zeros((4, 4, 3))
    if name == "TransferFunction.from_matplotlib": return "viridis"
    return USUAL.get(parameter, 1)

tried, wrong = 0, []
def attempt(name, call, label, positional, named):
    global tried
    print("AT", name, label, flush=True, file=sys.stderr)
    tried += 1
    try:
        call(*positional, **named)
    except THROWN as error:
        text = str(error.args[0]) if isinstance(error, KeyError) and error.args else str(error)
        if ("\n" in text or not text.strip() or "Unable to" in text or len(text) > 1500) and "odd" not in text: wrong.append(1), print(name, label, type(error).__name__, text[:300], sep=" | ", flush=True)

only = set(sys.argv[1:])
for name, call, parameters, needed, owner in members():
    if only and name not in only: continue
    base = {p: usual(name, p, owner) for p in needed}
    base.update(REQUIRED.get(name, {}))
    for parameter in parameters:
        for label, value in KINDS.items():
            if SLOW & {name.split(".")[0], f"{name} {parameter}"} and label not in ("none", "text", "list", "odd", "model", "minus", "cube"): continue
            if parameter in ("size", "width", "height", "resolution") and label in ("huge",): continue
            given = {**{key: one for key, one in base.items() if key not in WITHOUT.get(parameter, ())}, parameter: value}
            first = name.endswith(("__getitem__", "__add__", "__call__", "__eq__", "="))
            attempt(name, call, f"{parameter}={label}", list(given.values()) if first else [], {} if first else given)
        if not parameters: attempt(name, call, "", [], {})
print(f"tried {tried}")
'''

# Calls that touch Python's objects: none may stand in the body of unlocked().
TOUCHES = re.compile(
    r"\bpy::|\b(levels_of|size_of|numbers_in|numbers_of|rows_of|row_of|cast_to|described|background_of|transfer_function_of|box_to_view|sampled_fields|"
    r"voxel_fields_of|scene_of_data|warn|refuse_data|extinction_of|progress_of)\(|\.cast<|\.attr\("
)


def test_every_binding_survives_every_kind_of_argument(tmp_path):
    done = subprocess.run([sys.executable, "-c", SCRIPT], cwd=tmp_path, capture_output=True, text=True, timeout=550)
    last = done.stderr.strip().splitlines()[-40:]
    assert done.returncode == 0, f"ended with {done.returncode} at {[line for line in last if line.startswith('AT')][-1:]}:\n" + "\n".join(last)
    *wrong, count = done.stdout.strip().splitlines()
    assert int(count.split()[1]) > 5000
    assert not wrong, f"{len(wrong)} messages:\n" + "\n".join(wrong[:40])


def test_fields_of_levels_are_fitted():
    # Ended in a crash while the lock was released.
    import vog

    levels = vog.sample_levels(64)
    report = {}
    model = vog.convert(levels, joint_field="volume", budget=300, report=report)
    assert len(model) <= 300 and report["joint"]["error_after"] > 0
    again = vog.convert([levels[n] for n in range(len(levels))], joint_field="volume", budget=300)
    assert len(again) == len(model)


def test_no_python_object_is_touched_without_the_lock():
    for file in sorted((SOURCE / "python").glob("*.cpp")):
        text = file.read_text()
        for match in re.finditer(r"\bunlocked\(", text):
            depth, end = 1, match.end()
            while depth:
                depth += {"(": 1, ")": -1}.get(text[end], 0)
                end += 1
            found = TOUCHES.search(text, match.end(), end)
            assert not found, f"{file.name}:{text.count(chr(10), 0, match.start()) + 1}: {found.group()} inside of unlocked()"
