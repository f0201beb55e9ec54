"""Rows between surfaces with their own meshes: exact fractions, a uniform pressure in space, and arguments that are refused."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import FrozenInstanceError
from typing import Any

import numpy as np
import pytest
import signorini as sg
import skfem
from scipy import sparse
from skfem.models.elasticity import lame_parameters, linear_elasticity

# The lower side of an upper body, whose edges run to the right, and the upper side of a lower body, whose edges run to the left.
UPPER = (np.array([[0.0, 0.1], [1.0, 0.1]]), np.array([[0, 1]]))
LOWER = (np.array([[0.0, 0.0], [0.5, 0.0], [1.0, 0.0]]), np.array([[2, 1], [1, 0]]))

# The same in space: counterclockwise from below, and counterclockwise from above.
SQUARE = (np.array([[0.0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]]), np.array([[0, 1, 2, 3]]))
FOUR = (
    np.array([[x, y, 0.75] for y in (0.0, 0.5, 1.0) for x in (0.0, 0.5, 1.0)]),
    np.array([[k, k + 1, k + 4, k + 3] for k in (0, 1, 3, 4)]),
)

# Rounding of the integrals.
ROUNDING = 1e-14

# Rounding of a solve with some hundred unknowns, relative to the largest value.
SOLVED = 1e-11


def test_an_edge_against_two_halves_has_exact_fractions() -> None:
    rows = sg.mortar_rows(UPPER, LOWER, thickness=3.0)
    assert rows.B.shape == (2, 10) and rows.nodes.tolist() == [0, 1]
    expected = np.zeros((2, 10))
    # Along -y: minus the motion of the own node, plus a mean of the others.
    expected[0, 1], expected[0, [5, 7, 9]] = -1, [3 / 4, 1 / 2, -1 / 4]
    expected[1, 3], expected[1, [5, 7, 9]] = -1, [-1 / 4, 1 / 2, 3 / 4]
    assert np.abs(rows.B.toarray() - expected).max() < ROUNDING
    assert np.allclose(rows.g, 0.1, rtol=ROUNDING) and np.allclose(rows.area, 1.5, rtol=ROUNDING)
    assert np.abs(rows.normals - [0.0, -1.0]).max() < ROUNDING


def test_a_square_against_four_has_the_products_of_these_fractions() -> None:
    rows = sg.mortar_rows(SQUARE, FOUR, model="space")
    assert rows.B.shape == (4, 39) and rows.nodes.tolist() == [0, 1, 2, 3]
    of_master = rows.B.toarray()[0].reshape(13, 3)[4:, 2]
    assert np.abs(of_master - np.array([9, 6, -3, 6, 4, -2, -3, -2, 1]) / 16).max() < ROUNDING
    assert np.allclose(rows.g, 0.25, rtol=ROUNDING) and np.allclose(rows.area, 0.25, rtol=ROUNDING)
    assert np.abs(rows.normals - [0.0, 0.0, -1.0]).max() < ROUNDING


def test_an_area_about_the_axis_is_that_of_the_full_circle() -> None:
    rows = sg.mortar_rows(UPPER, LOWER, model="axisymmetric")
    assert abs(rows.area.sum() - np.pi) < ROUNDING * np.pi and rows.area[0] < rows.area[1]


def test_a_kind_may_be_named_and_a_quadratic_edge_has_three_columns() -> None:
    named = sg.mortar_rows((*UPPER, "Line2"), (*LOWER, "Line2"), model="plane-stress")
    assert np.array_equal(named.B.toarray(), sg.mortar_rows(UPPER, LOWER).B.toarray())
    curved = (np.array([[0.0, 0.1], [1.0, 0.1], [0.5, 0.1]]), np.array([[0, 1, 2]]))
    rows = sg.mortar_rows(curved, LOWER)
    # The area of a quadratic edge: a sixth at the ends, two thirds in the middle.
    assert np.abs(rows.area - np.array([1, 1, 4]) / 6).max() < ROUNDING


def test_a_direction_of_any_length_gives_the_rows_their_normal_and_reach_leaves_far_places_out() -> None:
    rows = sg.mortar_rows(UPPER, LOWER, direction=[0.0, -7.0], reach=0.2)
    assert np.array_equal(rows.normals, [[0.0, -1.0]] * 2)
    none = sg.mortar_rows(UPPER, LOWER, reach=0.05)
    assert none.B.shape == (0, 10) and none.g.size == none.area.size == 0 and none.normals.shape == (0, 2)


def test_rows_are_frozen() -> None:
    rows = sg.mortar_rows(UPPER, LOWER)
    assert repr(rows) == "<signorini.MortarRows: 2 rows, 10 unknowns>"
    with pytest.raises(FrozenInstanceError):
        rows.g = rows.area  # type: ignore[misc]
    with pytest.raises(ValueError):
        rows.g[0] = 1.0


def outside(mesh: Any, height: float, upwards: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The nodes of a horizontal side of a mesh in space, its facets counterclockwise from outside, and the numbers of the nodes."""
    facets = mesh.facets[:, mesh.facets_satisfying(lambda x: np.isclose(x[2], height), boundaries_only=True)].T
    around = []
    for facet in facets:
        x, y, _ = mesh.p[:, facet] - mesh.p[:, facet].mean(axis=1, keepdims=True)
        turn = np.arctan2(y, x)
        around.append(facet[np.argsort(turn if upwards else -turn)])
    numbers, facets = np.unique(around, return_inverse=True)
    return mesh.p[:, numbers].T, facets.reshape(len(around), -1), numbers


