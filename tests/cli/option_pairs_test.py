"""Pairs of options of the command: a result, or one line that says what is wrong.

The options come from `vog COMMAND --help`, so that none is forgotten: one without a value below fails the test.
usage: VOG_COMMAND=build/release/apps/cli/vog option_pairs_test.py [COMMAND...]
"""

import itertools
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

VOG = os.environ.get("VOG_COMMAND") or "build/release/apps/cli/vog"
SECONDS = 60  # of one run on a busy machine; most take some hundredths

# Values of options that take one. {made}: folder of inputs; {out}: folder of this run's outputs.
VALUES = {
    "--grid": "density", "--mask": "density", "--method": "paper", "--lod": "3", "--threads": "1", "--error": "0.3",
    "--budget": "200", "--block": "4", "--soft-steps": "2", "--refine": "0.01", "--spread": "1.1",
    "--mass-threshold": "0.01", "--strategy": "smart", "--dense-block": "4", "--amplitude": "mass", "--kappa": "0.02",
    "--opacity-threshold": "0.001", "--variance-threshold": "0.02", "--similarity": "0.2", "--tree-depth": "2",
    "--minimum-radius": "0.2", "--columns": "x,y,z", "--value": "speed", "--radius": "0.5", "--neighbours": "4",
    "--memory": "200M", "--scratch": "{out}", "--depth-out": "{out}/t.exr", "--size": "12x10",
    "--renderer": "reference", "--interpolation": "linear", "--step": "0.5", "--samples": "2", "--aabb-sigma": "1",
    "--pixel-error": "1", "--repeat": "2", "--anyhit": "collect", "--slab-hits": "4", "--stop-transmittance": "0.01",
    "--view": "+x", "--azimuth": "30", "--elevation": "20", "--distance": "2", "--fov": "30", "--width": "20",
    "--eye": "30,20,10", "--look-at": "1,2,3", "--up": "z", "--roll": "10", "--camera": "{made}/camera.json",
    "--save-camera": "{out}/camera.json", "--extinction": "0.5", "--tf": "viridis", "--background": "white",
    "--show": "column", "--range": "0.1,2", "--units": "g/cm^2", "--title": "A title",
    "--field": "density", "--scale": "linear", "--least-column": "0.01", "--values-out": "{out}/values.npy",
    "--window": "0.5,1", "--band": "0.1,0.4,red,0.5", "--iso": "0.5,#ffeedd", "--threshold": "0.2",
    "--unit-distance": "2", "--light": "1,2,3", "--light-weights": "0.2,0.7,0.1,10", "--clip": "-5,-5,-5,20,20,20",
    "--clip-plane": "1,0,0,3", "--description": "Some text", "--name": "a model", "--levels": "2",
    "--diff": "{out}/diff.png", "--diff-limit": "3", "--seed": "2",
}
# Command: its arguments with an input, for each kind of input, and the part of all pairs that is run, one in so many
# (all with VOG_ALL_PAIRS=1). A volume takes some tenths of a second.
COMMANDS = {
    "convert": [(["{made}/particles.csv", "-o", "{out}/m.ply"], 2), (["{made}/cloud.vdb", "-o", "{out}/m.ply"], 8)],
    "render": [(["{made}/model.ply", "-o", "{out}/p.png"], 6), (["{made}/cloud.vdb", "-o", "{out}/p.png"], 11)],
    "export": [(["{made}/model.ply", "-o", "{out}/p.html"], 2)],
    "compare": [(["{made}/a.exr", "{made}/b.exr"], 1)],
    "sample": [(["cloud", "{out}/s.vdb"], 1)],
    "info": [(["{made}/cloud.vdb"], 1), (["{made}/model.ply"], 1)],
}
# Each is small by itself: `vog render` without it draws 512 x 512 pixels.
ALWAYS = {"render": ["--size", "16x12"], "sample": ["--size", "64"]}


