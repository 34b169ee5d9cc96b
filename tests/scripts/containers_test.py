#!/usr/bin/env python3
"""Dockerfile, .devcontainer and workflow name what is there, and the Debian that scripts/bare_system.sh tests. No engine is needed: scripts/deb.sh
runs the image's last RUN on a bare system."""
import json
import os
import re
import shlex
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DEBIAN = "debian:12"  # bookworm


class Containers(unittest.TestCase):
    def check_script(self, words):
        """A script of ours is there, is a program, and knows the words behind it."""
        file = ROOT / words[0]
        self.assertTrue(file.is_file() and os.access(file, os.X_OK), words[0])
        for word in words[1:]:
            self.assertIn(word, file.read_text(), words)

    def check_commands(self, text):
        scripts = 0
        for command in re.split(r"&&|;", text):
            words = shlex.split(command)
            if words and words[0].startswith(("scripts/", ".ci/")):
                self.check_script(words)
                scripts += 1
            if words[:2] == ["cmake", "--preset"]:
                presets = json.loads((ROOT / "CMakePresets.json").read_text())["configurePresets"]
                self.assertIn(words[2], [preset["name"] for preset in presets])
        return scripts

    def test_dockerfile(self):
        lines = [line for line in (ROOT / "Dockerfile").read_text().splitlines() if line and not line.startswith("#")]
        images = [line.split()[1] for line in lines if line.startswith("FROM ")]
        self.assertEqual(images, [DEBIAN, DEBIAN + "-slim"])
        runs = [line.removeprefix("RUN ") for line in lines if line.startswith("RUN ")]
        self.assertEqual(sum(map(self.check_commands, runs)), 1)
        self.assertIn("/tmp/*.deb", runs[-1])
        self.assertEqual(lines[-1], 'ENTRYPOINT ["vog"]')
        ignored = (ROOT / ".dockerignore").read_text().split()
        self.assertIn("build*", ignored)

    def test_devcontainer(self):
        settings = json.loads((ROOT / ".devcontainer" / "devcontainer.json").read_text())
        self.assertEqual(settings["image"], DEBIAN)
        self.assertEqual(self.check_commands(settings["onCreateCommand"]), 1)
        self.check_commands(settings["postCreateCommand"])

    def test_workflow_is_ci_run(self):
        text = (ROOT / ".github" / "workflows" / "checks.yml").read_text()
        self.assertIn(f"container: {DEBIAN}\n", text)
        runs = re.findall(r"run: (.*)", text)
        self.assertEqual(runs[-1], ".ci/run")
        self.assertTrue(all("apt-get" in run for run in runs[:-1]), runs)


if __name__ == "__main__":
    unittest.main(verbosity=2)
