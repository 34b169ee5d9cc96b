"""Gaussians: array views, selection, concatenation, files, pickles."""
import copy
import gc
import pickle

import numpy as np
import pytest

import vog


def two(rotation=None):
    return vog.Gaussians([[0, 0, 0], [1, 2, 3]], [[1, 1, 1], [1, 2, 3]], [1, 2], rotation)


def test_arrays_are_the_models_own_memory():
    model = two()
    for name, shape in (("mean", (2, 3)), ("scale", (2, 3)), ("density", (2,)), ("rotation", (2, 4))):
        array = getattr(model, name)
        assert array.shape == shape and array.dtype == np.float32 and not array.flags.owndata
    before = vog.render(model, size=32, extinction=1).values
    model.density *= 2  # through the view, and by assignment of it to itself
    assert np.array_equal(model.density, [2, 4])
    assert np.array_equal(vog.render(model, size=32, extinction=1).values, 2 * before)
    model.mean[1] = 0
    model.scale = np.ones((2, 3))
    assert np.array_equal(model.mean, np.zeros((2, 3))) and np.array_equal(model.scale, np.ones((2, 3)))


def test_views_outlive_the_name_of_the_model():
    mean = vog.convert(vog.sample_cloud(64), block=8).mean
    expected = mean.copy()
    gc.collect()
    _ = [bytearray(mean.nbytes) for _ in range(100)]
    assert np.array_equal(mean, expected)


def test_rotations_of_axis_aligned_models_are_identities():
    model = two()
    assert model.axis_aligned
    assert np.array_equal(model.rotation, [[1, 0, 0, 0]] * 2) and not model.rotation.flags.writeable
    model.rotation = [[1, 0, 0, 0], [0, 1, 0, 0]]
    assert not model.axis_aligned and model.rotation.flags.writeable
    assert np.array_equal(two([[1, 0, 0, 0]] * 2).rotation, [[1, 0, 0, 0]] * 2)


def test_index_takes_what_numpy_takes(model):
    for index in (
        slice(3, 100, 7),
        slice(None, None, -1),
        model.density > np.median(model.density),
        np.array([5, 2, 5]),
        [7, -1],
        np.array([], int),
    ):
        part = model[index]
        assert np.array_equal(part.mean, model.mean[index]) and np.array_equal(part.rotation, model.rotation[index])
        assert np.array_equal(part.density, model.density[index]) and np.array_equal(part.box, model.box)
    assert len(model[3]) == 1 and np.array_equal(model[-1].mean[0], model.mean[-1])
    with pytest.raises(IndexError):
        model[len(model)]
    with pytest.raises(IndexError):
        model["mean"]
    with pytest.raises(IndexError):
        model[1.5]


def test_sum_of_parts_is_the_whole_picture(model):
    near = model.mean[:, 0] < np.median(model.mean[:, 0])
    both = model[near] + model[~near]
    assert len(both) == len(model)
    camera = vog.Camera.paper_view(model)
    pictures = [vog.render(m, camera, 64, extinction=1).values for m in (model, model[near], model[~near], both)]
    assert np.allclose(pictures[1] + pictures[2], pictures[0], rtol=1e-5)
    assert np.allclose(pictures[3], pictures[0], rtol=1e-5)
    other = two()
    other.cutoff = 3
    with pytest.raises(vog.Error, match="cutoff"):
        model + other
    with pytest.raises(TypeError):
        model + 1


def test_files_and_pickles_keep_every_bit(tmp_path, model):
    model.save(tmp_path / "a.ply")
    for back in (vog.Gaussians.load(tmp_path / "a.ply"), pickle.loads(pickle.dumps(model)), copy.deepcopy(model)):
        for name in ("mean", "scale", "rotation", "density", "box"):
            assert np.array_equal(getattr(back, name), getattr(model, name))
        for name in ("cutoff", "source", "source_voxels", "method", "options", "summary"):
            assert getattr(back, name) == getattr(model, name)
    two_back = pickle.loads(pickle.dumps(two()))
    assert two_back.axis_aligned


