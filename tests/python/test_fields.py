"""Fields: convert(fields=), render(show=, field=): arrays, volumes, grids, levels, errors, the command's numbers."""
import numpy as np
import pytest

import vog
from conftest import same_picture

SHAPE = (16, 16, 16)
X, Y, Z = np.mgrid[:16, :16, :16].astype("f4")
DENSITY = np.random.default_rng(1).random(SHAPE).astype("f4") + 0.1
TEMPERATURE = 300 + X
VELOCITY = np.stack([X, 0 * Y, -Z], axis=-1)
FIELDS = {"temperature": {"value": TEMPERATURE, "unit": "K"}, "velocity": VELOCITY}


@pytest.fixture(scope="module")
def volume():
    return vog.Volume.from_numpy(DENSITY, voxel_size=0.1)


@pytest.fixture(scope="module")
def model(volume):
    return vog.convert(volume, block=2, fields=FIELDS)


def test_planes_are_found(volume):
    hard = vog.convert(volume, block=4, soft_steps=0, fields=FIELDS).fields
    temperature, velocity = hard["temperature"], hard["velocity"]
    assert temperature.unit == "K" and temperature.range == (300, 315)
    # 1 a voxel of 0.1, by 15/16: a voxel of constant field is a box.
    # Planes of the outer cells are limited to the range of the data, and their residuals are larger.
    inner = abs(temperature.value - 307.5) < 4.5
    assert inner.sum() >= len(inner) // 4
    assert np.allclose(temperature.gradient[inner], (15 / 16 * 10, 0, 0), atol=0.3)
    assert temperature.deviation[inner].max() < 0.5 and velocity.is_vector
    assert np.allclose(velocity.gradient, 15 / 16 * np.diag([10, 0, -10]), atol=0.3)


def test_any_order_type_and_place_of_arrays_is_the_same(volume, model):
    value = model.fields["temperature"].value
    for same in (
        TEMPERATURE.astype("f8"),
        np.asfortranarray(TEMPERATURE),
        ((0, 0, 0), TEMPERATURE),
        [((0, 0, 0), TEMPERATURE[:8]), ((8, 0, 0), TEMPERATURE[8:])],
        vog.Volume.from_numpy(TEMPERATURE, voxel_size=0.1),
    ):
        other = vog.convert(volume, block=2, fields={"temperature": same})
        assert np.array_equal(other.fields["temperature"].value, value)
    paper = vog.convert(volume, method="paper", lod=1, fields={"temperature": TEMPERATURE})
    assert 300 <= paper.fields["temperature"].value.min() < 315


def test_adaptive_cuts_follow_fields(volume):
    hot = np.where((X < 3) & (Y < 3) & (Z < 3), np.float32(1000), np.float32(1))
    levels = vog.Levels([volume])
    for data in (volume, levels):
        blind, own, follows = (vog.convert(data, budget=60, fields=fields) for fields in (False, None, {"hot": hot}))
        assert np.array_equal(blind.mean, own.mean) and not np.array_equal(blind.mean, follows.mean)


@pytest.mark.parametrize("field", ["temperature", "velocity", "velocity.z", "velocity.magnitude"])
def test_maps_of_the_model_are_near_those_of_the_voxels(volume, model, field):
    maps = vog.render(model, size=48, show="mean", field=field)
    rays = vog.render(model, size=48, show="mean", field=field, renderer="trace")
    voxels = vog.render(volume, size=48, show="mean", field=field, fields=FIELDS)
    linear = vog.render(volume, size=48, show="mean", field=field, fields=FIELDS, interpolation="linear", samples=2)
    inside = voxels.column > 0.3 * voxels.column.max()
    assert inside.sum() > 100
    for other in (maps, linear):
        error = np.abs(other.values - voxels.values)[inside]
        assert 0 < error.mean() < 0.5 and error.max() < 3.5
    assert np.abs(maps.mean - rays.mean)[inside].max() < 1e-3
    assert np.isnan(maps.mean[maps.column == 0]).all()
    assert maps.unit == ("K" if field == "temperature" else "")


def test_numbers_are_the_commands(tmp_path, command, model):
    model.save(tmp_path / "m.ply")
    command("render", "m.ply", "--show", "deviation", "--field", "velocity", "--size", 40, "--values-out", "a.npy",
            "-o", "a.png", "--color-bar", "--scale", "log")  # fmt: skip
    maps = vog.render(
        vog.Gaussians.load(tmp_path / "m.ply"), size=40, show="deviation", field="velocity", scale="log", color_bar=True
    )
    assert np.array_equal(np.load(tmp_path / "a.npy"), maps.values, equal_nan=True)
    maps.save(tmp_path / "b.npy")
    maps.save(tmp_path / "b.png")
    assert (tmp_path / "a.npy").read_bytes() == (tmp_path / "b.npy").read_bytes()
    assert same_picture(tmp_path / "a.png", tmp_path / "b.png")


