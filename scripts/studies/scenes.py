"""The scenes of the studies, as dicts of a case."""
from taut import read_case
from taut.launch import find_case


def drape(vertices, end, step, **inextensibility):
    """cases/drape on vertices x vertices."""
    case = read_case(find_case("drape"))
    case["cloth"]["grid"]["vertices"] = [vertices, vertices]
    case["time"] = {"end": end, "frame_rate": 20, "max_step": step}
    case["inextensibility"] = inextensibility
    return case


def sphere(vertices, end):
    """cases/sphere on vertices x vertices, every step tested for intersections."""
    case = read_case(find_case("sphere"))
    case["cloth"]["grid"]["vertices"] = [vertices, vertices]
    case["time"]["end"] = end
    case["contact"] = {**case.get("contact", {}), "check": "step"}
    return case


def chain(vertices, step, **inextensibility):
    """Resists stretching but not bending; 1 m and 0.1 kg, let go from the horizontal [G07 figure 4]."""
    return {"name": "chain", "cloth": {"line": {"length": 1, "vertices": vertices},
                                       "material": {"density": 0.1, "bending": 0, "shear": 0}},
            "pins": [{"vertices": [0]}], "time": {"end": 1, "frame_rate": 1, "max_step": step},
            "inextensibility": inextensibility}


WEIGHT_OF_CHAIN = 0.1 * 9.81  # N