def test_mass_is_that_of_the_volume(cloud, model):
    assert model.mass == pytest.approx(cloud.mass, rel=2e-4)


@pytest.mark.parametrize(
    "arrays, message",
    [
        (([[0, 0]], [[1, 1, 1]], [1]), r"mean: shape \(1, 2\), expected \(N, 3\)"),
        (([[0, 0, 0]], [[1, 1, 1]], [[1]]), r"density: shape \(1, 1\), expected \(N,\)"),
        (([[0, 0, 0]], [[1, 1, 1]] * 2, [1]), "arrays of different lengths"),
        (([[0, 0, 0]], [[1, 0, 1]], [1]), "Gaussian 0: scales 1 0 1, expected finite and > 0"),
        (([[0, 0, np.nan]], [[1, 1, 1]], [1]), r"mean 0 0 nan, expected finite"),
        (([[0, 0, 0]], [[1, 1, 1]], [-1]), "density -1"),
        (([[0, 0, 0]], [[1, 1, 1]], [1], [[0, 0, 0, 0]]), "expected a quaternion"),
        (([["a", "b", "c"]], [[1, 1, 1]], [1]), "expected real numbers"),
    ],
)
def test_bad_arrays_are_refused(arrays, message):
    with pytest.raises(vog.Error, match=message):
        vog.Gaussians(*arrays)


def test_assignments_keep_the_shape_and_bad_values_are_found():
    model = two()
    with pytest.raises(vog.Error, match="mean: 3 rows, expected 2"):
        model.mean = np.zeros((3, 3))
    with pytest.raises(vog.Error, match="rotation: 1 rows, expected 2"):
        model.rotation = [[1, 0, 0, 0]]
    model.density[0] = np.nan
    with pytest.raises(vog.Error, match="Gaussian 0: density nan"):
        vog.render(model, size=8)


def test_models_far_from_the_origin_keep_their_places(tmp_path):
    at = np.array([5000000.1, -1e9, 3])
    volume = vog.Volume.from_numpy(np.ones((8, 8, 8)), voxel_size=0.1, origin=at)
    model = vog.convert(volume, block=2)
    assert model.origin.dtype == np.float64 and np.abs(model.origin - at).max() < 2
    assert model.world_mean.dtype == np.float64 and np.array_equal(model.world_mean, model.origin + model.mean)
    assert np.allclose(model.world_mean.mean(axis=0), at + 0.35, rtol=0, atol=1e-3)
    model.save(tmp_path / "a.ply")
    for back in (vog.Gaussians.load(tmp_path / "a.ply"), pickle.loads(pickle.dumps(model)), model[:]):
        assert np.array_equal(back.origin, model.origin) and np.array_equal(back.mean, model.mean)
    near = vog.convert(vog.Volume.from_numpy(np.ones((8, 8, 8)), voxel_size=0.1), block=2)
    assert np.array_equal(near.origin, [0, 0, 0])
    depth = [vog.render(m, vog.Camera.paper_view(m), 64, extinction=1).values for m in (near, model)]
    assert np.allclose(depth[0], depth[1], rtol=0, atol=1e-3 * depth[0].max())


def test_means_that_float32_cannot_hold_are_refused():
    far, ones = np.array([[1e9 + 0.25, 0, 0]]), [[1, 1, 1]]
    with pytest.raises(vog.Error, match="mean: row 0 would move by 0.25.* origin=point"):
        vog.Gaussians(far, ones, [1])
    model = vog.Gaussians(far - [1e9, 0, 0], ones, [1], origin=[1e9, 0, 0])
    assert np.array_equal(model.world_mean, far) and model.box[0, 0] == pytest.approx(1e9 - 2)
    with pytest.raises(vog.Error, match="origin: 2 numbers, expected 3"):
        vog.Gaussians(far, ones, [1], origin=[1, 2])
    with pytest.raises(vog.Error, match="would move by"):
        two() + model


