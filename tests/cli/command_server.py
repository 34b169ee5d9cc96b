"""Runs of the command, many a second: by command_server.cpp where VOG_SERVER names it, else each by a process of its own."""

import os
import subprocess
import tempfile
import threading
from pathlib import Path

VOG = os.environ.get("VOG_COMMAND") or "build/release/apps/cli/vog"
VOG = str(Path(VOG).resolve())
SERVER = os.environ.get("VOG_SERVER") or str(Path(VOG).parents[2] / "tests" / "vog_command_server")
_local = threading.local()  # a server each thread


def _server():
    if not hasattr(_local, "process"):
        _local.process = subprocess.Popen([SERVER], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        _local.files = tempfile.TemporaryDirectory()
    return _local.process


def run(words, folder=".", seconds=60):
    """subprocess.run([VOG, *words]) in a folder, with output and errors as bytes.
    raises  subprocess.TimeoutExpired"""
    if not Path(SERVER).exists():
        return subprocess.run([VOG, *words], capture_output=True, timeout=seconds, cwd=folder)
    process = _server()
    files = [str(Path(_local.files.name, name)) for name in ("out", "error")]
    line = "\0".join([str(Path(folder).resolve()), *files, str(seconds), *words])
    assert "\n" not in line, words
    process.stdin.write(line.encode() + b"\n")
    process.stdin.flush()
    status = os.waitstatus_to_exitcode(int(process.stdout.readline()))
    if status == -14:  # SIGALRM
        raise subprocess.TimeoutExpired(words, seconds)
    return subprocess.CompletedProcess([VOG, *words], status, *(Path(file).read_bytes() for file in files))
