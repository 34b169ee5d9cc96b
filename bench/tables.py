#!/usr/bin/env python3
"""Prints the tables of one bench run and writes them between the markers of docs/performance.md.

usage: bench/tables.py [--quick] RESULTS_FOLDER docs/performance.md

--quick: prints only. Exits with 1 if a bench reports a wrong picture or model.
"""
import json
import pathlib
import platform
import sys

BEGIN, END = "<!-- tables: written by bench/run.sh -->\n", "<!-- end of tables -->\n"


def cpu_name():
    for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor()


class Runs:
    """Aggregates of a bench by name: {name: {min, median, max: the JSON of that aggregate}}."""

    def __init__(self, file):
        report = json.loads(file.read_text())
        self.context = report["context"]
        self.by_name = {}
        for run in report["benchmarks"]:
            if run.get("error_occurred"):
                sys.exit(f"{file.stem}: {run['name']}: {run['error_message']}")
            if "aggregate_name" in run:
                name = run["run_name"].split("/min_time")[0].split("/repeats")[0]
                name = name.replace("/real_time", "").replace("/process_time", "")
                self.by_name.setdefault(name, {})[run["aggregate_name"]] = run

    def ms(self, name, which="median"):
        return self.by_name[name][which]["real_time"]

    def spread(self, name):
        return " / ".join(f"{self.ms(name, which):.2f}" for which in ("min", "median", "max"))

    def field(self, name, key):
        return self.by_name[name]["median"][key]

    def matching(self, start):
        return [name for name in self.by_name if name.startswith(start)]


def table(head, rows):
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows]) + "\n"


def splat_tables(runs, verified):
    """Tables of splat_bench. verified: runs of reference_bench, whose time is used where it has this size: it
    checks its picture and warms up; the first call of splat_bench was measured to take twice as long."""
    reference = runs.matching("reference/")[0]
    size = reference.split("/")[1]
    same = f"render/constant/size:{size.split('x')[0]}/threads:0"
    yardstick, reference = (verified, same) if same in verified.by_name else (runs, reference)
    targets = [name.split("/")[2] for name in runs.matching("project/block2/")]
    best = targets[0]
    models, speedups, out = ("block2", "block4", "block8"), [], []
    rows = []
    for model in models:
        all_threads = f"splat/{model}/{best}/{size}/threads:0"
        one, two = (f"splat/{model}/{best}/{size}/threads:{n}" for n in (1, 2))
        ms = runs.ms(all_threads)
        threads = runs.field(all_threads, "threads")
        rows.append((model, f"{runs.field(one, 'gaussians'):,.0f}", runs.spread(all_threads),
                     f"{yardstick.ms(reference) / ms:.1f}x", f"{runs.ms(one) / runs.ms(two):.2f}x",
                     f"{runs.field(one, 'rows'):,.0f}",
                     f"{1e6 * runs.ms(one) / runs.field(one, 'rows'):.2f}"))
        scalar = runs.ms(f"splat/{model}/scalar/{size}/threads:1")
        speedups.append([model] + [
            f"{runs.ms(f'splat/{model}/{target}/{size}/threads:1'):.2f} "
            f"({scalar / runs.ms(f'splat/{model}/{target}/{size}/threads:1'):.1f}x)"
            for target in targets])
    out.append(f"{size}, {best}, {threads:.0f} threads; the reference takes {yardstick.spread(reference)} ms "
               "(min / median / max).\n\n" +
               table(("model", "Gaussians", "splat, ms: min / median / max", "faster than the reference",
                      "two threads over one", "rows of 16 px", "ns per row, one thread"), rows))
    out.append(f"One thread, {size}: median ms, and the speedup over one SIMD lane.\n\n" +
               table(["model"] + targets, speedups))
    scales = [name for name in runs.matching("splat/") if name.endswith("threads:0") and
              (f"/{size}/" not in name or "/screen/" in name)]
    out.append("All scenes, all threads.\n\n" + table(
        ("model", "size", "Gaussians", "splats", "rows of 16 px", "ms: min / median / max", "peak MiB"),
        [(name.split("/")[1], name.split("/")[3], f"{runs.field(name, 'gaussians'):,.0f}",
          f"{runs.field(name, 'splats'):,.0f}", f"{runs.field(name, 'rows'):,.0f}", runs.spread(name),
          f"{runs.field(name, 'peak_mib'):.0f}") for name in scales]))
    out.append("Single stages, one thread: projection of block2, and the inner loop with data in the first-level "
               "cache.\n\n" + table(
                   ("target", "ns per Gaussian projected", "ns per row of 16 px"),
                   [(target,) + tuple(f"{1e9 / runs.field(f'{stage}/{target}', 'items_per_second'):.2f}"
                                      for stage in ("project/block2", "rows")) for target in targets]))
    return out, yardstick.ms(reference), {
        model: runs.ms(f"splat/{model}/{best}/{size}/threads:0") for model in models}


