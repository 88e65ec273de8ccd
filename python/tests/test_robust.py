"""Gaps, bad entries, interrupts and forks: nothing is computed from a gap, no result is lost, no call is deaf or waits without end."""

import datetime
import json
import os
import signal
import subprocess
import sys
import threading
import time
from decimal import Decimal
from fractions import Fraction

import implant_preview as ip
import numpy as np
import pytest


def sheet(projection=20.0, nodes=17, **more):
    implant = {"base_radius_mm": 30, "projection_mm": projection}
    return {"tissue_model": "sheet", "implant": implant, "solver": {"nodes_per_side": nodes}} | more


def volume(projection):
    return ip.solve(sheet(projection), fields=["implant_volume_ml"])["implant_volume_ml"]


NUMBERS = [
    np.float64(12.5),
    np.float32(12.5),
    np.float16(12.5),
    np.longdouble(12.5),
    np.array(12.5),
    np.array(12.5, dtype=np.longdouble),
    np.ma.array(12.5),
    Decimal("12.5"),
    Fraction(25, 2),
]


@pytest.mark.parametrize("number", NUMBERS, ids=repr)
def test_a_number_of_another_type_is_that_number(number):
    assert volume(number) == volume(12.5)
    (found,) = ip.solve_many([sheet(number)], fields=["implant_volume_ml"])
    assert found["implant_volume_ml"] == volume(12.5)


GAPS = [
    (None, "null"),
    (np.ma.masked, "null"),
    (np.ma.array(12.5, mask=True), "null"),
    (float("nan"), "nan"),
    (np.float32("nan"), "nan"),
    (np.longdouble("nan"), "nan"),
    (np.array(np.nan), "nan"),
    (Decimal("NaN"), "nan"),
    (float("inf"), "inf"),
    (-np.inf, "-inf"),
]


@pytest.mark.parametrize(("gap", "word"), GAPS, ids=lambda part: repr(part))
def test_a_gap_is_one_line_with_the_field_and_its_limits(gap, word):
    line = f"implant.projection_mm is {word}; allowed: 2 to 120 mm"
    with pytest.raises(ip.SceneError, match=line):
        volume(gap)
    (found,) = ip.solve_many([sheet(gap)])
    assert found["index"] == 0 and found["error"].startswith(line)
    with pytest.raises(ip.SceneError, match=line):
        ip.shape(sheet(gap))
    with pytest.raises(ip.SceneError, match=line):
        ip.solve_matrix(sheet(gap), ["insertion"], [[1.0]], outputs=["force_n"])


def test_a_masked_entry_of_a_list_is_refused_with_its_place():
    scene = sheet() | {"implant": {"base_radius_mm": 30, "center_mm": np.ma.array([0.0, 1.0], mask=[False, True])}}
    with pytest.raises(ip.SceneError, match=r"implant\.center_mm\[1\] is null"):
        ip.solve(scene)


@pytest.mark.parametrize(
    "values",
    [
        np.ma.array([[0.5], [0.7]], mask=[[False], [True]]),
        [np.ma.array([0.5]), np.ma.array([0.7], mask=[True])],
        [[0.5], [None]],
        [[0.5], [float("nan")]],
        [[0.5], [float("inf")]],
    ],
    ids=["masked", "list", "None", "nan", "inf"],
)
def test_a_gap_in_a_matrix_is_refused_with_its_row(values):
    with pytest.raises(ip.SceneError, match="row 1 of .*insertion is "):
        ip.solve_matrix(sheet(), ["insertion"], values, outputs=["force_n"])


def test_a_mask_that_hides_nothing_is_none():
    values = np.ma.array([[0.5], [0.7]], mask=False)
    found = ip.solve_matrix(sheet(), ["insertion"], values, outputs=["force_n"])
    assert np.array_equal(found, ip.solve_matrix(sheet(), ["insertion"], [[0.5], [0.7]], outputs=["force_n"]))


BAD = [
    (None, "NoneType is no scene; allowed: a dictionary or JSON text"),
    (b"{}", "bytes is no scene; allowed: a dictionary or JSON text"),
    (7, "int is no scene"),
    (sheet(id=datetime.date(2026, 1, 31)), "id: date is no part of a scene"),
    (sheet() | {"layers": [{}, {"thickness_mm": 1j}]}, r"layers[1].thickness_mm: complex is no part of a scene"),
    (sheet() | {"implant": {"base_radius_mm": object()}}, "implant.base_radius_mm: object is no part of a scene"),
    ("\ud800", "surrogates"),
    ({1: [sheet()], (2, 3): 4}, "keys must be"),
]


@pytest.mark.parametrize(("bad", "words"), BAD, ids=lambda part: ascii(part)[:40])
@pytest.mark.parametrize("in_order", [True, False])
def test_an_entry_that_is_no_scene_is_an_error_in_its_place(bad, words, in_order):
    found = list(ip.solve_many([sheet(), bad, sheet()], fields=["status"], in_order=in_order))
    found.sort(key=lambda result: result["index"])
    assert [result["index"] for result in found] == [0, 1, 2]
    assert words in found[1]["error"] and "\n" not in found[1]["error"]
    assert found[0]["status"] == found[2]["status"] == "converged"


def test_a_scene_that_contains_itself_is_an_error_in_its_place():
    around = sheet()
    around["visit"] = around
    found = list(ip.solve_many([around, sheet()]))
    assert "error" in found[0] and found[1]["status"] == "converged"


