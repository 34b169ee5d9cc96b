#!/usr/bin/env python3
"""Column density map of a volume or model as a FITS image with world coordinates, and as a figure where Matplotlib is installed.

usage: projection_to_fits.py FILE OUT.fits [DENSITY_UNIT LENGTH_UNIT]      units of astropy: 'g / cm3' kpc
Needs astropy (pip install astropy).
"""
import sys

import vog


def main(file, out, density=None, length=None):
    from astropy.io import fits

    data = vog.Gaussians.load(file) if file.endswith((".ply", ".vogz")) else vog.Volume.load(file)
    if density:
        vog.set_units(data, density, length)
    found = vog.projection(data, axis="z", resolution=512)
    array = getattr(found.array, "value", found.array)
    fits.PrimaryHDU(array.astype("float32"), fits.Header(list(found.header().items()))).writeto(out, overwrite=True)
    print(f"{out}: {array.shape[1]} x {array.shape[0]} pixels, {found.unit or 'density times world unit'}")
    try:
        import matplotlib.pyplot as plt
        from matplotlib.colors import LogNorm
    except ImportError:
        return
    most = array.max()
    plt.imshow(array, extent=found.extent, origin="lower", norm=LogNorm(most * 1e-4, most), cmap="inferno")
    plt.colorbar(label=f"column density [{found.unit or 'world units'}]")
    plt.savefig(out.rsplit(".", 1)[0] + ".png")


if __name__ == "__main__":
    if len(sys.argv) not in (3, 5):
        sys.exit(__doc__)
    main(*sys.argv[1:])
