"""vog: sparse scientific volumes as 3D Gaussians, rendered by exact line integration.

    import vog
    volume = vog.Volume.from_numpy(density, voxel_size=0.1)
    model = vog.convert(volume, block=4)
    picture = vog.render(model, tf="inferno")
    picture.save("picture.png")

vog.load(path) reads any file that vog or an installed Python package reads. Data flow: load -> convert -> render -> compare. Volumes are arrays [x, y, z]; images are
[row, column] with rows from the top. Lengths are in world units, densities per world unit of length.
Tutorial: docs/python.md.
"""
from ._python import own_libraries, require_python

require_python()
with own_libraries():
    from . import _vog

from . import _messages, _picture, _show, _units

_messages.shorten(_vog)
_units.accept_quantities()
_show.show_models()
_picture.extend_picture()

from ._load import load as load
from ._picture import Layer as Layer, Light as Light, Scale as Scale, Scene as Scene
from ._projection import Projection as Projection, projection as projection, slice as slice
from ._readers import from_nifti as from_nifti, from_tiff as from_tiff, from_xarray as from_xarray, from_yt as from_yt
from ._show import Page as Page, Settings as Settings, show as show
from ._units import Units as Units, set_units as set_units, units_of as units_of
from ._vog import *
from ._vog import __version__ as __version__
from ._vtk import to_pyvista as to_pyvista, to_vtk as to_vtk
