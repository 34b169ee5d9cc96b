"""Plots and a page for an evaluation: python -m vog.report FOLDER, with the FOLDER of `vog evaluate -o` or vog.evaluate. Needs Matplotlib."""
import html
import json
import math
import pathlib
import sys
from typing import Any, Dict, List, Sequence, Tuple, Union
from urllib.parse import quote

from ._packages import need

_Row = Dict[str, Any]
_Columns = Sequence[Tuple[str, str, str]]  # heading, keys of the value, format
_SERIES = {"mean": "paper's amplitude", "mass": "mass conserved", "uniform": "moments, uniform cells", "adaptive": "moments, adaptive cut"}
_LEVELS, _BOXES = [f"lod{n}" for n in range(1, 6)], [f"sigma{n}" for n in range(1, 4)]
# The paper's tables 1 to 4, column "smoke": dB, frames per second, Gaussians, share of the bounding box's voxels.
_PAPER = {
    "lod1": (24.11, 235.5, "890 K", "32.2 %"), "lod2": (23.41, 324, "871 K", "31.6 %"), "lod3": (25.70, 327, "868 K", "31.4 %"),
    "lod4": (22.43, 194, "153 K", "5.5 %"), "lod5": (20.87, 227, "2.5 K", "0.09 %"),
    "sigma1": (25.70, 327, "868 K", ""), "sigma2": (22.00, 285, "868 K", ""), "sigma3": (19.23, 254, "868 K", ""),
}  # fmt: skip
_ABOUT = """From the view paper, or mean and worst over all views. V = 1 - exp(-T) is compared as 8-bit grey, over all pixels or those that the
data cover; RGB under the transfer function. Frames per second are those of drawing T, without loading and shading. """
_ABOUT_PAPER = "The paper's figures: on a GeForce RTX 4090 Laptop GPU; it states no view, exposure, transfer function or resolution."
_STYLE = """body { margin: 2rem auto; max-width: 80rem; padding: 0 1rem; font: 16px/1.5 system-ui, sans-serif; color: #1d2329 }
table { border-collapse: collapse; font-size: .85rem; display: block; overflow-x: auto } th { color: #5b6670 }
th, td { padding: .3rem .6rem; text-align: right; border-bottom: 1px solid #d9dee3 } th:first-child, td:first-child { text-align: left }
td { white-space: nowrap } .strip { display: flex; flex-wrap: wrap; gap: .5rem } figure { margin: 0; width: 10.5rem; font-size: .8rem } img { width: 100% }
.plot { width: 38rem }"""
_COUNT = [("Gaussians", "gaussians", ",.0f"), ("of active voxels", "of_active", ".3g"), ("kB", "kB", ",.1f")]
_QUALITY = [*_COUNT, ("V, dB", "psnr", ".2f"), *((f"{name}, dB ({part})", f"{part} {key}", ".2f")
            for name, key in (("V", "psnr_v_db"), ("covered", "psnr_v_covered_db")) for part in ("mean", "worst")),
            ("RGB, dB", "paper psnr_rgb_db", ".2f"), ("L2 of T", "paper relative_l2", ".4f"), ("bias of T", "paper bias", ".3f"),
            ("frames/s", "speed", ".1f"), ("convert, ms", "convert_ms median", ".1f")]  # fmt: skip
_THEIRS = [(f"the paper: {name}", f"theirs {n}", "") for n, name in enumerate(("dB", "frames/s", "Gaussians", "of the box"))]


def _number(value: Any) -> float:
    """A number of the results, in which null is infinite."""
    return math.inf if value is None else float(value)


def _completed(row: _Row, data: "Dict[str, Any]", paper: "Dict[str, Any]") -> _Row:
    """A row with the numbers that tables and plots show."""
    views, figures = row["views"], ("psnr_v_db", "psnr_v_covered_db")
    over = {key: [_number(view[key]) for view in views] for key in figures}
    return {
        **row, "paper": views[0], "mean": {key: sum(over[key]) / len(views) for key in figures}, "worst": {key: min(over[key]) for key in figures},
        "of_active": row["gaussians"] / max(data["active_voxels"], 1), "of_box": row["gaussians"] / max(data["bounding_voxels"], 1),
        "kB": row["bytes"] / 1000, "speed": 1000 / max(views[0]["render_ms"]["median"], 1e-9), "psnr": _number(views[0]["psnr_v_db"]),
        # The paper has one amplitude: its figures stand beside the series of that amplitude.
        "theirs": paper.get(row["step"], ("",) * 4) if row["series"] == "mean" else ("",) * 4,
    }  # fmt: skip


