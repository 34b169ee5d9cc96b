#!/usr/bin/env python3
"""Adds the licences of the libraries that auditwheel copied into a wheel, and packs it as tightly as zip can.

usage: finish_wheel.py WHEEL LOG OUT      LOG: of `auditwheel -v repair`, which names each library and where it came from

Licences are those of the Debian packages of the libraries, with the common texts that they refer to: vog/licenses/PACKAGE.txt. The
file vog/licenses/LIBRARIES has a line for each library: its file and its package's text. Fails where a library has none.
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile

COMMON = pathlib.Path("/usr/share/common-licenses")


def package_of(library):
    """Debian package that a library is of; '' for none."""
    name = pathlib.Path(library).resolve().name
    done = subprocess.run(["dpkg-query", "-S", f"*/{name}"], capture_output=True, text=True)
    return done.stdout.split(":", 1)[0] if done.returncode == 0 else ""


def add_licences(libraries, folder):
    """Writes the licences of {file in the wheel: file of the system}."""
    folder.mkdir(parents=True, exist_ok=True)
    lines, common = [], set()
    for inside, library in sorted(libraries.items()):
        package = package_of(library)
        text = pathlib.Path("/usr/share/doc") / package / "copyright"
        if not package or not text.is_file():
            sys.exit(f"finish_wheel: {library}: no Debian package with a licence, expected one for the copy in the wheel")
        shutil.copy(text, folder / f"{package}.txt")
        common |= set(re.findall(rf"{COMMON}/([A-Za-z0-9.+-]*[A-Za-z0-9])", text.read_text(errors="replace")))
        lines.append(f"{inside} {package}.txt\n")
    for name in sorted(common):
        if (COMMON / name).is_file():
            shutil.copy(COMMON / name, folder / f"{name}.txt")
    (folder / "LIBRARIES").write_text("".join(lines))


def main():
    wheel, log, out = map(pathlib.Path, sys.argv[1:])
    grafted = re.findall(r"Grafting: (\S+) -> \S*?([^/\s]+)$", log.read_text(), re.M)
    libraries = {inside: library for library, inside in grafted}
    with tempfile.TemporaryDirectory() as made:
        run = lambda *words: subprocess.run([sys.executable, "-m", "wheel", *map(str, words)], check=True, stdout=subprocess.DEVNULL)
        run("unpack", "-d", made, wheel)
        (folder,) = pathlib.Path(made).iterdir()
        held = {path.name for path in (folder / "vog.libs").iterdir()}
        if held != set(libraries):
            sys.exit(f"finish_wheel: libraries in the wheel: {sorted(held)}, in auditwheel's log: {sorted(libraries)}")
        add_licences(libraries, folder / "vog" / "licenses")
        run("pack", "-d", made, folder)
        (packed,) = pathlib.Path(made).glob("*.whl")
        with zipfile.ZipFile(packed) as given, zipfile.ZipFile(out / packed.name, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as tight:
            for info in given.infolist():
                tight.writestr(info, given.read(info), compress_type=zipfile.ZIP_DEFLATED, compresslevel=9)
    print(out / packed.name)


if __name__ == "__main__":
    main()