@pytest.mark.parametrize("kinds", [("tet", "tet"), ("tet", "hex"), ("hex", "tet"), ("hex", "hex")])
def test_a_uniform_pressure_passes_between_random_meshes_in_space(kinds: tuple[str, str]) -> None:
    random = np.random.default_rng(5)
    meshes = {"tet": (skfem.MeshTet, skfem.ElementTetP1()), "hex": (skfem.MeshHex, skfem.ElementHex1())}
    materials, counts = ((2.0, 0.3), (5.0, 0.2)), ((4, 3), (3, 5))

    def block(body: int) -> Any:
        mesh, element = meshes[kinds[body]]
        low = 1.0 - body
        sides = [np.linspace(0, 1, counts[body][0] + 1), np.linspace(0, 1, counts[body][1] + 1)]
        mesh = mesh.init_tensor(*sides, np.linspace(low, low + 1, 3))
        inner = (np.abs(mesh.p[:2] - 0.5) < 0.499).all(axis=0)
        places = mesh.p.copy()
        places[:2, inner] += random.uniform(-0.06, 0.06, (2, inner.sum()))
        return skfem.Basis(type(mesh)(places, mesh.t), skfem.ElementVector(element), intorder=3)

    bases = [block(0), block(1)]
    stiffnesses = [
        linear_elasticity(*lame_parameters(*material)).assemble(basis)
        for basis, material in zip(bases, materials, strict=True)
    ]
    (nodes, facets, own), (others, other_facets, other) = outside(bases[0].mesh, 1.0, False), outside(bases[1].mesh, 1.0, True)
    rows = sg.mortar_rows((nodes, facets), (others, other_facets), model="space")
    first, size = bases[0].N, bases[0].N + bases[1].N
    place = np.concatenate([bases[0].nodal_dofs[:, own].T.ravel(), first + bases[1].nodal_dofs[:, other].T.ravel()])
    to_nodes = sparse.csr_array((np.ones(len(place)), (np.arange(len(place)), place)), shape=(len(place), size))
    top = bases[0].mesh.facets_satisfying(lambda x: np.isclose(x[2], 2.0))
    down = skfem.LinearForm(lambda v, _: -v[2]).assemble(skfem.FacetBasis(bases[0].mesh, bases[0].elem, facets=top))
    zero = [lambda x: np.isclose(x[0], 0), lambda x: np.isclose(x[1], 0), lambda x: np.isclose(x[2], 0)]
    held = [bases[0].get_dofs(zero[axis]).all(f"u^{axis + 1}") for axis in (0, 1)]
    held += [first + bases[1].get_dofs(zero[axis]).all(f"u^{axis + 1}") for axis in (0, 1, 2)]
    free = np.setdiff1d(np.arange(size), np.concatenate(held))
    stiffness = sparse.csr_array(sparse.block_diag(stiffnesses, format="csr"))
    problem = sg.Problem(
        stiffness[free][:, free],
        np.concatenate([down, np.zeros(bases[1].N)])[free],
        sparse.csc_array(rows.B @ to_nodes)[:, free],
        rows.g,
    )
    answer = sg.solve(problem)
    found = np.zeros(size)
    found[free] = answer.u
    for body, (basis, (young, nu)) in enumerate(zip(bases, materials, strict=True)):
        x, y, z = basis.mesh.p
        below = -1 / materials[1][0] if body == 0 else 0.0
        exact = np.stack([nu / young * x, nu / young * y, below - (z - (1 - body)) / young])
        of_body = found[first:] if body else found[:first]
        assert np.abs(of_body[basis.nodal_dofs] - exact).max() < SOLVED
    assert np.abs(-answer.multiplier / rows.area - 1).max() < SOLVED * 100
    assert len(answer.contact_set) == len(rows.g)


