"""Scenes through Ray: ray_run.py SCENES.jsonl FOLDER (Parquet files of id, status, force and stretch)"""

import sys

import implant_preview as ip
import numpy as np
import ray.data

FIELDS = ["contact_force_n", "strain.max_principal"]


def solve(batch: dict[str, np.ndarray]) -> dict[str, list]:
    """The results of a batch as columns."""
    found = list(ip.solve_many(batch["text"], threads=1, fields=FIELDS))
    return {
        "id": [str(result.get("id", "")) for result in found],
        "status": [result.get("status", "invalid") for result in found],
        "contact_force_n": [result.get("contact_force_n", np.nan) for result in found],
        "max_strain": [result.get("strain", {}).get("max_principal", np.nan) for result in found],
    }


ray.data.read_text(sys.argv[1]).map_batches(solve, batch_size=500).write_parquet(sys.argv[2])
