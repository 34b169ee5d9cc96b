#!/usr/bin/env python3
"""What messages recommend works: each is provoked, its recommendation taken out of its text, and run.

A new message with an option or a command in it fails `test_unprovoked_messages_do_not_exist` until a row provokes it, or NOT_RUN says
why none does. The calls of messages in Python are in tests/python/test_recommendations.py.
"""

import json
import math
import re
import shlex
import struct
import tempfile
import unittest
from pathlib import Path

import command_server

ROOT = Path(__file__).resolve().parents[2]
# Words that stand for a user's file or number in messages.
PLACEHOLDERS = {"MODEL": "m.ply", "VOLUME": "c.nrrd", "FILE.vogz": "o.vogz", "FILE": "c.nrrd", "FOLDER/": "o/", "REFERENCE.png": "a.png",
                "REFERENCE.exr": "a.exr", "X": "2", "N": "3", "NAME": "temperature", "FILE.exr": "o.exr", "CENTRE,WIDTH": "0,2"}

# [command that provokes a message, the recommendation in its text as a pattern, what is run: {0} is the recommendation,
# `+` the first command with it. Options that the first command has are replaced.]
ROWS = [
    # Another option.
    ("render m.ply -o p.png --light head", r"works with (--show volume)", "+"),
    ("render m.ply -o p.png --show slice --plane z --orthographic --view +x", r"edge-on; another (--view)", "+ +z"),
    ("render m.ply -o p.png --slabs 4", r"works with (--show volume)", "+"),
    ("render m.ply -o p.png --range 0,1", r"works with (--show column)", "+"),
    ("render m.ply -o p.png --set least-column=0.1", r"works with (--show mean)", "+ --field temperature"),
    ("render m.ply -o p.png --show mean --field temperature --depth-out t.exr", r"use (--values-out FILE.exr)", "render m.ply -o p.png --show mean --field temperature {0}"),
    ("render m.ply -o p.png --set light-weights=1,1,1,1 --show volume", r"needs (--light)", "+ head"),
    ("render m.ply -o p.png --light-from 1,2,1 --show volume", r"needs (--shadows) or --light studio", "+"),
    ("render m.ply -o p.png --steps", r"needs (--turntable)", "render m.ply m2.ply -o turn/ --steps {0} 2"),
    ("render m.ply -o p.png --set fps=3", r"works with (-o FILE.mp4)", None),
    ("render c.nrrd -o p.png --set step=0.5", r"works with (--interpolation linear)", "+"),
    ("render m.ply -o p.png --renderer trace --set hits-per-slab=4", r"works with (--set anyhit=collect)", "+"),
    ("render m.ply -o p.png --width 3", r"needs (--orthographic)", "+"),
    ("render m.ply -o p.png --camera camera.json --width 3", r"expected (--orthographic)", "+"),
    ("render m.ply -o p.png --show mean", r"needs (--field NAME)", "+"),
    ("render fire.vdb -o p.png --show mean", r"\((vog info fire.vdb) lists", "{0}"),
    ("render m.ply -o p.png --renderer trace --set anyhit=collect --set stop-transmittance=0.1", r"expected (--extinction) with a number", "+ 2"),
    ("render m.ply -o t.png --turntable 3", r"expected a folder", "render m.ply -o t/ --turntable 3"),
    ("render m.ply --turntable 3", r"\((turn/)\)", "render m.ply --turntable 3 -o {0}"),
    ("render m.ply -o t.mp4", r"several pictures: (--turntable N)", None),
    ("render m.ply m2.ply -o p/ --depth-out t.exr", r"needs a (folder)", "render m.ply m2.ply -o p/ --depth-out t/"),
    ("render m.ply m2.ply -o p/ --values-out t.npy", r"needs a (folder)", "render m.ply m2.ply -o p/ --values-out t/"),
    ("render m.ply m2.ply -o p/ --show column", r"\((--range) sets", "+ 0,3"),
    ("render m.ply -o p.png --look-at 900,0,0", r"(--look-at), --distance", "render m.ply -o p.png {0} 6,6,6"),
    ("render m.ply -o p.png --clip 900,0,0,901,1,1", r"(--clip) cuts away", "+ -9,-9,-9,9,9,9"),
    ("render m.ply -o p.png --show volume", r"\(((?:--scale log )?--range \S+ --unit-distance \S+) repeats it", "+"),
    ("render c.nrrd -o p.png --renderer splat", r"convert it first: (vog convert .*)", "{0}"),
    ("render jaw.ply -o p.png", r"vog render VOLUME (--show volume --layer) MESH.ply", "render c.nrrd -o p.png {0} jaw.ply,color=white"),
    ("render two.vdb -o p.png --grid 'density_*' --interpolation linear --show volume", None, None),
    ("render c.nrrd -o p.png --show volume --interpolation linear --set step=0", r"expected a (step > 0)", "render c.nrrd -o p.png --show volume --interpolation linear --set step=1"),
    # Values that are no density.
    ("render signed.nrrd -o p.png", r"(--clip-negative)", "+"),
    ("render signed.nrrd -o p.png", r"vog render (--show volume) draws", "+"),
    ("render signed.nrrd -o p.png", r"vog convert (--measure volume)", "convert signed.nrrd -o s.ply {0}"),
    ("convert signed.nrrd -o s.ply", r"(--clip-negative)", "+"),
    ("page signed.nrrd -o s.html", r"(--clip-negative)", "+"),
    ("render nan.nrrd -o p.png", r"(--skip-nonfinite)", "+"),
    ("render nan.csv -o p.png", r"(--skip-nonfinite)", "+"),
    ("render nan.ply -o p.png", r"(--skip-nonfinite)", "+"),
    ("evaluate c.nrrd nan.ply -o e/ --size 16", r"(--skip-nonfinite)", "+"),
    ("info nan.ply", r"(--skip-nonfinite)", "render nan.ply -o p.png {0}"),
    ("pack none.ply -o n.vogz --max-loss 1 --reference nan.nrrd", r"(--skip-nonfinite)", "+"),
    ("render fire.vdb -o p.png --set background-value=1", r"with (--set background-value)", "render c.nrrd -o p.png --set background-value=1"),
    ("convert c.nrrd ct.nrrd -o q.ply --combine mesh", r"\((--set background-value)=VALUE", "convert c.nrrd ct.nrrd -o q.ply --combine mesh --set background-value=-1000"),
    # Columns that are not sure.
    ("render whole.xyz -o p.png --radius 1", r"or (--columns 1,2,3)", "+"),
    ("render seven.xyz -o p.png --radius 1", r"(--columns) names others", "+ 1,2,3"),
    ("render counted.csv -o p.png --radius 1", r"without names.*(--columns) names others", "+ 2,3,4"),
    ("render few.csv -o p.png --radius 1", r"three columns \((--columns)\)", "+ 1,2,3"),
    ("render twice.csv -o p.png --radius 1", r"three columns \((--columns)\)", "+ 1,3,4"),
    ("render weights.csv -o p.png --value w", r"(--clip-negative)", "+"),
    ("render smooth.csv -o p.png", r"(--radius adaptive)", "+"),
    ("render smooth.csv -o p.png --periodic", r"expected (--periodic) EDGE", "render smooth.csv -o p.png {0} 9"),
    # Several volumes.
    ("render c.nrrd beside.nrrd -o p.png", r"(--combine sum) \(densities", "+"),
    ("render c.nrrd beside.nrrd -o p.png", r"(--combine mesh) \(the finest", "+"),
    ("render c.nrrd beside.nrrd -o p.png", r"(-o FOLDER/)", "+"),
    ("page c.nrrd beside.nrrd -o p.html", r"(-o FOLDER/)", "+"),
    # Fields.
    ("render none.ply -o p.png --show volume", r"(vog convert VOLUME -o model.ply) makes", "{0}"),
    ("render p.xyz -o p.png --show volume", r"\((vog convert p.xyz --field) NAME", "{0} speed -o q.ply"),
    ("render none.ply -o p.png --show mean --field heat", r"(vog convert VOLUME -o model.ply --field \S+)", None),
    ("render m.ply -o p.png --show mean --field heat", r"expected one of (\w+)", "render m.ply -o p.png --show mean --field {0}"),
    ("render m.ply -o p.png --show volume --field heat", r"\(scalar fields: (\w+)", "render m.ply -o p.png --show volume --field {0}"),
    ("render pv.ply -o p.png --show volume --field velocity.magnitude", r"(--show mean --field velocity.magnitude)", "render pv.ply -o p.png {0}"),
    ("render pv.ply -o p.png --show volume --field velocity", r"(--show mean --field velocity)", "render pv.ply -o p.png {0}"),
    ("page pv.ply -o p.html --show maximum --field velocity.x", r"(--show mean --field velocity.x)", "page pv.ply -o p.html {0}"),
    ("render fire.vdb -o p.png --show volume --field temperature.x", r"use (--field temperature)", "render fire.vdb -o p.png --show volume {0}"),
    ("convert fire.vdb -o q.ply --field 'a b=temperature'", r"NAME=... states one", "convert fire.vdb -o q.ply --field ab=temperature"),
    ("convert fire.vdb -o q.ply --field x=temperature", r"NAME=... states one", "convert fire.vdb -o q.ply --field ab=temperature"),
    ("convert fire.vdb -o q.ply --field temperature --field temperature", r"NAME=...", "convert fire.vdb -o q.ply --field temperature --field ab=temperature"),
    ("convert named.csv -o q.ply", r"(--columns)", "+ a,b,c"),
    # Outputs.
    ("voxelize c.nrrd -o v.vdb --voxel-size 2", r"from (vog convert)", "{0} c.nrrd -o q.ply"),
    ("voxelize m.ply -o v.vdb --like m.ply", r"--like needs a .vdb or .nvdb", "voxelize m.ply -o v.vdb --like fire.vdb"),
    ("convert c.nrrd", r"-o is missing: (vog .*)", "{0}"),
    ("page m.ply", r"-o is missing: (vog .*)", "{0}"),
    ("voxelize m.ply", r"-o is missing: (vog .*)", "{0}"),
    ("voxelize m.ply -o v.vdb", r"voxels: (--voxel-size X)", "+"),
    ("voxelize m.ply -o v.vdb", r"or (--like FILE)", "+"),
    ("voxelize m.ply -o v.vdb --voxel-size 2 --within", r"needs (--like)", "voxelize m.ply -o v.vdb --within {0} fire.vdb"),
    ("export m.ply -o p.html", r"use (vog page .*)", "{0}"),
    ("export m.ply -o p.vogz", r"use (vog pack .*)", "{0}"),
    ("page m.ply -o p.glb", r"use (vog export .*)", "{0}"),
    ("pack m.ply -o sitef/", r"use (vog page .*)", "{0}"),
    ("export m.ply -o p.ply", r"give (--as 3dgs)", "+"),
    ("export m.ply -o p5.ply", r"use (vog convert .*)", "{0}"),
    ("export m.ply -o p.spz --as 3dgs", r"works with (-o FILE.ply --as 3dgs)", "export m.ply {0}"),
    ("page m.ply -o p.html --max-loss 1", r"only in vog (pack)", "{0} m.ply -o p.vogz --max-loss 1"),
    ("page m.ply -o p.html --site", r"works with (-o FOLDER/)", "page m.ply -o site1/ --site"),
    ("page m.ply m2.ply -o p.html --name one", r"one name per model", "page m.ply m2.ply -o p.html --name one --name two"),
    ("page 'm*.ply' -o p.html", r"\((--no-steps):", "+"),
    ("page m.ply -o p.html --from https://e.org", r"compact model \((.vogz)\)", "page m.vogz -o p.html --from https://e.org"),
    ("page m.ply -o site2/", r"(vog serve \S+) shows", None),
    ("page m.ply -o p.html --scale pixels", r"not in \{auto,(linear)", "page m.ply -o p.html --show column --scale {0}"),
    ("page m.ply -o p.html --scale log", r"works with (--show column)", "+"),
    ("view m.ply --headless", r"needs (--script)", None),
    # Conversions.
    ("convert c.nrrd -o m3.ply --set joint-steps=3", r"needs (--for)", "+ volume"),
    ("convert c.nrrd -o m3.ply --method paper --set tree-depth=2", r"works with (--set strategy=tree)", "+"),
    ("convert c.nrrd -o m3.ply --set measure-error=1", r"needs (--block)", "+ 4"),
    ("convert c.nrrd -o m3.ply --set scratch=.", r"needs (--memory)", "+ 1G"),
    ("convert fine.nrrd -o m3.ply --for none --error 0.000001", r"(--error \S+) needs", "+"),
    ("convert same.csv -o m3.ply", r"\((--radius X)\)", "+"),
    ("convert seconds.csv -o m3.ply", r"\((--radius adaptive)", "+"),
    ("convert c.nrrd -o models/", r"\((--again) converts", "+"),
    # Files of other programs, and words.
    ("a.png", r"(vog compare REFERENCE.png \S+)", "{0}"),
    ("a.exr", r"(vog compare REFERENCE.exr \S+)", "{0}"),
    ("camera.json", r"(vog render FILE -o picture.png --camera \S+)", "{0}"),
    ("map.json", r"(vog render FILE -o picture.png --tf \S+)", "{0}"),
    ("empty", r"\((vog convert --help) lists", "{0}"),
    ("rendr m.ply", r"mean '(vog render)'", "{0} m.ply -o p.png"),
    ("render m.ply -o p.png --siez 3", r"mean (--size)", "render m.ply -o p.png {0} 3"),
    ("convert c.nrrd -o m3.ply --distance 3", r"only in vog (render)", "render c.nrrd -o p.png --distance 3"),
    ("convert c.nrrd -o m3.ply --nothing", r"(vog convert --help-all)", "{0}"),
]
# Messages whose recommendation no run here can follow: [part of the literal, the reason].
NOT_RUN = [
    ("has arrays, but no Coordinates", "tests/io/points"),
    ("particles with a number that", "tests/io/points"), ("the default stops at", "a fact, of large volumes"), ("is a vector, but --show", "needs a grid of vectors"),
    ("with --show volume is of one", "recommends nothing"), ("xdg-open", "needs a desktop"), ("every machine that reaches", "a warning"), ("--host {}", "needs the network of this machine"),
    ("http.server", "of builds without cpp-httplib"), ("no display to open", "needs a desktop"), ("peak memory", "needs more memory than the limit"),
    ("--open:", "needs a desktop"),
    ("one process (vog", "tests/mpi"), ("or vog render", "tests/mpi"), ("only in vog render", "tests/mpi"), ("vog-mpi", "tests/mpi"), ("at least one Gaussian per rank", "tests/mpi"), ("is evaluated by one process", "tests/mpi"),
    ("no hierarchy is written", "tests/mpi"), ("uniform cells are hard", "tests/mpi"), ("one build of vog", "tests/mpi"),
    ("vog page writes single pages", "tests/mpi"), ("which vog pack packs", "tests/mpi"), ("vog convert reads models", "tests/mpi"), ("strategy variance", "tests/mpi"), ("strategy neighbours", "tests/mpi"), ("makes no films", "tests/mpi"),
    ("is of T, --show", "needs a GPU"), ("--set anyhit=collect", "needs a GPU"), ("cuda", "needs a GPU"),
    ("films have no transparency", "needs ffmpeg"), ("a level set, expected", "tests/io/vdb writes level sets"),
    ("positions beyond 24", "tests/io/exchange"), ("standard deviations from", "tests/io/exchange"), ("positions of 24 bits", "tests/io/exchange"),
    ("usdcat", "a program of OpenUSD"), ("python -m vog.report", "tests/python/test_report.py"), ("splats, expected", "tests/io/exchange"), ("no steps in time are open", "tests/viewer"), ("vog view", "tests/viewer"),
    ("vog evaluate needs a volume", "tests/cli/command_line_test.cpp"), ("vog evaluate writes a folder", "tests/cli/inputs_test.cpp"),
    ("is the picture of --request", "tests/cli/request_command_test.cpp"), ("expected it as '--field' in 'reading'", "tests/cli/request_command_test.cpp"),
    ("docs/viewer.md", "names a document"), ("voxels take more than", "needs a lattice of terabytes"),
    ("an incomplete site", "tests/cli/site_command_test.cpp"), ("a folder without {}; expected a site", "tests/cli/serve_refusals_test.py"),
    ("no manifest of a site", "tests/io/site"), ("expected a site (a folder", "tests/cli/serve_refusals_test.py"), ("one that vog page wrote", "tests/io/site"),
    ("--hierarchy --deflate", "tests/cli/serve_test.py"), ("columns are of text files", "recommends nothing"), ("pip install", "names a package"),
    ("convert(volume, fields=...)", "tests/python"), ("Levels(volumes, force=True)", "tests/python"), ("vog.set_units", "tests/python"), ("vog.Field", "tests/python"),
    ("joint_field and fields", "tests/python"), ("vog.convert(cells)", "tests/python/test_cells.py"), ("choose one with --grid", "tests/io/points"), ("choose some with --grid", "tests/io/points"),
]
# A message that names options, and recommends none: a value is wrong, or a fact is told.
STATES_ONLY = re.compile(
    r"^(?:\{\}: |: )?(?:--[a-z-]+[ :,]|'?\{\}'?: '\{\}' of)|--set opacity-threshold=\{\}|^\{\}: error by value|grid '\{\}', expected|from --reference"
    r"|is of --show volume|default options of vog convert|the model has no field for|no field\{\}, expected|--mask '\{\}'")


