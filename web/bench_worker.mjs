// Runs the study of run time against error in a worker, so that the page stays responsive. The page sends
// the options (JSON text or undefined) once, and terminates the worker to stop the study.

import init, { Benchmark, wasm } from "./implant-preview.mjs";

// Error of the mark in chart and table, relative to the dome's radius [-].
const MARK = 1e-3;

const fail = (error) => postMessage({ type: "failed", message: String(error?.message ?? error) });

// The program's panic hook calls this function; exceptions caused by the panic follow.
globalThis.implantPreviewCrashed = fail;

/** Resolution of the clock [ms]; browsers reduce it. */
function clockStep() {
  let least = Infinity;
  for (let k = 0; k < 5; k += 1) {
    const start = performance.now();
    let now = start;
    while (now === start) now = performance.now();
    least = Math.min(least, now - start);
  }
  return least;
}

/** Runs a short study, so that the browser has optimised the code before the measurement. */
function warmUp() {
  const benchmark = new Benchmark('{"quick": true, "nodes_per_side": [17]}');
  while (benchmark.advance());
  benchmark.free();
}

onmessage = async ({ data: options }) => {
  try {
    await init({ module_or_path: wasm });
    const benchmark = new Benchmark(options);
    postMessage({ type: "warming" });
    warmUp();
    let progress = JSON.parse(benchmark.progress());
    postMessage({ type: "begun", progress, clockStep: clockStep() });
    for (let piece = progress.next; benchmark.advance(); piece = progress.next) {
      progress = JSON.parse(benchmark.progress());
      const times = JSON.parse(benchmark.timesTo(MARK));
      postMessage({
        type: "piece",
        progress,
        csv: benchmark.csv(),
        scene: piece.scene,
        svg: benchmark.svg(piece.scene),
        times: times.filter((time) => time.scene === piece.scene),
      });
    }
    postMessage({ type: "done" });
  } catch (error) {
    fail(error);
  }
};
