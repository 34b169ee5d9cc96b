"""render(), compare(): pictures equal to the command's, buffers, notebooks, transfer functions, pages."""
import functools
import gc
import json
import pickle
import zlib

import numpy as np
import pytest

import vog
from conftest import same_picture


@pytest.mark.parametrize(
    "options, flags",
    [
        ({}, []),
        ({"size": (90, 60), "renderer": "trace"}, ["--size", "90x60", "--renderer", "trace"]),
        ({"size": 80, "aabb_sigma": 1.5}, ["--size", 80, "--set", "aabb-sigma=1.5"]),
        ({"size": 80, "kappa": 0.2, "extinction": 3}, ["--size", 80, "--set", "kappa=0.2", "--extinction", 3]),
        (
            {
                "size": 40,
                "renderer": "trace",
                "anyhit": "collect",
                "hits_per_slab": 8,
                "stop_transmittance": 0.01,
                "extinction": 20,
            },
            ["--size", 40, "--renderer", "trace", "--set", "anyhit=collect", "--set", "hits-per-slab=8"]
            + ["--set", "stop-transmittance=0.01", "--extinction", 20],
        ),
    ],
)
def test_pictures_of_models_are_the_commands_bit_for_bit(tmp_path, command, model, options, flags):
    model.save(tmp_path / "model.ply")
    command("render", "model.ply", "-o", "a.png", "--depth-out", "a.exr", *flags)
    picture = vog.render(vog.Gaussians.load(tmp_path / "model.ply"), **options)
    picture.save_values(tmp_path / "b.exr")
    picture.save(tmp_path / "b.png")
    assert same_picture(tmp_path / "a.png", tmp_path / "b.png")
    for depth in (vog.DepthImage.load(tmp_path / "a.exr"), vog.DepthImage.load(tmp_path / "b.exr"), picture.depth):
        assert np.array_equal(depth.depth, picture.values) and depth.extinction == picture.extinction


@pytest.mark.parametrize(
    "options, flags",
    [({}, []), ({"interpolation": "linear", "step": 0.5, "samples": 2},
      ["--interpolation", "linear", "--set", "step=0.5", "--samples", 2])],
)
def test_pictures_of_voxels_are_the_commands_too(tmp_path, command, cloud, options, flags):
    cloud.save(tmp_path / "cloud.vdb")
    command("render", "cloud.vdb", "-o", "a.png", "--size", 64, "--tf", "blue-white", "--blend", *flags)
    vog.render(cloud, size=64, tf="blue-white", blend=True, **options).save(tmp_path / "b.png")
    assert same_picture(tmp_path / "a.png", tmp_path / "b.png")


def test_pictures_of_levels_and_particles_are_the_commands_too(tmp_path, command):
    command("sample", "amr", "amr.vdb", "--size", 64)
    command("render", "amr.vdb", "--grid", "density_L*", "-o", "a.png", "--size", 64)
    vog.render(vog.Levels.load(tmp_path / "amr.vdb", "density_L*"), size=64).save(tmp_path / "b.png")
    assert same_picture(tmp_path / "a.png", tmp_path / "b.png")
    vog.sample_particles(8).save(tmp_path / "points.xyz")
    command("render", "points.xyz", "-o", "c.png", "--size", 64)
    vog.render(vog.Points.load(tmp_path / "points.xyz"), size=64).save(tmp_path / "d.png")
    assert same_picture(tmp_path / "c.png", tmp_path / "d.png")


def test_cameras_are_shared_with_the_command(tmp_path, command, model):
    model.save(tmp_path / "model.ply")
    camera = vog.Camera.orbit(model, azimuth=57, elevation=-12, distance=2, fov_degrees=50)
    camera.save(tmp_path / "camera.json")
    command("render", "model.ply", "-o", "a.png", "--size", 64, "--camera", "camera.json")
    vog.render(model, camera, 64).save(tmp_path / "b.png")
    assert same_picture(tmp_path / "a.png", tmp_path / "b.png")
    for back in (vog.Camera.load(tmp_path / "camera.json"), pickle.loads(pickle.dumps(camera)), eval(repr(camera))):
        assert back == camera
    assert camera != vog.Camera.paper_view(model) and camera != 3
    for data in (vog.sample_cloud(64), vog.sample_particles(8), vog.sample_levels(64), np.array([[0, 0, 0], [1, 1, 1]])):
        assert vog.Camera.paper_view(data).fov_degrees == pytest.approx(38.58, abs=0.01)
    with pytest.raises(vog.Error):
        vog.Camera((0, 0, 0), (0, 0, 0))
    with pytest.raises(vog.Error, match="up 'w', expected"):
        vog.Camera.orbit(model, up="w")
    with pytest.raises(vog.Error, match="elevation 91"):
        vog.Camera.orbit(model, elevation=91)
    with pytest.raises(TypeError):
        vog.Camera.paper_view("model.ply")


