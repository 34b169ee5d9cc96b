"""The widget of notebooks under a model of Jupyter's, and a page inside of another: settings both ways."""
import json

from element_test import MODULE, ElementTest
from page_test_case import HOUSE, PageTest, run, vog, write_model
from site_server import SiteServer

# What Jupyter gives a widget, as far as ours uses it.
MODEL = """
class Model {
  constructor(values) { this.values = values; this.listeners = {}; this.saved = []; }
  get(name) { return this.values[name]; }
  set(name, value) { this.values[name] = value; }
  save_changes() { this.saved.push(this.values.link); }
  on(event, listener) { (this.listeners[event] ??= []).push(listener); }
  off(event, listener) { this.listeners[event] = this.listeners[event].filter((one) => one !== listener); }
  from_python(name, value) { this.values[name] = value; for (const one of this.listeners[`change:${name}`] ?? []) one(); }
}
const filesOf = async (site, names) => Object.fromEntries(await Promise.all(names.map(async (name) => [name, new DataView(await (await fetch(`${site}/${name}`)).arrayBuffer())])));
const begun = (async () => {
  const esm = await (await fetch('widget.js')).text();
  globalThis.model = new Model({ _esm: esm, files: await filesOf('one', ONE), height: 220, begin: '{"show": "column", "tf": "gray", "background": "white"}', sent: '', link: '' });
  globalThis.remove = (await import('./widget.js')).default.render({ model, el: document.getElementById('cell') });
})();
const view = () => document.querySelector('vog-view');
const canvas = () => view().shadowRoot.querySelector('canvas');
"""


class Widget(ElementTest):
    @classmethod
    def make(cls):
        write_model(cls.folder / "one.ply", [0, 0, 0, 1, 1, 1, 0.5, 2, 0, 0, 0.5, 0.5, 0.5, 1])
        write_model(cls.folder / "two.ply", [0, 0, 0, 2, 2, 2, 0.5])
        names = {}
        for name in ("one", "two"):
            vog("page", f"{name}.ply", "-o", f"{name}/")
            names[name] = [str(file.relative_to(cls.folder / name)) for file in (cls.folder / name).rglob("*.*") if file.name != "index.html"]
        (cls.folder / "widget.js").write_text(MODULE.read_text() + (HOUSE / "python/vog/_widget.js").read_text())
        (cls.folder / "outer.html").write_text(f"""<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><body style="margin: 0"><div id="cell"></div>
<script>const ONE = {json.dumps(names["one"])}, TWO = {json.dumps(names["two"])};{MODEL}</script></body>""")

    def setUp(self):
        super().setUp()
        self.browser.open(self.server.url + "outer.html")
        self.value("begun.then(() => view().ready).then(() => true)")
        self.until("model.values.link")

    def link(self):
        return dict(word.partition("=")[::2] for word in self.value("model.values.link").lstrip("#").split("&"))

    def test_it_begins_as_python_says_and_reports_its_settings(self):
        self.assertEqual([self.link()["show"], self.link()["tf"]], ["column", "gray"])
        self.assertEqual(self.value("[view().clientHeight, view().request.background]"), [220, [1, 1, 1, 1]])
        self.assertEqual(self.value("view().models.map(({ name }) => name)"), ["one"])
        # Nothing but the page and the script has been asked for.
        self.assertEqual({path for path in self.server.paths if path.startswith("/one/")}, {f"/one/{name}" for name in self.value("ONE")})
        # A hand in the picture arrives in Python.
        self.value("view().set({ tf: 'viridis' })")
        self.until("model.values.link.includes('tf=viridis')")
        self.assertIn("tf=viridis", self.value("model.saved.at(-1)"))

    def test_a_drag_arrives(self):
        before = self.link()["camera.eye"]
        self.browser.drag(100, 100, 160, 110)
        self.until(f"!model.values.link.includes({json.dumps(before)})")

    def test_its_keys_are_no_commands_of_the_notebook(self):
        self.value("{ globalThis.heard = []; addEventListener('keydown', ({ key }) => heard.push(key)); canvas().focus(); }")
        before = self.link()["camera.eye"]
        self.browser.key("ArrowLeft")
        self.until(f"!model.values.link.includes({json.dumps(before)})")
        self.assertEqual(self.value("[heard, view().closest('[data-lm-suppress-shortcuts]') !== null]"), [[], True])

    def test_python_sets_them(self):
        self.value("model.from_python('sent', '1 #tf=magma&camera.eye=5,6,7&camera.look_at=0,0,0&show=T')")
        self.until("view().tf === 'magma'")
        self.assertEqual(self.value("view().camera.eye"), [5, 6, 7])
        self.until("model.values.link.includes('show=T')")
        # What a view does not know changes nothing, and is named.
        self.value("model.from_python('sent', '2 #tf=nothing')")
        self.assertEqual(self.value("view().tf"), "magma")
        self.assertIn('tf "nothing": expected one of', self.value("view().shadowRoot.querySelector('p').textContent"))
        self.value("model.from_python('height', 300)")
        self.assertEqual(self.value("view().clientHeight"), 300)

    def test_another_model_takes_the_settings(self):
        self.value("model.from_python('sent', '1 #tf=magma')")
        self.browser.drag(100, 100, 160, 110)
        self.until("model.values.link.includes('tf=magma')")
        eye = self.value("view().camera.eye")
        self.value("filesOf('two', TWO).then((files) => { model.from_python('files', files); return view().ready; }).then(() => true)")
        self.assertEqual(self.value("[view().models[0].name, view().tf, view().show]"), ["two", "magma", "column"])
        for now, before in zip(self.value("view().camera.eye"), eye):
            self.assertAlmostEqual(now, before, delta=1e-6)

    def test_files_that_are_missing_are_named(self):
        self.value("model.from_python('files', {})")
        self.until("view().shadowRoot.querySelector('p').textContent === 'The model cannot be read: manifest.json: no such file; expected the manifest of a site.'")

    def test_a_removed_widget_is_silent(self):
        self.value("remove()")
        self.assertEqual(self.value("[document.querySelector('vog-view'), Object.values(model.listeners).flat().length]"), [None, 0])


