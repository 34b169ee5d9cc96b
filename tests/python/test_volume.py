"""Volume and Levels: files, arrays, transforms, errors."""
import pickle

import numpy as np
import pytest

import vog


def some_array(shape=(20, 17, 30), seed=1):
    random = np.random.default_rng(seed)
    return np.where(random.random(shape) < 0.3, random.random(shape), 0).astype(np.float32)


def test_array_comes_back_as_it_was():
    array = some_array()
    array[0, 0, 0] = array[-1, -1, -1] = 1
    volume = vog.Volume.from_numpy(array)
    assert volume.active_voxels == np.count_nonzero(array)
    assert volume.index_box == ((0, 0, 0), (19, 16, 29))
    back = volume.to_numpy()
    assert back.dtype == np.float32 and np.array_equal(back, array)
    assert np.array_equal(volume.to_numpy(first=(-1, 3, 2), shape=(5, 2, 3))[1:], array[:4, 3:5, 2:5])


@pytest.mark.parametrize(
    "same",
    [
        np.asfortranarray,
        lambda a: np.ascontiguousarray(a.T).T,
        lambda a: a.astype(np.float64),
        lambda a: a.astype(">f4"),
        lambda a: np.repeat(a, 2, axis=1)[:, ::2],
        lambda a: np.ascontiguousarray(a[:, :, ::-1])[:, :, ::-1],
        lambda a: np.rec.fromarrays([np.zeros(a.shape, "u1"), a], names="tag,value")["value"],
    ],
    ids=["fortran", "transposed", "float64", "big-endian", "strided", "reversed", "field of a record"],
)
def test_any_memory_order_and_type_is_the_same_volume(same):
    array = some_array()
    view = same(array)
    assert np.array_equal(vog.Volume.from_numpy(view).to_numpy(), vog.Volume.from_numpy(array).to_numpy())


@pytest.mark.parametrize("dtype", ["u1", "i2", "i8", "f2", "?"])
def test_integers_halves_and_bools_are_numbers(dtype):
    array = (some_array() > 0.5).astype(dtype)
    volume = vog.Volume.from_numpy(array)
    assert volume.mass == np.count_nonzero(array)


def test_voxel_size_origin_and_matrix_place_voxels():
    array = np.zeros((4, 5, 6))
    array[3, 2, 1] = 2
    one = vog.Volume.from_numpy(array, voxel_size=(1, 2, 3), origin=(10, 20, 30))
    assert np.allclose(one.matrix @ [3, 2, 1, 1], [13, 24, 33, 1])
    assert one.voxel_volume == 6 and one.mass == 12
    two = vog.Volume.from_numpy(array, matrix=one.matrix)
    assert np.array_equal(two.matrix, one.matrix) and np.array_equal(two.box, one.box)
    assert vog.Volume.from_numpy(array, 0.5).voxel_volume == 0.125
    assert vog.Volume.from_numpy(array, np.float32(0.5)).voxel_volume == 0.125
    assert vog.Volume.from_numpy(array, np.array([1, 2, 3])).voxel_volume == 6
    model = vog.convert(one, block=1)
    assert np.allclose(model.mean, [[13, 24, 33]])


def test_active_says_which_voxels_there_are():
    array = np.zeros((9, 9, 9))
    array[0] = np.nan
    active = np.zeros(array.shape, bool)
    active[4, 4, 4:6] = True
    volume = vog.Volume.from_numpy(array, active=active)
    assert volume.active_voxels == 2 and volume.mass == 0


def test_blocks_are_patches_of_one_volume():
    array = some_array((16, 16, 16))
    array[0, 0, 0] = 1
    patches = [((x, 0, 0), array[x : x + 4]) for x in range(0, 16, 4)]
    volume = vog.Volume.from_blocks(patches, voxel_size=0.5)
    assert np.array_equal(volume.to_numpy((0, 0, 0), (16, 16, 16)), array)
    assert vog.Volume.from_blocks(patches, all_active=True).active_voxels == 16**3


