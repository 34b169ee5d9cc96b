"""Cells of any shape: from arrays, from VTK's files, and by the command."""
import os
import pickle
import subprocess
import sys
import warnings

import numpy as np
import pytest

import vog

VOG = os.environ.get("VOG_COMMAND")
# Six tetrahedra of a unit cube, of corners in the order of VTK's hexahedron.
CUBE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float)
KUHN = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]


def test_a_cube_of_tetrahedra_equals_the_cube():
    plane = CUBE @ [1, -0.5, 0.25] + 2
    tetrahedra = vog.Cells(CUBE, np.ravel(KUHN), [10] * 6, plane, fields={"heat": CUBE @ [2, 4, -1] - 3, "wind": {"value": CUBE, "unit": "m/s"}})
    cube = vog.Cells(CUBE, np.arange(8), [12], plane, fields={"heat": CUBE @ [2, 4, -1] - 3, "wind": CUBE})
    assert len(tetrahedra) == 6 and repr(cube) == "<vog.Cells: 1 cells of 8 points, density, heat, wind>"
    report = {}
    one, other = vog.convert(tetrahedra, budget=1, report=report), vog.convert(cube, budget=1)
    assert one.mass == pytest.approx(2.375, rel=1e-6) and report["mass_ratio"] == pytest.approx(1, abs=1e-6)
    np.testing.assert_allclose(one.world_mean, other.world_mean, rtol=1e-6)
    # Means of both are of the cube, in which wind is the place.
    for name in ("heat", "wind"):
        np.testing.assert_allclose(one.fields[name].value, other.fields[name].value, rtol=1e-5)
    np.testing.assert_allclose(one.fields["wind"].value, one.world_mean, rtol=1e-5)
    # Limited to the range of the data, by 1.1 %.
    np.testing.assert_allclose(one.fields["heat"].gradient, 0.98875 * np.array([[2, 4, -1]]), rtol=1e-4)
    assert one.fields["wind"].unit == "m/s" and one.fields["density"].is_measure
    assert not vog.convert(cube, budget=1, fields=False).fields


def test_mistakes_are_one_line():
    for change, message in [
        ({"corners": [0, 1, 2, 9]}, "a corner at point 9, expected less than 8"), ({"types": [42]}, "type 42, expected 5, 8, 9"),
        ({"corners": [0, 1, 2]}, "expected 4"), ({"density": [1.0, 2.0]}, "expected 8 values of points or 1 of cells"),
        ({"density": [-1.0]}, "1 negative value"), ({"corners": [0.5, 1, 2, 3]}, "whole numbers"), ({"thickness": -1}, "thickness -1"),
    ]:  # fmt: skip
        given = {"points": CUBE, "corners": [0, 1, 3, 4], "types": [10], "density": [1.0], **change}
        with pytest.raises(vog.Error, match=message) as refused:
            vog.convert(vog.Cells(**given))
        assert "\n" not in str(refused.value)
    with pytest.raises(vog.Error, match="does not go with cells"):
        vog.convert(vog.Cells(CUBE, [0, 1, 3, 4], [10], [1.0]), block=2)
    with pytest.warns(UserWarning, match="of 2 cells 1 flat left out"):
        vog.convert(vog.Cells(CUBE, [0, 1, 3, 4, 0, 1, 1, 3], [10, 10], [1.0, 1.0]), budget=2)


@pytest.fixture(scope="module")
def meshes():
    """Hexahedra in the places of voxels with one value each, these, and a field that some voxels have as their largest."""
    rng = np.random.default_rng(3)
    density, heat = rng.uniform(0.2, 1, (5, 6, 7)), rng.uniform(300, 400, (5, 6, 7))
    number = np.arange(6 * 7 * 8).reshape(6, 7, 8)
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    hexahedra = np.stack([number[x : x + 5, y : y + 6, z : z + 7].ravel() for x, y, z in corners], -1)
    points = np.moveaxis(np.mgrid[0:6, 0:7, 0:8], 0, -1).reshape(-1, 3) - 0.5
    cells = vog.Cells(points, hexahedra.ravel(), np.full(210, 12), density.ravel(), fields={"heat": heat.ravel()})
    return cells, vog.Volume.from_numpy(density), heat