class Embedded(PageTest):
    """A page in an iframe of an outer page that scrolls, under #embed."""

    @classmethod
    def make(cls):
        write_model(cls.folder / "one.ply", [0, 0, 0, 1, 1, 1, 0.5, 2, 0, 0, 0.5, 0.5, 0.5, 1])
        vog("page", "one.ply", "-o", "one.html")
        (cls.folder / "outer.html").write_text("""<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><body style="margin: 0; height: 4000px">
<iframe src="one.html#embed" style="width: 300px; height: 200px; border: 0"></iframe><script>
const inner = () => document.querySelector('iframe').contentWindow;
let told = '';
addEventListener('message', ({ data }) => { if (data.vog === 'settings') told = data.settings; });
const send = (settings) => inner().postMessage({ vog: 'settings', settings }, '*');
</script></body>""")

    def setUp(self):
        super().setUp()
        server = SiteServer(self.folder).__enter__()
        self.addCleanup(server.__exit__)
        self.browser.open(server.url + "outer.html")
        self.until("told && inner().vog.state.embed")

    def eye(self):
        return self.value("inner().vog.settled().then(() => inner().vog.state.camera.eye)")

    def test_settings_leave_the_page_embedded_and_the_wheel_to_the_outer_page(self):
        for settings, answer in (("'#tf=magma'", "tf=magma"), ("'#camera.eye=5,6,7&camera.look_at=0,0,0'", "camera.eye=5,6,7"),
                                 ("told.replace('magma', 'viridis')", "tf=viridis")):  # the page's own settings, without `embed`
            self.value(f"send({settings})")
            self.until(f"told.includes('{answer}')")
            self.assertTrue(self.value("inner().vog.state.embed && inner().document.body.classList.contains('embed')"), settings)
            self.assertFalse(self.value("inner().vog.state.still"))
        eye = self.eye()
        self.browser.wheel(100, 100, 120)
        self.until("scrollY > 0")
        self.assertEqual(eye, self.eye())

    def test_settings_end_the_embedding_where_they_say_so(self):
        self.value("send('#embed=0')")
        self.until("!inner().vog.state.embed")
        eye = self.eye()
        self.browser.wheel(100, 100, 120)
        self.until(f"String(inner().vog.state.camera.eye) !== '{','.join(map(repr, eye))}'")
        self.assertEqual(self.value("scrollY"), 0)
        self.value("send('#embed&still')")
        self.until("inner().vog.state.still")
        self.value("send('#tf=gray')")
        self.until("inner().vog.state.map === 'gray'")
        self.assertTrue(self.value("inner().vog.state.embed && inner().vog.state.still"))

    def test_a_page_of_its_own_sends_nothing(self):
        self.open("one.html")
        self.assertEqual(self.value("vog.state.map"), "ember")


if __name__ == "__main__":
    run()
