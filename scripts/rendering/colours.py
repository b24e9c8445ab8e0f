"""Colours of a field, and the bar that explains them."""
import numpy as np
from paraview import simple

# Every strain is a pure number, "-".
UNITS = {"tension": "N", "velocity": "m/s", "speed": "m/s", "reaction": "N", "clearance": "m", "gap": "m"}
PALETTE = ["#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#ee8866", "#999933"]
NAMED = ["owner_rank", "panel", "seam"]  # whose values are numbers of something
UNNAMED = "seam"  # too many, and too long of name, for a bar beside the picture
INK = [0.15, 0.15, 0.18]


def scaled(pixels, options):
    return max(1, round(pixels * options.size[1] / 900))  # no line is of no width


def bar_room(options):
    """The part of the picture's width that the colour bar and its text take; names of panels are long."""
    return (0.3 if options.color == "panel" else 0.18) * options.size[1] / options.size[0]


def colour_by_number(lut, low, high, chosen):
    if chosen:
        low, high = chosen
    elif low < 0 < high:
        low, high = -max(-low, high), max(-low, high)
    if low == high:
        high = low + (abs(low) or 1.0) * 1e-3
    lut.ApplyPreset("Cool to Warm" if low == -high else "Viridis (matplotlib)", True)
    lut.RescaleTransferFunction(low, high)


def colour_by_name(lut, numbers, names):
    """A colour for each number; of more numbers than colours some share one."""
    lut.InterpretValuesAsCategories = 1
    lut.Annotations = [text for number in numbers for text in (str(number), names.get(number, str(number)))]
    colours = [PALETTE[number % len(PALETTE)] for number in numbers]
    lut.IndexedColors = [int(colour[i:i + 2], 16) / 255 for colour in colours for i in (1, 3, 5)]


def dress(bar, name, options):
    unit = "-" if "strain" in name else UNITS.get(name)
    bar.Title = name.replace("_", " ") + (f" ({unit})" if unit else "")
    bar.ComponentTitle = ""
    bar.TitleColor = bar.LabelColor = INK
    bar.TitleFontSize, bar.LabelFontSize = scaled(20, options), scaled(18, options)
    bar.AutomaticLabelFormat = 0
    bar.LabelFormat = bar.RangeLabelFormat = "%-#.3g"
    bar.TextPosition = "Ticks left/bottom, annotations right/top" if name in NAMED else \
        "Ticks right/top, annotations left/bottom"
    bar.WindowLocation = "Any Location"
    title_left = 0.045 * options.size[1] / options.size[0] if name in NAMED else 0.0
    bar.Position = [1.0 - bar_room(options) + title_left, 0.25]
    bar.ScalarBarLength, bar.ScalarBarThickness = 0.5, scaled(20, options)


def colour(view, parts, field, times, options):
    """The same colours mean the same values at all `times`."""
    for part in parts:
        simple.ColorBy(part, (field.kind, field.name))
        # between ranks 0 and 2 there is no rank 1
        part.InterpolateScalarsBeforeMapping = int(field.name not in NAMED)
    lut = simple.GetColorTransferFunction(field.name)
    if field.name in NAMED:
        colour_by_name(lut, [int(number) for number in np.unique(field.values(times[-1]))], field.names())
    else:
        ends = [(float(v.min()), float(v.max())) for v in map(field.values, times)]
        colour_by_number(lut, min(low for low, _ in ends), max(high for _, high in ends), options.range)
    dress(simple.GetScalarBar(lut, view), field.name, options)
    parts[0].SetScalarBarVisibility(view, field.name != UNNAMED)
