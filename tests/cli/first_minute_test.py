#!/usr/bin/env python3
"""A newcomer's first minute: vog FILE, help, completion in real shells, manual pages, vog doctor, remedies for mistakes."""

import importlib.util
import json
import os
import pty
import re
import select
import shutil
import signal
import struct
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

VOG = os.environ.get("VOG_COMMAND", "vog")
COMMANDS = ["sample", "info", "convert", "render", "compare", "evaluate", "view", "page", "pack", "export", "serve", "voxelize", "doctor", "completion", "man"]


def run(*words, folder=None, program=VOG):
    return subprocess.run([program, *words], cwd=folder, capture_output=True, text=True, timeout=120)


def needs(program):
    return unittest.skipUnless(shutil.which(program), f"{program} is not installed")


def write_ct(path):
    """Writes a ball of 40 in air of -1000, in Hounsfield units, 16 voxels an edge, as NIfTI-1."""
    edge, head = 16, bytearray(352)
    struct.pack_into("<i", head, 0, 348)
    struct.pack_into("<8h", head, 40, 3, edge, edge, edge, 1, 1, 1, 1)
    struct.pack_into("<2h", head, 70, 4, 16)  # int16
    struct.pack_into("<8f", head, 76, 1, 2, 2, 2, 0, 0, 0, 0)
    struct.pack_into("<3f", head, 108, 352, 1, 0)  # offset of the values, slope, intercept
    head[344:348] = b"n+1\0"
    inside = lambda *place: sum((p - edge / 2 + 0.5) ** 2 for p in place) < (edge / 3) ** 2
    values = [40 if inside(x, y, z) else -1000 for z in range(edge) for y in range(edge) for x in range(edge)]
    path.write_bytes(bytes(head) + struct.pack(f"<{len(values)}h", *values))


