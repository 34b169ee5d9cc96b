"""python -m vog.report: plots and a page of an evaluation, and one line where something is missing."""
import json
import re
import subprocess
import sys

import pytest

import vog
import vog.report

# Runs the module as `python -m` does, without a package.
HIDDEN = "import runpy, sys; sys.modules['matplotlib'] = None; runpy.run_module('vog.report', run_name='__main__', alter_sys=True)"


def report(*arguments, start=("-m", "vog.report")):
    return subprocess.run([sys.executable, *start, *map(str, arguments)], capture_output=True, text=True)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, cloud):
    folder = tmp_path_factory.mktemp("report") / "an evaluation"
    vog.evaluate(cloud, folder, size=24, repeats=1, show="volume", voxels=True)
    return folder


def test_the_page_has_plots_tables_and_pictures(folder):
    pytest.importorskip("matplotlib", reason="needs python3-matplotlib")
    done = report(folder)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"{folder / 'report.html'}\n"
    page = (folder / "report.html").read_text()
    headings = re.findall("<h2>(.*?)</h2>", page)
    assert [name.split(".")[0] for name in headings] == [
        "Plots", "1", "2", "3", "4", "5", "Volume rendering", "Voxels", "The views", "Pictures: paper", "Pictures: inside"]  # fmt: skip
    shown = re.findall("src='(.*?)'", page)
    assert len([name for name in shown if name.startswith("plots/")]) == 4 and len(shown) > 60
    assert all((folder / name).is_file() for name in shown)
    assert "http" not in page and "<script" not in page
    assert "RTX 4090" not in page, "the paper's figures beside other data"
    # Beside its own data, known by their counts.
    results = json.loads((folder / "results.json").read_text())
    results["data"].update(active_voxels=1049275, leaves=3117)
    (folder / "results.json").write_text(json.dumps(results))
    page = vog.report.write_report(folder).read_text()
    assert "RTX 4090" in page and all(f"<td>{figure}<" in page for figure in ("20.87", "2.5 K", "0.09 %"))


def test_it_is_one_line_without_matplotlib_or_results(folder, tmp_path):
    done = report(folder, start=("-c", HIDDEN))
    assert done.returncode == 1 and done.stdout == ""
    assert re.fullmatch(r"vog.report: the Python package matplotlib is not installed, .*pip install matplotlib, or apt .*\n", done.stderr)
    (tmp_path / "results.json").write_text("{}")
    for arguments in ([], [tmp_path / "none"], [tmp_path]):
        done = report(*arguments)
        assert done.returncode == 1 and done.stderr.count("\n") == 1 and "Traceback" not in done.stderr