def rows_of(slave: Any = UPPER, master: Any = LOWER, **options: Any) -> Callable[[], Any]:
    return lambda: sg.mortar_rows(slave, master, **options)


def with_node(value: float) -> tuple[np.ndarray, np.ndarray]:
    nodes = LOWER[0].copy()
    nodes[1, 0] = value
    return nodes, LOWER[1]


NODES, EDGES = UPPER
REFUSED: dict[str, tuple[Callable[[], Any], type[Exception], str]] = {
    "no pair": (rows_of(NODES), sg.BadType, "slave has the type ndarray"),
    "one entry": (rows_of((NODES,)), sg.BadType, "slave has 1 entries"),
    "no nodes": (rows_of((None, EDGES)), sg.BadType, "nodes of slave is None"),
    "text": (rows_of(("nodes", EDGES)), sg.BadType, "nodes of slave is of the type str"),
    "flat nodes": (rows_of((NODES.ravel(), EDGES)), sg.BadInput, "nodes of slave has the shape"),
    "nodes in space": (rows_of((np.zeros((2, 3)), EDGES)), sg.BadInput, "nodes of slave are 2 x 3; plane strain has 2"),
    "nodes in the plane": (rows_of(model="space"), sg.BadInput, "nodes of slave are 2 x 2; space has 3"),
    "nan": (rows_of(master=with_node(np.nan)), sg.BadInput, "nodes of master have the value NaN in row 1 and column 0"),
    "inf": (rows_of(master=with_node(np.inf)), sg.BadInput, "must be finite"),
    "radius": (rows_of(master=with_node(-0.5), model="axisymmetric"), sg.BadInput, "radius -0.5 in row 1"),
    "real facets": (rows_of((NODES, EDGES.astype(float))), sg.BadType, "facets of slave .*whole numbers"),
    "flat facets": (rows_of((NODES, EDGES.ravel())), sg.BadInput, "facets of slave have the shape"),
    "no facets": (rows_of(master=(NODES, np.zeros((0, 2), int))), sg.BadInput, "facets of master are 0 x 2; a surface has one facet"),
    "five columns": (rows_of((NODES, np.zeros((1, 5), int))), sg.BadInput, r"have 5 columns; in plane strain they have 2 \(Line2\)"),
    "unknown kind": (rows_of((*UPPER, "Q5")), sg.BadInput, 'kind of slave is "Q5"; it must be one of Line2'),
    "kind by number": (rows_of((*UPPER, 2)), sg.BadType, "kind of slave is of the type int"),
    "kind of a face": (rows_of((*UPPER, "T3")), sg.BadInput, "facets of slave are T3; they are no surface of plane strain"),
    "other kind": (rows_of((*UPPER, "Line3")), sg.BadInput, "facets of slave are 1 x 2; Line3 has 3 columns"),
    "node too large": (rows_of((NODES, np.array([[0, 2]]))), sg.BadInput, "facet 0 of slave .* names node 2; there are 2"),
    "node negative": (rows_of((NODES, np.array([[0, -1]]))), sg.BadInput, "names a node before 0"),
    "node twice": (rows_of((NODES, np.array([[1, 1]]))), sg.BadInput, "names node 1 twice"),
    "unknown model": (rows_of(model="bar"), sg.BadInput, 'model is "bar"; it must be one of plane-strain'),
    "thickness": (rows_of(thickness=0.0), sg.BadInput, "thickness is 0"),
    "no number": (rows_of(thickness="thick"), sg.BadType, "thickness is of the type str"),
    "direction zero": (rows_of(direction=[0, 0]), sg.BadInput, "direction is zero"),
    "direction long": (rows_of(direction=[0, 0, 1]), sg.BadInput, "direction has length 3; it must have length 2"),
    "direction nan": (rows_of(direction=[0, np.nan]), sg.BadInput, "direction has the value NaN"),
    "reach": (rows_of(reach=-1.0), sg.BadInput, "reach is -1"),
    "reach nan": (rows_of(reach=np.nan), sg.BadInput, "reach is NaN"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_surface_is_refused_with_a_sentence(name: str) -> None:
    call, kind, sentence = REFUSED[name]
    with pytest.raises(kind, match=sentence) as raised:
        call()
    assert isinstance(raised.value, ValueError) and isinstance(raised.value, sg.SignoriniError)


def test_a_surface_that_faces_two_layers_is_refused() -> None:
    nodes, edges = LOWER
    layers = (np.concatenate([nodes, nodes - [0.0, 1.0]]), np.concatenate([edges, edges + 3]))
    with pytest.raises(sg.BadInput, match="several layers"):
        sg.mortar_rows(UPPER, layers)
    assert sg.mortar_rows(UPPER, layers, reach=0.5).g.size == 2
