"""Starts a program of this folder on many ranks: finds an interpreter that has PETSc, and mpirun."""

import argparse
import os
import shutil
import subprocess
import sys
from pathlib import Path

DEBIAN = "/usr/bin/python3"
"""The interpreter for which Debian installs petsc4py. Another one may come first on the search path."""

INSTALL = "install PETSc and MPI, on Debian by apt-get install python3-petsc4py openmpi-bin"

OF_RANK = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK")
"""Variables in which mpirun tells a process its rank."""

SETTINGS = {
    # Open MPI refuses to run as root, as in a container, and with more ranks than processors.
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
    # The programs print their own sentence if they end with an error.
    "OMPI_MCA_orte_execute_quiet": "1",
}
"""Settings of Open MPI. They are variables, not options of mpirun, because other MPI libraries ignore them."""

USAGE = 2
"""Exit code of a wrong command, and of a machine without PETSc or MPI."""


def add_option(parser):
    """Adds the option that `start` reads."""
    parser.add_argument("--ranks", type=int, metavar="N", help="start this program on N ranks by mpirun")


def end(sentence):
    """Ends a program that cannot start. Only one rank says why."""
    if all(os.environ.get(name, "0") == "0" for name in OF_RANK):
        print(sentence, file=sys.stderr, flush=True)
    sys.exit(USAGE)


def has_petsc(python):
    """Returns `True` if the programs can run with this interpreter."""
    command = [python, "-B", "-c", "import ranks"]
    try:
        return subprocess.run(command, cwd=Path(__file__).parent, stdin=subprocess.DEVNULL, capture_output=True).returncode == 0
    except OSError:
        return False


def interpreter():
    """Returns an interpreter that has PETSc: this one, or that of Debian."""
    pythons = list(dict.fromkeys((sys.executable, DEBIAN)))
    for python in pythons:
        if has_petsc(python):
            return python
    return end(f"PETSc does not run with {' or '.join(pythons)}; {INSTALL}")


def start():
    """Starts this program again, by mpirun on as many ranks as `--ranks` says, with an interpreter that has PETSc.

    Returns if the program can continue as it is. A rank that mpirun has started always does.
    """
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    add_option(parser)
    options, words = parser.parse_known_args()
    ranks, is_rank = options.ranks, any(name in os.environ for name in OF_RANK)
    if ranks is not None and (ranks < 1 or is_rank):
        end("--ranks starts mpirun itself: leave out one of both" if is_rank else f"--ranks must be at least 1, not {ranks}")
    if is_rank:
        return
    mpirun = [] if ranks is None else [shutil.which("mpirun") or end(f"there is no mpirun; {INSTALL}"), "-n", str(ranks)]
    python = interpreter()
    if ranks is None and python == sys.executable:
        return
    command = [*mpirun, python, sys.argv[0], *words]
    os.execve(command[0], command, dict(os.environ) | SETTINGS)
