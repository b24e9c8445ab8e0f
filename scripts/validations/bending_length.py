"""ASTM D1388 on the named fabrics: the overhang at which a strip reaches down by 41.5 degrees; half of it is the
bending length."""
import math

from validations import cases, elastica, fabrics
from validations.cases import G
from validations.checks import Check

ABOUT = ("The cantilever test of ASTM D1388 on the named fabrics, against the bending length that their own numbers "
         "make.")
KEYS = ["fabric", "overhang_ratio"]
ANGLE = 41.5  # degrees
ALONG = 41


def plan(quick):
    names = ("cotton", "denim") if quick else fabrics.NAMES
    return cases.points(KEYS, *((name, ratio) for name in names for ratio in (0.97, 1.03)))


def expected_length(laboratory, name):
    """c = (B / w)^(1/3), w the weight per area [Peirce 1930]."""
    bending, density = fabrics.bending_and_density(laboratory, name)
    return (bending / (density * G)) ** (1 / 3)


def measure(laboratory, point):
    """With an overhang of so much times 2 c."""
    c = expected_length(laboratory, point["fabric"])
    overhang = 2 * c * point["overhang_ratio"]
    bending, density = fabrics.bending_and_density(laboratory, point["fabric"])
    case = elastica.clamped_strip(overhang, ALONG, {})
    case["cloth"]["fabric"] = point["fabric"]
    del case["cloth"]["material"]["density"]
    found = elastica.hangs(laboratory, case)
    return {"bending_Nm": bending, "density_kg_m2": density, "expected_c_m": c, "overhang_m": overhang, **found}


def angle(row):
    return math.degrees(math.atan2(row["drop_m"], row["reach_m"]))


def bending_length(rows, name):
    """Half the overhang at 41.5 degrees, on the line through the two that were tried."""
    a, b = cases.of(rows, fabric=name)
    return (a["overhang_m"] + (ANGLE - angle(a)) / (angle(b) - angle(a)) * (b["overhang_m"] - a["overhang_m"])) / 2


def judge(rows):
    return [Check(f"bending length, {name}", "mm", 1000 * cases.of(rows, fabric=name)[0]["expected_c_m"],
                  10 * cases.of(rows, fabric=name)[0]["expected_c_m"], 1000 * bending_length(rows, name),
                  "c = (B / w)^(1/3) of the fabric's own B and w (Peirce, ASTM D1388); 1 %")
            for name in cases.values(rows, "fabric")]


def draw(axes, rows):
    checks = judge(rows)
    axes.plot([0, 1.05 * max(check.expected for check in checks)], [0, 1.05 * max(check.expected for check in checks)],
              color="0.6")
    axes.plot([check.expected for check in checks], [check.measured for check in checks], "o")
    for check in checks:
        axes.annotate(check.quantity.split(", ")[1], (check.expected, check.measured), xytext=(5, -8),
                      textcoords="offset points", fontsize=8)
    axes.set_xlabel("(B / w)^(1/3), mm")
    axes.set_ylabel("half the overhang at 41.5 degrees, mm")
