"""The engines of examples/batch that run on one machine: every scene has one result."""

import json
import subprocess
import sys
from pathlib import Path

DASK = Path(__file__).parent.parent.parent / "examples" / "batch" / "dask_run.py"


def test_dask_returns_each_scene_once(tmp_path):
    count = 1500
    scene = {"tissue_model": "sheet", "solver": {"nodes_per_side": 17}}
    with open(tmp_path / "scenes.jsonl", "w") as scenes:
        for k in range(count):
            # The tenth radii are out of their limits.
            radius = 30 + 0.001 * k if k % 10 else -1
            print(json.dumps(scene | {"id": k, "implant": {"base_radius_mm": radius}}), file=scenes)
    subprocess.run([sys.executable, DASK, "scenes.jsonl", "results.jsonl"], cwd=tmp_path, check=True)
    with open(tmp_path / "results.jsonl") as lines:
        results = [json.loads(line) for line in lines]
    assert sorted(result["id"] for result in results) == list(range(count))
    assert all(("error" in result) == (result["id"] % 10 == 0) for result in results)
    assert all(result["status"] == "converged" for result in results if "error" not in result)
