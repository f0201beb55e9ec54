"""Contact problems without a scene, with their results in closed form if known."""

import numpy as np
from scipy import sparse

from problem import Problem, problem_of


def two_springs(first=300.0, second=100.0, force=10.0, gap=0.05) -> Problem:
    """Two springs in series (N/m). The first is fixed; a force (N) acts on the free end, in front of an obstacle at `gap` (m).

    Without obstacle the end moves by F (1/k1 + 1/k2); with it the reaction is F - g / (1/k1 + 1/k2).
    """
    stiffness = [[first + second, -second], [-second, second]]
    return problem_of(stiffness, [0.0, force], [[0.0, 1.0]], [gap])


def string_over_obstacle(elements=200, load=1.0, gap=0.08) -> Problem:
    """The string -u'' = -q on (0, 1) with fixed ends and u >= -g.

    The contact is [b, 1-b] with b = sqrt(2g/q); the reaction is q (1 - 2b). Linear elements give the exact nodal values and the exact
    reaction if b is a node.
    """
    nodes, h = elements - 1, 1.0 / elements
    return problem_of(
        second_difference(nodes) / h, np.full(nodes, -load * h), -sparse.identity(nodes), np.full(nodes, gap)
    )


def string_with_weak_nodes(elements=256, load=1.0, node=100) -> Problem:
    """The same string with the gap for which the nodes `node` and `elements - node` touch without force.

    With y the distance to that node, u = -g + q (y^2 + y h)/2 satisfies the nodal equations there without a reaction.
    """
    h = 1.0 / elements
    return string_over_obstacle(elements, load, gap=0.5 * load * node * (node + 1) * h * h)


def membrane_over_obstacle(side=60, load=1.0, gap=0.03) -> Problem:
    """The membrane -Laplace u = -q on the unit square, u = 0 on its edge, u >= -g; five-point stencil, side x side inner nodes."""
    h, line = 1.0 / (side + 1), second_difference(side)
    one = sparse.identity(side)
    nodes = side * side
    stiffness = sparse.kron(line, one) + sparse.kron(one, line)
    return problem_of(stiffness, np.full(nodes, -load * h * h), -sparse.identity(nodes), np.full(nodes, gap))


def bounded_quadratic(dofs=400, seed=20240229) -> Problem:
    """A random sparse positive definite K with two-sided bounds: first the rows u <= upper, then the rows -u <= -lower."""
    random = np.random.default_rng(seed)
    factor = sparse.random(dofs, dofs, density=4.0 / dofs, rng=random, data_rvs=random.standard_normal)
    product = sparse.csc_matrix(factor.T @ factor + 0.1 * sparse.identity(dofs))
    stiffness = 0.5 * (product + product.T)
    lower, upper = -random.uniform(0.1, 1.0, dofs), random.uniform(0.1, 1.0, dofs)
    one = sparse.identity(dofs)
    load = random.standard_normal(dofs)
    return problem_of(stiffness, load, sparse.vstack([one, -one]), np.concatenate([upper, -lower]))


def floating_rod(elements=20, axial_stiffness=2.0e3, length=2.0, force=5.0, gap=0.01) -> Problem:
    """A rod (EA in N) that is supported only by the wall at its right end, against which a force at its left end pushes it.

    K is singular. The reaction equals the force, the displacement of the right end is the gap, and the rod shortens by F L / EA.
    """
    spring = axial_stiffness * elements / length
    stiffness = spring * second_difference(elements + 1).tolil()
    stiffness[0, 0] = stiffness[-1, -1] = spring
    load, contact = np.zeros(elements + 1), np.zeros((1, elements + 1))
    load[0], contact[0, -1] = force, 1.0
    return problem_of(stiffness, load, contact, [gap])


def non_negative(stiffness, linear) -> Problem:
    """Returns the problem: minimise 1/2 x'K x + c'x subject to x >= 0, with the rows -x <= 0 and the load -c."""
    size = len(linear)
    return problem_of(stiffness, -np.asarray(linear, float), -np.identity(size), np.zeros(size))


def cycling_from_any_start() -> Problem:
    """A positive definite problem of order 3 on which the basic active-set loop cycles from any start; x = (0, 4/19, 11/19)."""
    return non_negative([[4, 5, -5], [5, 9, -5], [-5, -5, 7]], [2, 1, -3])


def cycling_from_all_open() -> Problem:
    """Another such problem, with the cycle {} -> {2,3} -> {1,3} -> {} of the complementary sets; x = (0, 0, 0.6)."""
    return non_negative([[5, -2, -4], [-2, 2, 3], [-4, 3, 5]], [4, -1, -3])


def weakly_active() -> Problem:
    """A problem that touches in one row without force, and is open in the others; x = (1, 6, 0)."""
    return non_negative([[12, -2, -2], [-2, 1, 1], [-2, 1, 3]], [0, -4, -4])


def second_difference(size: int) -> sparse.csr_matrix:
    """Returns the tridiagonal matrix [-1 2 -1], size x size."""
    return sparse.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(size, size), format="csr")