def messages():
    """Literals of errors and notes that name an option, a command or a call: [(file, text)]."""
    calls = re.compile(r"\b(Error|ValidationError|note|fail|refuse|print_line|push_back)\b")
    recommends = re.compile(r"--[a-z]|\bvog(-mpi)? [a-z]|\bvog\.[a-zA-Z]|pip install|=\.\.\.|force=True")
    for folder, ending in (("src", "cpp"), ("apps", "cpp"), ("python", "cpp")):
        for file in sorted((ROOT / folder).rglob(f"*.{ending}")):
            if file.name == "option_effects.cpp":  # tried by option_effects_test.py
                continue
            text = re.sub(r'R"\((.|\n)*?\)"', '""', file.read_text())
            text = re.sub(r"^\s*//.*$", "", text, flags=re.M)
            for found in re.finditer(r'((?:"(?:[^"\\\n]|\\.)*"\s*)+)', text):
                literal = "".join(re.findall(r'"((?:[^"\\\n]|\\.)*)"', found[1]))
                head = text[max(text.rfind(mark, 0, found.start()) for mark in ";{}") + 1:found.start()]
                if calls.search(head) and "->" not in head[-60:] and "add_option" not in head and len(literal) > 24 and recommends.search(literal):
                    yield file, literal


def as_pattern(literal):
    parts = re.split(r"\{[^{}]*\}", literal.replace('\\"', '"'))
    return ".*".join(re.escape(part) for part in parts)


