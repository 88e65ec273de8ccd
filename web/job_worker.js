// Runs the jobs of runner.js, one at a time, so that the page stays responsive. The page posts { program, wasm },
// then jobs. Messages to the page: { isReady }; for each job { piece }, any number; then { result }, or
// { error, isBroken }. A broken worker runs no further job.

/** Address of this script. */
export const address = import.meta.url;

/** Name that runner.js gives to its workers. In a page this module has no effect. */
const NAME = "implant-preview job";

// Error of the mark in chart and table, relative to the dome's radius [-].
const MARK = 1e-3;

// The module with the functions of the API.
let program = null;

const fail = (error, isBroken) => postMessage({ error: String(error?.message ?? error), isBroken });

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
  const benchmark = new program.Benchmark('{"quick": true, "nodes_per_side": [17]}');
  while (benchmark.advance());
  benchmark.free();
}

/** Runs the study of run time against error. Options: JSON text or undefined. */
function runBenchmark({ options }, send) {
  const benchmark = new program.Benchmark(options);
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
  simulate: ({ scene }) => program.simulate(scene),
  // Job and cases: JSON text.
  study: ({ job }) => program.evaluate(job),
};

async function load({ program: address, wasm }) {
  const loaded = await import(address);
  // A build with a hash in its file names exports the address of its wasm file.
  await loaded.default({ module_or_path: wasm ?? loaded.wasm });
  program = loaded;
  postMessage({ isReady: true });
}

function run(job) {
  try {
    if (!Object.hasOwn(KINDS, job.kind)) {
      throw new Error(`kind is ${job.kind}; allowed: ${Object.keys(KINDS).join(", ")}`);
    }
    postMessage({ result: KINDS[job.kind](job, (piece) => postMessage({ piece })) });
  } catch (error) {
    // A trap without a panic, for example for lack of memory.
    fail(error, error instanceof WebAssembly.RuntimeError);
  }
}

// The program imports this module too, by another address if the page has copies.
const isFirst = globalThis.onmessage === null;
if (globalThis.name === NAME && globalThis.document === undefined && isFirst) {
  // The program's panic hook calls this function; exceptions caused by the panic follow.
  globalThis.implantPreviewCrashed = (message) => fail(message, true);
  globalThis.onmessageerror = () => fail("a message could not be read", true);
  globalThis.onmessage = ({ data }) => {
    const loaded = load(data);
    globalThis.onmessage = ({ data: job }) => loaded.then(() => run(job), (error) => fail(error, true));
  };
}