def test_an_empty_model_is_one():
    empty = vog.Gaussians(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0))
    assert len(empty) == 0 and empty.box is None and empty.mean.shape == (0, 3)
    assert len(empty + two()) == 2


def with_fields():
    generator = np.random.default_rng(1)
    spread = generator.normal(size=(3, 3, 3)).astype(np.float32)
    return vog.Gaussians(
        generator.normal(size=(3, 3)), np.ones((3, 3)), [1, 2, 3],
        fields={
            "temperature": {
                "value": [300, 400, 500], "gradient": np.eye(3), "deviation": [1, 2, 3], "skewness": [0, -1, 3],
                "unit": "K", "range": (280, 520),
            },
            "gas velocity": {
                "value": [[3, 4, 0], [0, 0, 1], [0, 2, 0]], "gradient": generator.normal(size=(3, 3, 3)),
                "covariance": spread @ spread.transpose(0, 2, 1),
            },
        },
    )


def assert_same_fields(a, b):
    assert list(a.fields) == list(b.fields)
    for name, field in a.fields.items():
        other = b.fields[name]
        assert field.unit == other.unit and field.range == other.range and field.is_vector == other.is_vector
        for part in ("value", "gradient", "covariance") if field.is_vector else ("value", "gradient", "deviation", "skewness"):
            assert np.array_equal(getattr(field, part), getattr(other, part)), (name, part)


def test_fields_are_the_models_own_memory():
    model = with_fields()
    assert list(model.fields) == ["temperature", "gas velocity"] and len(model.fields) == 2
    field = model.fields["temperature"]
    assert field.name == "temperature" and field.unit == "K" and field.range == (280, 520) and not field.is_vector
    assert field.value.dtype == np.float32 and not field.value.flags.owndata
    assert np.array_equal(field.gradient, np.eye(3)) and np.array_equal(field.skewness, [0, -1, 3])
    field.value *= 2
    field.gradient[1] = 7
    field.deviation += 1
    again = model.fields["temperature"]
    assert np.array_equal(again.value, [600, 800, 1000]) and np.array_equal(again.gradient[1], [7, 7, 7])
    assert np.array_equal(again.deviation, [2, 3, 4])
    value = with_fields().fields["temperature"].value  # outlives the names of field and model
    gc.collect()
    assert np.array_equal(value, [300, 400, 500])
    with pytest.raises(KeyError):
        model.fields["density"]
    with pytest.raises(TypeError):
        model.fields["temperature"] = field
    assert two().fields == {} and repr(field) == "<vog.Field: temperature in K>"


def test_vector_fields_are_three_components_and_their_covariance():
    field = with_fields().fields["gas velocity"]
    assert field.is_vector and field.unit == "" and field.range == (1, 5)
    assert field.value.shape == (3, 3) and field.gradient.shape == field.covariance.shape == (3, 3, 3)
    assert np.array_equal(field.covariance, field.covariance.transpose(0, 2, 1))
    assert np.linalg.eigvalsh(field.covariance).min() > -1e-4
    field.value[0] = 0
    with pytest.raises(ValueError, match="read-only"):
        field.gradient[0] = 0
    with pytest.raises(AttributeError, match="gas velocity is a vector field without deviation"):
        field.deviation
    with pytest.raises(AttributeError, match="temperature is a scalar field without covariance"):
        with_fields().fields["temperature"].covariance


def test_fields_go_where_their_gaussians_go(tmp_path):
    model = with_fields()
    model.save(tmp_path / "a.ply")
    for back in (vog.Gaussians.load(tmp_path / "a.ply"), pickle.loads(pickle.dumps(model)), copy.deepcopy(model)):
        assert_same_fields(back, model)
    assert_same_fields(vog.Gaussians(model.mean, model.scale, model.density, fields=model.fields), model)
    part = model[[2, 0]]
    assert np.array_equal(part.fields["temperature"].value, [500, 300])
    both = part + model[1]
    assert np.array_equal(both.fields["gas velocity"].covariance, model.fields["gas velocity"].covariance[[2, 0, 1]])
    with pytest.raises(vog.Error, match="field 'temperature': one model has it"):
        model + two()
    one = model.coarsen(1)
    weight = np.array([1, 2, 3]) / 6
    assert one.fields["temperature"].value[0] == pytest.approx(weight @ [300, 400, 500])
    assert np.allclose(one.fields["gas velocity"].value[0], weight @ model.fields["gas velocity"].value)


