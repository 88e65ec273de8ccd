"""Scenes through Dask: dask_run.py SCENES.jsonl RESULTS.jsonl [ADDRESS of a scheduler; without: processes on this machine]

Dask repeats the batches of a worker that ends; each batch is in the result once.
"""

import json
import sys
from collections.abc import Iterable

import dask.bag
import implant_preview as ip
from distributed import Client, as_completed

# Some 500 scenes.
BLOCK = "256KiB"
FIELDS = ["contact_force_n", "strain.max_principal"]


def solve(lines: Iterable[str]) -> list[str]:
    """The results of a batch, a line each."""
    return [json.dumps(result) for result in ip.solve_many(lines, threads=1, fields=FIELDS)]


def main(scenes: str, results: str, *address: str) -> None:
    with Client(*address) if address else Client(threads_per_worker=1) as client, open(results, "w") as out:
        lines = dask.bag.read_text(scenes, blocksize=BLOCK, linedelimiter="\n").map(str.strip).filter(bool)
        batches = lines.map_partitions(solve).to_delayed()
        for _, batch in as_completed(client.compute(batches), with_results=True):
            out.writelines(line + "\n" for line in batch)


if __name__ == "__main__":
    main(*sys.argv[1:])
