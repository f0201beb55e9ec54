"""Measures if the uncertainties of peak pressure, width and area hold: twenty parts to design them on, and twenty to check them.

    cargo build --release
    target/venv/bin/python reference/uncertainty.py [--design] [--signorini PATH] FOLDER [NAME ...]

Every part is meshed with the real Gmsh at its element size h and at h/4, with linear and with quadratic elements (T3, T6, Tet4, Tet10),
and solved by the program. A line compares what the program prints at h with its value at h/4. Without `--design` the parts are those
that were not looked at when the estimates were designed. In space the size far from the contact is refined to a half only. Lengths are in
mm, forces in N. Meshes and answers stay in FOLDER; what is there is not made again. meshes.py names the libraries that Gmsh needs.
"""

import functools
import json
import pathlib
import statistics
import subprocess
import sys
from dataclasses import dataclass

import gmsh

import parts
from parts import AXIS, CLAMPED, NORMAL, RUBBER, STEEL, about, by_name, held, load, named, obstacle, occ, polygon, scene, sector

ROOT = pathlib.Path(__file__).resolve().parent.parent
FINER = 4
"""The element size at the contact is divided by this."""
FAR = {2: 4, 3: 2}
"""The element size far from the contact is divided by this, for each dimension."""
MUST = 0.9
"""Share of the printed uncertainties that must hold."""


def graded(fine, coarse, near, far, distance):
    """Sets the size to `fine` up to the distance `near` from the contact, and to `coarse` beyond `far`, on both meshes."""
    share = FINER / FAR[gmsh.model.getDimension()] if parts.COARSER == 1 / FINER else 1
    parts.graded(fine, coarse * share, near, far, distance)


def regraded(part, *sizes):
    """Returns a part of `parts` with other element sizes."""

    @functools.wraps(part)
    def sized():
        made = part()
        graded(*sizes)
        return made

    return sized


def pin():
    """Half a plate whose hole is pulled onto a pin."""
    plate = [(2, occ.addRectangle(-30, -20, 0, 60, 20))]
    occ.cut(plate, [(2, occ.addDisk(0, 0, 0, 8, 8))])
    named(middle="y", right="x - 30", hole="hypot(x, y) - 8")
    graded(0.6, 3, 3, 15, "hypot(x + 8, y)")
    bolt = obstacle(NORMAL, "hole", "+x", circle={"centre": [-0.02, 0], "radius": 7.98})
    return scene(STEEL, [held("y", on="middle")], [bolt], [load("traction", "right", [60, 0])], model="plane-stress", thickness=5)


def cylinder():
    """Half of the lower half of a cylinder that is pressed onto a plane."""
    occ.intersect([(2, occ.addDisk(0, 10, 0, 10, 10))], [(2, occ.addRectangle(0, 0, 0, 10, 10))])
    named(middle="x", cut="y - 10", arc="hypot(x, y - 10) - 10")
    graded(0.06, 1.5, 0.6, 8, "hypot(x, y)")
    plane = obstacle(AXIS, "arc", "-y", plane={"point": [0, 0], "normal": [0, -1]})
    return scene(STEEL, [held("x", on="middle"), held("y", on="cut", y=-0.02)], [plane], model="plane-strain")


def punch():
    """Half a block that a flat punch with sharp edges presses."""
    polygon((0, 0), (30, 0), (30, 20), (5, 20), (0, 20))
    named(middle="x", bottom="y", top="y - 20")
    graded(0.5, 3, 7, 20, "hypot(x, y - 20)")
    flat = obstacle(AXIS, "top", "+y", table={"points": [[-1, 20], [5, 20], [5.001, 25], [30, 26]]})
    return scene(STEEL, [held("x", on="middle"), held("x", "y", on="bottom")], [flat], gap=-0.02, model="plane-strain")


def press_fit():
    """A shaft that a rigid hub of finite length squeezes: the shaft goes on beyond the ends of its seat."""
    polygon((0, 0), (20, 0), (20, 20), (20, 40), (20, 60), (0, 60))
    named(bottom="y", seat="x - 20 if 20 < y < 40 else 1")
    graded(1, 4, 3, 12, "hypot(x - 20, max(0, abs(y - 30) - 10))")
    hub = obstacle(AXIS, "seat", "+x", plane={"point": [20, 0], "normal": [1, 0]})
    return scene(STEEL, [held("y", on="bottom")], [hub], gap=-0.02, model="axisymmetric")


def ball():
    """A quarter of the lower half of a ball that is pressed onto a plane."""
    occ.intersect([(3, occ.addSphere(0, 0, 10, 10))], [(3, occ.addBox(0, 0, 0, 10, 10, 10))])
    named(left="x", front="y", cut="z - 10", round="hypot(x, y, z - 10) - 10")
    graded(0.16, 2.4, 0.9, 8, "hypot(x, y, z)")
    plane = obstacle(AXIS, "round", "-z", plane={"point": [0, 0, 0], "normal": [0, 0, -1]})
    return scene(STEEL, [held("x", on="left"), held("y", on="front"), held("z", on="cut", z=-0.06)], [plane])


