// Runs the jobs of runner.mjs, one at a time, so that the page stays responsive. Messages to the page:
// { piece }, any number; then { result }, or { error, isBroken }. A broken worker runs no further job.

import init, { Benchmark, simulate, wasm } from "./implant-preview.mjs";

// Error of the mark in chart and table, relative to the dome's radius [-].
const MARK = 1e-3;

const fail = (error, isBroken) => postMessage({ error: String(error?.message ?? error), isBroken });

// The program's panic hook calls this function; exceptions caused by the panic follow.
globalThis.implantPreviewCrashed = (message) => fail(message, true);

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

/** Runs the study of run time against error. Options: JSON text or undefined. */
function runBenchmark({ options }, send) {
  const benchmark = new Benchmark(options);
  send({ type: "warming" });
  warmUp();
  let progress = JSON.parse(benchmark.progress());
  send({ type: "begun", progress, clockStep: clockStep() });
  for (let piece = progress.next; benchmark.advance(); piece = progress.next) {
    progress = JSON.parse(benchmark.progress());
    const times = JSON.parse(benchmark.timesTo(MARK));
    send({
      type: "piece",
      progress,
      csv: benchmark.csv(),
      scene: piece.scene,
      svg: benchmark.svg(piece.scene),
      times: times.filter((time) => time.scene === piece.scene),
    });
  }
  benchmark.free();
}

// By kind: a function of the job and of `send`, which posts a partial result.
const KINDS = {
  benchmark: runBenchmark,
  // Scene and result: JSON text.
  simulate: ({ scene }) => simulate(scene),
};

let ready = null;

onmessage = async ({ data: job }) => {
  try {
    await (ready ??= init({ module_or_path: wasm }));
  } catch (error) {
    return fail(error, true);
  }
  try {
    if (!Object.hasOwn(KINDS, job.kind)) {
      throw new Error(`kind is ${job.kind}; allowed: ${Object.keys(KINDS).join(", ")}`);
    }
    postMessage({ result: KINDS[job.kind](job, (piece) => postMessage({ piece })) });
  } catch (error) {
    // A trap without a panic, for example for lack of memory.
    fail(error, error instanceof WebAssembly.RuntimeError);
  }
};
