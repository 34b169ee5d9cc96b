"""Packaging: versions agree, and the configuration of pip works."""
import pathlib
import re
import subprocess
import sys

import pytest

import vog
from conftest import COMMAND, SOURCE

tomllib = pytest.importorskip("tomllib", reason="needs Python 3.11")


@pytest.fixture(scope="module")
def project():
    return tomllib.loads((SOURCE / "pyproject.toml").read_text())


def test_versions_agree(project):
    told = subprocess.run([COMMAND, "--version"], capture_output=True, text=True).stdout
    assert told.startswith(f"vog {vog.__version__} (")
    assert project["project"]["version"] == vog.__version__


def test_what_pip_configures_is_the_package_and_nothing_else(project, tmp_path):
    settings = project["tool"]["scikit-build"]
    options = settings["cmake"]["args"]
    known = set(re.findall(r"^option\((\w+)", (SOURCE / "CMakeLists.txt").read_text(), re.M))
    assert {re.match(r"-D(\w+)=", option).group(1) for option in options} <= known
    done = subprocess.run(
        ["cmake", "-S", SOURCE, "-B", tmp_path, "-G", "Ninja", "-DSKBUILD=ON", "-DSKBUILD_SCRIPTS_DIR=scripts", *options], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    build = (tmp_path / "build.ninja").read_text()
    assert "vog_python" in build and "vog_command" in build and "vog_tests" not in build
    assert settings["install"]["components"] == ["python"]
    install = (tmp_path / "python" / "cmake_install.cmake").read_text()
    assert set(re.findall(r'CMAKE_INSTALL_COMPONENT STREQUAL "(\w+)"', install)) == {"python"} and "_vog" in install


def test_installed_files_are_typed_and_documented():
    folder = pathlib.Path(vog.__file__).parent
    assert {"__init__.py", "_vog.pyi", "py.typed"} <= {file.name for file in folder.iterdir()}
    assert "docs/python.md" in vog.__doc__
