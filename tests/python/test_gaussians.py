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
    before = vog.render(model, size=32, extinction=1).depth.copy()
    model.density *= 2  # through the view, and by assignment of it to itself
    assert np.array_equal(model.density, [2, 4])
    assert np.array_equal(vog.render(model, size=32, extinction=1).depth, 2 * before)
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
    pictures = [vog.render(m, camera, 64, extinction=1).depth for m in (model, model[near], model[~near], both)]
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
    depth = [vog.render(m, vog.Camera.paper_view(m), 64, extinction=1).depth for m in (near, model)]
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
