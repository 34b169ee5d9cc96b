#!/usr/bin/env python3
"""Pages of smoke, OpenVDB's sample, in Chromium: its quantities and maxima against the command's, with the bounds that docs/web.md states.

VOG_COMMAND names the command, VOG_DATA the folder of real inputs. Exits with 77, which ctest takes as skipped, where there is no
smoke.vdb or no Chromium.
"""
import unittest

from maxima_test import Maxima
from page_test_case import DATA, run
from quantities_test import Quantities


class Smoke:
    size = (360, 300)
    block = 8
    measured = {"T": (73.3, 1), "column": (76.4, 1), "maximum": (65.6, 10), "volume": (60.3, 2)}
    # Rims that rounded numbers move change the ends of slabs and lit surfaces: measured at 6 of 108,000 pixels, by up to 17 steps.
    rims = 5.6e-5

    @classmethod
    def make_volume(cls):
        return DATA / "smoke.vdb"

    @classmethod
    def setUpClass(cls):
        if not cls.make_volume().exists():
            raise unittest.SkipTest(f"{cls.make_volume()} is absent (set VOG_DATA to the folder of real inputs)")
        super().setUpClass()


class SmokesQuantities(Smoke, Quantities):
    pass


class SmokesMaxima(Smoke, Maxima):
    pass


if __name__ == "__main__":
    run(*(f"real_data_test.Smokes{name}" for name in (
        "Quantities.test_volume_pictures_are_vog_renders", "Quantities.test_precise_pages_are_within_2_of_255",
        "Maxima.test_maxima_are_vog_renders", "Maxima.test_maxima_of_precise_pages_are_nearer")))