class Recommendations(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.made.name)
        make_inputs(cls)
        cls.seen = ""

    @classmethod
    def tearDownClass(cls):
        cls.made.cleanup()

    @classmethod
    def vog(cls, words, fails=False):
        done = command_server.run(words, cls.folder)
        text = (done.stdout + done.stderr).decode(errors="replace")
        assert fails or done.returncode == 0, f"vog {shlex.join(words)}: {text}"
        return done.returncode, text

    def followed(self, words, row, message):
        first, pattern, then = row
        found = re.search(pattern, message)
        self.assertTrue(found, f"vog {first}\n{message}expected {pattern}")
        if then is None:
            return
        recommended = [PLACEHOLDERS.get(word, word) for word in shlex.split(found[found.lastindex or 0])]
        if then.startswith("+"):
            option, more = recommended[0], shlex.split(then[1:])
            if option in words:  # another value
                at = words.index(option)
                words = words[:at] + words[at + 2:]
            run = [*words, *recommended, *more]
        else:
            run = [part for word in shlex.split(then) for part in (recommended if word == "{0}" else [word.replace("{0}", recommended[0])])]
        run = run[1:] if run[0] == "vog" else run
        self.vog(run)

    def test_recommendations_work(self):
        for row in ROWS:
            if row[1] is None:
                continue
            with self.subTest(row[0]):
                words = shlex.split(row[0])
                message = self.vog(words, fails=True)[1]
                type(self).seen += message
                self.followed(words, row, message)

    def test_unprovoked_messages_do_not_exist(self):
        for file, literal in messages():
            if any(part in literal for part, _ in NOT_RUN) or STATES_ONLY.search(literal):
                continue
            with self.subTest(f"{file.relative_to(ROOT)}: {literal}"):
                self.assertTrue(re.search(as_pattern(literal), self.seen), "no row of ROWS provokes it")


