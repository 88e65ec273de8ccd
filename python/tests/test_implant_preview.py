"""The Python module against the command's documented results, closed forms and its own other functions."""

import itertools
import json
import math
import subprocess
import sys
import threading
import time
from pathlib import Path

import implant_preview as ip
import numpy as np
import pytest

EXAMPLES = Path(__file__).parent.parent / "examples"


def sheet(radius=50.0, nodes=17, **more):
    implant = {"base_radius_mm": radius}
    return {"tissue_model": "sheet", "implant": implant, "solver": {"nodes_per_side": nodes}} | more


def layered(**more):
    return ip.opening_scene() | {"solver": {"nodes_per_side": 17, "tolerance": 1e-3}} | more


def test_a_result_has_the_implants_volume_and_profiles_as_arrays():
    result = ip.solve(layered())
    assert result["status"] == "converged"
    assert result["implant_volume_ml"] == pytest.approx(225, rel=1e-9)
    profile = result["profile_skin"]
    assert all(isinstance(values, np.ndarray) and values.dtype == float for values in profile.values())
    assert len({len(values) for values in profile.values()}) == 1
    assert ip.solve(json.dumps(sheet()))["status"] == "converged"


def test_a_refused_scene_raises_one_line():
    with pytest.raises(ip.SceneError) as caught:
        ip.solve(sheet(radius=500.0))
    line = str(caught.value)
    assert "implant.base_radius_mm is 500" in line and "allowed" in line and "\n" not in line
    assert isinstance(caught.value, ValueError)
    with pytest.raises(ip.SceneError):
        ip.solve("{")
    with pytest.raises(TypeError, match="allowed"):
        ip.solve(sheet() | {"visit": object()})
    numpy_numbers = ip.solve(sheet(radius=np.float32(50), nodes=np.int64(17)))
    assert numpy_numbers["solver"]["nodes_per_side"] == 17


def test_many_scenes_come_in_order_with_their_ids_and_errors():
    scenes = [sheet(radius=40 + k, id={"k": k}) for k in range(9)]
    scenes[4] = sheet(radius=-1.0, id="bad")
    scenes[5] = "nonsense"
    found = list(ip.solve_many(iter(scenes), threads=2))
    assert [result["index"] for result in found] == list(range(9))
    assert [result.get("id") for result in found[:5]] == [{"k": 0}, {"k": 1}, {"k": 2}, {"k": 3}, "bad"]
    assert "base_radius_mm" in found[4]["error"] and "error" in found[5]
    for k, result in enumerate(found):
        if "error" not in result:
            assert result["implant_volume_ml"] == pytest.approx(2e-3 / 3 * math.pi * (40 + k) ** 3, rel=1e-9)
    assert sorted(r["index"] for r in ip.solve_many(scenes, in_order=False)) == list(range(9))


def test_an_endless_stream_is_read_lazily_and_can_be_left():
    read = itertools.count()

    def endless():
        for k in read:
            yield sheet(radius=40 + k % 20)

    first = list(itertools.islice(ip.solve_many(endless(), threads=2), 3))
    assert len(first) == 3
    assert next(read) < 30


def test_other_threads_of_python_run_during_a_solve():
    ticks = []
    is_over = threading.Event()

    def tick():
        while not is_over.wait(0.005):
            ticks.append(time.monotonic())

    thread = threading.Thread(target=tick)
    thread.start()
    ip.solve(ip.opening_scene() | {"solver": {"nodes_per_side": 129}})
    is_over.set()
    thread.join()
    assert len(ticks) > 5


def test_a_matrix_has_the_numbers_of_single_scenes():
    outputs = ["force_n", "greatest_strain"]
    found = ip.solve_matrix(layered(), ["volume_ml", "insertion"], [[150, 1.0], [225, 1.0], [225, 0.5]], outputs=outputs, threads=2)
    assert found.shape == (3, 2) and found.dtype == float
    single = ip.solve(layered())
    expected = [single["contact_force_n"], single["strain"]["max_principal"]]
    assert found[1] == pytest.approx(expected, rel=1e-6)
    assert np.all(found[0] < found[1]) and np.all(found[2] < found[1])
    with pytest.raises(ip.SceneError, match="row 1"):
        ip.solve_matrix(layered(), ["volume_ml"], [[200.0], [-5.0]], outputs=["force_n"])
    with pytest.raises(ip.SceneError, match="allowed"):
        ip.solve_matrix(layered(), ["colour"], [[1.0]], outputs=["force_n"])
    with pytest.raises(ip.SceneError, match="allowed"):
        ip.solve_matrix(layered(), ["volume_ml"], [[200.0]], outputs=["colour"])
    with pytest.raises(ip.SceneError, match="dimensions"):
        ip.solve_matrix(layered(), ["volume_ml"], [200.0], outputs=["force_n"])
    with pytest.raises(ip.SceneError, match="insertion and insertion set the same field"):
        ip.solve_matrix(layered(), ["insertion", "insertion"], [[1.0, 0.5]], outputs=["force_n"])
    # The path of another number in the template.
    sheet = {"tissue_model": "sheet", "implant": {"base_radius_mm": 30}, "solver": {"nodes_per_side": 17}}
    found = ip.solve_matrix(sheet, ["solver.nodes_per_side"], [[17], [33]], outputs=["force_n"])
    finer = ip.solve(sheet | {"solver": {"nodes_per_side": 33}})
    assert found[1, 0] == pytest.approx(finer["contact_force_n"], rel=1e-6) and found[0, 0] != found[1, 0]