class Case(unittest.TestCase):
    def setUp(self):
        made = tempfile.TemporaryDirectory()
        self.addCleanup(made.cleanup)
        self.folder = Path(made.name)

    def vog(self, *words):
        done = run(*words, folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refusal(self, *words, code=None):
        done = run(*words, folder=self.folder)
        self.assertNotEqual(done.returncode, 0, done.stdout)
        if code:
            self.assertEqual(done.returncode, code, done.stderr)
        lines = [line for line in done.stderr.splitlines() if line != "Run with --help for usage."]
        self.assertEqual(len(lines), 1, done.stderr)
        self.assertEqual(done.stdout, "")
        return lines[0]


class Files(Case):
    def steps(self, text):
        return [line.split("   # ")[0].strip() for line in text.split("Try:\n")[1].splitlines()]

    def try_steps(self, *names):
        text = self.vog(*names)
        steps = self.steps(text)
        self.assertGreaterEqual(len(steps), 2, text)
        for step in steps:
            if step.startswith("vog view"):  # opens a window
                continue
            done = subprocess.run(["bash", "-c", step.replace("vog ", f"'{VOG}' ", 1)], cwd=self.folder, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, f"{step}\n{done.stderr}")
        return text

    def test_every_proposed_command_works(self):
        for kind, name in [("cloud", "cloud.vdb"), ("amr", "amr.vdb"), ("fire", "my fire.vdb"), ("particles", "box.xyz")]:
            self.vog("sample", kind, name, *(["--size", "64"] if kind != "particles" else ["--size", "10"]))
            self.try_steps(name)
        write_ct(self.folder / "ct.nii")
        for name in ["ct.nii", "cloud.ply", "box.ply", "ct.ply"]:
            self.try_steps(name)

    def test_splats_with_nan_are_counted_and_left_out(self):
        names = "x y z scale_0 scale_1 scale_2 rot_0 rot_1 rot_2 rot_3 opacity f_dc_0".split()
        head = "ply\nformat ascii 1.0\nelement vertex 3\n" + "".join(f"property float {name}\n" for name in names) + "element frame 1\nproperty int n\nend_header\n"
        rows = [f"{x} 0 0 -1 -1 -1 1 0 0 0 1 0" for x in ("0", "nan", "2")]
        (self.folder / "s.ply").write_text(head + "\n".join(rows) + "\n7\n")
        self.assertIn("1 more, which --skip-nonfinite leaves out", self.try_steps("s.ply"))
        self.assertIn("1 splats with a number that is not finite, or with a rotation of 0, the first is number 1", self.refusal("render", "s.ply", "-o", "a.png"))
        done = run("render", "s.ply", "-o", "a.png", "--skip-nonfinite", folder=self.folder)
        self.assertEqual((done.returncode, done.stderr.count("1 value not finite, left out")), (0, 1), done.stderr)
        self.vog("voxelize", "s.ply", "-o", "s.vdb", "--voxel-size", "0.5", "--skip-nonfinite")

    def test_particles_under_an_unknown_name(self):
        for name, text in [("a.particles", "# t\n1 2 3\n4 5 6\n"), ("scan", "1;2;3\n4;5;6"), ("rows.ascii", "x,y,z\n1,2,3\n4,5,6\n")]:
            (self.folder / name).write_text(text)
            for command in ([], ["info"], ["render"]):
                more = ["-o", "a.png"] if command == ["render"] else []
                self.assertIn(f"of a text with numbers; call it {name}.txt", self.refusal(*command, name, *more))
            (self.folder / name).rename(self.folder / f"{name}.txt")
            self.assertIn("count          2", self.vog("info", f"{name}.txt"))
        (self.folder / "words.doc").write_text("1 2 words\n")
        self.assertIn("unknown extension '.doc', expected", self.refusal("info", "words.doc"))

    def test_particles_with_nan_are_left_out(self):
        (self.folder / "nan.csv").write_text("x,y,z\n0,0,0\n1,2,3\nnan,1,2\n4,5,6\n")
        self.assertIn("1 value not finite, left out", self.try_steps("nan.csv"))

    @unittest.skipUnless(importlib.util.find_spec("h5py"), "h5py is not installed")
    def test_snapshots_of_several_types(self):
        import h5py

        for part, types in enumerate([{"PartType0": 30, "PartType1": 20, "PartType4": 0}, {"PartType1": 10, "PartType5": 3}]):
            with h5py.File(self.folder / f"s.{part}.hdf5", "w") as file:
                for name, count in types.items():
                    group = file.create_group(name)
                    place = [[n % 5, n // 5 % 5, n / 7] for n in range(count)]
                    group.create_dataset("Coordinates", (count, 3), "f8", place)
                    group.create_dataset("Masses", (count,), "f8", [2e43] * count)
        text = self.try_steps("s.0.hdf5")
        for words in ["particles 'PartType0'", "particles 'PartType1'", "2e+43"]:
            self.assertIn(words, text)
        self.assertNotIn("PartType4", text)
        contents = json.loads(self.vog("info", "s.0.hdf5", "--json"))["files"][0]["points"]
        self.assertEqual([(one["type"], one["particles"]) for one in contents], [("PartType0", 30), ("PartType1", 20)])
        self.try_steps("s.0.hdf5", "s.1.hdf5")
        done = run("render", "s.0.hdf5", "s.1.hdf5", "-o", "a.png", "--grid", "PartType5", "--value", "Masses", folder=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("s.0.hdf5: no particles of PartType5", done.stderr)
        self.assertIn("'Masses' is divided by 1e+43", done.stderr)

    def test_folders_and_several_files(self):
        for n in (1, 2):
            self.vog("sample", "cloud", f"step_{n}.vdb", "--size", "64")
        self.assertIn("2 .vdb", self.vog("."))
        self.assertIn("vog convert", self.vog("step_1.vdb", "step_2.vdb"))
        (self.folder / "empty").mkdir()
        self.assertIn("without files that vog reads", self.refusal("empty"))

    def test_render_names_what_it_wrote_and_costs_no_file(self):
        self.vog("sample", "cloud", "cloud.vdb", "--size", "64")
        self.assertIn("cloud.png", self.vog("render", "cloud.vdb", "--size", "32"))
        first = (self.folder / "cloud.png").read_bytes()
        self.assertIn("cloud-2.png", self.vog("render", "cloud.vdb", "--size", "48"))
        self.assertEqual((self.folder / "cloud.png").read_bytes(), first)
        self.assertIn("-o", self.refusal("render", "cloud.vdb", "--turntable", "3", code=2))


class Help(Case):
    def test_common_options_first_and_all_on_request(self):
        for command in ["convert", "render", "page", "pack", "export", "evaluate", "view"]:
            some, every = self.vog(command, "--help"), self.vog(command, "--help-all")
            count = lambda text: len(set(re.findall(r"^  (?:-\w,)?(--set [\w-]+|--[\w-]+)", text, re.M)))
            self.assertLessEqual(count(some), 13, command)
            self.assertGreater(count(every), 15, command)
            hidden = int(re.search(r"(\d+) more options", some)[1])
            self.assertEqual(count(every), count(some) + hidden, command)

    def test_no_command_is_the_help(self):
        self.assertEqual(self.vog(), self.vog("--help"))
        self.assertEqual(self.vog("help", "render"), self.vog("render", "--help"))
        self.assertRegex(self.vog("--version"), r"^vog \d+\.\d+\.\d+ \(commit [0-9a-f]{7,12}\+?|unknown, \w+\)\n$")

    def test_manual_pages_have_every_option(self):
        for command in COMMANDS:
            page = self.vog("man", command).replace("\\-", "-")
            for option in re.findall(r"--[a-z][\w-]+", self.vog(command, "--help-all")):
                self.assertIn(option, page, command)
        self.assertIn("expected", self.refusal("man", "nothing"))
        self.assertIn("cannot write", self.refusal("man", "absent/"))
        (self.folder / "man").mkdir()
        self.vog("man", "man/")
        self.assertEqual(sorted(path.name for path in (self.folder / "man").iterdir()), sorted(["vog.1", *(f"vog-{command}.1" for command in COMMANDS)]))
        self.assertEqual((self.folder / "man/vog-render.1").read_text(), self.vog("man", "render"))

    @needs("groff")
    def test_manual_pages_are_clean_roff(self):
        for command in ["", *COMMANDS]:
            page = run("man", *([command] if command else [])).stdout
            done = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z"], input=page, capture_output=True, text=True)
            self.assertEqual(done.stderr, "", command)


class Shell:
    """An interactive shell on a terminal of its own, in a `with` block."""

    WAIT_S = 60  # on a busy machine

    def __init__(self, folder, *words):
        self.process, self.terminal = pty.fork()
        if self.process == 0:
            os.chdir(folder)
            path = f"{Path(VOG).resolve().parent}:{os.environ['PATH']}"
            os.execvpe(words[0], words, {"PATH": path, "HOME": str(folder), "TERM": "dumb", "PS1": "ready> ", "LANG": "C.UTF-8"})

    def __enter__(self):
        return self

    def __exit__(self, *_):
        os.close(self.terminal)
        os.kill(self.process, signal.SIGKILL)
        os.waitpid(self.process, 0)

    def type(self, keys, until):
        """Types keys, and returns the output up to a pattern; raises AssertionError where it does not come."""
        os.write(self.terminal, keys.encode())
        text, deadline = "", time.monotonic() + self.WAIT_S
        while not re.search(until, text):
            ready = select.select([self.terminal], [], [], max(0, deadline - time.monotonic()))[0]
            if not ready:
                raise AssertionError(f"typed {keys!r}, expected {until!r}, got {text!r}")
            text += os.read(self.terminal, 1 << 16).decode(errors="replace").replace("\a", "")  # the bell
        return text


class Completion(Case):
    def complete(self, line):
        """Words that bash offers behind a line."""
        words = line.split(" ")
        script = (self.vog("completion", "bash") +
                  f'\nCOMP_WORDS=({" ".join(repr(word) for word in words)}); COMP_CWORD={len(words) - 1}; _vog; printf "%s\\n" "${{COMPREPLY[@]}}"')
        done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, cwd=self.folder)
        self.assertEqual([line for line in done.stderr.splitlines() if "compopt" not in line], [])
        return done.stdout.split()

    def test_bash(self):
        self.assertEqual(self.complete("vog ren"), ["render"])
        self.assertEqual(set(self.complete("vog ")), set(COMMANDS))
        self.assertEqual(self.complete("vog render a.ply --orth"), ["--orthographic"])
        self.assertIn("volume", self.complete("vog render a.ply --show "))
        self.assertEqual(self.complete("vog render a.ply --tf vir"), ["viridis"])
        self.assertEqual(self.complete("vog completion z"), ["zsh"])
        self.assertEqual(self.complete("vog render clo"), [])  # files: bash itself

    def type_words(self, shell):
        """What a newcomer types, in a shell that has the completion."""
        (self.folder / "smoke.vdb").touch()
        shell.type("vog rend\t", "vog render ")
        shell.type("smo\t", "smoke.vdb ")
        shell.type("--dist\t", "--distance ")
        shell.type("30 --tf vir\t", "viridis ")

    def test_bash_on_a_terminal(self):
        with Shell(self.folder, "bash", "--noprofile", "--norc", "-i") as shell:
            shell.type("", "ready> ")
            shell.type("bind 'set enable-bracketed-paste off'; source <(vog completion bash); echo do''ne\n", "done\r?\n.*ready> ")
            self.type_words(shell)

    @needs("zsh")
    def test_zsh(self):
        done = subprocess.run(["zsh", "-n"], input=self.vog("completion", "zsh"), capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with Shell(self.folder, "zsh", "-f", "-i") as shell:
            shell.type("", "ready> ")
            shell.type("autoload -U compinit && compinit -u -D; source <(vog completion zsh); echo do''ne\n", "done\r?\n(.|\n)*ready> ")
            self.type_words(shell)

    @needs("fish")
    def test_fish(self):
        script = self.vog("completion", "fish") + "\ncomplete -C 'vog render a.ply --orth'"
        done = subprocess.run(["fish", "-c", script], capture_output=True, text=True)
        self.assertIn("--orthographic", done.stdout)

    def test_other_shells_are_refused(self):
        self.assertIn("bash", self.refusal("completion", "csh", code=2))


class Doctor(Case):
    def test_facts(self):
        text, facts = self.vog("doctor"), json.loads(self.vog("doctor", "--json"))
        self.assertIn(facts["version"], self.vog("--version"))
        self.assertIn(facts["processor"]["simd"], facts["processor"]["simd_supported"] + ["scalar"])
        self.assertGreaterEqual(facts["processor"]["cores"], 1)
        self.assertGreater(facts["memory"]["total_bytes"], 1 << 28)
        for part in ["opengl", "cuda", "optix", "ffmpeg"]:
            self.assertTrue(facts[part].get("name") or facts[part].get("reason"), part)
        self.assertEqual(facts["ffmpeg"]["found"], shutil.which("ffmpeg") is not None)
        for word in ["SIMD", "memory", "OpenGL", "CUDA", "OptiX", "OpenVDB", "ffmpeg"]:
            self.assertIn(word, text)


class Mistakes(Case):
    def test_remedies(self):
        self.vog("sample", "amr", "amr.vdb", "--size", "64")
        self.vog("sample", "cloud", "cloud.vdb", "--size", "64")
        self.vog("convert", "cloud.vdb", "-o", "cloud.ply", "--block", "8")
        write_ct(self.folder / "ct.nii")
        for words, remedy in [
            (["rendr", "cloud.vdb"], "did you mean 'vog render'?"),
            (["nonsense"], "commands are sample, info"),
            (["clod.vdb"], "clod.vdb: no such file"),
            (["cloud.vdb", "--tf", "hot"], "without a command"),
            (["render", "cloud.vdb", "--siez", "3"], "did you mean --size?"),
            (["render", "amr.vdb", "--grid", "density"], "--grid 'density_L*' reads all of them as levels"),
            (["render", "cloud.vdb", "--grid", "dens"], "it has: density"),
            (["render", "."], "a folder, expected files"),
            (["render", "cloud.vdb", "-o", "a.jpg"], ".jpg"),
            (["convert", "cloud.vdb"], "vog convert cloud.vdb -o cloud.ply"),
            (["page", "cloud.ply"], "vog page cloud.ply -o cloud.html"),
            (["convert", "cloud.ply", "-o", "a.ply", "--block", "4"], "--block has no effect with models"),
            (["export", "cloud.ply", "-o", "a.html"], "use vog page cloud.ply -o a.html"),
            (["voxelize", "cloud.vdb", "-o", "a.vdb"], "--like FILE"),
            (["voxelize", "cloud.vdb", "-o", "a.vdb", "--voxel-size", "1"], "cloud.vdb"),
            (["evaluate", "cloud.vdb"], "-o is missing"),
            (["compare", "cloud.png"], "vog compare"),
            (["info"], "files is required"),
            (["render", "cloud.vdb", "--tf", "infreno"], "inferno"),
            (["render", "cloud.vdb", "--size", "0"], "640x480"),
            (["render", "ct.nii", "--set", "background-value=0"], "vog render --show volume draws them"),
        ]:
            self.assertIn(remedy, self.refusal(*words), words)


class Processors(Case):
    """A processor without instructions that the program is compiled for, by an emulator."""

    def emulated(self, processor, *words):
        return subprocess.run(["qemu-x86_64", "-cpu", processor, *map(str, words)], cwd=self.folder, capture_output=True, text=True, timeout=300)

    @needs("qemu-x86_64")
    def test_pictures_are_the_same_on_old_processors(self):
        self.vog("sample", "cloud", "cloud.vdb", "--size", "64")
        self.vog("convert", "cloud.vdb", "-o", "cloud.ply", "--block", "8")
        self.vog("render", "cloud.ply", "--size", "48", "--depth-out", "here.exr", "-o", "here.png")
        # SSE4.2 without AVX; Penryn has SSE4.1 alone.
        for processor in ["Nehalem", "Penryn"]:
            for words in [["convert", "cloud.vdb", "-o", f"{processor}.ply", "--block", "8"],
                          ["render", f"{processor}.ply", "--size", "48", "--depth-out", f"{processor}.exr", "-o", f"{processor}.png"],
                          ["render", "cloud.ply", "--size", "16", "--renderer", "trace", "-o", "trace.png"]]:
                done = self.emulated(processor, VOG, *words)
                self.assertEqual(done.returncode, 0, f"{processor}: {words}\n{done.stderr}")
            self.assertEqual((self.folder / f"{processor}.ply").read_bytes(), (self.folder / "cloud.ply").read_bytes())
            # Sums of the splat differ by the lanes of a target: in the last bits of floats.
            difference = json.loads(self.vog("compare", "here.exr", f"{processor}.exr", "--json"))
            self.assertLess(difference["relative_l2"], 1e-5)

    @needs("qemu-x86_64")
    @needs("g++")
    def test_a_program_for_newer_processors_says_so_at_its_start(self):
        root = Path(__file__).resolve().parents[2]
        (self.folder / "main.cpp").write_text("#include <cstdio>\nint main() { std::puts(\"ran\"); }\n")
        for march, processor, absent in [("haswell", "Nehalem", "AVX"), ("nehalem", "Penryn", "SSE4.2"), ("x86-64", "Penryn", "")]:
            subprocess.run(["g++", "-O2", f"-march={march}", "main.cpp", root / "apps/cli/processor.cpp", "-o", march], check=True, cwd=self.folder)
            done = self.emulated(processor, self.folder / march)
            if absent:
                self.assertEqual((done.returncode, done.stdout), (1, ""))
                self.assertIn(f"vog: this processor has no {absent}, which this program was compiled for; build without -march", done.stderr)
                self.assertEqual(done.stderr.count("\n"), 1)
            else:
                self.assertEqual((done.returncode, done.stdout), (0, "ran\n"))


if __name__ == "__main__":
    unittest.main(verbosity=2)