def roller():
    """A quarter of a roller that is pressed onto a plane."""
    occ.intersect([(3, occ.addCylinder(0, 0, 10, 0, 4, 0, 10))], [(3, occ.addBox(0, 0, 0, 10, 4, 10))])
    named(middle="x", front="y", cut="z - 10", round="hypot(x, z - 10) - 10")
    graded(0.2, 2, 0.6, 8, "hypot(x, z)")
    plane = obstacle(AXIS, "round", "-z", plane={"point": [0, 0, 0], "normal": [0, 0, -1]})
    return scene(STEEL, [held("x", on="middle"), held("y", on="front"), held("x", on="cut", z=-0.06)], [plane])


def clip():
    """Half a clip that is widened by a thick pin."""
    sector(10, 14, -50, 90)
    named(middle="x", inside="hypot(x, y) - 10")
    graded(0.35, 2, 4, 20, "hypot(x - 10, y)")
    bolt = obstacle(NORMAL, "inside", "-x", circle={"centre": [-0.05, 0], "radius": 10.2})
    supports = [held("x", on="middle"), {"on": {"point": [0, 14]}, "y": 0}]
    return scene(STEEL, supports, [bolt], thickness=2, model="plane-stress")


def hub():
    """A hub on a longer rigid shaft: the contact ends at the faces of the hub."""
    polygon((20, 0), (35, 0), (35, 12), (26, 12), (26, 30), (20, 30))
    named(bottom="y", bore="x - 20", rim="x - 35")
    graded(1, 3, 2, 12, "hypot(x - 20, y - 15) - 15")
    shaft = obstacle(AXIS, "bore", "-x", plane={"point": [20, 0], "normal": [-1, 0]})
    return scene(STEEL, [held("y", on="bottom")], [shaft], gap=-0.02, model="axisymmetric")


def ring():
    """Half the section of a seal ring that a plate presses into its groove."""
    occ.intersect([(2, occ.addDisk(20, 0, 0, 2, 2))], [(2, occ.addRectangle(17, 0, 0, 6, 3))])
    named(middle="y", round="hypot(x - 20, y) - 2")
    graded(0.2, 0.5, 0.8, 2, "hypot(x - 20, y - 2)")
    plate = obstacle(AXIS, "round", "+y", plane={"point": [20, 2], "normal": [0, 1]})
    wall = obstacle(AXIS, "round", "+x", plane={"point": [22.1, 0], "normal": [1, 0]})
    return scene(RUBBER, [held("y", on="middle")], [plate, wall], gap=-0.2, model="axisymmetric")


def beam():
    """Half a rubber beam that is pressed at its end onto a round support at its centre."""
    occ.addBox(0, 0, 0, 60, 10, 10)
    named(middle="x", end="x - 60", front="y", bottom="z")
    graded(0.9, 6, 4, 30, "hypot(x, z)")
    support = obstacle(AXIS, "bottom", "-z", cylinder={"axis": [0, 1, 0], "apex": [0, 0, 0], "radius": 60})
    supports = [held("x", on="middle"), held("y", on="front"), held("y", on="end", z=-1.2)]
    return scene(RUBBER, supports, [support])


def thick_plate():
    """A quarter of a thick plate under a ball, clamped at its edges."""
    occ.addBox(0, 0, 0, 30, 30, 12)
    named(left="x", front="y", edges="(x - 30) * (y - 30)", top="z - 12")
    graded(0.35, 6, 2, 25, "hypot(x, y, z - 12)")
    sphere = obstacle(AXIS, "top", "+z", sphere={"apex": [0, 0, 12], "radius": 40})
    return scene(STEEL, [held("x", on="left"), held("y", on="front"), held(*CLAMPED, on="edges")], [sphere], gap=-0.08)


def bearing():
    """A sector of the outer ring of a bearing, pressed onto a roller. Its ends are planes of symmetry."""
    sector(40, 50, 80, 90, 8)
    (x, y), ends = about(1, 80), {"start": "x * sin(radians(80)) - y * cos(radians(80))", "end": "x"}
    named(**ends, front="z", inside="hypot(x, y) - 40", outside="hypot(x, y) - 50")
    graded(0.3, 4, 0.7, 8, "hypot(x, y - 40)")
    roller = obstacle(NORMAL, "inside", "-y", cylinder={"axis": [0, 0, 1], "centre": [0, 35, 0], "radius": 5})
    supports = [held(on="start", normal=[y, -x, 0], value=0), held("x", on="end"), held("z", on="front")]
    return scene(STEEL, supports, [roller], [load("pressure", "outside", 40)])


