"""Pairs of options of the command: a result, or one line that says what is wrong.

Runs cover many pairs at once. Options that work alone go into runs of kOptions of them, chosen so that every two of
them meet in a run that works; two that are refused together, as far as the messages name them or else by halves, are run by
themselves. An option that is refused alone joins the option that its message names, if the two work; else it is refused
in runs with kRefused others. VOG_ALL_PAIRS=1 runs every pair by itself.

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

import command_server
from command_server import VOG

SECONDS = 60  # of one run on a busy machine; most take some hundredths

# Values of options that take one. {made}: folder of inputs; {out}: folder of this run's outputs.
VALUES = {
    "--grid": "density", "--mask": "density", "--method": "paper", "--lod": "3", "--threads": "1", "--error": "0.3",
    "--budget": "200", "--block": "4", "--set soft-steps": "2", "--refine": "0.01", "--set spread": "1.1", "--set background-value": "0.1",
    "--set mass-threshold": "0.01", "--set axis-aligned": "1", "--set measure-error": "1", "--set strategy": "smart", "--set dense-block": "4", "--set amplitude": "mass", "--set kappa": "0.02",
    "--set opacity-threshold": "0.001", "--set variance-threshold": "0.02", "--set similarity": "0.2", "--set tree-depth": "2",
    "--set minimum-radius": "0.2", "--columns": "x,y,z", "--from": "https://data.example.org/model.vogz", "--value": "speed", "--radius": "0.5", "--neighbours": "4", "--periodic": "40",
    "--memory": "200M", "--set scratch": "{out}", "--depth-out": "{out}/t.exr", "--size": "12x10",
    "--renderer": "reference", "--interpolation": "linear", "--set step": "0.5", "--samples": "2", "--set aabb-sigma": "1",
    "--pixel-error": "1", "--repeat": "2", "--set anyhit": "collect", "--set hits-per-slab": "4", "--set precision": "0.1", "--set stop-transmittance": "0.01",
    "--frame": "data", "--view": "+x", "--distance": "2", "--fov": "30", "--width": "20",
    "--eye": "30,20,10", "--look-at": "1,2,3", "--up": "z", "--set roll": "10", "--camera": "{made}/camera.json",
    "--extinction": "0.5", "--tf": "viridis", "--background": "white",
    "--show": "column", "--range": "0.1,2", "--units": "g/cm^2", "--title": "A title",
    "--combine": "sum", "--labels": "density", "--field": "density", "--for": "volume", "--set joint-steps": "1", "--measure": "volume", "--scale": "linear", "--set least-column": "0.01", "--values-out": "{out}/values.npy",
    "--window": "0.5,1", "--band": "0.1,0.4,red,0.5", "--iso": "0.5,#ffeedd", "--threshold": "0.2", "--gradient-opacity": "0:0.2,0.1:1",
    "--unit-distance": "2", "--layer": "tf=viridis", "--light": "1,2,3", "--light-from": "1,2,3", "--set scattering": "3", "--set asymmetry": "0.4", "--set clip-lights": "0", "--slabs": "8", "--set light-weights": "0.2,0.7,0.1,10", "--clip": "-5,-5,-5,20,20,20", "--plane": "z", "--thickness": "2",
    "--max-loss": "0.5", "--reference": "{made}/cloud.vdb", "--set model-psnr": "40", "--set rounding": "0.05", "--set field-rounding": "0.01", "--as": "3dgs", "--set description": "Some text", "--name": "a model", "--set levels": "2",
    "--voxel-size": "1", "--like": "{made}/cloud.vdb",
    "--request": "{made}/x.png", "--turntable": "2", "--set fps": "12", "--diff": "{out}/diff.png", "--set diff-limit": "3", "--set seed": "2",
}
kOptions, kRefused = 8, 16  # options of one run
# Command: its arguments with an input, for each kind of input.
COMMANDS = {
    "convert": [["{made}/particles.csv", "-o", "{out}/m.ply"], ["{made}/cloud.vdb", "-o", "{out}/m.ply"]],
    "render": [["{made}/model.ply", "-o", "{out}/p.png"], ["{made}/cloud.vdb", "-o", "{out}/p.png"]],
    "page": [["{made}/model.ply", "-o", "{out}/p.html"], ["{made}/model.ply", "-o", "{out}/site/"]],
    "pack": [["{made}/model.ply", "-o", "{out}/m.vogz"]],
    "export": [["{made}/model.ply", "-o", "{out}/m.spz"], ["{made}/model.ply", "-o", "{out}/m.ply"]],
    "voxelize": [["{made}/model.ply", "-o", "{out}/v.vdb", "--like", "{made}/cloud.vdb"]],
    "compare": [["{made}/a.exr", "{made}/b.exr"]],
    "sample": [["cloud", "{out}/s.vdb"]],
    "info": [["{made}/cloud.vdb"], ["{made}/model.ply"]],
}
# Each is small by itself: `vog render` without --size draws 512 x 512 pixels. Conversions of a volume without any of SIZES measure
# errors in twelve views, 1.8 s; --error, which meets every other option, does the same.
ALWAYS = {"render": ["--size", "16x12"], "sample": ["--size", "64"], "convert": [] if os.environ.get("VOG_ALL_PAIRS") else ["--block", "16"]}
SIZES = {"--size", "--block", "--budget", "--error", "--lod", "--method", "--measure"}


# An option in a help: "--block", or a setting, "--set kappa".
OPTION, TAKES_VALUE = r"^  (?:-\w,)?(--set [a-z-]+|--[a-z][a-z-]*)(.*)$", r"[ =](TEXT|INT|UINT|FLOAT|BOOLEAN)"


def words_of(option):
    """["--set", "kappa=0.2"] of ["--set kappa", "0.2"]."""
    return ["--set", f"{option[0][6:]}={option[1]}"] if option[0].startswith("--set ") else option


def options_of(command):
    """Long names of the options of a command, with their values: [["--shadows"], ["--block", "4"], ...]"""
    text = subprocess.run([VOG, command, "--help-all"], capture_output=True, text=True, check=True).stdout
    options = []
    for name, rest in re.findall(OPTION, text, re.MULTILINE):
        if name in ("--help", "--help-all", "--output", *(option[0] for option in options)):
            continue
        if re.match(TAKES_VALUE, rest):
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
        vog("render", f"{made}/model.ply", "-o", f"{made}/x.png", "--size", "16", "--set", "roll=" + roll, "--depth-out",
            f"{made}/{name}.exr")
    Path(made, "camera.json").write_text(json.dumps({"eye": [90, 60, 40], "look_at": [0, 0, 0], "up": [0, 1, 0], "fov_degrees": 40}))


class Outcome:
    """Result of one run. fault: what is wrong with it, None: it made its output, or was refused in one line."""

    def __init__(self, refusal="", fault=None):
        self.refusal, self.fault = refusal, fault
        self.works = not refusal and not fault


def outcome_of(made, command, arguments, chosen):
    out = tempfile.mkdtemp(dir=made)
    words = [*arguments, *[word for option in chosen for word in words_of(option)]]
    if not SIZES & set(words) and ".csv" not in words[0]:
        words += ALWAYS.get(command, [])
    words = [word.replace("{made}", made).replace("{out}", out) for word in words]
    try:
        run = command_server.run([command, *words], seconds=SECONDS)
    except subprocess.TimeoutExpired:
        return Outcome(fault=f"more than {SECONDS} s")
    finally:
        files = [path for path in Path(out).iterdir()]
        empty = [path.name for path in files if path.is_file() and path.stat().st_size == 0]
        shutil.rmtree(out)
    errors = run.stderr.decode(errors="replace")
    fault = None
    if run.returncode < 0 or run.returncode > 2:
        fault = f"exit status {run.returncode}: {errors}"
    elif empty:
        fault = f"empty files: {empty}"
    elif run.returncode == 0:
        if ["--json"] in chosen:
            json.loads(run.stdout)
        # A picture of NaN or a report of it has a cause that should have been refused.
        if re.search(rb"\bnan\b", run.stdout):
            fault = "a report with nan"
        return Outcome(fault=fault)
    else:
        if ["--verbose"] in chosen:
            errors = re.sub(r"^\w[\w ]* [\d.]+ ms\n", "", errors, flags=re.MULTILINE)  # times of stages
        errors = errors.removesuffix("Run with --help for usage.\n")
        if len(errors.splitlines()) != 1 or not errors.startswith("vog"):
            fault = f"not one line of error: {errors!r}"
        elif files:
            fault = f"refused, but wrote {[path.name for path in files]}"
    return Outcome(errors or "refused", fault)


class Pairs:
    """Runs of one command with one input until every pair of its options is covered."""

    def __init__(self, run, options):
        self.run, self.options = run, options  # run: [[option, ...], ...] -> [Outcome, ...]
        self.runs, self.faults, self.covered = 0, [], set()

    def outcomes(self, choices):
        found = self.run(choices)
        for chosen, outcome in zip(choices, found):
            self.runs += 1
            self.covered |= {frozenset(pair) for pair in itertools.combinations([o[0] for o in chosen], 2)}
            if outcome.fault:
                self.faults.append((chosen, outcome.fault))
        return found

    def named(self, refusal, options):
        words = set(re.findall(r"--set [a-z-]+|--[a-z-]+", refusal))
        named = [option for option in options if option[0] in words]
        if len(named) > 1:
            return named
        text = refusal.replace("-", " ")  # "block 4 and budget 200"
        return [option for option in options if re.search(rf"\b{option[0][2:].replace('-', ' ')}\b", text)]

    def all_alone(self):
        self.outcomes([[o] for o in self.options] + [list(pair) for pair in itertools.combinations(self.options, 2)])

    def packed(self):
        alone = self.outcomes([[option] for option in self.options])
        units = [[option] for option, outcome in zip(self.options, alone) if outcome.works]
        refused = []
        for option, outcome in zip(self.options, alone):
            if not outcome.refusal:
                continue
            others = [other for other in self.named(outcome.refusal, self.options) if other != option]
            needs = [[option, other] for other in others]
            working = [pair for pair, found in zip(needs, self.outcomes(needs)) if found.works]
            if working:
                units.append(working[0])
            else:
                refused.append(option)
        self.together(units)
        for option in refused:
            others = [other for other in self.options if frozenset((other[0], option[0])) not in self.covered]
            others = [other for other in others if other != option]
            self.outcomes([[option, *others[n : n + kRefused]] for n in range(0, len(others), kRefused)])

    def together(self, units):
        """Runs in which every two units meet: all work, or a message says which two options do not go together."""
        every = set(itertools.combinations(range(len(units)), 2))
        left, apart = set(every), set()  # pairs of units: without a run; known to be refused
        while left - apart:
            batch, planned = [], set(apart)
            while len(batch) < 8 and left - planned:
                batch.append(self.plan(len(units), left - planned, apart))
                planned |= set(itertools.combinations(batch[-1], 2))
            while batch:
                choices = [self.options_of([units[m] for m in members]) for members in batch]
                parts = set()
                for members, chosen, outcome in zip(batch, choices, self.outcomes(choices)):
                    pairs = set(itertools.combinations(members, 2))
                    if outcome.works or len(members) == 2:
                        left -= pairs
                        apart |= set() if outcome.works else pairs
                        continue
                    clash = self.named(outcome.refusal, chosen)
                    refused = {
                        (a, b)
                        for a, b in every
                        if len(clash) == 2
                        and (clash[0] in units[a] and clash[1] in units[b] or clash[1] in units[a] and clash[0] in units[b])
                    }
                    if refused & pairs & left:
                        left -= refused & pairs
                        apart |= refused  # the others meet in later runs
                    else:
                        parts |= {tuple(part) for part in self.halves(members)}
                batch = [list(part) for part in sorted(parts) if set(itertools.combinations(part, 2)) & (left - apart)]
        for unit in range(len(units)):
            others = sorted({a + b - unit for a, b in left if unit in (a, b)})
            left -= {(min(unit, other), max(unit, other)) for other in others}
            self.outcomes([
                self.options_of([units[m] for m in [unit, *others[n : n + kRefused]]])
                for n in range(0, len(others), kRefused)
            ])

    @staticmethod
    def options_of(units):
        return list({option[0]: option for unit in units for option in unit}.values())

    @staticmethod
    def plan(count, wanted, apart):
        """Up to kOptions units with many wanted pairs and none apart."""
        members = list(min(wanted))
        while len(members) < kOptions:
            gains = {}
            for unit in set(range(count)) - set(members):
                pairs = {(min(unit, m), max(unit, m)) for m in members}
                gains[unit] = 0 if pairs & apart else len(pairs & wanted)
            best = max(sorted(gains), key=gains.get, default=None)
            if best is None or gains[best] == 0:
                break
            members.append(best)
        return sorted(members)

    @staticmethod
    def halves(members):
        """Smaller sets in which every two members meet."""
        size = max(1, len(members) // 4)
        quarters = [members[n : n + size] for n in range(0, len(members), size)]
        return [sorted(a + b) for a, b in itertools.combinations(quarters, 2)]


def main():
    commands = sys.argv[1:] or list(COMMANDS)
    made = tempfile.mkdtemp(prefix="vog-pairs-")
    faults = []
    try:
        make_inputs(made)
        for command in commands:
            options = options_of(command)
            for arguments in COMMANDS[command]:
                with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
                    pairs = Pairs(
                        lambda choices: list(pool.map(lambda c: outcome_of(made, command, arguments, c), choices)),
                        options)
                    (pairs.all_alone if os.environ.get("VOG_ALL_PAIRS") else pairs.packed)()
                faults += [f"vog {command} {' '.join(arguments)} {chosen}: {fault}" for chosen, fault in pairs.faults]
                all_pairs = {frozenset((a[0], b[0])) for a, b in itertools.combinations(options, 2)}
                print(f"vog {command} {Path(arguments[0]).name}: {len(options)} options, {len(pairs.covered & all_pairs)} "
                      f"of {len(all_pairs)} pairs in {pairs.runs} runs, "
                      f"{len(pairs.covered & all_pairs) / pairs.runs:.1f} a run", flush=True)
                if not all_pairs <= pairs.covered:
                    faults.append(f"vog {command}: pairs without a run: {sorted(map(sorted, all_pairs - pairs.covered))[:3]}")
    finally:
        shutil.rmtree(made)
    for fault in faults[:30]:
        print(fault)
    print(f"{len(faults)} faults")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
