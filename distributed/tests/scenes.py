"""Scenes of the tests, as `signorini export` reads them."""

MATERIAL = {"young": 1e7, "poisson": 0.3}


def axis(divisions):
    return {"points": [0, 1], "divisions": [divisions]}


def box(divisions, element="hex8"):
    return {"box": {"x": axis(divisions), "y": axis(divisions), "z": axis(divisions), "element": element}}


def plane(boundary, approach, normal, point=(0, 0, 0), **more):
    return {"boundary": boundary, "approach": approach, "shape": {"plane": {"point": list(point), "normal": normal}}} | more


ROLLERS = [{"on": {"boundary": "left"}, "x": 0}, {"on": {"boundary": "front"}, "y": 0}]
FLOOR = [{"on": {"boundary": "bottom"}, "z": 0}]
CLAMPED = [{"on": {"boundary": "bottom"}, "x": 0, "y": 0, "z": 0}]
SPHERE = {"boundary": "top", "approach": "+z", "rule": "approach", "shape": {"sphere": {"apex": [0.5, 0.5, 1], "radius": 2}}}
PRESSED = [{"traction": {"boundary": "top", "value": [-2e4, -3e4, -1e5]}}]


def scene(body, supports, obstacles, **more):
    return {"model": "space", "body": body, "material": MATERIAL, "supports": supports, "obstacles": obstacles} | more


def pressed_by_sphere(divisions, element="hex8"):
    return scene(box(divisions, element), CLAMPED, [SPHERE], gap=-0.01)


def on_rollers():
    return scene(box(6), ROLLERS + FLOOR, [SPHERE], gap=-0.01)


def under_inclined_plane(divisions=6):
    inclined = plane("top", "+z", [0.05, 0.02, 1], (0.5, 0.5, 1), rule="closest-point")
    return scene(box(divisions), ROLLERS + FLOOR, [inclined], gap=-0.01, loads=PRESSED)


def on_an_inclined_support():
    supports = ROLLERS + [{"on": {"boundary": "bottom"}, "normal": [0, 0.3, 1]}]
    return scene(box(5), supports[:1] + supports[2:] + [{"on": {"point": [0, 0, 0]}, "y": 0}], [SPHERE], gap=-0.01)


def pressed_against_a_plane():
    loads = [{"traction": {"boundary": "top", "value": [2e4, 3e4, 1e5]}}]
    return scene(box(4), CLAMPED, [plane("top", "+z", [0, 0, 1], (0, 0, 1))], loads=loads)


def a_stiff_and_a_soft_body():
    """Two blocks that nothing couples; the second one has a 1e5th of the stiffness."""
    soft = box(4)
    soft["box"]["x"] = {"points": [2, 3], "divisions": [4]}
    sphere = {"sphere": {"apex": [2.5, 0.5, 1], "radius": 2}}
    return scene(box(5), CLAMPED + [{"on": {"boundary": "soft.bottom"}, "x": 0, "y": 0, "z": 0}],
                 [SPHERE, SPHERE | {"boundary": "soft.top", "shape": sphere}], gap=-0.01) | {
        "further-bodies": [{"name": "soft", "body": soft, "material": {"young": 1e2, "poisson": 0.3}}]}


def held_by_contact():
    """A box without supports, which a load pushes into the corner of three walls."""
    walls = [plane("bottom", "-z", [0, 0, -1]), plane("left", "-x", [-1, 0, 0]), plane("front", "-y", [0, -1, 0])]
    return scene(box(5), [], walls, loads=PRESSED)


def sheared_under_a_plane():
    """A box under a plane, one edge of whose top moves up towards the plane while the other moves down."""
    loads = [{"traction": {"boundary": "top", "value": [-2e5, 0, 0]}}]
    return scene(box(5), CLAMPED, [plane("top", "+z", [0, 0, 1], (0, 0, 1.002))], loads=loads)


def quarter_ball():
    zone = {"width": 0.11, "divisions": 4, "growth": 2.0}
    supports = [{"on": {"boundary": "cut"}, "z": -0.01}, {"on": {"boundary": "symmetry-x"}, "x": 0},
                {"on": {"boundary": "symmetry-y"}, "y": 0}]
    obstacle = plane("round", "-z", [0, 0, -1], (0, 0, -1))
    return scene({"half-ball": {"radius": 1, "symmetric": ["x", "y"], "zone": zone}}, supports, [obstacle])


def in_the_plane():
    body = {"rectangle": {"x": {"points": [0, 1], "divisions": [20]}, "y": {"points": [0, 0.5], "divisions": [10]}, "element": "t3"}}
    obstacle = {"boundary": "top", "approach": "+y", "rule": "closest-point",
                "shape": {"plane": {"point": [0.5, 0.5], "normal": [0.05, 1]}}}
    supports = [{"on": {"boundary": "bottom"}, "x": 0, "y": 0}]
    return scene(body, supports, [obstacle], gap=-0.005) | {"model": "plane-strain"}


def between_two_bodies():
    base = {"rectangle": {"x": {"points": [0, 1], "divisions": [4]}, "y": {"points": [-1, 0], "divisions": [4]}}}
    block = {"rectangle": {"x": {"points": [0, 1], "divisions": [4]}, "y": {"points": [0, 1], "divisions": [4]}}}
    return {
        "model": "plane-strain", "body": block, "material": MATERIAL,
        "further-bodies": [{"name": "base", "body": base, "material": MATERIAL}],
        "supports": [{"on": {"boundary": "base.bottom"}, "x": 0, "y": 0}, {"on": {"boundary": "left"}, "x": 0}],
        "loads": [{"traction": {"boundary": "top", "value": [0, -1e5]}}],
        "obstacles": [{"boundary": "bottom", "approach": "-y", "shape": {"body": {"boundary": "base.top"}}}],
    }


def under_two_inclined_planes():
    planes = [plane("top", "+z", [slope, 0, 1], (0.5, 0.5, 1), rule="closest-point") for slope in (0.05, -0.05)]
    return scene(box(3), CLAMPED, planes, gap=-0.005)