def plain_table(title, runs, rate):
    rows = []
    for name in runs.by_name:
        value = runs.by_name[name]["median"].get(rate)
        rows.append((name, runs.spread(name), f"{value / 1e6:,.1f}" if value else ""))
    unit = {"items_per_second": "million items / s", "bytes_per_second": "MB / s"}[rate]
    return f"{title}\n\n" + table(("bench", "ms: min / median / max", unit), rows)


def others(results, reference_ms, splat_ms):
    rows = []
    vtk = results / "vtk.lines"
    if vtk.exists():
        ms = json.loads(vtk.read_text())["render_ms"]
        rows.append(("VTK's CPU volume mapper, 1024x1024",
                     " / ".join(f"{ms[which]:.0f}" for which in ("min", "median", "max")),
                     f"{ms['median'] / reference_ms:.1f}x",
                     ", ".join(f"{model} {ms['median'] / t:.0f}x" for model, t in splat_ms.items())))
    vdb = results / "vdb_render.lines"
    if vdb.exists():
        run = json.loads(vdb.read_text().splitlines()[-1])
        ms = run["vdb_render_ms"]
        rows.append(("vdb_render, 512x512 (it also shades)",
                     " / ".join(f"{ms[which]:.0f}" for which in ("min", "median", "max")),
                     f"{run['ratio_of_medians']}x", ""))
    if not rows:
        return []
    return ["Other renderers of the same volume and view, in the same run, all threads.\n\n" + table(
        ("renderer", "ms: min / median / max", "reference is faster by", "splat is faster by"), rows)]


def main():
    arguments = [a for a in sys.argv[1:] if a != "--quick"]
    quick = len(arguments) + 1 < len(sys.argv)
    results, page = pathlib.Path(arguments[0]), pathlib.Path(arguments[1])
    splat = Runs(results / "splat.json")
    context = splat.context
    tables, reference_ms, splat_ms = splat_tables(
        splat, Runs(results / "reference.json"))
    tables += others(results, reference_ms, splat_ms)
    for name, title, rate in (("reference", "The reference.", "items_per_second"),
                              ("trace", "The ray tracer, 1024x1024.", "items_per_second"),
                              ("convert", "The paper's conversion, without reading the file.", "items_per_second"),
                              ("moments", "Moments, without reading the file.", "items_per_second"),
                              ("io", "Files, cached by the operating system.", "bytes_per_second"),
                              ("points", "A million particles (`points_bench` alone: also 10 million).",
                               "items_per_second"),
                              ("lod", "Clouds of increasing size, and level-of-detail cuts through their hierarchies "
                                      "([scaling.md](scaling.md)).", "items_per_second")):
        tables.append(plain_table(title, Runs(results / f"{name}.json"), rate))
    text = (f"`bench/run.sh` at commit {context['commit']}: {cpu_name()}, {context['num_cpus']} cores; "
            f"{context['date'][:10]}.\n\n" + "\n".join(tables))
    print(text)
    if quick:
        return
    old = page.read_text()
    before, rest = old.split(BEGIN)
    page.write_text(before + BEGIN + "\n" + text + "\n" + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
