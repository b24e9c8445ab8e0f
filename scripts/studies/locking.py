"""One drape on quads, on triangles by all their edges, and on triangles by warp and weft averaged at vertices: which of
them keep the cloth from folding."""
from studies import scenes
from studies.experiment import rms

MESHES = {"quads": ("quads", "edges"), "triangles by edges": ("alternating_triangles", "edges"),
          "triangles by vertices": ("alternating_triangles", "vertices"),
          "triangles of one diagonal by vertices": ("triangles", "vertices")}
ABOUT = ("triangles lock if all edges keep their lengths (small steps, little motion), not if warp and weft averaged "
         "at vertices do.")
KEYS = ["mesh", "vertices_a_side", "end_s", "max_step_s"]


def plan(quick):
    sides, end = ([11], 0.3) if quick else ([21, 41, 71], 0.6)
    return [dict(zip(KEYS, (mesh, side, end, 0.005))) for side in sides for mesh in MESHES]


def scene(point, mesh):
    cells, constrain = MESHES[mesh]
    case = scenes.drape(int(point["vertices_a_side"]), point["end_s"], point["max_step_s"], constrain=constrain,
                        strain=0.01)
    case["cloth"]["grid"]["cells"] = cells
    return case


def measure(laboratory, point):
    run, quads = laboratory.run(scene(point, point["mesh"])), laboratory.run(scene(point, "quads"))
    row = run.measures()
    if run.completed and quads.completed:
        row["rms_to_quads_m"] = rms(run.frames[-1].positions, quads.frames[-1].positions)
    if run.summary and run.summary["strain"]["faces_max"] is not None:
        row["face_strain"] = run.summary["strain"]["faces_max"]
    return row


def of_mesh(rows, mesh):
    return [row for row in rows if row["mesh"] == mesh]


def draw(axes, rows):
    for mesh in MESHES:
        found = of_mesh(rows, mesh)
        line, = axes.semilogy([row["vertices_a_side"] for row in found],
                              [(row["steps"] + row["rejected"]) / row["simulated_s"] for row in found],
                              "o-", label=mesh)
        stopped = [row for row in found if row["status"] != "completed"]
        axes.plot([row["vertices_a_side"] for row in stopped], [(row["steps"] + row["rejected"]) / row["simulated_s"]
                                                                for row in stopped], "o",
                  color=line.get_color(), markerfacecolor="white")
    axes.set_xlabel("vertices a side")
    axes.set_ylabel("steps tried per simulated second")
    axes.legend(fontsize="small")


def told(row):
    text = (f"{row['mesh']}, {row['vertices_a_side']:g} a side: {row['status']} at {row['simulated_s']:g} s, "
            f"{row['steps']:g} steps, "
            f"{row['rejected']:g} rejected, strain {100 * row['strain_had']:.2f} %")
    if row.get("face_strain") not in (None, ""):
        text += f" (of single triangles {100 * row['face_strain']:.2f} %)"
    if row["status"] == "completed":
        text += f", depth {row['depth_m']:.3f} m, RMS distance to quads {1000 * row['rms_to_quads_m']:.0f} mm"
    return text


def judge(rows):
    """By vertices no more than twice the steps of quads, and by edges more; and where both came to the end, by edges
    farther from the quads."""
    def steps(mesh):
        return {row["vertices_a_side"]: (row["steps"] + row["rejected"]) / row["simulated_s"]
                for row in of_mesh(rows, mesh)}

    quads = steps("quads")
    locked = all(count > 2 * quads[side] for side, count in steps("triangles by edges").items())
    free = all(count < 2 * quads[side] for mesh in MESHES if mesh.endswith("by vertices")
               for side, count in steps(mesh).items())
    away = {(row["mesh"], row["vertices_a_side"]): row["rms_to_quads_m"] for row in rows
            if row["status"] == "completed"}
    farther = all(d > away["triangles by vertices", side] for (mesh, side), d in away.items()
                  if mesh == "triangles by edges")
    return locked and free and farther, "\n".join(map(told, rows))
