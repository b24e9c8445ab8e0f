"""The named fabrics, as the program knows them."""
import re
import subprocess

NAMES = ["silk", "habotai", "crepe", "cotton", "poplin", "wool", "tropical", "flannel", "denim", "canvas", "flag",
         "polyester", "polycotton", "interlock", "ponte"]


def drapes(program):
    """What `taut fabrics` says of each: the drape coefficient it has, and the band published (or None), %."""
    table = subprocess.run([program, "fabrics"], check=True, capture_output=True, text=True).stdout
    rows = [[cell.strip() for cell in line.split("|")[1:-1]] for line in table.splitlines() if "| `" in line]
    return {row[0].strip("`"): (float(row[5]), [float(bound) for bound in re.findall(r"\d+", row[6])] or None)
            for row in rows}


def bending_and_density(laboratory, name):
    """N m and kg/m^2."""
    run = laboratory.whole_run({"cloth": {"grid": {"size": [1, 1], "vertices": [2, 2]}, "fabric": name},
                                "time": {"end": 0.01}})
    material = run.case["cloth"]["material"]
    return float(material["bending"]), float(material["density"])
