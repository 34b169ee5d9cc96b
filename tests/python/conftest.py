"""Fixtures of the Python tests, which run on the installed package (CMakeLists.txt here)."""
import json
import os
import pathlib
import re
import subprocess

import numpy as np
import pytest

import vog

SOURCE = pathlib.Path(__file__).resolve().parents[2]
COMMAND = os.environ.get("VOG_COMMAND", "vog")


def pytest_configure(config):
    config.addinivalue_line("markers", "data: reads real inputs (`ctest -L data`)")


def pytest_collection_modifyitems(items):
    for item in items:
        if "data" in item.fixturenames:
            item.add_marker("data")


def request_of(png):
    """The request that a PNG keeps: "picture" of the JSON in its chunk iTXt with the key "vog"."""
    text = re.search(rb"iTXtvog\0\0\0\0\0(.*)", pathlib.Path(png).read_bytes(), re.S)
    return json.JSONDecoder().raw_decode(text[1].decode("utf-8", "replace"))[0]["picture"]


def same_picture(one, other):
    """Whether two PNG files have the same pixels and the same request, whatever their inputs are called."""
    a, b = (np.asarray(image) for image in (vog.Image.load(one), vog.Image.load(other)))
    return a.shape == b.shape and np.array_equal(a, b) and request_of(one) == request_of(other)


@pytest.fixture(scope="session")
def cloud():
    return vog.sample_cloud(64)


@pytest.fixture(scope="session")
def model(cloud):
    return vog.convert(cloud, block=2)


@pytest.fixture
def command(tmp_path):
    """Runs `vog ARGUMENTS` in the test's own folder, and expects success."""

    def run(*arguments):
        done = subprocess.run([COMMAND, *map(str, arguments)], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def data():
    """A real input by its name; the test is skipped, aloud, where it is absent."""
    folder = pathlib.Path(os.environ.get("VOG_DATA", SOURCE / ".." / "shared" / "data"))

    def find(name):
        if not (folder / name).exists():
            pytest.skip(f"{folder / name} is absent (set VOG_DATA to the folder of real inputs)")
        return folder / name

    return find