def _step(step: str) -> str:
    names = {"lod": "LOD {}", "sigma": "σ = {}", "block": "{}³"}
    return next((text.format(step[len(word) :]) for word, text in names.items() if step.startswith(word) and "." not in step), step)


def _cell(row: _Row, keys: str, form: str) -> str:
    value: Any = row
    for key in keys.split("\t" if "\t" in keys else " "):
        value = value[int(key)] if isinstance(value, tuple) else value[key]
    return format(_number(value), form).replace("inf", "∞") if form else str(value)


def _table(title: str, rows: "List[_Row]", columns: _Columns, about: str = "") -> str:
    """A table with a heading for each series; empty without rows."""
    body, series = "", ""
    for row in rows:
        if row["series"] != series:
            series = row["series"]
            body += f"<tr><th colspan={len(columns) + 1}>{html.escape(_SERIES.get(series, series))}"
        body += f"<tr><td>{html.escape(_step(row['step']) + ': ' + row['label'])}"
        body += "".join(f"<td>{html.escape(_cell(row, keys, form))}" for _, keys, form in columns)
    head = "".join(f"<th>{html.escape(name)}" for name in ("", *(name for name, _, _ in columns)))
    return f"<h2>{title}</h2><p>{about}<table><tr>{head}{body}</table>\n" if rows else ""


def _tables(rows: "List[_Row]", paper: "Dict[str, Any]") -> str:
    of_paper = [row for row in rows if row["series"] in ("mean", "mass")]
    moments = [row for row in rows if row["series"] in ("uniform", "adaptive")]
    theirs, about, page = (_THEIRS if paper else []), _ABOUT + (_ABOUT_PAPER if paper else ""), ""
    for title, steps in (("1. Dense leaves: block size", _LEVELS[:3]), ("2. Sparse leaves: strategy", _LEVELS[2:]), ("3. Extent of the boxes", _BOXES)):
        page += _table(title, [row for row in of_paper if row["step"] in steps], [*_QUALITY, *theirs[:3]], about)
    levels = [row for row in of_paper if row["step"] in _LEVELS and row["series"] == of_paper[0]["series"]]  # both have the same counts
    page += _table("4. Gaussians against voxels", levels, [*_COUNT, ("of the box's voxels", "of_box", ".3g"), *theirs[2:]])
    page += _table("5. Moments", moments, _QUALITY, _ABOUT)
    page += _table("Models", [row for row in rows if row not in of_paper and row not in moments], _QUALITY, _ABOUT)
    for key, title, figures in (("fields", "Maps of fields", ("mean_l2", "deviation_l2")), ("volume", "Volume rendering", ("psnr_rgb_db", "ssim"))):
        shown = [row for row in rows if key in row]
        columns = [(f"{name}: {figure} ({word})", "\t".join((key, name, figure, word)), ".4g")
                   for name in (shown[0][key] if shown else ()) for figure in figures for word in ("mean", "worst")]  # fmt: skip
        page += _table(title, shown, [*_COUNT, *columns], "Mean and worst over the views.")
    voxels = [(name, f"voxels {name}", ".4g") for name in ("relative_l2", "psnr_db", "mean", "worst")]
    return page + _table("Voxels", [row for row in rows if "voxels" in row], [*_COUNT, *voxels])


def _plots(rows: "List[_Row]", paper: "Dict[str, Any]", folder: pathlib.Path) -> str:
    figure_type = need("matplotlib.figure", "vog.report").Figure
    (folder / "plots").mkdir(exist_ok=True)
    steps, page = [*_LEVELS, *_BOXES], ""
    for name, x, y, label in (("levels", "", "psnr", "PSNR of V, dB"), ("speed", "", "speed", "frames per second"),
                              ("gaussians", "gaussians", "psnr", "PSNR of V, dB"), ("bytes", "bytes", "psnr", "PSNR of V, dB")):  # fmt: skip
        axes = figure_type(figsize=(6.4, 4.4), layout="constrained").add_subplot()
        for n, series in enumerate(dict.fromkeys(row["series"] for row in rows)):
            shown = [row for row in rows if row["series"] == series and math.isfinite(row[y])]
            groups = [sorted((row for row in shown if row["aabb_sigma"] == 0), key=lambda row: row[x])] if x else [
                [row for row in shown if row["step"] in part and series in ("mean", "mass")] for part in (_LEVELS, _BOXES)]  # fmt: skip
            for first, group in zip((True, False), filter(None, groups)):
                places = [row[x] if x else steps.index(row["step"]) for row in group]
                axes.plot(places, [row[y] for row in group], "o-", color=f"C{n}", label=_SERIES.get(series, series) if first else None)
        for part in (_LEVELS, _BOXES) if paper and not x else ():
            axes.plot([steps.index(step) for step in part], [paper[step][y == "speed"] for step in part], "o--", color="0.5", label="the paper"[: 9 * (part is _LEVELS)])
        if not axes.lines:
            continue
        axes.set(ylabel=label, xlabel=x, xscale="log" if x else "linear", yscale="log" if y == "speed" else "linear")
        if not x:
            axes.set_xticks(range(len(steps)), [_step(step) for step in steps], rotation=30)
        axes.grid(alpha=0.3)
        axes.legend()
        axes.figure.savefig(folder / "plots" / f"{name}.svg")
        page += f"<img class=plot alt='{label}' src='plots/{name}.svg'>\n"
    return f"<h2>Plots</h2><p>From the view paper.<br>{page}"


