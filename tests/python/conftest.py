"""Fixtures of the Python tests, which run on the installed package (CMakeLists.txt here)."""
import os
import pathlib
import subprocess

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
