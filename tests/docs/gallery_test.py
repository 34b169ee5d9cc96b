#!/usr/bin/env python3
"""Runs every task of docs/gallery.md in a folder of its own, as a reader would, and compares the pictures with the page's.

Blocks of ```sh and ```python are run; blocks behind a line `NAME`: are files. VOG_COMMAND names the command, VOG_BUILD the
build folder. VOG_WRITE_GALLERY=1 replaces the page's pictures by those made now.
"""

import os
import re
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "gallery.md"
BUILD = Path(os.environ.get("VOG_BUILD", ROOT / "build" / "release"))
COMMAND = Path(os.environ.get("VOG_COMMAND", BUILD / "apps" / "cli" / "vog"))
IMAGES = ROOT / "docs" / "images" / "gallery"
# Mean difference of two pictures in 255ths: rounding of other processors, not another picture.
MOST_DIFFERENCE = 0.5

BLOCK = re.compile(r"(?:`(?P<file>[\w.]+)`:\n\n)?```(?P<language>\w+)\n(?P<text>.*?)```", re.S)


def sections():
    """Title and text of each task."""
    parts = re.split(r"^## (.*)$", PAGE.read_text(), flags=re.M)
    return dict(zip(parts[1::2], parts[2::2]))


def pixels(file):
    """Size, channels and bytes of a PNG of 8 bits a channel, not interlaced."""
    data = file.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n", file
    at, body, head = 8, b"", None
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + size]
        head = chunk if kind == b"IHDR" else head
        body += chunk if kind == b"IDAT" else b""
        at += 12 + size
    width, height, depth, color, _, _, interlace = struct.unpack(">IIBBBBB", head)
    assert depth == 8 and interlace == 0, file
    channels = {0: 1, 2: 3, 4: 2, 6: 4}[color]
    raw, stride = zlib.decompress(body), width * channels
    before, rows = bytearray(stride), []
    for y in range(height):
        method = raw[y * (stride + 1)]
        row = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for x in range(stride):
            left = row[x - channels] if x >= channels else 0
            up = before[x]
            corner = before[x - channels] if x >= channels else 0
            if method == 1:
                row[x] = (row[x] + left) & 255
            elif method == 2:
                row[x] = (row[x] + up) & 255
            elif method == 3:
                row[x] = (row[x] + (left + up) // 2) & 255
            elif method == 4:
                p = left + up - corner
                near = min((abs(p - left), 0, left), (abs(p - up), 1, up), (abs(p - corner), 2, corner))
                row[x] = (row[x] + near[2]) & 255
        rows.append(bytes(row))
        before = row
    return (width, height, channels), b"".join(rows)


class Gallery(unittest.TestCase):
    """One test a task, added below."""

    def environment(self, folder):
        if not hasattr(Gallery, "prefix"):
            Gallery.prefix = Path(Gallery.folder.name) / "prefix"
            subprocess.run(["cmake", "--install", str(BUILD), "--prefix", str(Gallery.prefix)], check=True,
                           capture_output=True)
        paths = [str(COMMAND.parent), str(BUILD / "apps" / "mpi"), os.environ["PATH"]]
        return {**os.environ, "PATH": ":".join(paths), "CMAKE_PREFIX_PATH": str(Gallery.prefix),
                "LD_LIBRARY_PATH": str(BUILD / "src"), "PYTHONPATH": str(BUILD / "python"), "HOME": str(folder),
                "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
                "OMPI_MCA_rmaps_base_oversubscribe": "1"}

    def run_task(self, text):
        folder = Path(tempfile.mkdtemp(dir=Gallery.folder.name))
        environment = self.environment(folder)
        ran = 0
        for block in BLOCK.finditer(text):
            if block["file"]:
                (folder / block["file"]).write_text(block["text"])
                continue
            if block["language"] == "python":
                command = [sys.executable, "-c", block["text"]]
            elif block["language"] == "sh":
                command = ["bash", "-eu", "-c", block["text"]]
            else:
                continue
            if "mpirun" in block["text"] and not (BUILD / "apps" / "mpi" / "vog-mpi").exists():
                self.skipTest("this build has no vog-mpi")
            if block["language"] == "python" and not any((BUILD / "python" / "vog").glob("_vog*.so")):
                self.skipTest("this build has no Python package")
            done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300)
            self.assertEqual(done.returncode, 0, f"{block['text']}\n{done.stdout}{done.stderr}")
            ran += 1
            for name in re.findall(r"(?:-o|--values-out|--depth-out) (\S+)", block["text"]):
                made = folder / name
                self.assertTrue(made.exists(), f"{name} was not written")
                self.assertGreater(len(list(made.iterdir())) if made.is_dir() else made.stat().st_size, 0, name)
        self.assertGreater(ran, 0, "a task without lines to run")
        for name in re.findall(r"\(images/gallery/(\w+)\.png\)", text):
            self.compare(folder, name)

    def compare(self, folder, name):
        made = folder / f"{name}.png"
        if not made.exists():  # of a folder of pictures the first
            made = sorted((folder / name).glob("*.png"))[0]
        shown = IMAGES / f"{name}.png"
        if os.environ.get("VOG_WRITE_GALLERY"):
            IMAGES.mkdir(parents=True, exist_ok=True)
            shutil.copy(made, shown)
        size, new = pixels(made)
        self.assertGreater(len(set(new[::size[2]])), 8, f"{name} is blank")
        old_size, old = pixels(shown)
        self.assertEqual(size, old_size, name)
        difference = sum(abs(a - b) for a, b in zip(new, old)) / len(new)
        self.assertLess(difference, MOST_DIFFERENCE, f"{name} is another picture than the page's")


def test_of(text):
    return lambda self: self.run_task(text)


for title, text in sections().items():
    setattr(Gallery, "test_" + re.sub(r"\W+", "_", title.lower()), test_of(text))


class Page(unittest.TestCase):
    def test_has_ten_tasks_and_no_picture_that_no_task_makes(self):
        self.assertEqual(len(sections()), 10)
        shown = set(re.findall(r"\(images/gallery/([\w.]+)\)", PAGE.read_text()))
        self.assertEqual(shown, {file.name for file in IMAGES.iterdir()})


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        class Folder:
            name = made
        Gallery.folder = Folder
        unittest.main(verbosity=2)
