#!/usr/bin/env python3
"""A newcomer's first minute: vog FILE, help, completion in real shells, manual pages, vog doctor, remedies for mistakes."""

import json
import os
import re
import shutil
import subprocess
import tempfile
import unittest
from pathlib import Path

VOG = os.environ.get("VOG_COMMAND", "vog")
COMMANDS = ["sample", "info", "convert", "render", "compare", "evaluate", "view", "export", "serve", "voxelize", "doctor", "completion", "man"]


def run(*words, folder=None, program=VOG):
    return subprocess.run([program, *words], cwd=folder, capture_output=True, text=True, timeout=120)


def needs(program):
    return unittest.skipUnless(shutil.which(program), f"{program} is not installed")


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

    def test_every_proposed_command_works(self):
        for kind, name in [("cloud", "cloud.vdb"), ("amr", "amr.vdb"), ("fire", "my fire.vdb"), ("particles", "box.xyz")]:
            self.vog("sample", kind, name, *(["--size", "64"] if kind != "particles" else ["--size", "10"]))
            text = self.vog(name)
            steps = self.steps(text)
            self.assertGreaterEqual(len(steps), 3, text)
            for step in steps:
                if step.startswith("vog view"):  # opens a window
                    continue
                done = subprocess.run(["bash", "-c", step.replace("vog ", f"'{VOG}' ", 1)], cwd=self.folder, capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, f"{step}\n{done.stderr}")
        for model in ["cloud.ply", "box.ply"]:
            for step in self.steps(self.vog(model)):
                if not step.startswith("vog view"):
                    done = subprocess.run(["bash", "-c", step.replace("vog ", f"'{VOG}' ", 1)], cwd=self.folder, capture_output=True, text=True)
                    self.assertEqual(done.returncode, 0, f"{step}\n{done.stderr}")

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
        for command in ["convert", "render", "export", "evaluate", "view"]:
            some, every = self.vog(command, "--help"), self.vog(command, "--help-all")
            count = lambda text: len(set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", text, re.M)))
            self.assertLessEqual(count(some), 13, command)
            self.assertGreater(count(every), 20, command)
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

    @needs("groff")
    def test_manual_pages_are_clean_roff(self):
        for command in ["", *COMMANDS]:
            page = run("man", *([command] if command else [])).stdout
            done = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z"], input=page, capture_output=True, text=True)
            self.assertEqual(done.stderr, "", command)


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
        self.assertEqual(self.complete("vog render a.ply --elev"), ["--elevation"])
        self.assertIn("volume", self.complete("vog render a.ply --show "))
        self.assertEqual(self.complete("vog render a.ply --tf vir"), ["viridis"])
        self.assertEqual(self.complete("vog completion z"), ["zsh"])
        self.assertEqual(self.complete("vog render clo"), [])  # files: bash itself

    @needs("zsh")
    def test_zsh(self):
        done = subprocess.run(["zsh", "-n"], input=self.vog("completion", "zsh"), capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    @needs("fish")
    def test_fish(self):
        script = self.vog("completion", "fish") + "\ncomplete -C 'vog render a.ply --elev'"
        done = subprocess.run(["fish", "-c", script], capture_output=True, text=True)
        self.assertIn("--elevation", done.stdout)

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
        for words, remedy in [
            (["rendr", "cloud.vdb"], "did you mean 'vog render'?"),
            (["nonsense"], "expected a file, or one of"),
            (["clod.vdb"], "clod.vdb: no such file"),
            (["cloud.vdb", "--tf", "hot"], "without a command"),
            (["render", "cloud.vdb", "--siez", "3"], "did you mean --size?"),
            (["render", "amr.vdb"], "--grid 'density_L*' reads all of them as levels"),
            (["render", "amr.vdb", "--grid", "density"], "--grid 'density_L*' reads all of them as levels"),
            (["render", "cloud.vdb", "--grid", "dens"], "it has: density"),
            (["render", "."], "a folder, expected files"),
            (["render", "cloud.vdb", "-o", "a.jpg"], ".jpg"),
            (["convert", "cloud.vdb"], "vog convert cloud.vdb -o cloud.ply"),
            (["export", "cloud.ply"], "vog export cloud.ply -o cloud.html"),
            (["convert", "cloud.ply", "-o", "a.ply"], "a model already"),
            (["voxelize", "cloud.vdb", "-o", "a.vdb"], "--like FILE"),
            (["voxelize", "cloud.vdb", "-o", "a.vdb", "--voxel-size", "1"], "cloud.vdb"),
            (["evaluate", "cloud.vdb"], "-o is missing"),
            (["compare", "cloud.png"], "vog compare"),
            (["info"], "files is required"),
            (["render", "cloud.vdb", "--tf", "infreno"], "inferno"),
            (["render", "cloud.vdb", "--size", "0"], "640x480"),
        ]:
            self.assertIn(remedy, self.refusal(*words), words)


class Processors(Case):
    """A processor without instructions that the program is compiled for."""

    @needs("qemu-x86_64")
    def test_old_processors_run_it_or_are_told(self):
        for processor in ["qemu64", "Nehalem", "Haswell"]:
            done = run("-cpu", processor, VOG, "--version", program="qemu-x86_64")
            if done.returncode != 0:
                self.assertRegex(done.stderr, "^vog: this processor has no ")
            else:
                self.assertTrue(done.stdout.startswith("vog "), processor)


if __name__ == "__main__":
    unittest.main(verbosity=2)
