#!/usr/bin/env python3
"""Lines of device code that no test has run, by gcov, from a build with VOG_EMULATED_GPU whose tests have run.

usage: tests/emulation/coverage.py BUILD

Exit status 1 if there are any.
"""
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
DEVICE = ("src/render/device/", "src/render/gpu/cuda_splat.cu", "src/render/gpu/chords/chord_kernels.cu",
          "src/render/gpu/sums/sums_kernels.cu", "src/render/gpu/optix/optix_programs.cu")


def counts(build):
    """{file: {line: times run}}, of all objects of device code."""
    lines = {}
    objects = sorted(build.glob("src/**/*.cu.gcda"))
    if not objects:
        sys.exit(f"{build}: no counts of device code; configure with -DVOG_EMULATED_GPU=ON and run the tests")
    for data in objects:
        made = subprocess.run([os.environ.get("GCOV", "gcov"), "--json-format", "--stdout", str(data.name)],
                              cwd=data.parent, capture_output=True, text=True)
        if made.returncode:
            sys.exit(f"{data}: {made.stderr.strip()} (GCOV names the gcov of the compiler)")
        for text in made.stdout.splitlines():
            for file in json.loads(text)["files"]:
                path = (build / file["file"]).resolve()
                name = path.relative_to(ROOT).as_posix() if path.is_relative_to(ROOT) else ""
                if not name.startswith(DEVICE):
                    continue
                of_file = lines.setdefault(name, {})
                for line in file["lines"]:
                    number = line["line_number"]
                    of_file[number] = of_file.get(number, 0) + line["count"]
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
