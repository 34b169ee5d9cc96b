#!/usr/bin/env python3
"""A newcomer's first ten seconds with a wheel: install, import, a picture, a page, the command. Fails where a promise of docs/install.md does not hold.

usage: PYTHON try_wheel.py FOLDER_OF_WHEELS OUT      packages come from the folder alone; pictures and pages are written to OUT
       PYTHON try_wheel.py --beside FOLDER           vog, unpacked in FOLDER, beside the system's copies of its libraries

Limits are of processor time, which other programs on the machine leave alone.
"""
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile
import time

MOST_IMPORT_S = 0.3
MOST_IMPORT_OF_NUMPY = 2.5  # times NumPy's own, on machines where that takes long
MOST_FIRST_PAGE_S = 10
LIBRARIES = ("openvdb", "tbb", "blosc", "embree", "Imath", "OpenEXR")

IMPORT = """
import time
start, wall = time.process_time(), time.perf_counter()
import numpy
of_numpy = time.process_time() - start
import vog
print(time.process_time() - start, of_numpy, time.perf_counter() - wall)
"""
# The four lines.
FIRST = """
import vog
model = vog.convert(vog.sample_cloud(64), block=4)
page = vog.show(model, live=False)
page.save("cloud.html")
"""
MORE = """
import vog
model = vog.convert(vog.sample_cloud(64), block=4)
vog.render(model, size=256, tf="inferno").save("cloud.png")
vog.render(model, size=64, renderer="trace")
vog.sample_cloud(64).save("saved.vdb")
assert vog.Volume.load("saved.vdb").active_voxels == vog.sample_cloud(64).active_voxels
loaded = {line.split()[-1] for line in open("/proc/self/maps") if ".so" in line}
outside = sorted(path for path in loaded if any("lib" + name in path for name in %r) and "site-packages" not in path)
assert not outside, outside
"""

# Copies that are mixed end in crashes, some only when the process ends and destroys what both have registered.
BESIDE = """
import ctypes, sys
sys.path.insert(0, %r)
held = []
for name in ("libtbb.so.12", "libImath-3_1.so.29", "libopenvdb.so.10.0", "libembree3.so.3", "libOpenEXR-3_1.so.30"):
    try:
        ctypes.CDLL(name, mode=ctypes.RTLD_GLOBAL)
        held.append(name)
    except OSError:
        pass
import os, tempfile, vog
model = vog.convert(vog.sample_cloud(64), block=4)
with tempfile.TemporaryDirectory() as folder:
    vog.sample_cloud(64).save(os.path.join(folder, "a.vdb"))
    assert vog.Volume.load(os.path.join(folder, "a.vdb")).active_voxels == vog.sample_cloud(64).active_voxels
    vog.render(model, size=64).save_values(os.path.join(folder, "a.exr"))
a, b = vog.render(model, size=64), vog.render(model, size=64, renderer="trace")
assert vog.compare(a, b).relative_l2 < 1e-4
print("wheel: works beside", ", ".join(held) or "no other copy: this machine has none")
"""


def spent():
    """Processor time of all finished processes that this one began, s."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def run(*words, **more):
    done = subprocess.run([str(word) for word in words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True, **more)
    if done.returncode:
        sys.exit("try_wheel: {}\n{}{}".format(" ".join(map(str, words)), done.stdout, done.stderr))
    return done.stdout


def install(wheels, venv):
    """Processor and elapsed time of pip, s."""
    run(sys.executable, "-m", "venv", venv)
    before, start = spent(), time.perf_counter()
    run(venv / "bin" / "pip", "install", "--quiet", "--disable-pip-version-check", "--no-index", "--find-links", wheels, "vog")
    return spent() - before, time.perf_counter() - start


def import_time(python, out):
    """(all, of it NumPy, elapsed), s: the least of seven, after one that compiles what Python keeps."""
    times = [tuple(map(float, run(python, "-c", IMPORT, cwd=out).split())) for _ in range(8)]
    return min(times[1:])


def licences(python):
    """Libraries in the wheel; each names the notice of its licence."""
    package = pathlib.Path(run(python, "-c", "import vog; print(vog.__file__)").strip()).parent
    listed = dict(line.split(None, 1) for line in (package / "licenses" / "LIBRARIES").read_text().splitlines())
    held = sorted(path.name for path in (package.parent / "vog.libs").iterdir())
    for name in held:
        stem = name.split("-")[0].split(".so")[0]
        notices = [notice for library, notice in listed.items() if library.split(".so")[0].startswith(stem)]
        if not notices or not (package / "licenses" / notices[0].strip()).stat().st_size:
            sys.exit("try_wheel: {} is in the wheel without the notice of its licence".format(name))
    return held


def beside(folder):
    """Fails where a library of the wheel finds a function in the system's copy of another one."""
    with tempfile.TemporaryDirectory() as made:
        environment = {**os.environ, "LD_DEBUG": "bindings", "LD_DEBUG_OUTPUT": made + "/loader"}
        told = run(sys.executable, "-c", BESIDE % (str(folder),), env=environment).strip()
        # Functions; static members of templates are one in a process whatever the loader is asked for (STB_GNU_UNIQUE), and constant.
        binding = re.compile(r"binding file %s/vog\S* \[0\] to (/\S*) \[0\]: normal symbol `((?:rtc|blosc_|_ZN3tbb6detail2r1)\w+)'" % re.escape(str(folder)))
        for log in pathlib.Path(made).iterdir():
            for found in binding.finditer(log.read_text(errors="replace")):
                if not found[1].startswith(str(folder)):
                    sys.exit("try_wheel: {} is of {}, expected the wheel's own".format(found[2], found[1]))
    print(told)


def main():
    if sys.argv[1] == "--beside":
        beside(pathlib.Path(sys.argv[2]).resolve())
        return
    wheels, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    out.mkdir(parents=True, exist_ok=True)
    venv = out / "venv"
    processor, elapsed = install(wheels, venv)
    python, vog = venv / "bin" / "python", venv / "bin" / "vog"
    before, start = spent(), time.perf_counter()
    run(python, "-c", FIRST, cwd=out)
    processor, elapsed = processor + spent() - before, elapsed + time.perf_counter() - start
    print("wheel: pip and four lines to a page: {:.1f} s, {:.1f} s of processor time".format(elapsed, processor))
    whole, of_numpy, wall = import_time(python, out)
    print("wheel: import: {:.2f} s of processor time, of it NumPy {:.2f} s; {:.2f} s elapsed".format(whole, of_numpy, wall))
    run(python, "-c", MORE % (LIBRARIES,), cwd=out)
    print(run(vog, "--version").strip())
    for line in ("sample fire fire.vdb --size 64", "fire.vdb", "convert fire.vdb --grid density --field temperature -o fire.ply --block 4",
                 "render fire.ply -o fire.png --size 200", "page fire.ply -o fire.html", "doctor"):
        run(vog, *line.split(), cwd=out)
    print("wheel: {} libraries inside, each with its licence".format(len(licences(python))))
    most_import = max(MOST_IMPORT_S, MOST_IMPORT_OF_NUMPY * of_numpy)
    if whole > most_import or processor > MOST_FIRST_PAGE_S:
        sys.exit("try_wheel: expected an import of {:.2f} s, a page after {} s of processor time".format(most_import, MOST_FIRST_PAGE_S))


if __name__ == "__main__":
    main()
