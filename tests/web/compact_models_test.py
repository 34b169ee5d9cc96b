#!/usr/bin/env python3
"""The page's reader of compact models (src/web/page/model), in Node.js: every number beside those that the library reads.

VOG_COMMAND names the command. Exits with 77, which ctest takes as skipped, where there is no Node.js.
"""
import array
import base64
import json
import random

from page_test_case import run, sampled_cloud, vog, write_model
from quantity_test_case import write_flow
from streaming_test_case import NodeTest

# Numbers of a file in the order of the library's PLY: 11 a Gaussian (7 without rotations), then those of its fields.
READER = """
async function numbers(base64) {
  const file = await opened(Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0)));
  const rows = Array.from({ length: file.gaussians }, () => []);
  let first = 0;
  for (const chunk of file.chunks) {
    const mean = Array.from({ length: chunk.count }, () => []);
    await chunkShapes(file, chunk, (n, s, quaternion, mass) => {
      rows[first + n] = [...s, ...(file.rotated ? quaternion : []), mass / s[0] / s[1] / s[2]];
    }, (n, axis, value) => { mean[n][axis] = file.origin[axis] + file.corner[axis] + value; });
    mean.forEach((place, n) => rows[first + n].unshift(...place));
    for (let field = 0; field < file.fields.length; ++field)
      await chunkField(file, chunk, field, (n, s, quaternion, { value, deviation: d, gradient, share }) => {
        const row = rows[first + n];
        if (file.fields[field].kind !== 'vector') return row.push(value[0], ...gradient[0], d[0], share[0]);
        const [xy, xz, yz] = share;
        row.push(...value, ...gradient.flat(), d[0] * d[0], xy * d[0] * d[1], xz * d[0] * d[2], d[1] * d[1], yz * d[1] * d[2],
          d[2] * d[2]);
      });
    first += chunk.count;
  }
  return rows;
}
"""


def rows_of(path):
    """Rows of a binary PLY of floats."""
    header, _, body = path.read_bytes().partition(b"end_header\n")
    names = [line.split()[-1].decode() for line in header.splitlines() if line.startswith(b"property float ")]
    count = next(int(line.split()[-1]) for line in header.splitlines() if line.startswith(b"element vertex "))
    numbers = array.array("f", body[:4 * len(names) * count])
    return names, [numbers[n * len(names):(n + 1) * len(names)] for n in range(count)]


def covariance(row):
    """Entries of R diag(s^2) R^T: axes of one ellipsoid may be named in several ways."""
    s, (w, x, y, z) = row[3:6], row[6:10]
    r = ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
         (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
         (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))
    return [sum(r[a][k] * r[b][k] * s[k] ** 2 for k in range(3)) for a in range(3) for b in range(a, 3)]


class CompactModels(NodeTest):
    modules = ("model/vogz.js",)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.node.evaluate(f"{READER}; globalThis.numbers = numbers; 0")

    def numbers(self, model, *options):
        """Numbers of a model that is written with some options, as the page reads them."""
        vog("pack", model, "-o", "m.vogz", "--deflate", *options)
        data = base64.b64encode((self.folder / "m.vogz").read_bytes()).decode()
        return self.value(f"numbers('{data}')")

    def expect_the_librarys(self, model, *options):
        rows = self.numbers(model, *options)
        vog("convert", "m.vogz", "-o", "back.ply", "--no-hierarchy")
        names, wanted = rows_of(self.folder / "back.ply")
        self.assertEqual(len(rows), len(wanted))
        self.assertGreater(len(rows), 0)
        rotated = "rot_0" in names
        shapes = 11 if rotated else 7
        largest = [max(abs(row[k]) for row in wanted) or 1 for k in range(len(names))]
        for row, want in zip(rows, wanted):
            self.assertEqual(len(row), len(want))
            for k in range(3):
                self.assertLessEqual(abs(row[k] - want[k]), 1.2e-7 * max(largest[:3]), names[k])
            if rotated:
                found, right = covariance(row), covariance(want)
                for a, b in zip(found, right):
                    self.assertLessEqual(abs(a - b), 2e-5 * max(map(abs, right)))
            else:
                for k in range(3, 6):
                    self.assertLessEqual(abs(row[k] / want[k] - 1), 1e-6)
            self.assertLessEqual(abs(row[shapes - 1] / want[shapes - 1] - 1), 1e-4, "density")
            for k in range(shapes, len(names)):
                # A limited plane's residual is from a difference.
                close = 4e-6 if names[k].endswith("_skew") else 1e-6
                self.assertLessEqual(abs(row[k] - want[k]), close * largest[k], names[k])

    def test_shapes_and_fields_are_the_librarys(self):
        vog("convert", sampled_cloud(), "-o", "cloud.ply", "--block", 4)
        self.expect_the_librarys("cloud.ply")
        self.expect_the_librarys("cloud.ply", "--set", "rounding=1e-5", "--set", "field-rounding=1e-6")
        self.expect_the_librarys("cloud.ply", "--hierarchy")
        write_flow(self.folder / "flow.ply")
        self.expect_the_librarys("flow.ply")

    def test_round_gaussians_far_apart_are_the_librarys(self):
        """Steps along the curve and places inside of cells have more bits than a word of JavaScript."""
        draw = random.Random(5)
        rows = []
        for n in range(500):
            s = 10 ** draw.uniform(-4, 1)
            rows += [draw.uniform(-50, 50) + 900 * (n % 2), draw.uniform(-1e4, 1e4), draw.gauss(0, 9), s, s, s, 1 + draw.random()]
        write_model(self.folder / "far.ply", rows)
        self.expect_the_librarys("far.ply")
        self.expect_the_librarys("far.ply", "--set", "rounding=1e-5")

    def test_no_gaussians(self):
        write_model(self.folder / "none.ply", [])
        self.assertEqual(self.numbers("none.ply"), [])

    def test_damaged_files_are_refused(self):
        write_flow(self.folder / "flow.ply", 300)
        vog("pack", "flow.ply", "-o", "m.vogz", "--deflate")
        whole = (self.folder / "m.vogz").read_bytes()
        draw = random.Random(1)
        broken = [whole[:draw.randrange(len(whole))] for _ in range(8)] + [whole + b"0"]
        # All but the minor version and the reserved word.
        for place in [*range(0, 9, 2), *range(12, 44, 2), *(draw.randrange(48, len(whole)) for _ in range(60))]:
            broken.append(whole[:place] + bytes([whole[place] ^ (1 << draw.randrange(8))]) + whole[place + 1:])
        data = json.dumps([base64.b64encode(one).decode() for one in broken])
        answers = self.value(f"Promise.all({data}.map((one) => numbers(one).then(() => 'read', (error) => error.message)))")
        for answer in answers:
            self.assertTrue("damaged" in answer or "expected" in answer, answer)

    def test_files_packed_by_zstd_say_so(self):
        write_flow(self.folder / "flow.ply", 300)
        vog("pack", "flow.ply", "-o", "m.vogz")
        data = base64.b64encode((self.folder / "m.vogz").read_bytes()).decode()
        self.assertIn("--deflate", self.value(f"numbers('{data}').then(() => '', (error) => error.message)"))


if __name__ == "__main__":
    run()