def options_of(command):
    """Long names of the options of a command, with their values: [["--axis-aligned"], ["--block", "4"], ...]"""
    text = subprocess.run([VOG, command, "--help"], capture_output=True, text=True, check=True).stdout
    options = []
    for match in re.finditer(r"^ +(?:-\w,)?(--[a-z-]+)(.*)$", text, re.MULTILINE):
        name, rest = match[1], match[2]
        if name in ("--help", "--output"):
            continue
        if re.match(r" (TEXT|INT|UINT|FLOAT)", rest):
            assert name in VALUES, f"vog {command} {name}: no value for it in {__file__}"
            options.append([name, VALUES[name]])
        else:
            options.append([name])
    return options


def make_inputs(made):
    def vog(*arguments):
        subprocess.run([VOG, *arguments], check=True, stdout=subprocess.DEVNULL)

    vog("sample", "cloud", f"{made}/cloud.vdb", "--size", "64")
    vog("sample", "particles", f"{made}/particles.csv", "--size", "8")
    vog("convert", f"{made}/cloud.vdb", "-o", f"{made}/model.ply", "--block", "16")
    for name, roll in (("a", "0"), ("b", "5")):
        vog("render", f"{made}/model.ply", "-o", f"{made}/x.png", "--size", "16", "--roll", roll, "--depth-out",
            f"{made}/{name}.exr", "--save-camera", f"{made}/camera.json")


def fault_of(made, command, arguments, chosen):
    """What is wrong with one run; None: it made its output, or was refused in one line."""
    out = tempfile.mkdtemp(dir=made)
    words = [*arguments, *[word for option in chosen for word in option]]
    if "--size" not in words:
        words += ALWAYS.get(command, [])
    words = [word.replace("{made}", made).replace("{out}", out) for word in words]
    try:
        run = subprocess.run([VOG, command, *words], capture_output=True, timeout=SECONDS)
    except subprocess.TimeoutExpired:
        return f"more than {SECONDS} s"
    finally:
        files = [path for path in Path(out).iterdir()]
        empty = [path.name for path in files if path.is_file() and path.stat().st_size == 0]
        shutil.rmtree(out)
    errors = run.stderr.decode(errors="replace")
    if run.returncode < 0 or run.returncode > 2:
        return f"exit status {run.returncode}: {errors}"
    if empty:
        return f"empty files: {empty}"
    if run.returncode == 0:
        if ["--json"] in chosen:
            json.loads(run.stdout)
        # A picture of NaN or a report of it has a cause that should have been refused.
        return "a report with nan" if re.search(rb"\bnan\b", run.stdout) else None
    if ["--verbose"] in chosen:
        errors = re.sub(r"^\w[\w ]* [\d.]+ ms\n", "", errors, flags=re.MULTILINE)  # times of stages
    errors = errors.removesuffix("Run with --help for usage.\n")
    if len(errors.splitlines()) != 1 or not errors.startswith("vog"):
        return f"not one line of error: {errors!r}"
    if files:
        return f"refused, but wrote {[path.name for path in files]}"
    return None


def main():
    commands = sys.argv[1:] or list(COMMANDS)
    made = tempfile.mkdtemp(prefix="vog-pairs-")
    faults = []
    try:
        make_inputs(made)
        for command in commands:
            options = options_of(command)
            singles = [[option] for option in options]
            pairs = [list(pair) for pair in itertools.combinations(options, 2)]
            runs = [
                (made, command, arguments, chosen)
                for arguments, part in COMMANDS[command]
                for chosen in singles + pairs[:: 1 if os.environ.get("VOG_ALL_PAIRS") else part]
            ]
            with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
                found = list(pool.map(lambda run: fault_of(*run), runs))
            for run, fault in zip(runs, found):
                if fault:
                    faults.append(f"vog {command} {' '.join(run[2])} {run[3]}: {fault}")
            print(f"vog {command}: {len(options)} options, {len(runs)} runs", flush=True)
    finally:
        shutil.rmtree(made)
    for fault in faults[:30]:
        print(fault)
    print(f"{len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
