"""examples/notebook.ipynb: run by Jupyter, and seen in a headless browser."""
import json
import os
import sys

import pytest

import vog
from conftest import SOURCE

nbclient = pytest.importorskip("nbclient", reason="needs python3-nbclient")
nbformat = pytest.importorskip("nbformat", reason="needs python3-nbformat")
pytest.importorskip("ipykernel", reason="needs python3-ipykernel")


@pytest.fixture(scope="module")
def notebook(tmp_path_factory):
    """The notebook with its outputs, by this interpreter."""
    folder = tmp_path_factory.mktemp("kernels")
    kernel = folder / "kernels" / "vog-test"
    kernel.mkdir(parents=True)
    argv = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    (kernel / "kernel.json").write_text(f'{{"argv": {str(argv).replace(chr(39), chr(34))}, "display_name": "vog", "language": "python"}}')
    before = os.environ.get("JUPYTER_PATH")
    os.environ["JUPYTER_PATH"] = str(folder)
    try:
        book = nbformat.read(SOURCE / "examples" / "notebook.ipynb", as_version=4)
        nbclient.NotebookClient(book, timeout=300, kernel_name="vog-test").execute()
    finally:
        os.environ.pop("JUPYTER_PATH") if before is None else os.environ.update(JUPYTER_PATH=before)
    return book


def html_of(book):
    """Outputs of all cells that are HTML."""
    return [o["data"]["text/html"] for cell in book.cells if cell.cell_type == "code" for o in cell.outputs if "text/html" in o.get("data", {})]


def test_every_cell_runs_and_models_show_themselves(notebook):
    pages = html_of(notebook)
    assert len(pages) >= 2
    assert all(page.startswith("<iframe srcdoc=") and "<script" not in page for page in pages)


def test_the_pages_draw_in_a_browser(notebook, tmp_path):
    sys.path.insert(0, str(SOURCE / "tests" / "web"))
    from browser import Browser, find_chromium

    if not find_chromium():
        pytest.skip("needs chromium")
    file = tmp_path / "outputs.html"
    file.write_text("<!doctype html><meta charset=utf-8>" + "".join(f"<div>{page}</div>" for page in html_of(notebook)[:2]))
    with Browser() as browser:
        browser.viewport(500, 400)
        browser.open(file, "")
        ready = "[...document.querySelectorAll('iframe')].every((one) => one.contentWindow.vog?.settled)"
        assert browser.evaluate(f"(async () => {{ for (let n = 0; n < 400 && !({ready}); ++n) await new Promise((d) => setTimeout(d, 50)); return {ready}; }})()")
        for n in range(2):
            colors = browser.colors(f"document.querySelectorAll('iframe')[{n}].contentWindow")
            assert colors > 50, "the picture is blank"


@pytest.mark.filterwarnings("error")
def test_a_live_widget_has_the_settings():
    pytest.importorskip("anywidget", reason="needs anywidget (pip install anywidget)")
    model = vog.convert(vog.sample_cloud(64), block=8)
    widget = vog.show(model, title="A cloud")
    seen = []
    widget.on_change(lambda one: seen.append(one.tf))
    widget.tf = "viridis"
    assert widget.sent == "1 #tf=viridis"
    widget.show = "column"
    assert [widget.sent, widget.link] == ["2 #show=column", "#tf=viridis&show=column"]  # a display that comes later has both
    widget.link = "#tf=magma&camera.eye=1,2,3&camera.look_at=0,0,0&camera.up=0,1,0&camera.fov_degrees=30"  # as the page sends it
    assert seen == ["magma"]
    assert widget.model == 1
    assert widget.camera.eye == (1, 2, 3)
    before = widget.files
    assert json.loads(before["manifest.json"])["models"][0]["name"] == "A cloud" and "page.json" in before and "index.html" not in before
    widget.set_model(vog.convert(vog.sample_cloud(64), block=4))
    assert widget.files.keys() != before.keys() and "A cloud" in widget.files["manifest.json"].decode()


def test_a_live_widget_begins_with_a_request():
    pytest.importorskip("anywidget", reason="needs anywidget (pip install anywidget)")
    model = vog.convert(vog.sample_cloud(64), block=8)
    widget = vog.show([model, model], show="volume", light="studio", background="system", camera=vog.Camera((1, 2, 3), (0, 0, 0)))
    begin = json.loads(widget.begin)
    assert [begin[key] for key in ("show", "light", "background")] == ["volume", "studio", "system"] and begin["camera"]["eye"] == [1, 2, 3]
    assert [one["name"] for one in json.loads(widget.files["manifest.json"])["models"]] == ["model 1", "model 2"]
    assert json.loads(vog.show(model).begin) == {"background": "black"}
    assert "customElements.define('vog-view'" in widget._esm and widget._esm.endswith("export default { render };\n")
    for option, value in (("levels", 3), ("slabs", 16), ("description", "A text")):
        with pytest.raises(vog.Error, match=f"show: {option} has no effect on a live widget, expected live=False"):
            vog.show(model, **{option: value})