def test_orbits_are_the_commands_views(tmp_path, command, model):
    model.save(tmp_path / "model.ply")
    for options, camera in (
        (["--view", "+z", "--up", "z"], vog.Camera.orbit(model, view="+z", up="z")),
        (["--view", "30,20", "--set", "roll=20"], vog.Camera.orbit(model, azimuth=30, elevation=20, roll=20)),
        (["--view", "-x", "--orthographic"], vog.Camera.orbit(model, view="-x", orthographic=True)),
        (["--orthographic", "--width", "70"], vog.Camera.orbit(model, width=70)),
        (["--view", "paper"], vog.Camera.paper_view(model)),
    ):
        command("render", "model.ply", "-o", "a.png", "--size", 64, *options)
        vog.render(model, camera, 64).save(tmp_path / "b.png")
        assert same_picture(tmp_path / "a.png", tmp_path / "b.png")


def test_parallel_rays_sum_to_the_mass(model, cloud):
    # Four pixels a voxel, edge on edge: along the axes the sum over the voxels is exact. Cells on the same
    # lattice as the pixels are sampled all alike, 5e-4 off.
    box = cloud.box
    voxels = 96
    size, width = 4 * voxels, voxels / 64 * float((box[1] - box[0]).max())
    for data, renderer, within in ((model, "splat", 1e-3), (model, "trace", 1e-3), (cloud, "reference", 1e-7)):
        for view in ("+x", "-y", "+z", "paper"):
            camera = vog.Camera.orbit(data, view=view, width=width)
            column = vog.render(data, camera, size, renderer=renderer, show="column").values
            mass = column.sum(dtype=float) * (width / size) ** 2
            assert mass == pytest.approx(data.mass, rel=1e-4 if view == "paper" else within)


def test_any_unit_of_length_gives_the_same_picture():
    z, y, x = np.mgrid[:20, :20, :20] - 9.5
    density = np.exp(-(x**2 + y**2 + z**2) / 20).astype(np.float32)
    for renderer in ("splat", "trace", "reference"):
        pictures = []
        for unit in (1, 1e-30, 1e-21, 1e21, 1e30):
            volume = vog.Volume.from_numpy(density, voxel_size=unit)
            data = volume if renderer == "reference" else vog.convert(volume, block=2)
            picture = vog.render(data, size=48, renderer=renderer)
            pictures.append(1 - np.exp(-np.asarray(picture, dtype=float)))
        assert pictures[0].max() > 0.9
        for other in pictures[1:]:
            assert np.abs(other - pictures[0]).max() < 1e-5, renderer


def test_a_scene_draws_many_views_and_quantities(model, cloud):
    for data, renderer in ((model, "splat"), (model, "trace"), (cloud, "reference")):
        scene = vog.Scene(data)
        for azimuth in (6, 115):
            camera = vog.Camera.orbit(data, azimuth)
            for show in ("T", "volume", "column", "maximum", "T"):
                one, other = (draw(camera, 40, show=show, renderer=renderer) for draw in (scene.render, functools.partial(vog.render, data)))
                assert np.array_equal(one.values, other.values, equal_nan=True) and one.request == other.request
                assert np.array_equal(one.image, other.image) and one.camera == camera
    with pytest.raises(TypeError, match="render: unknown keyword 'value_range', nearest 'range', expected show, field, range"):
        scene.render(value_range=(0, 1))
    with pytest.raises(TypeError, match="value_range"):
        vog.render(model, value_range=(0, 1))


def test_pictures_are_buffers_without_copies(model):
    picture = vog.render(model, size=(50, 30))
    array = np.asarray(picture)
    assert array.shape == picture.shape == (30, 50) and array.dtype == np.float32 and not array.flags.owndata
    assert np.shares_memory(array, picture.values) and np.shares_memory(array, np.asarray(memoryview(picture)))
    assert np.shares_memory(array, picture.column) and picture.mean is None and picture.deviation is None
    for view in (array, picture.values):
        with pytest.raises(ValueError):
            view[0] = 0
    values = vog.render(model, size=16).values  # outlives its picture
    gc.collect()
    assert np.array_equal(values, vog.render(model, size=16).values)