@pytest.mark.parametrize("renderer", ["splat", "trace"])
def test_clips_cut_maps_of_models_and_voxels(volume, model, renderer):
    x = np.mean(model.box, axis=0)[0]
    options = dict(size=32, show="mean", field="temperature")
    whole = vog.render(model, renderer=renderer, **options)
    options["camera"] = whole.camera  # clips have their own frame
    low = vog.render(model, renderer=renderer, clip_planes=[(-1, 0, 0, -x)], **options)
    high = vog.render(model, renderer=renderer, clip=[[x, -99, -99], [99, 99, 99]], **options)
    assert 0.1 * whole.column.sum() < low.column.sum() < 0.9 * whole.column.sum()
    assert np.allclose(low.column + high.column, whole.column, atol=2e-5 * whole.column.max())
    voxels = vog.render(volume, fields=FIELDS, clip_planes=[(-1, 0, 0, -x)], **options)
    assert voxels.column.sum() == pytest.approx(low.column.sum(), rel=0.1)
    t = vog.render(model, whole.camera, size=32, renderer=renderer, clip_planes=[(-1, 0, 0, -x)], extinction=1)
    assert np.allclose(np.asarray(t), low.column, atol=2e-5 * whole.column.max())
    column = vog.Scene(model).render(whole.camera, size=32, show="column", renderer=renderer, clip_planes=[(-1, 0, 0, -x)])
    assert np.array_equal(np.asarray(column), np.asarray(t))
    with pytest.raises(vog.Error, match="clip box"):
        vog.render(model, clip=[[1, 1, 1], [0, 2, 2]], **options)


def test_maps_are_arrays_and_pictures(tmp_path, model):
    maps = vog.render(model, size=(32, 24), show="deviation", field="velocity")
    assert maps.shape == (24, 32) == np.asarray(maps).shape
    assert np.array_equal(np.asarray(maps), maps.deviation, equal_nan=True) and maps.label == "deviation of velocity along the view"
    framed = maps.recolor(tf="coolwarm", range=(-1, 1), title="A title", color_bar=True)
    assert framed.image.shape[1] > 32 and framed.shape == (24, 32) and framed.scale == vog.Scale(-1, 1, "linear")
    assert framed._repr_png_()[1:4] == b"PNG" and repr(maps) == "<vog.Picture: deviation of velocity along the view, 32x24>"
    column = vog.render(model, size=(32, 24), show="column")
    assert np.allclose(column.values, maps.column, rtol=1e-4, atol=1e-6) and column.mean is None
    with pytest.raises(vog.Error, match="depth: of show 'T' and 'column'"):
        maps.depth
    maps.save_values(tmp_path / "maps.exr")
    assert b"column" in (tmp_path / "maps.exr").read_bytes() and b"deviation" in (tmp_path / "maps.exr").read_bytes()


def test_levels_take_one_field_each():
    coarse = vog.Volume.from_numpy(np.ones((8, 8, 8)), voxel_size=1, origin=(0.5,) * 3)
    fine = vog.Volume.from_blocks(
        [((0, 0, 0), np.full((4, 4, 4), 3.0)), ((4, 0, 0), np.zeros((4, 4, 4)))],
        voxel_size=0.5, origin=(0.25,) * 3, all_active=True,
    )  # fmt: skip
    fields = {"t": [np.full((8, 8, 8), 1.0), [((0, 0, 0), np.full((8, 4, 4), 5.0))]]}
    model = vog.convert([coarse, fine], block=1, fields=fields)
    value = model.fields["t"].value
    assert value.min() == 1 and value.max() == 5 and (value > 3).sum() == 4**3
    maps = vog.render([coarse, fine], size=32, show="mean", field="t", fields=fields)
    assert np.nanmin(maps.mean) == 1 and 2 < np.nanmax(maps.mean) < 5
    with pytest.raises(vog.Error, match="1 values for 2 levels"):
        vog.convert([coarse, fine], fields={"t": fields["t"][:1]})


def test_a_grid_of_the_volumes_file_by_name(tmp_path, volume):
    volume.save(tmp_path / "a.vdb")
    loaded = vog.Volume.load(tmp_path / "a.vdb")
    own = vog.convert(loaded, block=2, soft_steps=0, fields={"value": "density"})
    assert own.fields["value"].range == pytest.approx((DENSITY.min(), DENSITY.max()))


