"""Cantilevers of cloth: a strip clamped at one end that hangs under its own weight, as Taut has it and as a heavy
elastica."""
import functools
import math

from validations.cases import G, steps_of

DENSITY = 0.2  # kg/m^2


def from_tip(gamma, steepness, points=200):
    """From the tip, at the angle pi/2 - `steepness` below the horizontal and without curvature, to the clamp, by Runge
    and Kutta's method in r = 1 - s: (a, drop, reach) of a'' = gamma r sin a, a the angle to the vertical [gamma = w L^3
    / B, w the weight per area]."""
    def slope(r, a, rate):
        return rate, gamma * r * math.sin(a), math.cos(a), math.sin(a)

    y, h = [steepness, 0.0, 0.0, 0.0], 1 / points
    for n in range(points):
        r = n * h
        k1 = slope(r, *y[:2])
        k2 = slope(r + h / 2, y[0] + h / 2 * k1[0], y[1] + h / 2 * k1[1])
        k3 = slope(r + h / 2, y[0] + h / 2 * k2[0], y[1] + h / 2 * k2[1])
        k4 = slope(r + h, y[0] + h * k3[0], y[1] + h * k3[1])
        y = [v + h / 6 * (a + 2 * b + 2 * c + d) for v, a, b, c, d in zip(y, k1, k2, k3, k4)]
    return y[0], y[2], y[3]


@functools.lru_cache(maxsize=None)
def hanging(gamma):
    """(drop, reach) over the length: by bisection, the least steepness of the tip for which the clamp is horizontal."""
    high = math.log(1e-30)
    while from_tip(gamma, math.exp(high))[0] < math.pi / 2:
        high += 2
    low = high - 2
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if from_tip(gamma, math.exp(middle))[0] < math.pi / 2 else (low, middle)
    return from_tip(gamma, math.exp(low))[1:]


def clamped_strip(length, along, material, cells="quads", step=None):
    """A strip that is held by its first two columns of vertices. A bend between two segments belongs to the vertex
    between them, so the segment that is held stays horizontal in its middle: there the elastica is clamped, and
    `length` begins. Settles by damping with its mass."""
    spacing = length / (along - 1.5)
    return {"cloth": {"grid": {"size": [(along - 1) * spacing, 2 * spacing], "vertices": [along, 3], "cells": cells},
                      "material": {"density": DENSITY, "damping": {"mass": 2 * math.sqrt(2 * G / length)}, **material}},
            "pins": [{"box": {"min": [-1, -1, -1], "max": [1.01 * spacing, 1, 1]}}],
            "inextensibility": {"strain": 0.01},
            "time": steps_of(20 * math.sqrt(length / G), step or 0.1 * math.sqrt(length / G))}


def hangs(laboratory, case):
    """Drop and reach of the middle of its tip, m."""
    run = laboratory.whole_run(case)
    along = case["cloth"]["grid"]["vertices"][0]
    spacing = case["cloth"]["grid"]["size"][0] / (along - 1)
    x, _, z = run.frames[-1].positions.reshape(3, along, 3)[1, -1]
    return {"drop_m": -z, "reach_m": x - spacing / 2, "kinetic_J": run.steps["kinetic_J"][-1]}
