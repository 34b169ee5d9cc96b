"""Modules of the page in Node.js, without a browser: expressions over their exports, and streamed pages without a picture.

Needs Debian's nodejs (18 or newer) and nothing else.
"""
import json
import pathlib
import select
import shutil
import subprocess
import tempfile

PAGE = pathlib.Path(__file__).resolve().parents[2] / "src/web/page"
HOST = pathlib.Path(__file__).resolve().parent / "node"
# What a streamed page has of the page's modules.
STREAMED = ("vectors.js", "camera.js", "quantity.js", "link/link.js", "controls.js", "model/gaussians.js", "model/decoder.js", "picture/clip.js",
            "stream/site.js", "stream/status.js")

TIMEOUT_S = 300


def find_node():
    """Node.js 18 or newer; None: absent."""
    for name in ("nodejs", "node"):
        if path := shutil.which(name):
            version = subprocess.run([path, "--version"], capture_output=True, text=True).stdout
            if int(version.lstrip("v").split(".")[0]) >= 18:
                return path
    return None


class Node:
    """
    Process of Node.js, ended at the end of a `with` block.
    modules  of src/web/page, whose exports are global
    changed  {module: (text, other text in its place)}
    """

    def __init__(self, *modules, changed={}):
        self.folder = tempfile.TemporaryDirectory(prefix="vog-node-")
        root = pathlib.Path(self.folder.name)
        shutil.copytree(PAGE, root / "page", ignore=lambda _, names: [n for n in names if n.endswith((".css", ".html"))])
        shutil.copytree(HOST, root / "node")
        (root / "package.json").write_text('{"type": "module"}')
        for name, (text, other) in changed.items():
            before = (root / "page" / name).read_text()
            assert text in before, text
            (root / "page" / name).write_text(before.replace(text, other))
        self.process = subprocess.Popen([find_node(), "--no-warnings", root / "node/host.mjs", root / "page"], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, text=True, bufsize=1)
        self.evaluate(f"load(...{json.dumps(modules)})")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        self.process.stdin.close()
        self.process.stdout.close()
        self.folder.cleanup()

    def evaluate(self, expression):
        """Value of a JavaScript expression; promises are awaited."""
        self.process.stdin.write(json.dumps(expression) + "\n")
        if not select.select([self.process.stdout], [], [], TIMEOUT_S)[0]:
            raise TimeoutError(f"no answer within {TIMEOUT_S} s to {expression[:200]}")
        answer = json.loads(self.process.stdout.readline())
        if "error" in answer:
            raise RuntimeError(answer["error"])
        return answer.get("value")


class NodePage(Node):
    """A streamed page without a picture: node/page.mjs."""

    def __init__(self, url, fragment, size, changed={}):
        super().__init__(*STREAMED, "../node/page.mjs", "../node/likeness.mjs", changed=changed)
        self.evaluate(f"openPage({json.dumps(url)}, {json.dumps(fragment)}, {size[0]}, {size[1]})")
