"""Points: arrays, files, conversion."""
import pickle

import numpy as np
import pytest

import vog


@pytest.fixture(scope="module")
def arrays():
    random = np.random.default_rng(2)
    return random.random((200, 3)), random.normal(size=(200, 3)), random.random(200)


def test_arrays_round_trip_in_memory_text_and_pickles(tmp_path, arrays):
    position, velocity, mass = arrays
    points = vog.Points.from_numpy(position, velocity, {"mass": mass})
    assert len(points) == 200
    points.save(tmp_path / "a.csv")
    for back in (points, vog.Points.load(tmp_path / "a.csv"), pickle.loads(pickle.dumps(points))):
        assert np.array_equal(back.position, position) and back.position.dtype == np.float64
        assert np.array_equal(back.velocity, velocity.astype(np.float32))
        assert list(back.attributes) == ["mass"]
        assert np.array_equal(back.attributes["mass"], mass.astype(np.float32))
    assert points.value_names == ["count", "speed", "mass"]
    points.attributes["mass"][:] = 1
    assert vog.convert(points, value="mass").mass == pytest.approx(200, rel=1e-5)
    assert vog.Points.from_numpy(position).velocity is None


def test_models_have_the_mass_asked_for(arrays):
    position, _, mass = arrays
    points = vog.Points.from_numpy(position, attributes={"mass": mass})
    assert len(vog.convert(points)) == 200
    few = vog.convert(points, value="mass", budget=20)
    assert len(few) <= 20 and few.mass == pytest.approx(mass.sum(), rel=1e-4)
    assert vog.convert(points, radius=0.1).scale.min() == pytest.approx(0.1 * 1.1863, rel=1e-4)  # after truncation
    paper = vog.convert(vog.Points.from_numpy(position, position), method="paper")
    assert paper.method == "paper"


def test_columns_are_chosen_by_name(tmp_path):
    (tmp_path / "a.csv").write_text("id,px,py,pz,temperature\n1,1,2,3,300\n2,4,5,6,400\n")
    points = vog.Points.load(tmp_path / "a.csv", columns=["px", "py", "pz"])
    assert np.array_equal(points.position, [[1, 2, 3], [4, 5, 6]])
    assert np.array_equal(points.attributes["temperature"], [300, 400])


@pytest.mark.parametrize(
    "arguments, message",
    [
        ((np.zeros((3, 2)),), r"position: shape \(3, 2\), expected \(N, 3\)"),
        ((np.full((1, 3), np.nan),), "finite"),
        ((np.zeros((2, 3)), np.zeros((3, 3))), "velocit"),
        ((np.zeros((2, 3)), None, {"m": np.zeros(3)}), "m"),
        ((np.zeros((0, 3)),), "no particle"),
    ],
)
def test_bad_arrays_are_refused(arguments, message):
    with pytest.raises(vog.Error, match=message):
        vog.Points.from_numpy(*arguments)


@pytest.mark.parametrize("kind, made", [(vog.Points, "use Points.load or Points.from_numpy"), (vog.Picture, "use what calls of vog return")])
def test_kinds_without_constructor_say_what_makes_them(kind, made):
    with pytest.raises(TypeError, match=f"{kind.__name__}: has no constructor; {made}"):
        kind(np.zeros(3))


def test_several_files_are_read_as_one_and_values_may_be_missing(tmp_path):
    (tmp_path / "a.csv").write_text("x,y,z,m\n1,2,3,4\n")
    (tmp_path / "b.csv").write_text("x,y,z,m\n1,2,5,\n")
    points = vog.Points.load([tmp_path / "a.csv", str(tmp_path / "b.csv")])
    assert len(points) == 2 and np.isnan(points.attributes["m"][1])
    vog.convert(points, radius=1)
    with pytest.raises(vog.Error, match="'m' of particle 1 is missing"):
        vog.convert(points, radius=1, value="m")
    with pytest.raises(vog.Error, match="no files"):
        vog.Points.load([])
    (tmp_path / "c.csv").write_text("x,y,z,m\n1,2,3,2e43\n")
    with pytest.warns(UserWarning, match="'m' is divided by 1e\\+43"):
        assert vog.Points.load(tmp_path / "c.csv").attributes["m"] == [2]
