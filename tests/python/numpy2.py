#!/usr/bin/env python3
"""The tests that exchange arrays, once more with NumPy 2 from PyPI, in a virtual environment of their own.

usage: numpy2.py BUILD VENV      exit status 77, with the reason, where pip cannot install NumPy 2 and pytest
"""
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
FILES = ("calls", "fields", "gaussians", "picture", "points", "projection", "render", "volume", "volume_picture")


def main():
    build, venv = sys.argv[1:]
    python = f"{venv}/bin/python"
    subprocess.run([sys.executable, "-m", "venv", venv], check=True)
    done = subprocess.run([python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "numpy>=2", "pytest"],
                          capture_output=True, text=True)
    if done.returncode:
        print(f"skipped: pip cannot install NumPy 2 and pytest: {done.stderr.strip().splitlines()[-1]}")
        sys.exit(77)
    packages = subprocess.run([python, "-c", "import sysconfig; print(sysconfig.get_path('platlib'))"],
                              check=True, capture_output=True, text=True).stdout.strip()
    subprocess.run(["cmake", "--install", build, "--component", "python", "--prefix", packages], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([python, "-c", "import numpy, vog; assert numpy.__version__ >= '2', numpy.__version__; print('NumPy', numpy.__version__)"],
                   check=True)
    files = [str(HERE / f"test_{name}.py") for name in FILES]
    sys.exit(subprocess.run([python, "-m", "pytest", "-q", "-rs", "-p", "no:cacheprovider", "-m", "not data", *files]).returncode)


main()