def _pictures(rows: "List[_Row]", folder: pathlib.Path) -> str:
    page = ""
    for view in ("paper", "inside"):
        page += f"<h2>Pictures: {view}</h2><p>Differences are V of the model minus that of the voxels, from -20/255 to 20/255.\n"
        for step in dict.fromkeys(row["step"] for row in rows):
            strip = [(f"reference-{view}", "voxels")]
            for row in (row for row in rows if row["step"] == step):
                name, series = f"{row['series']}-{step}-{view}", _SERIES.get(row["series"], row["series"])
                psnr = next(_number(result["psnr_v_db"]) for result in row["views"] if result["view"] == view)
                strip += [(name, f"{series}, {psnr:.2f} dB"), (f"{name}-difference", "difference")]
            shown = "".join(f"<figure><img loading=lazy alt='' src='pictures/{quote(name)}.png'><figcaption>{html.escape(text)}</figcaption></figure>"
                            for name, text in strip if (folder / "pictures" / f"{name}.png").exists())  # fmt: skip
            page += f"<h3>{html.escape(_step(step))}</h3><div class=strip>{shown}</div>\n"
    return page


def write_report(folder: "Union[str, pathlib.Path]") -> pathlib.Path:
    """Draws plots of an evaluation into FOLDER/plots and writes FOLDER/report.html: plots, tables, and pictures beside each other.

    folder  of `vog evaluate -o` or vog.evaluate, also of one that was interrupted

    Raises ImportError without Matplotlib. Returns the page's path.
    """
    folder = pathlib.Path(folder)
    results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    data, settings, machine = results["data"], results["settings"], results["machine"]
    paper = _PAPER if (data["active_voxels"], data["leaves"]) == (1049275, 3117) else {}
    rows = [_completed(row, data, paper) for row in results["rows"]]
    voxels = f"{data['active_voxels']:,} active voxels of {data['bounding_voxels']:,} in the bounding box, {data['leaves']:,} leaves, {data['tiles']:,} tiles"
    kind, count = ("voxels", voxels) if data["bounding_voxels"] else ("cells", f"{data['active_voxels']:,} cells")
    title = html.escape(f"Gaussians against {kind}: {data['title']}")
    facts = f"""{count}. {settings['width']}×{settings['height']} pixels, extinction {settings['extinction']}, transfer function
        {settings['tf']}, {machine['threads']} threads of {machine['processor']}."""
    views = "".join(f"<tr><td>{html.escape(view['name'])}<td>{100 * view['covered']:.1f} %<td>{view['extinction']:.4g}"
                    f"<td>{view['reference_ms']['median']:.1f}" for view in results["views"])  # fmt: skip
    page = f"<!doctype html><html lang=en><meta charset=utf-8><title>{title}</title><style>{_STYLE}</style><h1>{title}</h1><p>{html.escape(facts)}\n"
    page += _plots(rows, paper, folder) + _tables(rows, paper)
    page += f"<h2>The views</h2><table><tr><th>view<th>covered<th>extinction<th>reference, ms{views}</table>\n" + _pictures(rows, folder)
    (folder / "report.html").write_text(page, encoding="utf-8")
    return folder / "report.html"


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit("usage: python -m vog.report FOLDER, of vog evaluate")
    try:
        print(write_report(sys.argv[1]))
    except (ImportError, OSError) as error:
        sys.exit(str(error))
    except (LookupError, StopIteration, TypeError, ValueError) as error:
        sys.exit(f"{sys.argv[1]}/results.json: not the results of vog evaluate: {type(error).__name__} {error}")