def test_files_round_trip(tmp_path, cloud):
    cloud.save(tmp_path / "a.vdb")
    assert vog.grid_names(tmp_path / "a.vdb") == ["density"]
    for file in (tmp_path / "a.vdb", str(tmp_path / "a.vdb")):
        back = vog.Volume.load(file, "density")
        assert np.array_equal(back.to_numpy(), cloud.to_numpy())
        assert np.array_equal(back.matrix, cloud.matrix)
        assert back.source == str(file)


def test_negative_values_of_a_file_are_refused_or_clipped(tmp_path):
    vdb = pytest.importorskip("pyopenvdb", reason="needs python3-openvdb")
    grid = vdb.FloatGrid()
    grid.name = "density"
    grid.copyFromArray(np.full((4, 4, 4), -1.0) + 2.0 * (np.arange(64).reshape(4, 4, 4) > 9))
    vdb.write(str(tmp_path / "a.vdb"), grid)
    with pytest.raises(vog.Error, match="10 active values are negative, the first at index"):
        vog.Volume.load(tmp_path / "a.vdb")
    with pytest.warns(UserWarning, match="10 negative values set to 0"):
        vog.Volume.load(tmp_path / "a.vdb", clip_negative=True)


def test_invalid_values_of_an_array_are_refused_or_accepted():
    array = np.ones((9, 10, 11), np.float32)
    array[1, 2, 3] = np.nan
    array[4, 5, 6] = -2
    with pytest.raises(vog.Error, match=r"2 values that are no densities, the first nan at \[1, 2, 3\]"):
        vog.Volume.from_numpy(array)
    with pytest.raises(vog.Error, match="1 values that are no densities, the first -2"):
        vog.Volume.from_numpy(array, skip_nonfinite=True)
    with pytest.warns(UserWarning, match="1 negative value set to 0; 1 value not finite, left out"):
        volume = vog.Volume.from_numpy(array, skip_nonfinite=True, clip_negative=True)
    assert volume.active_voxels == array.size - 2
    assert volume.mass == array.size - 2


def test_volumes_that_overlap_are_no_levels(cloud):
    for data in ([cloud, cloud], (cloud, cloud)):
        with pytest.raises(vog.Error, match="voxels of the same size at the same place"):
            vog.render(data, size=8)
    with pytest.raises(vog.Error, match="force=True"):
        vog.Levels([cloud, cloud])
    forced = vog.Levels([cloud, cloud], force=True)
    assert "not levels of one mesh" in forced.arrangement
    assert np.allclose(vog.render(forced, size=16, extinction=1), vog.render(cloud, size=16, extinction=1))
    levels = vog.sample_levels(64)
    assert "3 levels of one mesh" in levels.arrangement
    vog.Levels([levels[n] for n in range(3)])


def test_non_finite_particles_are_refused_or_left_out(tmp_path):
    (tmp_path / "a.xyz").write_text("1 2 3\nnan 5 6\n7 8 9\n")
    with pytest.raises(vog.Error, match="a.xyz:2: got 'nan' in column 1, expected a finite number"):
        vog.Points.load(tmp_path / "a.xyz")
    with pytest.warns(UserWarning, match="1 value not finite, left out"):
        assert len(vog.Points.load(tmp_path / "a.xyz", skip_nonfinite=True)) == 2


def test_pickles_are_whole(cloud):
    back = pickle.loads(pickle.dumps(cloud))
    assert np.array_equal(back.to_numpy(), cloud.to_numpy())
    assert np.array_equal(back.matrix, cloud.matrix) and back.name == cloud.name and back.tiles == cloud.tiles
    levels = pickle.loads(pickle.dumps(vog.sample_levels(64)))
    assert len(levels) == 3 and levels[1].name == "density_L1"


