"""vog: sparse scientific volumes as 3D Gaussians, rendered by exact line integration.

    import vog
    volume = vog.Volume.from_numpy(density, voxel_size=0.1)
    model = vog.convert(volume, block=4)
    image = vog.render(model, size=512).shade("inferno")
    image.save("picture.png")

Data flow: load -> convert -> render -> shade -> compare. Volumes are arrays [x, y, z]; images are
[row, column] with rows from the top. Lengths are in world units, densities per world unit of length.
Tutorial: docs/python.md.
"""
from ._vog import *
from ._vog import __version__ as __version__