@pytest.mark.parametrize(
    "call, message",
    [
        (lambda v, m: vog.render(m, show="mean"), "expected field, the name of one"),
        (lambda v, m: vog.render(m, show="mean", field="p"), "no field 'p' in the model, expected one of"),
        (lambda v, m: vog.render(m, show="mode"), "show mode: expected 'T', 'column', 'mean'"),
        (lambda v, m: vog.render(m, field="temperature"), "field has no effect on show 'T', expected mean"),
        (lambda v, m: vog.render(v, fields=FIELDS), "fields have no effect on show 'T' and 'column'"),
        (lambda v, m: vog.render(v, fields=FIELDS, show="mean"), "show 'mean': expected field, one of fields: "),
        (lambda v, m: vog.render(m, show="mean", field="temperature", extinction=2), "extinction has no effect on show 'mean'"),
        (lambda v, m: vog.render(m, show="mean", field="velocity", fields=FIELDS), "fields: of voxels"),
        (lambda v, m: vog.render(v, show="mean", field="velocity"), "no field 'velocity' with the volume, expected fields={'velocity': array}"),
        (lambda v, m: vog.render(v, show="mean", field="p", fields=FIELDS), "expected one of temperature, velocity"),
        (lambda v, m: vog.convert(v, fields={"t": X[0]}), r"fields: t: shape \(16, 16\), expected \(X, Y, Z\)"),
        (lambda v, m: vog.convert(v, fields={"t": np.nan * X}), "field 't': not finite at 4,096 voxels"),
        (lambda v, m: vog.convert(v, fields={"t": ((99, 0, 0), X)}), "field 't': active at no voxel"),
        (lambda v, m: vog.convert(v, fields={"t": "temperature"}), "of a volume that no file has"),
        (lambda v, m: vog.convert(v, fields={"t": {"vale": X}}), "unknown 'vale', expected value and unit"),
        (lambda v, m: vog.convert(vog.sample_particles(8), fields=FIELDS), "fields of Points: expected names"),
    ],
)
def test_errors_are_one_line(volume, model, call, message):
    with pytest.raises(vog.Error, match=message) as error:
        call(volume, model)
    assert "\n" not in str(error.value)


def test_the_wrong_kind_of_thing_is_a_type_error(volume):
    for fields in (3, {"t": 3}, {"t": None}):
        with pytest.raises(TypeError, match="expected"):
            vog.convert(volume, fields=fields)


def test_partial_cover_warns(volume):
    with pytest.warns(UserWarning, match="inactive at .* % of the mass"):
        vog.convert(volume, block=4, fields={"t": ((8, 0, 0), X)})


def test_evaluate_compares_maps(tmp_path, volume, model):
    result = vog.evaluate(volume, tmp_path / "out", size=24, repeats=1, models={"m": model}, fields=FIELDS)
    assert result["rows"][0]["fields"].keys() == {"temperature", "velocity", "density"}
    with pytest.raises(vog.Error, match=r"evaluate: fields: t: shape \(16, 16\)"):
        vog.evaluate(volume, tmp_path / "no", fields={"t": X[0]})


def test_particles_carry_columns():
    points = vog.sample_particles(8)
    model = vog.convert(points, fields=["velocity", "speed"])
    assert set(model.fields) == {"velocity", "speed"}
    assert np.array_equal(model.fields["velocity"].value[0], points.velocity[0])
    assert set(vog.convert(points, fields={"v": "speed"}).fields) == {"v"}
    assert not vog.convert(points).fields
    for fields, message in [("speed", "expected names of columns"), (["none"], "none"), ({"a": 1}, "expected names")]:
        with pytest.raises(vog.Error, match=message):
            vog.convert(points, fields=fields)


def test_gaussians_are_fitted_to_a_field(volume):
    hot = {"temperature": np.where(X < 7, 300, 900).astype("f4")}
    plain = vog.convert(volume, block=4, fields=hot)
    report = {}
    fitted = vog.convert(volume, block=4, fields=hot, joint_field="temperature", joint_steps=4, report=report)
    assert fitted.mass == pytest.approx(volume.mass, rel=1e-4)

    def residual(model):
        return np.average(model.fields["temperature"].deviation ** 2)

    assert residual(fitted) < 0.7 * residual(plain)
    assert report["joint"]["error_before"] > 0 and report["joint"]["error_after"] > 0
    assert not np.array_equal(vog.convert(volume, block=4, joint_field="volume").mean, vog.convert(volume, block=4).mean)
    for options, message in (
        ({"joint_field": "heat"}, "no field 'heat' to fit the Gaussians to"),
        ({"joint_field": "volume", "fields": False}, "joint_field and fields=False exclude each other"),
        ({"joint_field": "volume", "spread": 1.1}, "spread has no effect beside `joint_field`"),
    ):
        with pytest.raises(vog.Error, match=message):
            vog.convert(volume, block=4, **options)
    assert report["joint"]["value_error"] is None
    calls = []
    few = vog.convert(volume, error=0.5, joint_field="volume", report=report, progress=calls.append)
    assert 0 < report["joint"]["value_error"] <= 0.5
    assert calls == sorted(calls) and calls[-1] == 1
    with pytest.warns(UserWarning, match="error by value .* the least of all cuts"):
        finest = vog.convert(volume, error=1e-6, joint_field="volume")
    assert len(few) < len(finest)
    calls = []
    with pytest.raises(vog.Error, match="no field 'heat'"):
        vog.convert(volume, block=4, joint_field="heat", progress=calls.append)
    assert calls == []  # refused before the conversion
    with pytest.raises(vog.Error, match="joint_field does not go with"):
        vog.convert(volume, method="paper", joint_field="volume")
