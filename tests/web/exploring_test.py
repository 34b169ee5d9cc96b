#!/usr/bin/env python3
"""Exploring a model by hand in the page that `vog export` writes, in Chromium: fields that come first, the editor's axis and
bands, the probe in volumes, handles of the clip box, decoding in a worker.

VOG_COMMAND names the command, VOG_DATA the folder of real inputs. Exits with 77, which ctest takes as skipped,
where there is no Chromium.
"""
import array
import json
import math
import random

from page_test_case import PageTest, run, smoke, vog


def write_scalars(path, gaussians, fields):
    """
    Writes a PLY of axis-aligned Gaussians with scalar fields that are planes.
    gaussians  rows (mean, scales, density, [(value, gradient) of each field])
    fields     [(kind, name, lower, upper)]
    """
    names = ["x", "y", "z", "scale_0", "scale_1", "scale_2", "density"]
    for _, name, *_ in fields:
        names += [name, *(f"{name}_{k}" for k in ("gx", "gy", "gz", "sd", "skew"))]
    header = "ply\nformat binary_little_endian 1.0\ncomment vog 1\ncomment cutoff 3\n"
    header += "".join(f"comment field {kind} {name} {lower} {upper}\n" for kind, name, lower, upper in fields)
    header += f"element vertex {len(gaussians)}\n" + "".join(f"property float {name}\n" for name in names) + "end_header\n"
    rows = array.array("f")
    for mean, scales, density, values in gaussians:
        rows.extend([*mean, *scales, density])
        for value, gradient in values:
            rows.extend([value, *gradient, 0, 0])
    with open(path, "wb") as out:
        out.write(header.encode())
        rows.tofile(out)


def random_gaussians(count, plane):
    """plane(mean)  [(value, gradient) of each field]"""
    rng, rows = random.Random(7), []
    for _ in range(count):
        mean = [rng.uniform(-1, 1) for _ in range(3)]
        rows.append((mean, [rng.uniform(0.1, 0.3) for _ in range(3)], rng.uniform(0.2, 1), plane(mean)))
    return rows


class Exploring(PageTest):
    @classmethod
    def make(cls):
        vog("convert", smoke(), "-o", "smoke.ply", "--block", 8)
        vog("export", "smoke.ply", "-o", "smoke.html", "--levels", 1)
        # Heat rises with x; the measure is the second field.
        cls.rows = random_gaussians(60, lambda mean: [(300 + 10 * mean[0], [10, 0, 0]), (0.5, [0, 0, 0])])
        write_scalars(cls.folder / "two.ply", cls.rows, [("scalar", "heat", 285, 315), ("measure", "mass", 0.1, 1)])
        vog("export", "two.ply", "-o", "two.html", "--levels", 1)

    def start(self, page, fragment="#subframes=1"):
        self.browser.viewport(1000, 800)
        self.open(page, fragment)

    def box_of(self, identifier):
        return self.value(f"(() => {{ const b = document.getElementById('{identifier}').getBoundingClientRect();"
                          " return [b.left, b.top, b.width, b.height]; })()")

    # --- The first field. ---

    def test_volumes_without_a_word_about_the_field_are_of_the_density(self):
        self.start("two.html", "#subframes=1&show=volume")
        names = self.value("vog.page.models[0].fields.map(({name}) => name)")
        self.assertEqual(names, ["heat", "mass"])
        self.assertEqual(names[self.value("vog.state.field")], "mass")
        self.start("two.html", "#subframes=1&show=volume&field=heat")
        self.assertEqual(names[self.value("vog.state.field")], "heat")
        # A field that was chosen stays.
        self.start("two.html", "#subframes=1&show=mean")
        self.assertEqual(names[self.value("vog.state.field")], "heat")
        self.value("vog.change({show: 'volume'})")
        self.assertEqual(names[self.value("vog.state.field")], "heat")
        # A transfer function of a link is the density's.
        self.start("two.html", "#subframes=1&show=volume&colors=0,1,0,0;1,1,1,1&opacity=0,0;1,1&unit=2")
        self.assertEqual(self.value("Object.keys(vog.state.transfers)"), ["1"])


if __name__ == "__main__":
    run()
