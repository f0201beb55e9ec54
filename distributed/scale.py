#!/usr/bin/env python3
"""A model of seconds and memory per rank, printed as the tables of docs/scale.md: python3 distributed/scale.py

It needs neither PETSc nor MPI. Its constants were measured with peers.py and solve.py on the block of docs/scale.md.
"""

import math

CYCLES = (15, 17, 19)
"""Cycles of a contact solve on one rank, for blocks with 16, 32 and 64 cells along a side."""

MEASURED_DOFS = 811_200

CYCLE, SET_UP, CERTIFICATE = 0.32e-6, 16.1e-6, 6.5e-6
"""Seconds of one processor per dof: one iteration with its cycle, the set-up, and the certificate."""

BYTES = 5.0e3
"""Peak of memory per dof, measured with eight ranks."""

OVERHEAD = 1.3e-3
"""Seconds of a cycle that do not depend on the rows of a rank: calls from Python."""

PRODUCTS, REDUCTIONS, LEVELS = 7, 5, 4
"""In an iteration: products with K, with one exchange of halos each; sums of a few numbers over all ranks; levels below the
first. Each of these levels has as many exchanges as there are products, and two more."""

LATENCY, BANDWIDTH = 2e-6, 1e9
"""Assumed for the network: seconds for a message, bytes per second for a rank."""


def cycles(dofs):
    """Returns the cycles for a number of dofs: each doubling of the cells along a side adds as many as it did when measured."""
    doublings = math.log2((dofs / MEASURED_DOFS) ** (1 / 3))
    return CYCLES[-1] + (CYCLES[-1] - CYCLES[0]) / 2 * doublings


def halo(dofs, ranks, shape):
    """Returns the number of dofs of other ranks that the rows of a rank refer to."""
    own, plane = dofs / ranks, 3 * (dofs / 3) ** (2 / 3)
    if shape == "slices":
        return 2 * plane
    return 6 * 3 * (own / 3) ** (2 / 3)


def model(dofs, ranks, shape):
    own, count = dofs / ranks, cycles(dofs)
    messages = 2 if shape == "slices" else 26
    exchanges = PRODUCTS + LEVELS * (PRODUCTS + 2)
    of_halo = PRODUCTS * 8 * halo(dofs, ranks, shape) / BANDWIDTH + exchanges * messages * LATENCY
    of_sums = REDUCTIONS * math.log2(max(ranks, 2)) * 2 * LATENCY
    work = CYCLE * own
    solve = count * (work + of_halo + of_sums + OVERHEAD)
    return {
        "cycles": count, "work": count * work, "halo": count * of_halo, "sums": count * of_sums, "python": count * OVERHEAD,
        "set-up": SET_UP * own, "certificate": CERTIFICATE * own, "total": solve + (SET_UP + CERTIFICATE) * own,
        "memory": BYTES * own / 1e9,
    }


def main():
    for shape in ("cubes", "slices"):
        print(f"\nParts are {shape}:\n")
        print("| dofs | ranks | halo, dofs | cycles | work, s | halos, s | reductions, s | Python, s | set-up, s | certificate, s |"
              " total, s | memory of a rank, GB |")
        print("|---|---|---|---|---|---|---|---|---|---|---|---|")
        for dofs in (1e8, 1e9):
            for ranks in (64, 256, 1024):
                m = model(dofs, ranks, shape)
                print(f"| {dofs:.0e} | {ranks} | {halo(dofs, ranks, shape):,.0f} | {m['cycles']:.0f} | {m['work']:.1f} | "
                      f"{m['halo']:.2f} | {m['sums']:.3f} | "
                      f"{m['python']:.2f} | {m['set-up']:.0f} | {m['certificate']:.0f} | {m['total']:.0f} | {m['memory']:.1f} |")


if __name__ == "__main__":
    main()
