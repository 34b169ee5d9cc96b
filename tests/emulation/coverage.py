#!/usr/bin/env python3
"""Lines of device code that no test has run, by gcov, from the build of the preset sanitize, whose tests have run.

usage: tests/emulation/coverage.py BUILD

Exit status 1 if there are any.
"""
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
DEVICE = ("src/render/device/", "src/render/gpu/cuda_splat.cu", "src/render/gpu/chords/chord_kernels.cu",
          "src/render/gpu/sums/sums_kernels.cu", "src/render/gpu/optix/optix_programs.cu")
COUNTS_OF = os.environ.get("GCOV", "llvm-cov-16 gcov")


def counts(build):
    """{file: {line: times run}}, of all objects of device code."""
    lines = {}
    objects = sorted(build.glob("src/**/*.cu.gcda"))
    if not objects:
        sys.exit(f"{build}: no counts of device code; build the preset sanitize and run its tests")
    for data in objects:
        made = subprocess.run([*COUNTS_OF.split(), "--stdout", data.name], cwd=data.parent, capture_output=True, text=True)
        if made.returncode:
            sys.exit(f"{data}: {made.stderr.strip()} (GCOV names the gcov of the compiler)")
        of_file = {}
        for text in made.stdout.splitlines():
            if source := re.match(r"\s*-:\s*0:Source:(.*)", text):
                path = (build / source[1]).resolve()
                name = path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else ""
                of_file = lines.setdefault(name, {}) if name.startswith(DEVICE) else {}
            elif line := re.match(r"\s*(\d+|#####)\*?:\s*(\d+):", text):
                number, times = int(line[2]), 0 if line[1] == "#####" else int(line[1])
                of_file[number] = of_file.get(number, 0) + times
    return lines


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: tests/emulation/coverage.py BUILD")
    lines = counts(pathlib.Path(sys.argv[1]).resolve())
    absent = [file for file in DEVICE[1:] if not lines.get(file)]
    if absent:
        sys.exit(f"{sys.argv[1]}: no counts of {absent[0]}")
    missing = 0
    for file in sorted(lines):
        text = (ROOT / file).read_text().splitlines()
        idle = sorted(number for number, times in lines[file].items() if times == 0)
        print(f"{file}: {len(lines[file]) - len(idle)} of {len(lines[file])} lines run")
        for number in idle:
            print(f"  {number}: {text[number - 1].strip()}")
        missing += len(idle)
    sys.exit(1 if missing else 0)


if __name__ == "__main__":
    main()