def test_depth_takes_another_extinction(model):
    picture = vog.render(model, size=(50, 30))
    depth = picture.depth
    array = np.asarray(depth)
    assert array.shape == depth.shape == (30, 50) and array.dtype == np.float32 and not array.flags.owndata
    assert np.shares_memory(array, depth.depth) and np.shares_memory(array, np.asarray(memoryview(depth)))
    assert np.array_equal(array, picture.values) and depth.extinction == picture.extinction
    sum_before, extinction = array.sum(), depth.extinction
    depth.extinction = 2 * extinction
    assert array.sum() == pytest.approx(2 * sum_before, rel=1e-5) and picture.values.sum() == sum_before
    depth.extinction = "auto"
    assert depth.extinction == pytest.approx(extinction, rel=1e-6)
    copied = vog.DepthImage.from_numpy(array.astype(np.float64), depth.extinction)
    assert vog.compare(depth, copied).identical
    assert vog.compare(depth, pickle.loads(pickle.dumps(depth))).identical
    column = vog.render(model, size=(50, 30), show="column")
    assert column.depth.extinction == column.extinction == 1
    assert np.allclose(depth.column_density(), column.values, rtol=1e-5)


def test_images_are_uint8_and_show_themselves(tmp_path, model):
    picture = vog.render(model, size=(50, 30), tf="viridis", background=(0.2, 0.4, 1))
    image = picture.image
    array = np.asarray(image)
    assert array.shape == image.shape == (30, 50, 3) and array.dtype == np.uint8 and not array.flags.owndata
    assert np.array_equal(array[0, 0], [51, 102, 255])
    assert np.array_equal(np.rint(255 * image.rgba[..., :3]).astype(np.uint8), array)
    with pytest.raises(ValueError):
        array[0] = 0
    clear = picture.recolor(background="transparent").image
    assert np.asarray(clear).shape == (30, 50, 4) and np.asarray(clear)[0, 0, 3] == 0
    image.save(tmp_path / "a.png")
    assert image._repr_png_() == (tmp_path / "a.png").read_bytes()
    assert picture._repr_png_() == image._repr_png_() and repr(picture) == "<vog.Picture: T, 50x30>"
    assert np.array_equal(image, picture.depth.shade("viridis", background=(0.2, 0.4, 1)))
    assert picture.depth._repr_png_() == vog.render(model, size=(50, 30)).image._repr_png_()
    for back in (vog.Image.load(tmp_path / "a.png"), vog.Image.from_numpy(array), pickle.loads(pickle.dumps(image))):
        assert vog.compare(image, back).psnr_db == np.inf
    # Decoded by the PNG specification: 8 bits, RGB.
    png = image._repr_png_()
    assert png[:8] == b"\x89PNG\r\n\x1a\n" and png[24:26] == b"\x08\x02" and zlib.crc32(png[12:29]).to_bytes(4, "big") == png[29:33]


def test_compare_tells_what_the_command_tells(tmp_path, command, model, cloud):
    voxels, gaussians = vog.render(cloud, size=64), vog.render(model, size=64)
    voxels.save_values(tmp_path / "a.exr")
    gaussians.save_values(tmp_path / "b.exr")
    report = json.loads(command("compare", "a.exr", "b.exr", "--json", "--diff", "a.png"))
    difference = vog.compare(voxels, gaussians)
    assert difference.psnr_db == difference.grey.psnr_db == pytest.approx(report["psnr_v_db"])
    assert difference.relative_l2 == pytest.approx(report["relative_l2"]) and difference.bias == pytest.approx(report["bias"])
    assert list(difference.largest_at) == report["dt_at"][::-1]
    assert vog.compare_shaded(voxels, gaussians).psnr_db == pytest.approx(report["psnr_rgb_db"])
    vog.difference_map(voxels, gaussians).save(tmp_path / "b.png")
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()
    assert vog.compare(voxels.depth, gaussians).relative_l2 == difference.relative_l2
    assert vog.compare(voxels.image, gaussians.image).largest > 0
    assert vog.difference_map(voxels.image, gaussians.image, bar=False).shape == (64, 64, 3)
    lights = [vog.render(data, size=64, show="volume") for data in (cloud, model)]
    assert vog.compare(*lights).largest == vog.compare(lights[0].image, lights[1]).largest > 0
    with pytest.raises(TypeError, match="got DepthImage and Image, expected two Pictures"):
        vog.compare(voxels, gaussians.image)
    with pytest.raises(TypeError, match="expected a Picture of T or a DepthImage"):
        vog.compare_shaded(*lights)
    with pytest.raises(vog.Error):
        vog.compare(voxels, vog.render(model, size=32))


