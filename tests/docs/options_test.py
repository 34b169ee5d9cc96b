#!/usr/bin/env python3
"""The documents name options, values and defaults that the command has; docs/options.md is the list of its manual pages.

VOG_COMMAND names the command. VOG_WRITE_OPTIONS=1 writes docs/options.md.
"""

import os
import re
import shlex
import subprocess
import sys
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COMMAND = Path(os.environ.get("VOG_COMMAND", ROOT / "build/release/apps/cli/vog"))
PAGE = ROOT / "docs" / "options.md"
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
# Options of vog-mpi alone, and of other programs.
OTHERS = """--split --version --help --help-all --no-steps --allow-run-as-root --build --preset --prefix --gpus --gtest_filter --model-sizes
--tolerances --blocks --most --modes""".split()
HEAD = """# Options

All options of all commands, as `vog man COMMAND` has them. `--set NAME=VALUE` states what few runs need.
Intervals are written as (0, 1), without their ends, and [0, 1], with them.
"""


def manual(*command):
    done = subprocess.run([COMMAND, "man", *command], capture_output=True, text=True, check=True)
    return re.sub(r"\\f[BIR]|\\&", "", done.stdout).replace("\\-", "-").replace("\\e", "\\")


class Option:
    """An entry of a manual page: names, value, text, words, interval, default."""

    def __init__(self, group, entry):
        head, *lines = entry.strip().split("\n")
        self.group = group
        self.names, self.takes = re.fullmatch(r"((?:--set )?[^ =,]+(?:, -{1,2}[^ =,]+)*)[ =]?(.*)", head).groups()
        self.words, self.interval, self.default = [], "", ""
        text = []
        for line in lines:
            if found := re.fullmatch(r"One of (.*)\.", line):
                self.words = found[1].split(", ")
            elif found := re.fullmatch(r"In ([\[(].*)\.", line):
                self.interval = found[1]
            elif found := re.fullmatch(r"Default: (.*)\.", line):
                self.default = found[1]
            else:
                text.append(line)
        self.text = " ".join(text)

    def has(self, value):
        if self.words:
            return value in self.words
        if not self.interval:
            return True
        low, high = (float(end) for end in self.interval[1:-1].split(","))
        number = float(value)
        above = number >= low if self.interval[0] == "[" else number > low
        return above and (number <= high if self.interval[-1] == "]" else number < high)


def options_of(command):
    options, group = [], "Options"
    for part in re.split(r"^\.(S[HS] .*|TP)\n", manual(command).split(".SH OPTIONS\n")[1], flags=re.M):
        if part.startswith(("SH ", "SS ")):
            group = part[3:]
        elif part.startswith("-"):
            options.append(Option(group, part))
    return {name: option for option in options if "--help" not in option.names for name in option.names.split(", ")}


COMMANDS = {name: options_of(name) for name in re.findall(r"^\.TP\n(\w+)\n", manual().split(".SH COMMANDS\n")[1], re.M)}
ALL = {name: [options[name] for options in COMMANDS.values() if name in options] for options in COMMANDS.values() for name in options}


def cell(text):
    return re.sub(r"([|*`\\])", r"\\\1", text).replace("<", "&lt;")


def reference():
    text = HEAD
    for command, options in COMMANDS.items():
        text += f"\n## vog {command}\n"
        group = None
        for option in dict.fromkeys(options.values()):
            if option.group != group:
                group = option.group
                text += ("" if group == "Options" else f"\n{group}\n") + "\n| option | values | default | |\n|---|---|---|---|\n"
            names = option.names + ("=" + option.takes if option.names.startswith("--set ") else " " + option.takes if option.takes else "")
            values = ", ".join(option.words) or option.interval
            text += f"| `{cell(names)}` | {cell(values)} | {cell(option.default)} | {cell(option.text)} |\n"
    return text


def stated(words):
    """[name, value] of the options of a command line; value None: none is stated."""
    found = []
    for n, word in enumerate(words):
        following = words[n + 1] if n + 1 < len(words) and not re.match("-[-a-z]", words[n + 1]) else None
        if word == "--set":
            name, _, value = (following or "").partition("=")
            found.append(["--set " + name, value or None])
        elif re.match("--[a-z]", word):
            name, equals, value = word.partition("=")
            found.append([name, value if equals else following])
    return found


