"""Units, colours and meshes that a call cannot keep, take or read, which it says."""
import warnings

import numpy as np
import pytest

import vog


def test_nanovdb_drops_units_with_a_warning(tmp_path):
    volume = vog.Volume.from_numpy(np.ones((8, 8, 8)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        volume.save(tmp_path / "a.nvdb")
        vog.Levels([volume]).save(tmp_path / "b.nvdb")
        vog.set_units(volume, "kg/m3", "km").save(tmp_path / "a.vdb")
    with pytest.warns(UserWarning, match=".nvdb keeps no units"):
        volume.save(tmp_path / "a.nvdb")
    plain = vog.Volume.from_numpy(np.ones((8, 8, 8)))
    with pytest.warns(UserWarning, match=".nvdb keeps no units"):
        plain.save(tmp_path / "a.nvdb", fields={"heat": {"value": np.ones((8, 8, 8)), "unit": "K"}})
    with pytest.raises(vog.Error, match="half and fields"):
        plain.save(tmp_path / "a.vdb", True, fields={"heat": np.ones((8, 8, 8))})


def test_backgrounds_are_texts_with_commas_too(cloud):
    pictures = [np.asarray(vog.render(cloud, size=16, background=color).image) for color in ("0.1,0.12,0.18", (0.1, 0.12, 0.18))]
    np.testing.assert_array_equal(*pictures)
    with pytest.raises(vog.Error, match="background 0.1,a,0: expected black"):
        vog.render(cloud, size=16, background="0.1,a,0")


@pytest.mark.parametrize("level", [None, 0])
def test_meshes_of_yt_are_refused_with_what_works(level):
    yt = pytest.importorskip("yt", reason="needs yt (pip install yt)")
    yt.set_log_level("error")
    corners, cells = yt.hexahedral_connectivity(*[np.linspace(0, 1, 5)] * 3)
    box = np.array([[0, 1.0]] * 3)
    mesh = yt.load_hexahedral_mesh({"density": (np.ones((4, 4, 4)), "g/cm**3")}, cells, corners, length_unit="cm", bbox=box)
    with pytest.raises(vog.Error, match="from_yt: a mesh of .*saved as .vtu"):
        vog.from_yt(mesh, "density", level=level)