def test_transfer_functions_come_from_anywhere(tmp_path, model):
    picture = vog.render(model, size=32)
    depth = picture.depth
    inferno = vog.TransferFunction("inferno")
    assert "inferno" in vog.TransferFunction.names()
    assert np.allclose(inferno([[0, 1]]).shape, (1, 2, 4))
    inferno.save(tmp_path / "tf.json")
    pictures = [
        shaded._repr_png_()
        for tf in (
            inferno,
            "inferno",
            str(tmp_path / "tf.json"),
            tmp_path / "tf.json",
            vog.TransferFunction.load(tmp_path / "tf.json"),
            vog.TransferFunction.from_points("again", inferno.color),
            pickle.loads(pickle.dumps(inferno)),
        )
        for shaded in (vog.render(model, size=32, tf=tf).image, picture.recolor(tf=tf).image, depth.shade(tf))
    ]
    assert all(png == pictures[0] for png in pictures)
    red = vog.TransferFunction.from_colors([[1, 0, 0, 0], [1, 0, 0, 1]], "red")
    assert np.allclose(red(0.25), [1, 0, 0, 0.25]) and red.opacity.shape == (2, 2)
    assert np.array_equal(np.asarray(depth.shade(np.array([[0, 1, 0]]))).max(axis=(0, 1)), [0, 255, 0])
    for wrong, error in (
        ("no-such-map", vog.Error),
        (np.zeros((2, 5)), vog.Error),
        (np.full((2, 3), 2.0), vog.Error),
        (3, TypeError),
    ):
        for call in (lambda: depth.shade(wrong), lambda: vog.render(model, size=32, tf=wrong), lambda: picture.recolor(tf=wrong)):
            with pytest.raises(error) as told:
                call()
            assert "\n" not in str(told.value)


def test_paraviews_maps_are_read(tmp_path, model):
    preset = [{"Name": "mine", "ColorSpace": "RGB", "RGBPoints": [10, 0, 0, 0, 20, 1, 0.5, 0]}]
    (tmp_path / "paraview.json").write_text(json.dumps(preset))
    assert np.allclose(vog.TransferFunction(tmp_path / "paraview.json")(0.5), [0.5, 0.25, 0, 1])


def test_matplotlibs_maps_are_taken(model):
    matplotlib = pytest.importorskip("matplotlib", reason="needs python3-matplotlib")
    viridis = matplotlib.colormaps["viridis"]
    tf = vog.TransferFunction(viridis)
    assert tf.name == "viridis" and np.allclose(tf(np.arange(256) / 255), viridis(np.arange(256)), atol=1e-6)
    ours, theirs, same = (np.asarray(vog.render(model, size=32, tf=tf).image, int) for tf in ("viridis", viridis, vog.TransferFunction.from_matplotlib("viridis")))
    assert np.array_equal(theirs, same)
    assert abs(ours - theirs).max() <= 2


def test_gpu_renderers_draw_or_say_what_is_missing(model):
    for renderer in ("cuda", "optix"):
        try:
            picture = vog.render(model, size=64, renderer=renderer)
        except vog.Error as error:
            assert str(error).startswith(f"render: {renderer}")
        else:
            assert vog.compare(vog.render(model, size=64), picture).relative_l2 < 1e-3


@pytest.mark.parametrize("renderer", ["cuda", "optix"])
def test_gpu_renderers_draw_fields_or_say_what_is_missing(model, renderer):
    def difference(draw, number):
        try:
            on_gpu = draw(renderer)
        except vog.Error as error:
            assert str(error).startswith(f"render: {renderer}") and "\n" not in str(error)
            return 0
        drawn, expected = number(on_gpu), number(draw("splat"))
        assert np.isfinite(expected).any() and np.mean(np.isnan(drawn) != np.isnan(expected)) < 0.01
        return np.nanmax(np.abs(drawn - expected))

    field = model.fields["density"]
    maps = difference(lambda name: vog.render(model, size=48, show="mean", field="density", renderer=name), lambda m: m.mean)
    assert maps < 1e-3 * field.range[1]
    assert difference(lambda name: vog.render(model, size=48, show="volume", renderer=name), lambda picture: picture.image.rgba) < 0.01
    maximum = difference(lambda name: vog.render(model, size=48, show="maximum", renderer=name), np.asarray)
    assert maximum < 0.01 * field.range[1]
    for options, message in (({"anyhit": "collect"}, "anyhit"), ({"samples": 2}, "samples")):
        with pytest.raises(vog.Error, match=f"{message} has no effect on show 'mean', expected T, column|{message} is (for T|not for renderer '{renderer}')"):
            vog.render(model, size=48, show="mean", field="density", renderer=renderer, **options)