@pytest.fixture(scope="module")
def twins(meshes):
    cells, volume, heat = meshes
    return vog.Scene(cells), vog.Scene(volume, fields={"heat": heat}), vog.Camera((8, 7, 13), (2, 2.5, 3))


def test_evaluate_has_the_figures_of_the_same_voxels(tmp_path, meshes):
    cells, volume, heat = meshes
    model = vog.convert(volume, budget=20, fields={"heat": heat})
    result = vog.evaluate(cells, tmp_path, size=24, repeats=1, models={"m": model}, show="volume", fields=["heat"], extinction=1)
    for view, row in zip(result["views"], result["rows"][0]["views"]):
        place = view["camera"]
        camera = vog.Camera(place["eye"], place["look_at"], place["up"], place["fov_degrees"])
        voxels = vog.compare(vog.render(volume, camera, 24, extinction=1), vog.render(model, camera, 24, extinction=1))
        assert row["relative_l2"] == pytest.approx(voxels.relative_l2, rel=1e-3) and row["relative_l2"] > 0.05
        truth, maps = (vog.render(data, camera, 24, show="mean", field="heat", **more) for data, more in ((volume, {"fields": {"heat": heat}}), (model, {})))
        weight = truth.column * (truth.column > truth.column.max() / 1000)
        off, whole = np.nan_to_num(maps.mean) - np.nan_to_num(truth.mean), np.nan_to_num(truth.mean)
        assert row["fields"][0]["mean_l2"] == pytest.approx(np.sqrt((weight * off**2).sum() / (weight * whole**2).sum()), rel=0.02)
    assert list(result["rows"][0]["volume"]) == ["ramp", "bands", "step"] and result["rows"][0]["volume"]["ramp"]["psnr_rgb_db"]["worst"] > 15