def test_a_map_and_bands_have_arrays():
    x = {"field": "volume_ml", "from": 150, "to": 200, "count": 3}
    y = {"field": "insertion", "from": 0.5, "to": 1.0, "count": 2}
    grid = {"nodes_per_side": 17, "tolerance": 1e-3}
    found = ip.map(ip.opening_scene(), x=x, y=y, grid=grid)
    strain = found["values"]["greatest_strain"]
    assert strain.shape == (2, 3) and np.all(np.diff(strain, axis=0) > 0) and np.all(np.diff(strain, axis=1) > 0)
    report = ip.bands(layered(), samples=16, importance_rows=0, grid=grid)
    assert report["profile"]["z_mm"].shape == (41, 3)
    assert np.all(np.diff(report["profile"]["z_mm"], axis=1) >= 0)
    with pytest.raises(ip.SceneError):
        ip.bands(layered(), samples=3)
    with pytest.raises(ip.SceneError):
        ip.map(layered(), x=x | {"field": "colour"})


def test_pressure_falls_with_the_time_after_the_operation():
    scene = ip.opening_scene() | {"solver": {"nodes_per_side": 33, "tolerance": 1e-3}}
    found = ip.times(scene)
    assert found["schema"] == "implant-preview/times/1"
    assert [time["when"] for time in found["times"]] == ["on_the_table", "week", "six_months"]
    pressures = [time["values"]["mean_pressure_mmhg"] for time in found["times"]]
    assert pressures[0]["value"] == pytest.approx(ip.solve(scene)["contact_pressure_mmhg"]["mean"], rel=1e-6)
    assert np.all(np.diff([pressure["value"] for pressure in pressures]) < 0)
    assert all(least <= pressure["value"] <= most for pressure in pressures for least, most in [pressure["range"]])
    with pytest.raises(ip.SceneError, match="times: a sheet; allowed: layered tissue"):
        ip.times({"tissue_model": "sheet", "implant": {"base_radius_mm": 50}})


def test_a_shape_is_that_of_the_result():
    shape = ip.shape(layered())
    faces, vertices, axes = shape.points.shape
    assert (faces, axes) == (3, 3) and shape.triangles.max() == vertices - 1
    assert shape.triangles.shape[1] == 3
    strain = shape.fields["strain"]
    assert strain.shape == (vertices,)
    assert strain.max() == pytest.approx(shape.result["strain"]["max_principal"], rel=1e-3)
    assert shape.fields["thickness_stretch"].shape == (2, vertices)
    # Area of the skin over the patch, from the triangles.
    a, b, c = (shape.points[-1][shape.triangles[:, k]].astype(float) for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 100
    assert area == pytest.approx(shape.result["skin_area"]["patch_after_cm2"], rel=0.02)


def test_the_shape_of_a_right_breast_is_the_mirror_image():
    scene = layered()
    scene["implant"] = {**scene["implant"], "center_mm": [4, -2]}
    left, right = ip.shape(scene), ip.shape({**scene, "side": "right"})
    assert (right.points == left.points * np.float32([-1, 1, 1])).all()
    assert (right.triangles == left.triangles[:, [0, 2, 1]]).all()
    assert all((right.fields[name] == left.fields[name]).all() for name in ["strain", "cover_mm"])


# The one that draws needs PyVista and a body.
QUICK = sorted(path for path in EXAMPLES.glob("*.py") if path.name != "before_after.py")


@pytest.mark.parametrize("example", QUICK, ids=lambda path: path.name)
def test_the_examples_run(example, tmp_path):
    subprocess.run([sys.executable, example, "--quick"], cwd=tmp_path, check=True)
