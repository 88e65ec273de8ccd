// Runs the study of run time against error beside the page, which so stays responsive. The page
// sends the options (JSON text or undefined) once and ends the worker to stop it.

import init, { Benchmark, wasm } from "./implant-preview.mjs";

// What the picture and the table mark [share of the dome's radius].
const MARK = 1e-3;

const fail = (error) => postMessage({ type: "failed", message: String(error?.message ?? error) });

// The program's panic hook calls this; what follows from the panic is thrown after it.
globalThis.implantPreviewCrashed = fail;

/** The least step of the clock [ms]: browsers make it coarse. */
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

/** Browsers optimise code once it has run for a while: without this the first times are too long. */
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
