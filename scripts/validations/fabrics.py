"""The named fabrics, as the program knows them."""
NAMES = ["cotton", "wool", "silk", "canvas", "denim", "polyester", "polycotton", "interlock", "ponte"]


def bending_and_density(laboratory, name):
    """N m and kg/m^2."""
    run = laboratory.whole_run({"cloth": {"grid": {"size": [1, 1], "vertices": [2, 2]}, "fabric": name},
                                "time": {"end": 0.01}})
    material = run.case["cloth"]["material"]
    return float(material["bending"]), float(material["density"])