def is_placeholder(value):
    return value is None or re.search(r"[A-Z$<{…]|\.\.", value) is not None and not re.fullmatch("T", value)


def faults_of(words, known, where):
    """known: {name: options}"""
    for name, value in stated(words):
        if name in OTHERS:
            continue
        if name.rstrip(".") not in known:
            yield f"{where}: no option {name}"
        elif not is_placeholder(value) and all(option.takes and not fits(option, value) for option in known[name]):
            yield f"{where}: {name} {value}, expected {', '.join(known[name][0].words) or known[name][0].interval}"


def fits(option, value):
    try:
        return option.has(value.rstrip(",;."))
    except ValueError:
        return False


def command_lines(text):
    """Command lines of vog in blocks of shell, without what follows a pipe or a #."""
    for block in re.findall(r"^```(?:sh|bash|console)?\n(.*?)^```|((?:^ {4}.*\n)+)", text, re.M | re.S):
        for line in re.sub(r"\\\n", " ", block[0] or block[1]).split("\n"):
            for command in re.split(r"[|;&]|\s#", line):
                if found := re.match(r"\s*(?:mpirun .*)?\b(vog|vog-mpi) (\w+)\s(.*)", command):
                    yield found.groups()


class Options(unittest.TestCase):
    maxDiff = None

    def test_the_list_of_options_is_current(self):
        if os.environ.get("VOG_WRITE_OPTIONS"):
            PAGE.write_text(reference())
        self.assertEqual(PAGE.read_text(), reference(), "VOG_WRITE_OPTIONS=1 writes docs/options.md")

    def test_command_lines_of_the_documents_have_options_of_their_commands(self):
        faults, lines = [], 0
        for file in DOCUMENTS:
            for program, command, rest in command_lines(file.read_text()):
                if command not in COMMANDS:
                    continue
                lines += 1
                try:
                    words = shlex.split(rest)
                except ValueError:
                    continue  # a text over several lines
                known = {name: [option] for name, option in COMMANDS[command].items()} if program == "vog" else ALL
                faults += faults_of(words, known, f"{file.relative_to(ROOT)}: vog {command}")
        self.assertGreater(lines, 200)
        self.assertEqual(faults, [])

    def test_options_in_texts_and_tables_are_there(self):
        faults, spans = [], 0
        for file in DOCUMENTS:
            if file == PAGE:
                continue
            text = re.sub(r"^```.*?^```|^ {4}.*?$", "", file.read_text(), flags=re.M | re.S)
            for span in re.findall(r"`(--[a-z][^`]*)`", text):
                spans += 1
                try:
                    faults += faults_of(shlex.split(span), ALL, f"{file.relative_to(ROOT)}: `{span}`")
                except ValueError:
                    pass
        self.assertGreater(spans, 500)
        self.assertEqual(faults, [])

    def test_rows_of_tables_state_values_and_defaults_of_their_option(self):
        faults, rows = [], 0
        for file in DOCUMENTS:
            for row in re.findall(r"^\| (`--[a-z].*)$", file.read_text() if file != PAGE else "", re.M):
                first, *rest = (part.strip() for part in re.split(r"(?<!\\)\|", row))
                spans = re.findall(r"`([^`]*)`", first)
                names = [name for span in spans for name, _ in stated(span.split())]
                if len(names) != 1 or names[0] not in ALL:
                    continue
                rows += 1
                for word in (span for span in spans[1:] if re.fullmatch("[a-z]+", span)):
                    if not any(option.has(word) for option in ALL[names[0]] if option.words) and any(option.words for option in ALL[names[0]]):
                        faults.append(f"{file.name}: {names[0]} {word}")
                default = re.search(r"[Dd]efault:? `?(\d[\d.e-]*\d|\d|[a-z]+)`?(?=[ ,;.:|]|$)", " ".join(rest))
                standards = {option.default for option in ALL[names[0]]} - {""}
                if default and standards and not any(same(default[1], one) for one in standards):
                    faults.append(f"{file.name}: {names[0]}: default {default[1]}, expected {' or '.join(standards)}")
        self.assertGreater(rows, 40)
        self.assertEqual(faults, [])


def same(a, b):
    try:
        return float(a) == float(b)
    except ValueError:
        return a == b


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[1:])
