"""Examples in docstrings give what they say. Each begins with vog and NumPy imported, in a folder of its own."""
import doctest
import inspect
import re

import numpy as np
import pytest

import vog

# Calls whose help begins with their use.
CHIEF = ["convert", "render", "compare", "voxelize", "export_html", "export_splats", "projection", "show",
         "set_units", "from_yt", "from_xarray", "from_nifti", "from_tiff", "to_vtk", "to_pyvista", "Gaussians", "Camera", "DepthImage",
         "TransferFunction", "Settings", "threads", "Volume.from_numpy", "Volume.from_blocks", "Volume.to_numpy", "Camera.orbit",
         "Points.from_numpy", "DepthImage.shade", "Picture.recolor"]  # fmt: skip


def docstrings():
    """{'Volume.from_numpy': its docstring} of all public names."""
    found = {}
    for name, item in vars(vog).items():
        if name.startswith("_") or inspect.ismodule(item):
            continue
        found[name] = item.__doc__ or ""
        if inspect.isclass(item):
            for member, value in vars(item).items():
                if not member.startswith("_"):
                    found[f"{name}.{member}"] = getattr(value, "__doc__", None) or ""
    return found


WITH_EXAMPLES = {name: text for name, text in docstrings().items() if ">>>" in text}


@pytest.mark.parametrize("name", sorted(WITH_EXAMPLES))
def test_examples_give_what_they_say(name, tmp_path, monkeypatch):
    text = WITH_EXAMPLES[name]
    for package in re.findall(r">>> import (\w+)", text):
        pytest.importorskip(package, reason=f"needs {package}")
    monkeypatch.chdir(tmp_path)
    examples = doctest.DocTestParser().get_doctest(text, {"vog": vog, "np": np}, name, None, None)
    told = []
    result = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE).run(examples, out=told.append)
    assert result.attempted and not result.failed, "".join(told)


def test_chief_calls_have_examples():
    assert [name for name in CHIEF if name not in WITH_EXAMPLES] == []