@pytest.mark.parametrize(
    "field, message",
    [
        ({"value": [1]}, "field 't': an array of 1 values, expected 2"),
        ({"value": [1, np.inf]}, "Gaussian 1: field 't': value inf, expected finite"),
        ({"value": [1, 2], "deviation": [1, -1]}, "Gaussian 1: field 't': deviation -1"),
        ({"value": [1, 2], "gradient": [1, 2]}, r"fields: t: gradient: shape \(2,\), expected \(N, 3\)"),
        ({"value": [1, 2], "covariance": np.zeros((2, 3, 3))}, "fields: t: covariance: of a scalar field"),
        ({"value": np.zeros((2, 3)), "deviation": [1, 2]}, "fields: t: deviation: of a vector field"),
        ({"value": np.zeros((2, 3)), "gradient": np.zeros((2, 3))}, r"gradient: shape \(2, 3\), expected \(2, 3, 3\)"),
        ({"value": [1, 2], "units": "K"}, "fields: t: unknown 'units'"),
        ({"value": [1, 2], "range": [1]}, "fields: t: range: 1 numbers, expected 2"),
        ({"value": [1, 2], "range": [2, 1]}, "field 't': range 2 to 1"),
        ({"unit": "K"}, "fields: t: value: missing"),
        ([1, 2], "fields: t: expected a dict"),
    ],
)
def test_bad_fields_are_refused(field, message):
    with pytest.raises(vog.Error, match=message):
        vog.Gaussians([[0, 0, 0]] * 2, [[1, 1, 1]] * 2, [1, 2], fields={"t": field})


def test_compact_models(tmp_path, cloud, model):
    model.save(tmp_path / "m.ply")
    model.save(tmp_path / "m.vogz")
    back = vog.Gaussians.load(tmp_path / "m.vogz")
    assert len(back) == len(model) and back.fields.keys() == model.fields.keys()
    assert back.mass == pytest.approx(model.mass, rel=1e-6)
    assert (tmp_path / "m.vogz").stat().st_size < (tmp_path / "m.ply").stat().st_size / 3

    model.save(tmp_path / "fine.vogz", max_loss=0.01, reference=cloud)
    assert (tmp_path / "fine.vogz").stat().st_size > (tmp_path / "m.vogz").stat().st_size
    model.save(tmp_path / "coarse.vogz", step=0.1, field_step=0.1, hierarchy=True)
    coarse = vog.Gaussians.load(tmp_path / "coarse.vogz", level=1, fields=[])
    assert 0 < len(coarse) < len(model) and not coarse.fields
    assert coarse.mass == pytest.approx(model.mass, rel=1e-5)
    assert len(vog.Gaussians.load(tmp_path / "m.vogz", box=[[1e6] * 3, [2e6] * 3])) == 0

    for options, text in (
        ({"step": 0.1, "max_loss": 1}, "exclude each other"),
        ({"reference": cloud}, "expected max_loss"),
        ({"step": 0.9}, "expected from 1e-6 to 0.5"),
    ):
        with pytest.raises(vog.Error, match=text):
            model.save(tmp_path / "m.vogz", **options)
    with pytest.raises(vog.Error, match="expected a .vogz"):
        model.save(tmp_path / "m.ply", step=0.1)
    with pytest.raises(vog.Error, match="expected a .vogz"):
        vog.Gaussians.load(tmp_path / "m.ply", level=1)
    with pytest.raises(TypeError, match="save: got int, expected a Volume or Levels"):
        model.save(tmp_path / "m.vogz", max_loss=1, reference=3)
