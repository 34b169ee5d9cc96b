"""vog: sparse scientific volumes as 3D Gaussians, rendered by exact line integration.

    import vog
    volume = vog.Volume.from_numpy(density, voxel_size=0.1)
    model = vog.convert(volume, block=4)
    image = vog.render(model, size=512).shade("inferno")
    image.save("picture.png")

load -> convert -> render -> shade -> compare. Arrays are [x, y, z]; images are [row, column], rows from
the top. Lengths are world units, densities per world unit. docs/python.md is the tutorial.
"""
from ._vog import *
from ._vog import __version__ as __version__
