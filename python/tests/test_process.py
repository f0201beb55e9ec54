"""Behaviour of the package in a process: signals, threads, memory."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import signorini as sg
from bodies import membrane, two_springs

# Solves a body for seconds by the given method, and sends a signal in the meantime.
INTERRUPTED = """
import os, signal, sys, threading, time
sys.path.insert(0, sys.argv[1])
import signorini as sg
from bodies import membrane

problem = sg.Problem(*membrane(int(sys.argv[3])))
sent = []

def send():
    sent.append(time.perf_counter())
    os.kill(os.getpid(), signal.SIGINT)

timer = threading.Timer(float(sys.argv[4]), send)
timer.start()
try:
    sg.solve(problem, method=sys.argv[2])
    timer.cancel()
    print("solved")
except sg.Interrupted as stopped:
    waited = time.perf_counter() - sent[0]
    print(f"{waited:.3f} {stopped.solution is not None}")
    if stopped.solution is not None:
        assert len(stopped.solution.u) == problem.dofs and stopped.solution.certificate.worst
"""


def interrupted(method: str, cells: int, after: float) -> tuple[float, bool]:
    """Returns the seconds until the interrupt was answered, and whether its exception carries an answer.

    The seconds are infinite if the problem was solved before the interrupt came.
    """
    program = [sys.executable, "-c", INTERRUPTED, str(Path(__file__).parent), method, str(cells), str(after)]
    ended = subprocess.run(program, capture_output=True, text=True, timeout=120, check=False)
    assert ended.returncode == 0, ended.stderr
    if "solved" in ended.stdout:
        return float("inf"), False
    waited, has_answer = ended.stdout.split()
    return float(waited), has_answer == "True"


@pytest.mark.parametrize(("method", "cells"), [("active-set", 400), ("mprgp", 700), ("qp", 400)])
def test_an_interrupt_is_answered_at_once(method: str, cells: int) -> None:
    # On a busy machine the system may resume the process late, so that one of three attempts must be fast.
    waited = (interrupted(method, cells, after)[0] for after in (0.3, 0.2, 0.4))
    assert any(seconds < 0.2 for seconds in waited)


def test_an_interrupt_carries_the_best_answer_until_then() -> None:
    # A method has no answer before its first iteration ends. The iterations here are short, so that one ends in time
    # even on a busy machine. The smaller body is solved on the calling thread, the larger one on a thread of its own.
    for cells in (85, 100):
        tried = [(method, cells, after) for method in ("mprgp", "penalty") for after in (0.05, 0.1, 0.15)]
        assert any(interrupted(*attempt)[1] for attempt in tried), cells


def test_an_interrupt_is_a_keyboard_interrupt_without_an_answer_by_default() -> None:
    error = sg.Interrupted("interrupted")
    assert isinstance(error, KeyboardInterrupt) and error.solution is None


def test_the_exception_of_the_callers_own_signal_handler_is_passed_on() -> None:
    class Enough(Exception):
        pass

    def ring(*_: object) -> None:
        raise Enough

    before = signal.signal(signal.SIGALRM, ring)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.2)
        with pytest.raises(Enough):
            sg.solve(sg.Problem(*membrane(300)), method="active-set")
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def test_other_threads_run_while_a_body_is_solved() -> None:
    problem, ticks = sg.Problem(*membrane(120)), []
    done = threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(time.perf_counter())
            time.sleep(0.001)

    watcher = threading.Thread(target=tick)
    watcher.start()
    began = time.perf_counter()
    sg.solve(problem, method="active-set")
    took = time.perf_counter() - began
    done.set()
    watcher.join()
    during = [at for at in ticks if began < at < began + took]
    assert took < 0.05 or len(during) > 5


def test_two_threads_solve_at_once_and_find_the_same_bits() -> None:
    problems = [sg.Problem(*membrane(40)), two_springs()]
    alone = [sg.solve(problem).u.copy() for problem in problems]
    wrong: list[int] = []

    def work(number: int) -> None:
        for _ in range(20):
            if not np.array_equal(sg.solve(problems[number]).u, alone[number]):
                wrong.append(number)

    threads = [threading.Thread(target=work, args=(number,)) for number in (0, 1, 0)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def resident() -> int:
    """Returns the bytes of memory that the process holds."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the system does not report the memory of a process")
def test_memory_is_flat_over_ten_thousand_solves() -> None:
    problem = two_springs()
    prepared = sg.prepare(problem)

    def solve(times: int) -> None:
        for _ in range(times):
            answer = sg.solve(problem)
            assert answer.u[1] == 1.0 and len(answer.contact_set) == 1
            prepared.solve([0.5])
            try:
                sg.Problem(np.eye(2), [1.0])
            except sg.BadInput:
                pass

    solve(2000)
    before = resident()
    solve(10_000)
    # If each solve leaked one answer of some 500 bytes, the growth would be several times as large.
    assert resident() - before < 1_000_000


# The rest of a limited address space counts as available memory: a problem that needs more is refused, and the process
# goes on.
LIMITED = """
import resource, sys
sys.path.insert(0, sys.argv[1])
import signorini as sg
from bodies import membrane

problem = sg.Problem(*membrane(int(sys.argv[2])))
pages = int(open("/proc/self/statm").read().split()[0])
most = pages * resource.getpagesize() + (int(sys.argv[3]) << 20)
resource.setrlimit(resource.RLIMIT_AS, (most, most))
try:
    print(sg.solve(problem, method="active-set").certificate.meets(1e-9))
except sg.TooLarge as error:
    print(f"{error.bytes > error.allowed}, too large")
"""


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="the system does not report the memory of a process")
@pytest.mark.parametrize(("cells", "megabytes", "said"), [(300, 150, "True, too large"), (200, 4000, "True")])
def test_what_does_not_fit_into_a_limited_address_space_is_refused(cells: int, megabytes: int, said: str) -> None:
    program = [sys.executable, "-c", LIMITED, str(Path(__file__).parent), str(cells), str(megabytes)]
    ended = subprocess.run(program, capture_output=True, text=True, timeout=120, check=False)
    assert (ended.returncode, ended.stdout.strip()) == (0, said), ended.stderr
