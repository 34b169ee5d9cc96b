"""A page inside of another, as in notebooks: settings as messages, and the widget's script under a model of Jupyter's."""
import html
import json

from page_test_case import HOUSE, PageTest, run, vog, write_model
from site_server import SiteServer

WIDGET = HOUSE / "python" / "vog" / "_widget.js"

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
"""


class Outer(PageTest):
    @classmethod
    def make(cls):
        write_model(cls.folder / "one.ply", [0, 0, 0, 1, 1, 1, 0.5, 2, 0, 0, 0.5, 0.5, 0.5, 1])
        write_model(cls.folder / "two.ply", [0, 0, 0, 2, 2, 2, 0.5])
        for name in ("one", "two"):
            vog("page", f"{name}.ply", "-o", f"{name}.html")
        text = {name: (cls.folder / f"{name}.html").read_text() for name in ("one", "two")}
        script = WIDGET.read_text().replace("export default { render };", "")
        (cls.folder / "outer.html").write_text(f"""<!doctype html><meta charset="utf-8"><body style="margin: 0"><div id="cell"></div>
<template id="one">{html.escape(text["one"])}</template><template id="two">{html.escape(text["two"])}</template>
<script>{MODEL}{script}
const page = (name) => document.getElementById(name).content.textContent;
const model = new Model({{ html: page('one'), height: 220, sent: '', link: '' }});
const remove = render({{ model, el: document.getElementById('cell') }});
const inner = () => document.querySelector('iframe').contentWindow;
const until = async (test) => {{ for (let n = 0; n < 2400 && !test(); ++n) await new Promise((done) => setTimeout(done, 25)); return test(); }};
const shown = () => until(() => inner().vog?.state && model.values.link);
</script></body>""")

    def setUp(self):
        super().setUp()
        self.browser.open(self.folder / "outer.html", "")
        self.assertTrue(self.value("shown().then(Boolean)"))

    def link(self):
        return dict(word.partition("=")[::2] for word in self.value("model.values.link").lstrip("#").split("&"))

    def test_the_page_reports_its_settings(self):
        self.assertEqual(self.link()["tf"], "ember")
        self.assertEqual(self.value("document.querySelector('iframe').clientHeight"), 220)
        # A hand in the page arrives in Python.
        self.value("inner().vog.change({ map: 'viridis' })")
        self.assertTrue(self.value("until(() => model.values.link.includes('tf=viridis'))"))
        self.assertTrue(self.value("model.saved.at(-1).includes('tf=viridis')"))

    def test_a_drag_arrives(self):
        before = self.link()["camera.eye"]
        self.browser.drag(100, 100, 160, 110)
        self.assertTrue(self.value(f"until(() => !model.values.link.includes({json.dumps(before)}))"))

    def test_python_sets_them(self):
        self.value("model.from_python('sent', '1 #tf=magma&camera.eye=5,6,7&camera.look_at=0,0,0&show=column')")
        self.assertTrue(self.value("until(() => inner().vog.state.map === 'magma')"))
        self.assertEqual(self.value("inner().vog.state.camera.eye"), [5, 6, 7])
        self.assertTrue(self.value("until(() => model.values.link.includes('show=column'))"))
        # What a page does not know changes nothing.
        self.value("model.from_python('sent', '2 #tf=nothing')")
        self.value("inner().postMessage({ vog: 'settings', settings: 5 }, '*'); inner().postMessage(null, '*')")
        self.assertEqual(self.value("inner().vog.state.map"), "magma")

    def test_another_model_takes_the_settings(self):
        self.value("model.from_python('sent', '1 #tf=magma')")
        self.assertTrue(self.value("until(() => model.values.link.includes('tf=magma'))"))
        radius = self.value("inner().vog.page.models[0].box.radius")
        self.value("model.from_python('html', page('two'))")
        self.assertTrue(self.value(f"until(() => inner().vog && inner().vog.page.models[0].box.radius !== {radius})"))
        self.assertTrue(self.value("until(() => inner().vog.state.map === 'magma')"))

    def test_a_removed_widget_is_silent(self):
        self.value("remove()")
        count = self.value("model.saved.length")
        self.value("inner().vog.change({ map: 'gray' })")
        # A message of its own comes back after all that the page has sent.
        self.assertEqual(self.value("inner().vog.settled().then(() => new Promise((done) => inner().requestAnimationFrame(() => {"
                                    " addEventListener('message', ({data}) => data === 'last' && done(model.saved.length));"
                                    " inner().parent.postMessage('last', '*'); })))"), count)

    def test_a_page_of_its_own_sends_nothing(self):
        self.open("one.html")
        self.assertEqual(self.value("vog.state.map"), "ember")


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


if __name__ == "__main__":
    run()