def test_evaluate_converts_cells(tmp_path, meshes):
    cells = meshes[0]
    result = vog.evaluate(cells, tmp_path, size=16, repeats=1)
    assert [(row["series"], row["step"]) for row in result["rows"]] == [("adaptive", name) for name in ("cells4", "cells16", "cells64", "default")]
    assert all(row["gaussians"] <= 210 // share for row, share in zip(result["rows"], (4, 16, 64)))
    assert result["data"]["active_voxels"] == 210 and result["rows"][0]["mass_ratio"] == pytest.approx(1, abs=1e-6)
    assert vog.evaluate(cells, tmp_path, size=16, repeats=1, resume=True)["rows"] == result["rows"]
    for change, message in [
        ({"conversions": "paper"}, "expected 'all' or 'moments' of Cells"), ({"voxels": True}, "no field error on voxels"),
        ({"fields": ["no"]}, "no field 'no'"), ({"models": {"m": vog.convert(cells, fields=False)}, "show": "volume"}, "without the cells' density"),
    ]:  # fmt: skip
        with pytest.raises(vog.Error, match=message) as refused:
            vog.evaluate(cells, tmp_path, size=16, **change)
        assert "\n" not in str(refused.value)
    assert "<html" in vog.show(cells, live=False).html


@pytest.mark.parametrize("request_", [
    {}, {"show": "column"}, {"show": "mean", "field": "heat"}, {"show": "deviation", "field": "heat"}, {"show": "maximum", "field": "heat"},
    {"show": "maximum"}, {"show": "slice", "plane": (1, 2, -1, 3.1)}, {"show": "slice", "field": "heat", "plane": (1, 2, -1, 3.1)},
    {"show": "slice", "plane": "z=3", "thickness": 1.3}, {"clip_planes": [(1, 0.2, 0, 2)]}, {"show": "volume"},
    {"show": "volume", "field": "heat", "tf": "viridis"}, {"show": "volume", "field": "heat", "bands": [(350, 352, "red", 0.9)], "samples": 2},
], ids=str)  # fmt: skip
def test_pictures_are_those_of_the_same_voxels(twins, request_):
    cells, voxels, camera = twins
    if request_.get("show") != "volume":
        request_ = {**request_, "extinction": 1} if not request_ or "clip_planes" in request_ else request_
        seen, expected = cells.render(camera, 48, **request_).values, voxels.render(camera, 48, **{"field": "", **request_}).values
        assert np.isfinite(expected).sum() > 150
        # Rays in a face, and points on one, are of either side.
        off = ~np.isclose(seen, expected, rtol=2e-5, equal_nan=True)
        assert off.mean() < 0.002, (off.sum(), seen[off], expected[off])
        return
    fixed = {"range": (300, 400) if "field" in request_ else (0.2, 1), "unit_distance": 1.0} if "bands" not in request_ else {"unit_distance": 1.0}
    seen, expected = (np.asarray(scene.render(camera, 48, **fixed, **request_).image, int) for scene in (cells, voxels))
    assert seen.max() > 100 and np.abs(seen - expected).max() <= 1


def test_light_is_near_that_of_the_same_voxels(twins):
    cells, voxels, camera = twins
    request = {"show": "volume", "tf": "white", "range": (0.2, 1), "unit_distance": 1.0, "light": "studio"}
    lit, expected, plain = cells.render(camera, 64, **request), voxels.render(camera, 64, **request), cells.render(camera, 64, **{**request, "light": None})
    assert vog.compare(expected, lit).psnr_db > 38 and vog.compare(expected, plain).psnr_db < 25
    shaded, flat = (np.asarray(cells.render(camera, 64, **{**request, "light": light}).image, int) for light in ("head", None))
    assert np.abs(shaded - flat).mean() > 3


def test_the_first_view_holds_all_cells():
    cells = vog.Cells(CUBE, np.arange(8), [12], [1.0])
    seen = np.asarray(vog.render(cells, size=64).values)
    assert not seen[[0, -1]].any() and not seen[:, [0, -1]].any() and (seen > 0).mean() > 0.4
    assert vog.render(cells, size=64).camera.eye == pytest.approx(vog.Camera.orbit(cells).eye)


def test_maps_of_linear_data_are_exact():
    cells = vog.Cells(CUBE, np.ravel(KUHN), [10] * 6, CUBE @ [1, -0.5, 0.25] + 2, fields={"heat": CUBE @ [2, 4, -1] - 3, "wind": {"value": CUBE, "unit": "m/s"}})
    x, y = np.meshgrid((np.arange(8) + 0.5) / 8, (np.arange(8) + 0.5) / 8)
    density, heat = 2 + x - 0.5 * y, 2 * x + 4 * y - 3  # at z = 0
    np.testing.assert_allclose(vog.projection(cells, axis="z", resolution=8).array, density + 0.125, rtol=1e-6)
    mean = (density * heat - density / 2 + heat / 8 - 1 / 12) / (density + 0.125)
    np.testing.assert_allclose(vog.projection(cells, "heat", axis="z", resolution=8).array, mean, rtol=1e-5, atol=1e-6)
    np.testing.assert_allclose(vog.slice(cells, "z", 0.25, resolution=8).array, density + 0.0625, rtol=1e-6)
    np.testing.assert_allclose(vog.slice(cells, "z", 0.25, field="wind.magnitude", resolution=8).array, np.sqrt(x**2 + y**2 + 0.0625), rtol=1e-6)
    # The band from 0.9 to 1 of heat, of every ray from above: (0.1 / gradient) of its way, or less.
    picture = vog.render(cells, vog.Camera((0.5, 0.5, 5), (0.5, 0.5, 0), orthographic_width=1), 16, show="volume", field="heat",
                         bands=[(-1, 1, "white", 0.5)], unit_distance=1.0)  # fmt: skip
    u, v = np.meshgrid((np.arange(16) + 0.5) / 16, 1 - (np.arange(16) + 0.5) / 16)
    low = 2 * u + 4 * v - 3  # heat at z = 0, less z above
    first, last = np.clip(low - 1, 0, 1), np.clip(low + 1, 0, 1)
    column = (2 + u - 0.5 * v) * (last - first) + 0.125 * (last**2 - first**2)
    np.testing.assert_allclose(np.asarray(picture.values), 1 - 0.5**column, atol=2e-3)


def test_requests_that_cells_cannot_meet():
    cells = vog.Cells(CUBE, np.arange(8), [12], [1.0], fields={"heat": [2.0]})
    for request, message in [
        ({"renderer": "splat"}, "renderer 'splat', expected 'reference' for cells"), ({"interpolation": "linear"}, "interpolation is for voxels, not for cells"),
        ({"show": "mean", "field": "cold"}, "no field 'cold' in the model, expected one of heat, density$"), ({"show": "mean", "field": "heat", "fields": {"heat": [1.0]}}, "cells have their own"),
    ]:  # fmt: skip
        with pytest.raises(vog.Error, match=message):
            vog.render(cells, size=16, **request)


def test_pickles_keep_every_number():
    cells = vog.Cells(CUBE, [0, 1, 3, 4, 0, 1, 2], [10, 5], {"value": [1.0, 2], "at": "cells"}, thickness=0.1, source="a.vtu", name="rho",
                      fields={"heat": {"value": CUBE[:, 0], "unit": "K"}, "wind": CUBE})  # fmt: skip
    vog.set_units(cells, "g / cm3", "m")
    back = pickle.loads(pickle.dumps(cells))
    assert repr(back) == repr(cells) and vog.units_of(back) == vog.units_of(cells)
    one, other = vog.convert(cells, budget=2), vog.convert(back, budget=2)
    assert pickle.dumps(one) == pickle.dumps(other) and one.fields["heat"].unit == "K" and len(one) == 2


def test_cells_beside_others_in_layers(twins):
    cells = vog.Cells(CUBE, np.arange(8), [12], [1.0])
    volume = vog.Volume.from_numpy(np.ones((4, 4, 4)), voxel_size=0.25, origin=(0.125, 0.125, 0.125))
    look = {"tf": "white", "range": (0, 2), "unit_distance": 1.0}
    camera = vog.Camera.orbit(cells)
    one, other = (np.asarray(vog.render([vog.Layer(data, **look)], camera, 48).image, int) for data in (cells, volume))
    assert one.max() > 50 and np.abs(one - other).max() <= 1
    both = np.asarray(vog.render([vog.Layer(cells, **look), vog.Layer(vog.convert(volume, block=1), **look)], camera, 48).image, int)
    assert both.max() > one.max() + 20


@pytest.fixture
def curvilinear():
    """A quarter of a ring with linear data, [points along the radius, the angle, z]."""
    pyvista = pytest.importorskip("pyvista", reason="needs pyvista (pip install pyvista)")
    r, a, z = np.meshgrid(np.linspace(1, 2, 9) ** 1.5, np.linspace(0, np.pi / 2, 17), np.linspace(0, 1, 5), indexing="ij")
    grid = pyvista.StructuredGrid(r * np.cos(a), r * np.sin(a), z)
    grid["density"] = 5 + grid.points @ [1, 1, -1]
    grid["heat"] = grid.points @ [2.0, 0, 3]
    return grid


def expected_mass(grid):
    """Integral of 5 + x + y - z over the prisms of the ring's polygon, by the moments of trapezoids."""
    edges = np.linspace(0, np.pi / 2, 17)
    total = 0.0
    for low, high in zip(edges, edges[1:]):
        for radius, sign in ((2**1.5, 1), (1.0, -1)):
            triangle = np.array([[0, 0], [radius * np.cos(low), radius * np.sin(low)], [radius * np.cos(high), radius * np.sin(high)]])
            area = 0.5 * radius**2 * np.sin(high - low)
            total += sign * area * (5 + triangle.mean(axis=0).sum() - 0.5)
    return total


def test_curvilinear_grids_with_linear_data_equal_the_closed_form(tmp_path, curvilinear):
    curvilinear.save(tmp_path / "ring.vts")
    cells, fields = vog.load(tmp_path / "ring.vts", fields=["heat"])
    assert len(cells) == 8 * 16 * 4 and fields is None
    model = vog.convert(cells, budget=1, fields=fields)
    assert model.mass == pytest.approx(expected_mass(curvilinear), rel=1e-6)
    # Of one Gaussian the plane is limited to the range of the data.
    gradient = model.fields["heat"].gradient[0]
    np.testing.assert_allclose(gradient / gradient[2], [2 / 3, 0, 1], atol=1e-5)
    assert 2.5 < gradient[2] <= 3
    whole = vog.convert(cells, budget=10000)
    assert len(whole) == len(cells) and whole.mass == pytest.approx(model.mass, rel=1e-6)
    np.testing.assert_allclose(whole.fields["heat"].value, whole.world_mean @ [2, 0, 3], rtol=1e-4, atol=1e-4)


def test_other_meshes_have_the_same_mass(tmp_path, curvilinear):
    mass = vog.convert(_cells_of(tmp_path, curvilinear, "a.vts"), budget=1).mass
    import pyvista

    others = {"tetrahedra.vtu": curvilinear.triangulate(), "curved.vtu": _quadratic(curvilinear), "block.vtm": pyvista.MultiBlock([
        curvilinear.extract_subset([0, 8, 0, 8, 0, 4]), curvilinear.extract_subset([0, 8, 8, 16, 0, 4])])}  # fmt: skip
    for name, mesh in others.items():
        assert vog.convert(_cells_of(tmp_path, mesh, name), budget=1).mass == pytest.approx(mass, rel=1e-5), name
    rectilinear = pyvista.RectilinearGrid(np.array([0.0, 1, 3]), np.array([0.0, 1]), np.array([0.0, 2, 3, 7]))
    rectilinear.cell_data["rho"] = np.arange(1.0, 7)
    cells = _cells_of(tmp_path, rectilinear, "r.vtr")
    volumes = np.outer([2, 1, 4], [1, 2]).ravel()
    assert vog.convert(cells, budget=6).mass == pytest.approx(volumes @ np.arange(1.0, 7), rel=1e-6)
    surface = rectilinear.extract_surface()
    surface = surface.cast_to_unstructured_grid()
    surface.cell_data["rho"] = np.ones(surface.n_cells)
    surface.save(tmp_path / "s.vtu")
    shell = vog.load(tmp_path / "s.vtu", "rho", thickness=0.01)
    assert vog.convert(shell, budget=100).mass == pytest.approx(0.01 * surface.area, rel=1e-5)


def _cells_of(folder, mesh, name):
    mesh.save(folder / name)
    return vog.load(folder / name)


def _quadratic(grid):
    """The same cells as polyhedra, which are divided."""
    import pyvista

    mesh = grid.cast_to_unstructured_grid()
    stream = []
    faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    for corners in mesh.cell_connectivity.reshape(-1, 8):
        cell = [6] + [number for face in faces for number in (4, *corners[face])]
        stream += [len(cell), *cell]
    made = pyvista.UnstructuredGrid(np.array(stream), np.full(mesh.n_cells, 42, np.uint8), mesh.points)
    for name in mesh.point_data:
        made.point_data[name] = mesh.point_data[name]
    return made


def test_files_of_pyvista(tmp_path):
    pyvista = pytest.importorskip("pyvista", reason="needs pyvista (pip install pyvista)")
    cells = vog.load(os.path.join(os.path.dirname(pyvista.__file__), "examples", "hexbeam.vtk"), "sample_point_scalars")
    assert len(cells) == 40
    box = pyvista.examples.load_hexbeam().bounds
    np.testing.assert_allclose(cells.box.T.ravel(), box)


@pytest.mark.skipif(not VOG, reason="VOG_COMMAND names no command")
def test_commands_take_meshes(tmp_path, curvilinear):
    curvilinear.save(tmp_path / "ring.vts")
    environment = {**os.environ, "PATH": os.path.dirname(VOG) + os.pathsep + os.environ["PATH"]}

    def run(*words):
        done = subprocess.run([sys.executable, "-m", "vog", *words], cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert "density  at points\n  heat  at points\n" in run("ring.vts")
    run("convert", "ring.vts", "--field", "heat", "--budget", "50", "-o", "ring.ply")
    model = vog.Gaussians.load(tmp_path / "ring.ply")
    assert len(model) <= 50 and model.mass == pytest.approx(expected_mass(curvilinear), rel=1e-5) and "heat" in model.fields
    run("render", "ring.vts", "-o", "ring.png", "--size", "32")
    run("convert", "ring.vts", "--error", "0.3", "-o", "few.ply")
    assert 0 < len(vog.Gaussians.load(tmp_path / "few.ply")) < 512


@pytest.fixture
def box():
    """[5, 4, 3] cells of 1 x 2 x 3, of which the 20 in the first layer are marked."""
    pyvista = pytest.importorskip("pyvista", reason="needs pyvista (pip install pyvista)")
    return pyvista.ImageData(dimensions=(6, 5, 4), spacing=(1, 2, 3)), (np.arange(60) < 20).astype(np.uint8)


def test_arrays_of_cells_win_over_those_of_points_with_the_same_name(tmp_path, box):
    for mesh, name in ((box[0], "a.vti"), (box[0].cast_to_unstructured_grid(), "a.vtu")):
        mesh.point_data["density"], mesh.cell_data["density"] = np.ones(mesh.n_points), np.full(60, 3.0)
        mesh.save(tmp_path / name)
        assert vog.convert(vog.load(tmp_path / name), budget=1).mass == pytest.approx(3 * 360, rel=1e-6)


def test_blocks_without_the_density_are_left_out(tmp_path, box):
    import pyvista

    whole = box[0].cast_to_unstructured_grid()
    whole.cell_data["rho"], bare, at_points = np.ones(whole.n_cells), whole.copy(), whole.copy()
    bare.clear_data()
    at_points.clear_data()
    at_points.point_data["rho"] = np.ones(whole.n_points)
    pyvista.MultiBlock({"inside": whole, "patch": bare.extract_surface()}).save(tmp_path / "patch.vtm")
    with pytest.warns(UserWarning, match="1 of 2 blocks have no 'rho' and are left out"):
        cells = vog.load(tmp_path / "patch.vtm", "rho")
    assert len(cells) == whole.n_cells
    pyvista.MultiBlock({"a": whole, "b": at_points.translate((100, 0, 0))}).save(tmp_path / "both.vtm")
    with pytest.raises(vog.Error, match="'rho' lies at points in some blocks and in cells in others"):
        vog.load(tmp_path / "both.vtm", "rho")
    with pytest.raises(vog.Error, match="no field 'heat', expected one of rho"):
        vog.load(tmp_path / "patch.vtm", "heat")


def test_components_of_meshes_are_a_vector(tmp_path, box):
    mesh = box[0].cast_to_unstructured_grid()
    mesh.point_data.update({"density": np.ones(120), "vx": mesh.points[:, 0], "vy": mesh.points[:, 1], "vz": np.zeros(120)})
    mesh.save(tmp_path / "a.vtu")
    field = vog.convert(vog.load(tmp_path / "a.vtu", fields=["v"])[0], budget=1).fields["v"]
    assert field.is_vector
    np.testing.assert_allclose(field.value, [[2.5, 4, 0]], atol=1e-5)


@pytest.mark.parametrize("kind", ["vti", "vtr", "vts", "vtk", "vtu"])
@pytest.mark.parametrize("ghost, counted", [(1, 40), (8, 40), (32, 40), (2, 60)])  # duplicate, refined, hidden; in high connectivity
def test_ghosts_do_not_count(tmp_path, box, kind, ghost, counted):
    mesh, marked = box
    mesh = {"vtr": mesh.cast_to_rectilinear_grid, "vts": mesh.cast_to_structured_grid, "vtu": mesh.cast_to_unstructured_grid}.get(kind, mesh.copy)()
    mesh.cell_data.update({"density": np.ones(60), "heat": np.arange(60.0), "vtkGhostType": ghost * marked})
    path = tmp_path / f"a.{kind}"
    mesh.save(path)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        data, weighted = vog.load(path), vog.load(path, "volume", fields=["heat"])
    assert ("20 of 60 cells are ghosts or hidden" in str([str(one.message) for one in caught])) == (counted == 40)
    for model in (vog.convert(data, budget=50), vog.convert(weighted[0], budget=50, fields=weighted[1])):
        assert model.mass == pytest.approx(6 * counted, rel=1e-6)


def test_hidden_points_do_not_count(tmp_path, box):
    image, hidden = box[0], 2 * (np.arange(120) < 30).astype(np.uint8)
    image.point_data.update({"density": np.ones(120), "vtkGhostType": hidden})
    image.save(tmp_path / "a.vti")
    assert vog.load(tmp_path / "a.vti").mass == pytest.approx(90 * 6)
    image.cell_data["rho"] = np.ones(60)  # hidden with their corners
    image.save(tmp_path / "b.vti")
    assert vog.load(tmp_path / "b.vti", "rho").mass == pytest.approx(40 * 6)
    bent = image.cast_to_structured_grid()
    bent.points[:, 2] += 0.3 * (bent.points[:, 2] == 9) * np.sin(bent.points[:, 0])
    bent.save(tmp_path / "c.vts")
    assert len(vog.load(tmp_path / "c.vts", "rho")) == 40
    # A point is hidden by all cells around it.
    image.clear_data()
    image.point_data["density"], image.cell_data["vtkGhostType"] = np.ones(120), 32 * box[1]
    image.save(tmp_path / "d.vti")
    assert vog.load(tmp_path / "d.vti").mass == pytest.approx(90 * 6)


def test_concave_polyhedra_have_their_own_volume(tmp_path):
    """An L of two by two, with linear data and a cube beside it, against the closed form."""
    pyvista = pytest.importorskip("pyvista", reason="needs pyvista (pip install pyvista)")
    base = np.array([[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], float)
    points = np.vstack([np.c_[base, np.zeros(6)], np.c_[base, np.ones(6)], CUBE + [5, 0, 0]])
    sides = [[n, (n + 1) % 6, (n + 1) % 6 + 6, n + 6] for n in range(6)]
    faces = [[5, 4, 3, 2, 1, 0], [6, 7, 8, 9, 10, 11], *sides]
    for turned in (faces, [face[::-1] for face in faces]):
        stream = [8, *(number for face in turned for number in (len(face), *face))]
        mesh = pyvista.UnstructuredGrid(np.array([len(stream), *stream, 8, *range(12, 20)]), np.array([42, 12], np.uint8), points)
        mesh.point_data["heat"], mesh.cell_data["density"] = points @ [1.0, 2, 3], [1.0, 2.0]
        mesh.save(tmp_path / "a.vtu")
        cells = vog.load(tmp_path / "a.vtu", fields=["heat"])[0]
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            model = vog.convert(cells, budget=1)
        assert model.mass == pytest.approx(3 + 2, rel=1e-6)
        centre = (np.array([2.5, 2.5, 1.5]) + 2 * np.array([5.5, 0.5, 0.5])) / 5
        np.testing.assert_allclose(model.world_mean, [centre], rtol=1e-5)
        np.testing.assert_allclose(model.fields["heat"].value, [centre @ [1, 2, 3]], rtol=1e-4)


def test_files_of_several_times(tmp_path, box):
    mesh = box[0].cast_to_unstructured_grid()
    for time in range(3):
        mesh.cell_data["density"] = np.full(60, time + 1.0)
        mesh.save(tmp_path / f"t{time}.vtu")
    parts = "".join(f'<DataSet timestep="{10 * time}" part="0" file="t{time}.vtu"/>' for time in range(3))
    (tmp_path / "a.pvd").write_text(f'<?xml version="1.0"?><VTKFile type="Collection" version="0.1"><Collection>{parts}</Collection></VTKFile>')
    mass = lambda **at: vog.convert(vog.load(tmp_path / "a.pvd", **at), budget=1).mass
    with pytest.warns(UserWarning, match="time 0 of 3; at="):
        assert mass() == pytest.approx(360)
    assert mass(at={"time": 2}) == mass(at={"time": -1}) == pytest.approx(3 * 360)
    for at, message in (({"time": 3}, "time 3, expected 0 to 2"), ({"step": 1}, "no axis 'step' beside x, y and z, expected time")):
        with pytest.raises(vog.Error, match=message):
            mass(at=at)
    with pytest.raises(vog.Error, match="no axis 'time' beside x, y and z, expected none"):
        vog.load(tmp_path / "t0.vtu", at={"time": 0})


def test_structured_grids_in_pieces(tmp_path, box):
    grid = box[0].cast_to_structured_grid()
    grid.cell_data["density"] = np.arange(60.0)
    grid.save(tmp_path / "a.vts")
    (tmp_path / "a.pvts").write_text(
        '<?xml version="1.0"?><VTKFile type="PStructuredGrid" version="0.1"><PStructuredGrid WholeExtent="0 5 0 4 0 3" GhostLevel="0"><PPoints>'
        f'<PDataArray type="{"Float64" if grid.points.dtype == float else "Float32"}" Name="Points" NumberOfComponents="3"/></PPoints><PCellData>'
        '<PDataArray type="Float64" Name="density"/></PCellData><Piece Extent="0 5 0 4 0 3" Source="a.vts"/></PStructuredGrid></VTKFile>')  # fmt: skip
    np.testing.assert_array_equal(vog.load(tmp_path / "a.pvts").to_numpy(), vog.load(tmp_path / "a.vts").to_numpy())