DESIGN = by_name(
    pin,
    cylinder,
    regraded(parts.seal, 0.09, 0.8, 0.6, 3, "hypot(x - 19.5, y - 2.5)"),
    punch,
    regraded(parts.gear_tooth, 0.09, 1.2, 0.7, 5, "hypot(x - {} + 17, y - {})".format(*about(22, 15))),
    press_fit,
    ball,
    regraded(parts.cup, 0.45, 3.5, 2, 12, "hypot(x, y, z - 6)"),
    roller,
    regraded(parts.lug, 1.2, 4, 3, 20, "hypot(x + 10, y)"),
)
CHECK = by_name(
    clip,
    regraded(parts.half_space, 0.15, 5, 2, 30, "hypot(x, y)"),
    hub,
    regraded(parts.layered_strip, 0.6, 4, 20, 40, "x"),
    ring,
    regraded(parts.dovetail, 0.5, 2, 4, 12, "hypot(x - 6.2, y - 5)"),
    regraded(parts.rail, 0.6, 9, 3, 30, "hypot(x, y, z)"),
    beam,
    thick_plate,
    bearing,
)


@dataclass
class Quantity:
    """A value that the program prints, with its uncertainty; `None` if it prints none."""

    value: float
    uncertainty: float | None


def solved(program, part, folder, name, order, finer):
    """Returns the report of a part on one mesh."""
    stem = folder / f"{name}-{order}-{finer}"
    if not stem.with_suffix(".json").exists():
        parts.COARSER = 1 / finer
        parts.write(part, stem.with_suffix(".msh"), order)
    out = folder / f"{stem.name}-out"
    if not (out / "report.json").exists():
        command = [program, "solve", stem.with_suffix(".json"), "--no-proof", "--pictures", "none", "--out", out, "--quiet"]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            raise SystemExit(f"{stem.name}: {done.stderr or done.stdout}")
    return json.loads((out / "report.json").read_text())


def quantities(report):
    """Returns the printed quantities of a contact by their names."""
    contact, estimate = report["contact"], report["contact"]["estimate"]
    extent = "width" if "width" in estimate else "area"
    return {
        "peak": Quantity(contact["pressure_max"], estimate.get("pressure_uncertainty")),
        extent: Quantity(estimate[extent], estimate.get(f"{extent}_uncertainty")),
    }


def main(program, chosen, folder):
    folder.mkdir(parents=True, exist_ok=True)
    found = {"peak": [], "width": [], "area": []}
    print(f"{'part':14} {'element':7} {'closed':>6} {'':6} {'at h':>10} {'± of it':>8} {'at h/4':>10} {'off by':>8}  holds  warned")
    for name, part in chosen.items():
        for order in (1, 2):
            coarse, fine = (solved(program, part, folder, name, order, finer) for finer in (1, FINER))
            element = (("T3", "T6") if "width" in coarse["contact"]["estimate"] else ("Tet4", "Tet10"))[order - 1]
            warned = any(warning["code"] == "mesh-dependent" for warning in coarse.get("warnings", []))
            others = quantities(fine)
            for quantity, ours in quantities(coarse).items():
                exact, written, verdict = others[quantity].value, "-", "-"
                off = ours.value / exact - 1
                if ours.uncertainty is not None:
                    share = ours.uncertainty / ours.value
                    holds = abs(ours.value - exact) <= ours.uncertainty + 1e-9 * exact
                    found[quantity].append((holds, share))
                    written, verdict = f"{100 * share:.1f} %", "yes" if holds else "NO"
                print(
                    f"{name:14} {element:7} {coarse['contact']['count']:6} {quantity:6} {ours.value:10.4g} {written:>8} "
                    f"{exact:10.4g} {100 * off:6.1f} %  {verdict:5}  {'yes' if warned else ''}",
                    flush=True,
                )
    failed = False
    for quantity, all_of in found.items():
        if all_of:
            held_by, median = sum(holds for holds, _ in all_of), statistics.median(share for _, share in all_of)
            print(f"{quantity}: {held_by} of {len(all_of)} hold; median of the uncertainty over the value {100 * median:.1f} %")
            failed |= held_by < MUST * len(all_of)
    return int(failed)


if __name__ == "__main__":
    arguments, program, chosen = sys.argv[1:], ROOT / "target/release/signorini", CHECK
    if arguments[:1] == ["--design"]:
        chosen, arguments = DESIGN, arguments[1:]
    if arguments[:1] == ["--signorini"]:
        program, arguments = arguments[1], arguments[2:]
    if not arguments:
        sys.exit("usage: uncertainty.py [--design] [--signorini PATH] FOLDER [NAME ...]")
    if arguments[1:]:
        chosen = {name: chosen[name] for name in arguments[1:]}
    sys.exit(main(program, chosen, pathlib.Path(arguments[0])))
