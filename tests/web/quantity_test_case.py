"""What tests of quantities in pages share: a page of a converted volume, one of rotated Gaussians with a scalar and a vector field, and
their pictures against the command's."""
import array
import json
import math
import random

from page_test_case import FACTOR, FACTOR_DB, FolderTest, PageTest, vog, write_model


def make_plume(path):
    """Makes a volume of a turbulent column that widens upwards, 70 x 120 x 70 world units, densities 0 to 3."""
    rng, rows = random.Random(2), []
    for _ in range(120):
        height = rng.random()
        width, s = 8 + 14 * height, rng.uniform(3, 6) * (1 + height)
        x, z = rng.gauss(4 * math.sin(6 * height), 0.5 * width), rng.gauss(4 * math.cos(5 * height), 0.5 * width)
        rows += [x, 120 * height, z, s, s, s, rng.uniform(0.1, 0.7) * (1 - 0.6 * height)]
    write_model(FolderTest.folder / "column.ply", rows)
    vog("voxelize", "column.ply", "-o", path, "--voxel-size", 3)


def write_flow(path, count=400):
    """Writes a PLY of rotated Gaussians with a field `temperature` [K] and a vector field `velocity` [km/s]."""
    rng, names = random.Random(5), ["x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3", "density"]
    scalar = ["temperature", *(f"temperature_{k}" for k in ("gx", "gy", "gz", "sd", "skew"))]
    vector = [f"velocity_{c}" for c in "xyz"]
    vector += [f"velocity_{c}_g{axis}" for c in "xyz" for axis in "xyz"]
    vector += [f"velocity_{pair}" for pair in ("xx", "xy", "xz", "yy", "yz", "zz")]
    rows = array.array("f")
    for _ in range(count):
        q = [rng.gauss(0, 1) for _ in range(4)]
        rows.extend([rng.uniform(-1, 1) for _ in range(3)] + [rng.uniform(0.05, 0.3) for _ in range(3)])
        rows.extend([v / math.hypot(*q) for v in q] + [rng.uniform(0.1, 1)])
        rows.extend([rng.uniform(280, 320), *(rng.gauss(0, 8) for _ in range(3)), rng.uniform(0, 4), rng.uniform(-1, 1)])
        spread = [rng.uniform(1, 5) for _ in range(3)]
        rows.extend([rng.gauss(0, 20) for _ in range(3)] + [rng.gauss(0, 10) for _ in range(9)])
        rows.extend([spread[0] ** 2, 0.3 * spread[0] * spread[1], 0, spread[1] ** 2, -0.2 * spread[1] * spread[2], spread[2] ** 2])
    header = "ply\nformat binary_little_endian 1.0\ncomment vog 1\ncomment cutoff 2.25\n"
    header += "comment field scalar temperature 270 330 K\ncomment field vector velocity 0 80 km/s\n"
    header += f"element vertex {count}\n" + "".join(f"property float {n}\n" for n in names + scalar + vector)
    with open(path, "wb") as out:
        out.write((header + "end_header\n").encode())
        rows.tofile(out)


class QuantityTest(PageTest):
    # Large enough that no Gaussian is narrower than a pixel: those lose their planes at a sharp limit.
    size = (180, 150)
    block = 4
    # Errors of the plume's and the flow's pictures: PSNR [dB], largest difference [steps of 255], which is of rims that quantised scales move.
    measured = {"T": (73.2, 4), "column": (56.5, 4), "maximum": (67.2, 1), "volume": (62.9, 2)}
    # Share of a picture's pixels that may be off by more than 4 steps, in place of the largest difference.
    rims = None
    # Shares of the pixels of the flow's maps that are off by more than 4 and 1 steps.
    measured_maps = {4: 3.0e-4, 1: 8.9e-4}

    @classmethod
    def make_volume(cls):
        """Path of the volume that model.ply is made of."""
        make_plume("plume.vdb")
        return "plume.vdb"

    @classmethod
    def make(cls):
        vog("convert", cls.make_volume(), "-o", "model.ply", "--block", cls.block)
        write_flow(cls.folder / "flow.ply")
        # From black: where a map begins with a colour, the pixel at which a support ends differs by all of it.
        for name in "model", "flow":
            vog("page", f"{name}.ply", "-o", f"{name}.html", "--set", "levels=1", "--tf", "inferno")

    def start(self, page, fragment="#subframes=1&embed"):
        self.browser.viewport(*self.size)
        self.open(page, fragment)

    def change(self, **state):
        self.value(f"vog.change({json.dumps(state)})")
        self.browser.settle()

    def compared(self, model, *options):
        """Differences between the page's picture and that of vog render with some options."""
        self.picture()
        width, height = self.write_camera()
        if "volume" not in options and "--tf" not in options:
            options += ("--tf", self.value("vog.state.map"))
        if "volume" in options:  # pages draw every pixel
            options += ("--set", "precision=0")
        vog("render", model, "-o", "cpu.png", "--camera", "camera.json", "--size", f"{width}x{height}", *options)
        return json.loads(vog("compare", "cpu.png", "web.png", "--json"))

    def expect_page_is(self, model, *options, off=None):
        """Expects the page's picture to equal that of vog render with some options; off: largest difference [steps], if not FACTOR's."""
        found, name = self.compared(model, *options), options[options.index("--show") + 1] if "--show" in options else "T"
        psnr, steps = self.measured[name]
        self.hold(f"-PSNR of {name} [dB]", -(found["psnr_rgb_db"] or math.inf), FACTOR_DB - psnr)
        if self.rims is not None:
            self.hold(f"{name}: share off by more than 4", found["off_by_more_than_4"], FACTOR * self.rims)
            return
        # Both round to whole steps: one step each.
        self.hold(f"{name}: steps of 255", found["largest"], off or max(2, FACTOR * steps))

    def expect_map_is(self, model, *options):
        """The same for a map of a field, which has no colour below a thousandth of the picture's largest column."""
        width, height = self.write_camera()
        clips = [option for option in options if option.startswith("--clip=")]
        vog("render", model, "--show", "column", "--values-out", "column.npy", "--camera", "camera.json",
            "--size", f"{width}x{height}", *clips)
        column = array.array("f", (self.folder / "column.npy").read_bytes()[-4 * width * height:])
        # The page's bound is 1e-4 of this number.
        self.value(f"vog.page.models[0].mostColumn = {10 * max(column)!r}; vog.change({{}})")
        self.browser.settle()
        # A pixel whose column is the bound to rounding has a colour in one of the two.
        found = self.compared(model, "--set", "least-column=1e-3", *options)
        for steps, share in self.measured_maps.items():
            self.hold(f"maps: share off by more than {steps}", found[f"off_by_more_than_{steps}"], FACTOR * share)