def test_levels_load_by_pattern_and_index(tmp_path):
    levels = vog.sample_levels(64)
    vog.sample_cloud(64).save(tmp_path / "cloud.vdb")
    for n in range(3):
        levels[n].save(tmp_path / f"{n}.vdb")
    files = [tmp_path / f"{n}.vdb" for n in range(3)]
    loaded = vog.Levels.load(files, "density_L*")
    assert [loaded[n].name for n in (0, 1, -1)] == ["density_L0", "density_L1", "density_L2"]
    assert np.array_equal(loaded.box, levels.box)
    with pytest.raises(vog.Error, match=r"no grid matches 'density_L\*' \(it has: density\)"):
        vog.Levels.load(tmp_path / "cloud.vdb", "density_L*")
    with pytest.raises(IndexError):
        levels[3]
    masked = vog.Levels([levels[0]], masks=[levels[0]])
    assert "1 masks" in repr(masked)


@pytest.mark.parametrize(
    "make, message",
    [
        (lambda: np.zeros((3, 4)), r"density: shape \(3, 4\), expected 3 axes, \(x, y, z\)"),
        (lambda: np.zeros((3, 4, 5)), "no active voxel"),
        (lambda: np.zeros((0, 4, 5)), "0 voxels along axis 0"),
        (lambda: np.full((2, 2, 2), np.nan), "8 values that are no densities, the first nan at"),
        (lambda: np.full((2, 2, 2), -1.0), r"the first -1 at \[0, 0, 0\]"),
        (lambda: np.full((2, 2, 2), 1e300), "the first inf at"),
        (lambda: np.zeros((2, 2, 2), complex), "dtype complex128, expected real numbers"),
        (lambda: np.array([["a"]]), "dtype <U1, expected real numbers"),
        (lambda: [[[None]]], "dtype object, expected real numbers"),
        (lambda: np.ma.masked_less(np.ones((2, 2, 2)), 2), "masked array, expected a plain array"),
    ],
)
@pytest.mark.filterwarnings("ignore:overflow")
def test_invalid_densities_are_refused_in_one_line(make, message):
    with pytest.raises(vog.Error, match=message) as error:
        vog.Volume.from_numpy(make())
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "options, message",
    [
        ({"matrix": np.eye(3)}, r"matrix: shape \(3, 3\), expected \(N, 4\)"),
        ({"matrix": np.zeros((4, 4))}, "last row 0 0 0 0, expected 0 0 0 1"),
        ({"matrix": np.eye(4), "voxel_size": 2}, "exclude each other"),
        ({"matrix": np.diag([1, 1, 0, 1])}, "determinant 0"),
        ({"voxel_size": 0}, "expected finite and above 0"),
        ({"voxel_size": (1, -1, 1)}, "expected finite and above 0"),
        ({"origin": (0, np.nan, 0)}, "expected finite"),
        ({"active": np.ones((2, 2, 3), bool)}, "expected a bool array of shape"),
        ({"active": np.ones((2, 2, 2))}, "expected a bool array of shape"),
        ({"first": (2**30, 0, 0)}, r"expected within \+-2\^30"),
    ],
)
def test_invalid_transforms_are_refused(options, message):
    with pytest.raises(vog.Error, match=message):
        vog.Volume.from_numpy(np.ones((2, 2, 2)), **options)


def test_errors_are_one_class_and_name_the_file(tmp_path):
    assert issubclass(vog.Error, Exception) and vog.Error.__module__ == "vog"
    with pytest.raises(vog.Error, match="no such file") as error:
        vog.Volume.load(tmp_path / "nothing.vdb")
    assert str(error.value).startswith(str(tmp_path))
    with pytest.raises(vog.Error):
        vog.Volume.from_numpy(np.ones((2, 2, 2))).save(tmp_path / "none" / "a.vdb")
    array = np.ones((2, 2, 2))
    for call in (
        lambda: vog.Volume.load(3),
        lambda: vog.Volume.from_numpy(array, "big"),
        lambda: vog.Volume.from_numpy(array, (1, 2)),
        lambda: vog.Volume.from_numpy(array, origin=3),
        lambda: vog.Volume.from_numpy(array, first=(0, 0)),
        lambda: vog.Volume.from_blocks([array]),
        lambda: vog.Volume.from_blocks(3),
        lambda: vog.Levels([array]),
        lambda: vog.Levels.load(3),
    ):
        with pytest.raises(TypeError):
            call()
    assert str(pickle.loads(pickle.dumps(vog.Error("a.vdb: gone")))) == "a.vdb: gone"