def make_inputs(case):
    def volume(name, value, edge=12, origin=0):
        cells = [value(x, y, z) for z in range(edge) for y in range(edge) for x in range(edge)]
        head = (f"NRRD0004\ntype: float\ndimension: 3\nsizes: {edge} {edge} {edge}\nspace dimension: 3\n"
                f"space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: ({origin},0,0)\nendian: little\nencoding: raw\n\n")
        (case.folder / name).write_bytes(head.encode() + struct.pack(f"<{len(cells)}f", *cells))

    def ball(x, y, z):
        return max(0.0, 6 - ((x - 5) ** 2 + (y - 6) ** 2 + (z - 5) ** 2) ** 0.5)

    volume("c.nrrd", ball)
    volume("fine.nrrd", lambda x, y, z: max(0.0, 12 - math.dist((x, y, z), (12, 12, 12))), edge=24)
    volume("beside.nrrd", ball, origin=3)
    volume("ct.nrrd", lambda x, y, z: 100 * ball(x, y, z) - 1000, origin=12)
    volume("signed.nrrd", lambda x, y, z: ball(x, y, z) - 1)
    volume("nan.nrrd", lambda x, y, z: float("nan") if x == 5 else ball(x, y, z))
    rows = [f"{n * 7 % 11},{n * 5 % 13},{n * 3 % 17}" for n in range(100)]
    (case.folder / "nan.csv").write_text("\n".join(["x,y,z", *rows, "nan,1,2"]) + "\n")
    (case.folder / "weights.csv").write_text("\n".join(["x,y,z,w", *(row + ",1" for row in rows), "1,1,2,-3"]) + "\n")
    (case.folder / "smooth.csv").write_text("\n".join(["x,y,z,smoothing_length", *(row + ",0.5" for row in rows)]) + "\n")
    (case.folder / "named.csv").write_text("\n".join(["a,b,c", *rows]) + "\n")
    (case.folder / "whole.xyz").write_text("2\nwater\n1 2 3 4\n8 3 4 5\n")
    (case.folder / "seven.xyz").write_text("1 2 3 4 5 6 7\n8 3 4 5 6 7 8\n")
    (case.folder / "counted.csv").write_text(",0,1,2\n0,1,2.5,3\n1,3,2.5,4\n")
    (case.folder / "few.csv").write_text("x,y,z\n" + "1,2,3,4,5\n3,2,3,4,5\n")
    (case.folder / "twice.csv").write_text("x,x,y,z\n" + "1,2,3,4\n3,2,3,4\n")
    names = ["x", "y", "z", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    (case.folder / "nan.ply").write_text("\n".join(["ply", "format ascii 1.0", "element vertex 3", *("property float " + name for name in names), "end_header",
                                                    "0 0 0 0 0 0 0 1 0 0 0", "1 1 1 0 0 0 0 1 0 0 0", "nan 0 0 0 0 0 0 1 0 0 0"]) + "\n")
    (case.folder / "jaw.ply").write_text("\n".join(["ply", "format ascii 1.0", "element vertex 3", *("property float " + name for name in "xyz"), "element face 1",
                                                     "property list uchar int vertex_indices", "end_header", "0 0 0", "9 0 9", "0 9 9", "3 0 1 2"]) + "\n")
    (case.folder / "same.csv").write_text("x,y,z\n" + "1,1,1\n" * 9)
    (case.folder / "seconds.csv").write_text("\n".join(["x,y,z,hsml", "m,m,m,s", *(row + ",0.5" for row in rows)]) + "\n")
    (case.folder / "map.json").write_text('{"colors": [[0, 0, 0, 0], [1, 1, 0.5, 0]]}')
    (case.folder / "empty").mkdir()
    (case.folder / "t.vog").write_text("wait\n")
    for line in ["sample fire fire.vdb --size 64", "sample amr amr.vdb --size 64", "sample particles p.xyz --size 8",
                 "convert fire.vdb -o m.ply --block 8 --field temperature", "convert fire.vdb -o m2.ply --block 16 --field temperature",
                 "convert c.nrrd -o none.ply --block 4 --no-fields", "convert p.xyz -o pv.ply --field velocity",
                 "convert c.nrrd -o models/ --block 4", "pack m.ply -o m.vogz --hierarchy --deflate",
                 "render m.ply -o a.png --size 16 --depth-out a.exr"]:
        case.vog(line.split())
    (case.folder / "camera.json").write_text(json.dumps(json.loads(case.vog(["render", "m.ply", "-o", "a.png", "--size", "16", "--json"])[1])["camera"]))


if __name__ == "__main__":
    unittest.main()
