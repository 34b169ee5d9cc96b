#!/usr/bin/env python3
"""Every option of every command, on every kind of input and output: it changes the result, or is refused in one line.

The options come from `vog COMMAND --help-all`, so that a new one is tried without a change here; it needs a value in
VALUES, unless option_pairs_test.py has one. Each option must also have an effect in one case at least.
VOG_ALL_EFFECTS=1 tries those of vog view and vog-mpi, too, and every option in the cases that take longest (scripts/nightly.sh).
usage: VOG_COMMAND=build/release/apps/cli/vog option_effects_test.py [COMMAND...]
"""

import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import command_server
import option_pairs_test as pairs
from command_server import VOG
from option_effects_inputs import make_inputs
from serve_test_case import Server

VOG_MPI = Path(VOG).resolve().parents[1] / "mpi" / "vog-mpi"
MPI_ENVIRONMENT = {**os.environ, "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
SECONDS = 120

# By design these change no byte of a result: words about it, its speed, and what a run that ends early leaves.
PRESENTATION = {"--help", "--help-all", "--json", "--verbose", "--threads", "--memory", "--set scratch", "--repeat",
                "--resume", "--again", "--open"}

# Values that differ from the default, where those of option_pairs_test.py do not; COMMAND OPTION goes before OPTION.
VALUES = {
    "--renderer": "trace", "--interpolation": "linear", "--scale": "log|linear", "--view": "+x", "--set kappa": "0.2",
    "--set aabb-sigma": "0.5", "--columns": "y,x,z", "--value": "weight", "--grid": "temperature", "voxelize --grid": "density_L1", "--mask": "density_L1", "--labels": "{made}/labels.nrrd",
    "--set rounding": "0.05", "--set step": "0.1", "export --units": "world|box", "export --as": "3dgs|volprim", "export --iso": "0.03|0.02", "export --voxel-size": "0.02", "--pixel-error": "40", "--set similarity": "0.9",
    "--set resolution": "0.5", "--set clip-lights": "0", "view --size": "300x200", "--clip": "0,0,0,20,20,4", "--combine": "sum|mesh",
    "--window": "0.2,0.3", "--band": "0.1,0.4,red,0.5", "--iso": "0.2,#ffeedd", "--threshold": "0.2", "--gradient-opacity": "0:0,0.2:1", "--range": "0.1,0.3",
    "--error": "0.2", "--budget": "60", "--block": "4", "--set mass-threshold": "0.2", "--set strategy": "single",
    "--voxel-size": "3", "--unit-distance": "0.5", "--name": "another", "convert --field": "heat=value|heat=weight", "evaluate --field": "value", "--field": "temperature", "--for": "volume|none",
    "--set joint-steps": "3", "--set least-column": "0.5", "--set tree-depth": "2", "--port": "0", "--script": "{made}/tour.vog", "--set ui-scale": "2", "--set variance-threshold": "0.3",
    "--set opacity-threshold": "0.2", "--set minimum-radius": "2", "--set host": "0.0.0.0", "--set allow-origin": "https://example.org", "--tf": "viridis", "--set stop-transmittance": "0.5",
    "--title": "T", "--set hits-per-slab": "1", "--set precision": "0.2", "--set asymmetry": "0.5", "--samples": "3", "--slabs": "4", "--set levels": "1", "--refine": "0.05",
    "--plane": "y", "render --up": "z|y", "mpi render --up": "z|y", "--like": "{made}/small.nrrd", "--reference": "{made}/cloud.vdb", "--set seed": "5",
    "--request": "{made}/request.png", "--radius": "0.7", "--neighbours": "2", "--periodic": "30", "--set spread": "1.3", "--set background-value": "0.1", "--set soft-steps": "7", "--lod": "4",
}

# Effects that depend on the data: inputs in place of the case's, for both runs.
INPUTS = {
    ("--skip-nonfinite", "small.nrrd"): "nan.nrrd", ("--skip-nonfinite", "points.csv"): "nan.csv",
    ("--skip-nonfinite", "points.vdb"): "nan.csv", ("--clip-negative", "points.vdb"): "negative.csv --value weight",
    ("--clip-negative", "small.nrrd"): "negative.nrrd", ("--clip-negative", "points.csv"): "negative.csv --value weight",
    ("--skip-nonfinite", "model.ply"): "nan.ply", ("--skip-nonfinite", "many.ply"): "nan.ply",
    ("--skip-nonfinite", "other.ply"): "nan_too.ply", ("--combine", "small.nrrd"): "small.nrrd {made}/across.nrrd",
    ("--grid", "fire.vdb"): "amr.vdb", ("--grid", "small.nrrd"): "fire.vdb", ("--mask", "small.nrrd"): "amr.vdb --grid density_L0",
    ("--level-set-to-fog", "small.nrrd"): "sphere.vdb",
}
UNTRIED = set() if shutil.which("ffmpeg") else {"--set fps"}

# Says what is the default for one input.
STATED = {("page", "--site"), ("mpi page", "--site"), ("page", "--set levels"), ("mpi convert", "--no-hierarchy")}
# Refused by what the data then lack, which the message names.
OF_DATA = {"--no-fields", "--grid", "--field", "--mask", "--combine", "mesh", "--method", "--renderer"}
# Scans have no active voxel without a number.
NOTHING_LEFT = {("--skip-nonfinite", "volume"), ("--scale", "volume")}  # the default there is logarithmic

MODEL, VOLUME, TEXT, POINTS = "{made}/model.ply", "{made}/small.nrrd", "{made}/points.csv", "{made}/points.vdb"
SMALL = ["--size", "48x32"]
PICTURE = ["-o", "{out}/p.png", *SMALL]


def cases():
    """[command, words]: every kind of input and output, and for pictures every quantity and way to draw it.
    [command, words, quicker]: a case that takes a second or more. An option that changes the result of the quicker case is
    tried there alone."""
    for command, output in (("page", "p.html"), ("page", "site/"), ("pack", "m.vogz"), ("export", "m.spz"), ("export", "m.glb"), ("export", "m.usda")):
        yield command, [MODEL, "-o", "{out}/" + output]
    for layout in ("3dgs", "volprim"):
        yield "export", [MODEL, "-o", "{out}/m.ply", "--as", layout]
    for data, value in ((MODEL, "0.03"), (VOLUME, "0.2")):
        for surface in ("m.stl", "m.ply"):
            yield "export", [data, "-o", "{out}/" + surface, "--iso", value]
    for show in ("column", "mean --field temperature", "volume", "maximum", "volume --light head", "volume --shadows"):
        yield "page", [MODEL, "-o", "{out}/p.html", "--show", *show.split()]
    yield "page", ["{made}/many.ply", "-o", "{out}/p.html"]
    yield "page", [MODEL, "{made}/other.ply", "-o", "{out}/site/", "--site"]
    yield "page", [MODEL, "{made}/other.ply", "-o", "{out}/pages/"]
    yield "page", [MODEL, "-o", "{out}/p.html", "--orthographic"]
    yield "pack", [MODEL, "-o", "{out}/m.vogz", "--max-loss", "3"]
    yield "page", ["{made}/streams.vogz", "-o", "{out}/p.html", "--from", "https://data.example.org/m.vogz"]
    # A conversion without its size measures errors in twelve views.
    yield "export", [VOLUME, "-o", "{out}/m.spz"], [VOLUME, "-o", "{out}/m.spz", "--budget", "60"]
    for command, data, output in (("page", VOLUME, "p.html --budget 60"), ("page", VOLUME, "site/ --budget 60"), ("export", VOLUME, "m.spz --budget 60"),
                                  ("pack", VOLUME, "m.vogz --budget 60"), ("page", TEXT, "p.html"), ("pack", TEXT, "m.vogz"), ("export", TEXT, "m.spz"),
                                  ("export", POINTS, "m.spz")):
        yield command, [data, "-o", *("{out}/" + output).split()]
    yield "convert", [MODEL, "{made}/other.ply", "-o", "{out}/m.ply"]
    for output in ("m.ply", "m.vogz", "models/"):
        yield "convert", [VOLUME, "-o", "{out}/" + output, "--block", "4"]
        yield "convert", [TEXT, "-o", "{out}/" + output]
    yield "convert", [POINTS, "-o", "{out}/m.ply"]
    yield "convert", [TEXT, "-o", "{out}/p.xyz"]
    yield "convert", [TEXT, "-o", "{out}/m.ply", "--method", "paper", "--value", "weight"]
    yield "convert", [TEXT, "-o", "{out}/m.ply", "--budget", "100"]
    for strategy in ("smart", "variance", "neighbours", "tree"):
        yield "convert", [VOLUME, "-o", "{out}/m.ply", "--method", "paper", "--set", "strategy=" + strategy]
    for how in ("--for value --budget 30", "--budget 30", "--lod 2"):
        yield "convert", [VOLUME, "-o", "{out}/m.ply", *how.split()]
    for how, quicker in (("", "--budget 30"), ("--measure volume", "--budget 30"), ("--for value", "--for value --budget 30")):
        yield "convert", [VOLUME, "-o", "{out}/m.ply", *how.split()], [VOLUME, "-o", "{out}/m.ply", *quicker.split()]
    for data in (MODEL, VOLUME, TEXT, POINTS):
        yield "render", [data, *PICTURE]
        yield "render", [data, *PICTURE, "--show", "column"]
        yield "render", [data, "--depth-out", "{out}/t.exr", *SMALL]
    for show in ("mean --field temperature", "deviation --field temperature", "volume", "maximum"):
        yield "render", [MODEL, *PICTURE, "--show", *show.split()]
        yield "render", [MODEL, *PICTURE, "--show", *show.split(), "--renderer", "trace"]
        yield "render", [VOLUME, *PICTURE, "--show", *show.replace("temperature", "value").split()]
    yield "render", [MODEL, *PICTURE, "--renderer", "trace", "--set", "anyhit=collect"]
    yield "render", [MODEL, *PICTURE, "--renderer", "trace", "--set", "anyhit=collect", "--extinction", "300"]
    yield "render", [VOLUME, *PICTURE, "--interpolation", "linear"]
    yield "render", [MODEL, "--values-out", "{out}/v.npy", *SMALL, "--show", "mean", "--field", "temperature"]
    yield "render", [MODEL, *PICTURE, "--show", "volume", "--light", "head"]
    yield "render", [MODEL, *PICTURE, "--show", "volume", "--shadows"]
    for command, output in (("render", PICTURE), ("page", ["-o", "{out}/p.html"])):
        yield command, [MODEL, *output, "--show", "volume", "--shadows", "--clip", "0,0,0,20,20,4"]
    yield "render", [MODEL, *PICTURE, "--show", "slice", "--plane", "z=0"]
    yield "render", [VOLUME, *PICTURE, "--show", "slice", "--plane", "x=4", "--field", "value"]
    yield "render", [MODEL, *PICTURE, "--orthographic"]
    yield "render", [MODEL, "{made}/other.ply", "-o", "{out}/turn/", "--turntable", "2", *SMALL]
    yield "render", [MODEL, "{made}/other.ply", "-o", "{out}/pictures/", *SMALL]
    if shutil.which("ffmpeg"):
        yield "render", [MODEL, "-o", "{out}/turn.mp4", "--turntable", "2", *SMALL]
    for kind in ("a.exr b.exr", "a.png b.png", "a.npy b.npy", "field_a.exr field_b.exr", "a.exr b.exr --diff {out}/d.png"):
        yield "compare", [word if word[0] in "-{" else "{made}/" + word for word in kind.split()]
    # Without a model: some thirty conversions.
    yield "evaluate", [VOLUME, "-o", "{out}/e", "--size", "12"], [VOLUME, MODEL, "-o", "{out}/e", "--size", "12"]
    yield "evaluate", [VOLUME, MODEL, "-o", "{out}/e", "--size", "12"]
    yield "evaluate", [VOLUME, "{made}/tiny.ply", "-o", "{out}/e", "--size", "12", "--show", "volume"]
    yield "voxelize", [MODEL, "-o", "{out}/v.vdb", "--like", "{made}/fire.vdb"]
    yield "voxelize", [MODEL, "-o", "{out}/v.nvdb", "--voxel-size", "4"]
    for kind in ("cloud", "head", "amr", "fire", "explosion"):
        yield "sample", [kind, "{out}/s.vdb", "--size", "64"]
    yield "sample", ["particles", "{out}/s.csv", "--size", "8"]
    yield "info", [MODEL, VOLUME, TEXT]
    yield "doctor", []
    if "cpp-httplib" not in subprocess.run([VOG, "serve", "{made}"], capture_output=True, text=True).stderr:
        yield "serve", ["{made}/page.html"]
    if not os.environ.get("VOG_ALL_EFFECTS"):  # a window, and processes of MPI, begin slowly: minutes in all
        return
    for show in ("", "--show volume", "--show column", "--orthographic", "--show volume --light head"):
        yield "view", [MODEL, "--headless", "--script", "{made}/tour.vog", *show.split()]
    yield "view", [VOLUME, "--headless", "--script", "{made}/tour.vog"]
    yield "view", [TEXT, "--headless", "--script", "{made}/tour.vog"]
    if VOG_MPI.exists():
        yield "mpi convert", [VOLUME, "-o", "{out}/m.ply", "--block", "4"]
        yield "mpi convert", [TEXT, "-o", "{out}/m.ply", "--budget", "100"]
        yield "mpi page", [VOLUME, "-o", "{out}/site/", "--block", "4"]
        yield "mpi page", [MODEL, "-o", "{out}/site/"]
        yield "mpi render", [MODEL, *PICTURE]
        yield "mpi render", [VOLUME, *PICTURE, "--show", "volume"]
        yield "mpi evaluate", [VOLUME, "-o", "{out}/e", "--size", "12"]


def served(words):
    """Exit status, what a browser is sent, and errors of vog serve: its address, the fields of an answer."""
    server = Server(*words)
    if not server.port:
        _, out, errors = server.stop()
        return server.process.returncode, ({}, out), errors
    answer, body = server.get("/", Origin="https://example.org")
    fields = sorted(pair for pair in answer.getheaders() if pair[0] != "Date")
    _, _, errors = server.stop()
    return 0, ({"page": hashlib.sha256(body).hexdigest()}, (server.url.split(":")[1], 8080 <= server.port < 9000, fields)), errors


def without_record(data):
    """A PNG or an EXR without the words on how it was made: an option that changes no pixel has no effect."""
    if data.startswith(b"\x89PNG"):
        bare, at = data[:8], 8
        while at < len(data):
            end = at + 12 + int.from_bytes(data[at : at + 4], "big")
            bare += b"" if data[at + 4 : at + 8] == b"iTXt" else data[at:end]
            at = end
        return bare
    if not data.startswith(b"\x76\x2f\x31\x01"):
        return data
    bare, at = b"", 8
    while data[at]:
        value = data.index(b"\0", data.index(b"\0", at) + 1) + 5  # behind name, type and length
        end = value + int.from_bytes(data[value - 4 : value], "little")
        bare += b"" if data[at:].startswith(b"vog\0") else data[at:end]
        at = end
    # Places of the blocks of pixels, 8 bytes each up to the first one, then the blocks.
    return bare + data[int.from_bytes(data[at + 1 : at + 9], "little") :]


def scrubbed(value):
    """A report without times, memory, processes and the request."""
    if isinstance(value, dict):
        return {key: scrubbed(one) for key, one in value.items()
                if not re.search(r"ms$|memory|peak|threads|per_second|hierarchy$|date|seconds|commit|repeats|request", key)}
    return [scrubbed(one) for one in value] if isinstance(value, list) else value


def result_of(made, command, words, extra):
    """Exit status, files and report of a run; errors of one that was refused."""
    out = tempfile.mkdtemp(dir=made)
    text = pairs_text(command)
    full = [*words, *extra, *(["--json"] if "--json" in text and "--json" not in extra else [])]
    full = [word.replace("{made}", made).replace("{out}", out) for word in full]
    if command == "view":
        script = Path(out, "script.vog")
        script.write_text(Path(made, "tour.vog").read_text().replace("{out}", out))
        full = [str(script) if word.endswith("tour.vog") else word for word in full]
    try:
        if command == "serve":
            return served(full)
        if command.startswith("mpi "):
            run = subprocess.run([str(VOG_MPI), command.split()[1], *full], capture_output=True, timeout=SECONDS, env=MPI_ENVIRONMENT, cwd=out)
        else:
            run = command_server.run([command, *full], out, SECONDS)
        files = {}
        for path in sorted(Path(out).rglob("*")):
            if not path.is_file() or path.suffix in (".md", ".vog") or (command.endswith("evaluate") and path.suffix in (".html", ".svg", ".csv")):
                continue
            data = path.read_bytes()
            if path.suffix == ".json":
                data = json.dumps(scrubbed(json.loads(data))).encode()
            data = without_record(data).replace(out.encode(), b"")
            files[str(path.relative_to(out))] = hashlib.sha256(data).hexdigest()
    finally:
        shutil.rmtree(out)
    report = run.stdout.decode(errors="replace").replace(out, "")
    if report.startswith("{"):
        report = json.dumps(scrubbed(json.loads(report)))
    errors = run.stderr.decode(errors="replace").removesuffix("Run with --help for usage.\n")
    errors = "".join(line for line in errors.splitlines(True) if ": note: " not in line)
    return run.returncode, (files, report), errors


def pairs_text(command, known={}):
    if command not in known:
        program = [str(VOG_MPI), command.split()[1]] if command.startswith("mpi ") else [VOG, command]
        known[command] = subprocess.run([*program, "--help-all"], capture_output=True, text=True, check=True, env=MPI_ENVIRONMENT).stdout
    return known[command]


def options_of(command):
    """[["--shadows"], ["--block", "4"], ...] of the help."""
    found = {}
    for name, rest in re.findall(pairs.OPTION, pairs_text(command), re.MULTILINE):
        if name in PRESENTATION or name == "--output" or name in found:
            continue
        found[name] = [name]
        if re.match(pairs.TAKES_VALUE, rest):
            value = VALUES.get(f"{command} {name}") or VALUES.get(name) or pairs.VALUES.get(name)
            assert value, f"vog {command} {name}: no value for it in {__file__}"
            found[name].append(value)  # "a|b": one of both is the default
    return list(found.values())


def inputs_for(option, words):
    """The case's words with data that the option has an effect on."""
    changed = []
    for word in words:
        other = INPUTS.get((option, word.removeprefix("{made}/")))
        changed += ("{made}/" + other).split() if other else [word]
    return changed


class Trial:
    """Runs of the cases with each option, and what is wrong with them."""

    def __init__(self, made, pool):
        self.made, self.pool = made, pool
        self.bases, self.faults, self.runs = {}, [], 0
        self.works = {}  # (command, option): whether it has an effect in some case
        self.effects = set()  # (command, words of the case, option)

    def run(self, command, words, extra=()):
        return self.pool.submit(result_of, self.made, command, words, list(extra))

    def base_of(self, command, words):
        key = (command, *words)
        if key not in self.bases:
            self.bases[key] = self.run(command, words)
        return self.bases[key]

    def begin(self, command, words, quicker=()):
        """Runs of a case: [(command, words, name of the option, result without it, results with it), ...]"""
        begun = []
        self.base_of(command, words)
        for name, *value in options_of(command):
            stated = name in words or any(f"--set {word}".startswith(name + "=") for word in words)
            self.works[command, name] = self.works.get((command, name), False) or stated or name in UNTRIED
            if stated or name in UNTRIED or (command, *quicker, name) in self.effects:
                continue
            given = inputs_for(name, words)
            choices = [[name, one] for one in value[0].split("|")] if value else [[name]]
            begun.append((command, words, name, self.base_of(command, given),
                          [self.run(command, given, pairs.words_of(one)) for one in choices]))
        return begun

    def judge(self, command, words, name, before, after):
        before, results = before.result(), [one.result() for one in after]
        after = next((one for one in results if one[0] == 0 and one[:2] != before[:2]), results[0])
        self.runs += 1
        line = f"vog {command} {' '.join(words)} + {name}"
        if after[0] == 0:
            changed = before[0] != 0 or before[1] != after[1]
            self.works[command, name] |= changed
            if changed:
                self.effects.add((command, *words, name))
            elif (command, name) not in STATED and not any((name, word) in NOTHING_LEFT for word in words):
                self.faults.append(f"{line}: no effect")
        elif after[0] not in (1, 2) or after[2].count("\n") != 1:
            self.faults.append(f"{line}: status {after[0]}, {after[2]!r}")
        elif not any(word in after[2] for word in (name, *words) if word.startswith("--")) and name not in OF_DATA:
            self.faults.append(f"{line}: refused without its name: {after[2]!r}")
        if os.environ.get("VOG_SHOW"):
            print(line, "->", after[2].strip() or "ok")

    def judge_bases(self, chosen):
        for (command, *words), base in self.bases.items():
            if base.result()[0] != 0 and [command, words] in chosen:
                self.faults.append(f"vog {command} {' '.join(words)}: {base.result()[2]}")
            again = result_of(self.made, command, words, []) if os.environ.get("VOG_TWICE") else base.result()
            if again[1] != base.result()[1]:
                self.faults.append(f"vog {command} {' '.join(words)}: another result the second time")
        # vog-mpi has the options of vog, and few cases.
        self.faults += [f"vog {command} {option}: no case in which it has an effect" for (command, option), used in self.works.items()
                        if not used and not command.startswith("mpi ")]


def main():
    made = tempfile.mkdtemp(prefix="vog-effects-")
    try:
        make_inputs(made)
        with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
            trial = Trial(made, pool)
            chosen = [list(case) for case in cases() if case[0] in (sys.argv[1:] or case[0])]
            if os.environ.get("VOG_ALL_EFFECTS"):
                chosen = [case[:2] for case in chosen]
            # Cases with a quicker one come second: what has an effect there is known by then.
            for some in ([case for case in chosen if len(case) == count] for count in (2, 3)):
                for begun in [one for case in some for one in trial.begin(*case)]:
                    trial.judge(*begun)
            trial.judge_bases([case[:2] for case in chosen])
    finally:
        shutil.rmtree(made)
    for fault in trial.faults:
        print(fault)
    print(f"{len(trial.works)} options of commands in {trial.runs} runs, {len(trial.faults)} faults")
    return 1 if trial.faults else 0


if __name__ == "__main__":
    sys.exit(main())