def test_evaluate_returns_what_it_writes(tmp_path, cloud):
    fractions = []
    result = vog.evaluate(cloud, tmp_path / "out", size=32, repeats=1, conversions="paper", progress=fractions.append)
    assert json.loads((tmp_path / "out" / "results.json").read_text()) == result
    assert len(result["rows"]) > 4 and (tmp_path / "out" / "results.csv").exists() and fractions[-1] == pytest.approx(1)
    with pytest.raises(vog.Error, match="expected 'all', 'paper' or 'moments'"):
        vog.evaluate(cloud, tmp_path, conversions="some")
    with pytest.raises(TypeError):
        vog.evaluate(vog.sample_particles(8), tmp_path)
    result = vog.evaluate(
        cloud, tmp_path / "by_value", size=16, repeats=1, models={"mine": vog.convert(cloud, block=8)}, show="volume", tf=["hot"]
    )
    assert [row["step"] for row in result["rows"]] == ["mine"]
    assert list(result["rows"][0]["volume"]) == ["ramp", "bands", "step", "hot"]
    assert len(result["rows"][0]["volume"]["ramp"]["views"]) == 7
    with pytest.raises(vog.Error, match="expected 'T' or 'volume'"):
        vog.evaluate(cloud, tmp_path, show="mean")
    with pytest.raises(vog.Error, match="several transfer functions need show='volume'"):
        vog.evaluate(cloud, tmp_path, tf=["hot", "jet"])


def test_a_folder_gets_a_site_of_the_whole_model(tmp_path, model):
    folder = tmp_path / "site"
    report = vog.export_html(f"{folder}/", {"a": model})
    assert report["gaussians"] == len(model) and report["chunks"] == 1
    assert (folder / "index.html").stat().st_size == report["viewer_bytes"]
    again = vog.Gaussians.load(folder)
    assert len(again) == len(model)
    assert again.mass == pytest.approx(model.mass, rel=1e-6)
    with pytest.raises(vog.Error, match="slabs|quantity|field|show nothing"):
        vog.export_html(f"{tmp_path}/none/", model, show="nothing")
    assert not (tmp_path / "none").exists()


def test_pages_are_the_commands_byte_for_byte(tmp_path, command, model):
    for name, some in (("a", model), ("b", model[::2])):
        some.save(tmp_path / f"{name}.ply")
    flags = ["--title", "Two", "--set", "levels=2", "--background", "system", "--tf", "jet", "--extinction", 3]
    command("page", "a.ply", "b.ply", "-o", "command.html", *flags)
    report = vog.export_html(
        tmp_path / "python.html", {"a": model, "b": model[::2]},
        title="Two", levels=2, background="system", tf="jet", extinction=3,
    )
    assert (tmp_path / "python.html").read_bytes() == (tmp_path / "command.html").read_bytes()
    assert report["bytes"] == (tmp_path / "python.html").stat().st_size and report["gaussians"] == len(model) + len(model[::2])
    command("page", "a.ply", "-o", "command.html", "--background", "0.1,0.2,0.3", "--blend")
    vog.export_html(tmp_path / "python.html", {"a": model}, background=(0.1, 0.2, 0.3), blend=True)
    assert (tmp_path / "python.html").read_bytes() == (tmp_path / "command.html").read_bytes()
    for flags, options in [
        (["--show", "volume"], {"show": "volume"}),
        (["--show", "volume", "--tf", "viridis", "--range", "0.1,0.5"], {"show": "volume", "tf": "viridis", "range": (0.1, 0.5)}),
        (["--show", "volume", "--unit-distance", 0.3, "--light", "head"], {"show": "volume", "unit_distance": 0.3, "light": "head"}),
        (["--show", "column", "--scale", "log"], {"show": "column", "scale": "log"}),
        (["--show", "maximum", "--range", "0.1,0.4"], {"show": "maximum", "range": (0.1, 0.4)}),
        (["--show", "mean", "--field", "density", "--tf", "jet"], {"show": "mean", "field": "density", "tf": "jet"}),
    ]:
        command("page", "a.ply", "-o", "command.html", *flags)
        vog.export_html(tmp_path / "python.html", {"a": model}, **options)
        assert (tmp_path / "python.html").read_bytes() == (tmp_path / "command.html").read_bytes(), flags
    vog.export_html(tmp_path / "one.html", model)
    for wrong, error in (({}, vog.Error), ([model], TypeError), ({"a": 3}, TypeError)):
        with pytest.raises(error):
            vog.export_html(tmp_path / "none.html", wrong)
    assert not (tmp_path / "none.html").exists()