def test_the_results_come_before_the_exception_of_a_producer():
    def producer():
        yield sheet()
        yield sheet()
        raise LookupError("the producer stopped")

    seen = []
    with pytest.raises(LookupError, match="the producer stopped"):
        for result in ip.solve_many(producer(), fields=["status"]):
            seen.append(result["status"])
    assert seen == ["converged"] * 2


@pytest.mark.parametrize("scenes", [sheet(), json.dumps(sheet()), b"[]"], ids=["dictionary", "text", "bytes"])
def test_one_scene_is_no_list(scenes):
    with pytest.raises(TypeError, match="scenes is one scene; allowed: a list"):
        ip.solve_many(scenes)


@pytest.mark.parametrize("threads", [-1, 0, -(2**70)])
def test_a_number_of_threads_below_one_is_one_line(threads):
    grid = {"x": {"field": "insertion", "from": 0.5, "to": 1, "count": 2}}
    for call in [
        lambda: ip.solve_many([sheet()], threads=threads),
        lambda: ip.solve_matrix(sheet(), ["insertion"], [[1.0]], outputs=["force_n"], threads=threads),
        lambda: ip.map(sheet(), **grid, threads=threads),
        lambda: ip.bands(sheet(), samples=16, threads=threads),
        lambda: ip.times(sheet(), threads=threads),
    ]:
        with pytest.raises(ValueError, match=f"threads is {threads}; allowed: 1 to 1024"):
            call()


def test_a_huge_number_of_threads_is_limited():
    before = len(os.listdir("/proc/self/task")) if os.path.exists("/proc/self/task") else 0
    results = ip.solve_many((sheet() for _ in range(3)), threads=10**9, fields=["status"])
    assert next(results)["status"] == "converged"
    if before:
        assert len(os.listdir("/proc/self/task")) <= before + 1024
    assert len(list(results)) == 2


# Ctrl+C after a while in a call that takes much longer; NumPy's interface is not used before.
INTERRUPT = """
import os, signal, sys, threading, time
import implant_preview as ip
# A shell that runs the tests in the background has it ignored.
signal.signal(signal.SIGINT, signal.default_int_handler)
big = {"implant": {"base_radius_mm": 60, "projection_mm": 58}, "solver": {"nodes_per_side": 513, "tolerance": 1e-7}}
calls = {
    "shape": lambda: ip.shape(big),
    "solve": lambda: ip.solve(big),
    "matrix": lambda: ip.solve_matrix(big, ["volume_ml"], [[240]], outputs=["greatest_strain"]),
    "many": lambda: list(ip.solve_many([big])),
    "bands": lambda: ip.bands(big, samples=16, importance_rows=0, grid={"nodes_per_side": 513, "tolerance": 1e-7}),
    "times": lambda: ip.times(big),
    "map": lambda: ip.map(big, x={"field": "insertion", "from": 0.9, "to": 1, "count": 2}, grid={"nodes_per_side": 513, "tolerance": 1e-7}),
}
sent = []
def end():
    sent.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)
threading.Timer(float(sys.argv[2]), end).start()
try:
    calls[sys.argv[1]]()
    print("finished")
except KeyboardInterrupt:
    print("KeyboardInterrupt", time.monotonic() - sent[0])
except BaseException as error:
    print(type(error).__name__, error)
sys.stdout.flush()
# The solve that was left ends soon, too.
cpu = time.process_time()
time.sleep(3)
first = time.process_time()
time.sleep(0.5)
print("idle" if time.process_time() - first < 0.1 else "busy")
os._exit(0)
"""


@pytest.mark.parametrize("call", ["shape", "solve", "matrix", "many", "bands", "map", "times"])
def test_an_interrupt_ends_a_long_call_soon(call):
    run = subprocess.run([sys.executable, "-c", INTERRUPT, call, "0.7"], capture_output=True, text=True, timeout=60)
    first, second = run.stdout.splitlines()
    name, seconds = first.split(" ", 1)
    assert name == "KeyboardInterrupt" and float(seconds) < 1.5, run.stdout + run.stderr
    assert second == "idle"


def test_other_calls_go_on_after_an_interrupt():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    results = ip.solve_many((sheet(id=k) for k in range(50)), fields=["status"])
    next(results)
    threading.Timer(0.05, lambda: signal.raise_signal(signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        ip.solve({"implant": {"base_radius_mm": 60, "projection_mm": 58}, "solver": {"nodes_per_side": 513, "tolerance": 1e-7}})
    assert [result["id"] for result in results] == list(range(1, 50))
    assert ip.solve(sheet())["status"] == "converged"
    signal.signal(signal.SIGINT, before)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
@pytest.mark.parametrize("action", ["next", "close", "delete", "again"])
def test_a_forked_child_has_an_error_at_once(action):
    # Many scenes: the threads hold their locks often.
    results = ip.solve_many([sheet()] * 400, fields=["status"])
    next(results)
    child = os.fork()
    if child == 0:
        signal.alarm(20)
        code = 1
        try:
            if action == "next":
                try:
                    next(results)
                except RuntimeError as error:
                    code = 0 if "solve_many" in str(error) else 2
            elif action == "close":
                results.close()
                code = 0
            elif action == "delete":
                del results
                code = 0
            else:
                found = list(ip.solve_many([sheet()] * 3, fields=["status"]))
                code = 0 if len(found) == 3 and ip.solve(sheet())["status"] == "converged" else 3
        finally:
            os._exit(code)
    start = time.monotonic()
    status = os.waitpid(child, 0)[1]
    assert status == 0, f"{status:#x} after {time.monotonic() - start:.1f} s"
    assert len(list(results)) == 399
