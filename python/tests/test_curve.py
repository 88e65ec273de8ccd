"""The curve of a raw tensile test, against the law behind its samples."""

from pathlib import Path

import implant_preview as ip
import numpy as np
import pytest

FIXTURES = Path(__file__).parents[2] / "tests" / "fixtures" / "tensile"


def test_a_table_of_a_file_becomes_a_curve_that_a_scene_takes():
    found = ip.curve(FIXTURES / "percent-mpa-unload.csv")
    assert "Stress: “Stress [MPa]”, in MPa, by the header." in found["notes"]
    strain, stress = np.array(found["curve"]["points"]).T
    assert np.abs(stress - 9 * np.expm1(6 * strain)).max() < 1.0
    assert 0.3 < found["rms_kpa"] < 0.5 and found["samples"].shape == (300, 2)
    layer = {"tissue": "skin", "thickness_mm": 1.5, "curve": found["curve"]}
    scene = {"implant": {"base_radius_mm": 50}, "tissue_model": "sheet", "layers": [layer], "solver": {"nodes_per_side": 17}}
    assert ip.solve(scene)["status"] == "converged"
    assert ip.curve((FIXTURES / "noisy.csv").read_bytes())["curve"]["interpolation"] == "spline"


def test_an_array_becomes_a_curve_in_the_units_asked():
    strain = np.linspace(0, 40, 200)
    found = ip.curve(np.column_stack([strain, 0.3 * strain]), unit="pa", strain="percent")
    assert found["curve"]["points"] == [[0, 0], [pytest.approx(0.4), pytest.approx(0.012)]]
    assert any("more than 30 times softer than every preset" in note for note in found["notes"])


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ([[0, 1, 2]], "allowed: \\(samples, 2\\)"),
        ([[0, 0], [0.1, np.nan]], "row 1 of the table"),
        (np.ma.masked_greater([[0.0, 0.0], [0.1, 5.0]], 4), "row 1 of the table"),
        ([[0, 5], [0.1, 2], [0.2, 1]], "the stress does not rise"),
        (b"\x1f\x8b", "a gzip file"),
    ],
)
def test_what_is_no_test_raises_one_line(table, words):
    with pytest.raises(ip.SceneError, match=words):
        ip.curve(table)
