"""Inputs of option_effects_test.py: volumes, particles, models and pictures, small, with what each option needs to change a result."""

import json
import struct
import subprocess
from pathlib import Path

from command_server import VOG


def make_inputs(made):
    def vog(*words):
        done = subprocess.run([VOG, *(word.replace("{made}", made) for word in words)], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr

    def volume(name, value, edge=12, origin=0, spacing=1):
        cells = [value(x, y, z) for z in range(edge) for y in range(edge) for x in range(edge)]
        head = (f"NRRD0004\ntype: float\ndimension: 3\nsizes: {edge} {edge} {edge}\nspace dimension: 3\n"
                f"space directions: ({spacing},0,0) (0,{spacing},0) (0,0,{spacing})\nspace origin: ({origin},{origin},0)\n"
                "endian: little\nencoding: raw\n\n")
        Path(made, name).write_bytes(head.encode() + struct.pack(f"<{len(cells)}f", *cells))

    def blob(x, y, z):
        r = ((x - 5.5) ** 2 + (y - 5.5) ** 2 + (z - 5) ** 2) ** 0.5
        return max(0.0, 0.5 - 0.08 * r + 0.02 * ((x * 7 + y * 3 + z) % 5)) * (r < 5.5)

    volume("small.nrrd", blob)
    volume("labels.nrrd", lambda x, y, z: 1.0 + (x > 5))
    volume("across.nrrd", blob, origin=0.3, spacing=0.7)
    volume("nan.nrrd", lambda x, y, z: float("nan") if x == y == 5 else blob(x, y, z))
    volume("negative.nrrd", lambda x, y, z: -0.1 if x == y == 5 else blob(x, y, z))
    points = [f"{n * 7 % 11},{n * 5 % 13},{n * 3 % 17},{1 + n % 4}" for n in range(200)]
    for name, bad in (("points", "3,4,5,6"), ("nan", "nan,4,5,6"), ("negative", "3,4,5,-6")):
        Path(made, name + ".csv").write_text("\n".join(["x,y,z,weight", *points, bad]) + "\n")
    vog("convert", "{made}/points.csv", "-o", "{made}/points.vdb")
    vog("sample", "fire", "{made}/fire.vdb", "--size", "64")
    for kind in ("cloud", "amr"):
        vog("sample", kind, "{made}/%s.vdb" % kind, "--size", "64")
    vog("convert", "{made}/fire.vdb", "-o", "{made}/model.ply", "--block", "4", "--field", "temperature")
    vog("convert", "{made}/fire.vdb", "-o", "{made}/other.ply", "--block", "16", "--field", "temperature")
    vog("convert", "{made}/small.nrrd", "-o", "{made}/tiny.ply", "--block", "8")
    vog("convert", "{made}/cloud.vdb", "-o", "{made}/many.ply", "--block", "2")
    vog("export", "{made}/model.ply", "-o", "{made}/nan.ply", "--as", "3dgs")
    head, rows = Path(made, "nan.ply").read_bytes().split(b"end_header\n", 1)
    for name in ("nan", "nan_too"):
        Path(made, name + ".ply").write_bytes(head + b"end_header\n" + struct.pack("<f", float("nan")) + rows[4:])
    vog("pack", "{made}/model.ply", "-o", "{made}/streams.vogz", "--hierarchy", "--deflate")
    vog("page", "{made}/tiny.ply", "-o", "{made}/page.html")
    Path(made, "sphere.vdb").write_bytes(level_set())
    for name, roll in (("a", "0"), ("b", "5")):
        vog("render", "{made}/model.ply", "-o", "{made}/%s.png" % name, "--size", "16", "--set", "roll=" + roll, "--depth-out",
            "{made}/%s.exr" % name, "--values-out", "{made}/%s.npy" % name)
        vog("render", "{made}/model.ply", "--show", "mean", "--field", "temperature", "--size", "16", "--set", "roll=" + roll,
            "--values-out", "{made}/field_%s.exr" % name)
    Path(made, "camera.json").write_text(json.dumps({"eye": [60, 40, 30], "look_at": [8, 8, 8], "up": [0, 1, 0], "fov_degrees": 30}))
    # Of no data, so that it goes with all: what differs is the size.
    vog("render", "{made}/model.ply", "-o", "{made}/request.png", "--size", "24")
    Path(made, "tour.vog").write_text("wait\npicture {out}/p.png\ndepth {out}/d.exr\nscreenshot {out}/s.png\n")


def level_set():
    """A sphere as OpenVDB writes a narrow band, in one leaf: an uncompressed file of version 224."""
    def text(*words):
        return b"".join(struct.pack("<I", len(word)) + word.encode() for word in words)

    head = struct.pack("<qIIIB36sii", 0x56444220, 224, 10, 0, 1, b"0" * 36, 0, 1) + text("value", "Tree_float_5_4_3", "")
    grid = struct.pack("<Ii", 0, 1) + text("class", "string", "level set", "UniformScaleMap") + struct.pack("<15d", *[1] * 12, *[0.5] * 3)
    distance = [((x - 3.5) ** 2 + (y - 3.5) ** 2 + (z - 3.5) ** 2) ** 0.5 - 2.5 for x in range(8) for y in range(8) for z in range(8)]
    mask = int("".join("1" if one < 3 else "0" for one in reversed(distance)), 2).to_bytes(64, "little")
    grid += struct.pack("<ifII3i", 1, 3.0, 0, 1, 0, 0, 0)
    for edge in (32, 16):  # inner nodes whose first child is all they have
        grid += (1).to_bytes(edge**3 // 8, "little") + bytes(edge**3 // 8) + b"\6" + struct.pack("<f", 3.0) * edge**3
    grid += mask
    leaf = mask + b"\6" + struct.pack("<512f", *(min(one, 3.0) for one in distance))
    place = len(head) + 24
    return head + struct.pack("<3q", place, place + len(grid), place + len(grid) + len(leaf)) + grid + leaf
