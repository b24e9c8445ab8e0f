#!/usr/bin/env python3
"""What scripts/validate compares with, against values found by other means."""
import math
import unittest

import numpy as np

from validations import catenary, elastica, pendulum


class References(unittest.TestCase):
    def test_heavy_elastica(self):
        """Drop and reach from a solver of boundary-value problems; gamma / 8 where it hardly bends."""
        for gamma, drop, reach in ((0.1, .01250, .99991), (1, .12347, .99125), (10, .70020, .65635),
                                   (100, .93752, .15922),
                                   (1000, .98114, .04599), (10000, .99411, .01426)):
            for found, expected in zip(elastica.hanging(gamma), (drop, reach)):
                self.assertAlmostEqual(found, expected, delta=2e-4)
        self.assertAlmostEqual(elastica.hanging(1e-3)[0], 1e-3 / 8, delta=1e-8)

    def test_asks_for_41_5_degrees_at_twice_the_bending_length(self):
        drop, reach = elastica.hanging(8)
        self.assertAlmostEqual(math.degrees(math.atan2(drop, reach)), 41.5, delta=0.05)

    def test_links_hang_as_a_catenary(self):
        """2 a sinh(d / 2a) = sqrt(S^2 - v^2), a the horizontal tension over the weight per length."""
        vertices, tension = catenary.equilibrium()
        horizontal = tension[0] * (vertices[1, 0] - vertices[0, 0]) * catenary.LINKS / catenary.LENGTH
        a = horizontal / (catenary.DENSITY * 9.81)
        self.assertAlmostEqual(2 * a * math.sinh(catenary.SPAN / (2 * a)),
                               math.sqrt(catenary.LENGTH**2 - catenary.RISE**2), delta=1e-3)
        self.assertLess(np.abs(vertices[-1] - (catenary.SPAN, catenary.RISE)).max(), 1e-10)

    def test_period_of_a_large_swing(self):
        """2 pi sqrt(l/g) (1 + a^2/16 + 11 a^4/3072 + 173 a^6/737280 + ...)"""
        series = 1 + 1 / 16 + 11 / 3072 + 173 / 737280
        self.assertAlmostEqual(pendulum.large_period(1), 2 * math.pi / math.sqrt(9.81) * series, delta=1e-4)


if __name__ == "__main__":
    unittest.main()