def test_pages_of_models_elsewhere_are_the_commands(tmp_path, command, model):
    model.save(tmp_path / "a.ply")
    command("pack", "a.ply", "-o", "a.vogz", "--hierarchy", "--deflate")
    command("page", "a.ply", "-o", "site/")
    for name, url in (("a.vogz", "https://data.example.org/a.vogz"), ("site", "../site"), ("a.vogz", "a.vogz")):
        command("page", name, "-o", "command.html", "--from", url, "--title", "a", "--name", "a")
        report = vog.export_html(tmp_path / "python.html", tmp_path / name, title="a", url=url)
        assert (tmp_path / "python.html").read_bytes() == (tmp_path / "command.html").read_bytes()
        assert report["bytes"] == (tmp_path / "python.html").stat().st_size
    for wrong, words in ((("a.ply", "https://host/a.ply"), "vogz"), (("a.vogz", "ftp://host/a.vogz"), "https"), (("site", "https://a b/"), "expected")):
        with pytest.raises(vog.Error, match=words):
            vog.export_html(tmp_path / "none.html", tmp_path / wrong[0], url=wrong[1])
    with pytest.raises(TypeError, match="path"):
        vog.export_html(tmp_path / "none.html", model, url="https://host/a.vogz")
    with pytest.raises(vog.Error, match="levels"):
        vog.export_html(tmp_path / "none.html", tmp_path / "a.vogz", url="a.vogz", levels=2)
    assert not (tmp_path / "none.html").exists()


def test_coarser_models_keep_the_mass(model):
    few = model.coarsen(100)
    assert len(few) <= 100 and few.mass == pytest.approx(model.mass, rel=1e-4)
    with pytest.raises(vog.Error):
        model.coarsen(0)


def test_optix_draws_voxels_with_fields_and_clips_or_says_what_is_missing():
    values = np.random.default_rng(3).random((9, 8, 7), dtype=np.float32)
    volume = vog.Volume.from_numpy(values)
    fields = {"heat": 300 + 5 * values}

    def difference(draw, number):
        expected = number(draw("reference"))
        try:
            drawn = number(draw("optix"))
        except vog.Error as error:
            assert str(error).startswith("render: optix") and "\n" not in str(error)
            return 0
        assert np.array_equal(np.isnan(drawn), np.isnan(expected))
        return np.nanmax(np.abs(drawn - expected))

    clip = [[1, 1, 1], [6, 6, 6]]
    assert difference(lambda name: vog.render(volume, size=20, renderer=name, clip=clip, extinction=1, samples=2), np.asarray) < 1e-5
    assert difference(lambda name: vog.render(volume, size=20, renderer=name, show="mean", field="heat", fields=fields), lambda m: m.mean) < 1e-3
    assert difference(lambda name: vog.render(volume, size=20, show="volume", renderer=name, light="head", clip=clip), lambda picture: picture.image.rgba) < 1e-5
    assert difference(lambda name: vog.render(volume, size=20, show="maximum", renderer=name, field="heat", fields=fields), np.asarray) < 1e-3
    with pytest.raises(vog.Error, match="interpolation is not for renderer 'optix', expected 'reference'"):
        vog.render(volume, size=20, show="volume", renderer="optix", interpolation="linear")


@pytest.mark.parametrize("points, triangles, message", [
    ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0.0, 1, 2]], "whole numbers"),
    ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, -2]], "row 0 has point -2, expected 0 to 2"),
    ([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 3]], "row 0 has point 3, expected 0 to 2"),
    ([[0, 0, 0], [1, 0, 0], [0, np.nan, 0]], [[0, 1, 2]], "row 2 is not finite"),
])  # fmt: skip
def test_surfaces_of_wrong_numbers_are_refused_in_one_line(points, triangles, message):
    surface = (np.array(points, float), np.array(triangles))
    with pytest.raises(vog.Error, match=message) as error:
        vog.render([vog.Layer(vog.sample_cloud(64), tf="white"), vog.Layer(surface, color="red")], size=32)
    assert "\n" not in str(error.value)
