// The runner of jobs: module workers of the page, their replacement, and the functions of the API in workers.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp({ webgl: false });

// (module (func (export "f") unreachable))
const TRAP = [
  0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 7, 5, 1, 1, 102, 0, 0, 10, 5, 1, 3, 0, 0, 11,
];

/** Kinds of jobs of these tests, added to the script of the workers. */
const KINDS = `
  // A panic: the call of the hook, then a trap.
  KINDS.panic = () => { implantPreviewCrashed("a defect\\nin two lines"); throw new WebAssembly.RuntimeError(); };
  KINDS.trap = () => new WebAssembly.Instance(new WebAssembly.Module(new Uint8Array([${TRAP}]))).exports.f();
  // A trap in the first attempt only: the test's server counts the attempts.
  KINDS.trapOnce = (job) => {
    const request = new XMLHttpRequest();
    request.open("GET", "attempt", false);
    request.send();
    return request.responseText === "1" ? KINDS.trap() : KINDS.simulate(job);
  };
  KINDS.silence = () => { for (;;); };
  // The error of the job is lost, another exception follows.
  KINDS.script = () => { globalThis.postMessage = () => {}; setTimeout(() => { throw new Error("a script error"); }); throw 0; };
  KINDS.name = ({ name }, send) => { send("begun"); return name; };
`;

/** Opens a page without the app; `jobs` there has the runner's module, a program, scenes and helpers. */
async function open(options) {
  const { page, ...opened } = await fixture.openPage("bench.html", options);
  let attempts = 0;
  await page.context().route("**/attempt", (route) => route.fulfill({ body: String((attempts += 1)) }));
  await page.context().route("**/job_worker.js", async (route) => {
    const response = await route.fetch();
    await route.fulfill({ response, body: `${await response.text()}\n${KINDS}` });
  });
  await page.evaluate(async () => {
    const { Runner } = await import(new URL("runner.js", document.querySelector("script").src));
    globalThis.jobs = {
      Runner,
      program: new URL("implant-preview.mjs", location.href),
      scenes: [40, 55].map((base_radius_mm) =>
        JSON.stringify({ implant: { base_radius_mm }, solver: { nodes_per_side: 33 } }),
      ),
      withoutTime: (json) => JSON.stringify(JSON.parse(json), (key, value) => (key === "time_ms" ? 0 : value)),
      message: ({ result }) => result.then(() => "no error", (error) => `${error.name}: ${error.message}`),
    };
  });
  return { page, ...opened };
}

describe("the runner", { timeout: 4 * harness.PATIENCE }, () => {
  test("solves scenes in workers as the main thread does, and rejects a bad scene in one line", async () => {
    const { page, finish } = await open();
    const found = await page.evaluate(async () => {
      const { Runner, program, scenes, withoutTime, message } = jobs;
      const { default: init, simulate, wasm } = await import(program);
      await init({ module_or_path: wasm });
      const runner = new Runner({ program, workers: 2 });
      const job = (scene, kind = "simulate") => runner.submit({ kind, scene });
      const before = runner.stats();
      const workers = (await Promise.all(scenes.map((scene) => job(scene).result))).map(withoutTime);
      const bad = await message(job('{"implant": {"base_radius_mm": 500}}'));
      const unknown = await message(job("{}", "magic"));
      const after = runner.stats();
      // The compiled program instead of the address.
      const module = await WebAssembly.compileStreaming(fetch(wasm));
      const shared = new Runner({ program, wasm: module, workers: 1 });
      const fromModule = withoutTime(await shared.submit({ kind: "simulate", scene: scenes[0] }).result);
      const here = scenes.map((scene) => withoutTime(simulate(scene)));
      [runner, shared].forEach((each) => each.terminate());
      return { here, workers, bad, unknown, before, after, fromModule };
    });
    assert.deepEqual(found.workers, found.here);
    assert.notEqual(found.here[0], found.here[1]);
    assert.equal(found.fromModule, found.here[0]);
    assert.match(found.bad, /^Error: implant\.base_radius_mm is 500; allowed: .+$/);
    assert.match(found.unknown, /^Error: kind is magic; allowed: benchmark, simulate, study, /);
    assert.deepEqual(found.before, { workers: 2, alive: 0, jobs: 0, started: 0, restarted: 0, failed: 0 });
    assert.deepEqual(found.after, { workers: 2, alive: 2, jobs: 4, started: 2, restarted: 0, failed: 0 });
    await finish();
  });

  test("has one worker per core less one, at least one, started when first needed", async () => {
    for (const [cores, expected] of [[1, 1], [2, 1], [8, 7], [undefined, 1]]) {
      const { page, finish } = await open({
        init: `Object.defineProperty(navigator, "hardwareConcurrency", { value: ${cores} });`,
      });
      const found = await page.evaluate(async () => {
        const { Runner, program } = jobs;
        const runner = new Runner({ program });
        const before = runner.stats();
        const names = [...Array(3).keys()].map((name) => runner.submit({ kind: "name", name }).result);
        const results = await Promise.all(names);
        return { before, results, after: runner.stats() };
      });
      assert.deepEqual([found.before.workers, found.before.alive], [expected, 0], `${cores} cores`);
      assert.deepEqual(found.results, [0, 1, 2]);
      assert.equal(found.after.started, Math.min(3, expected));
      assert.equal(page.workers().length, found.after.alive);
      await finish();
    }
  });

  test("runs the job of a stopped worker once more in a new worker, then names and leaves out the job", async () => {
    const { page, finish } = await open();
    const found = await page.evaluate(async () => {
      const { Runner, program, scenes, withoutTime, message } = jobs;
      const runner = new Runner({ program, workers: 2, patience: 2000 });
      const solve = (scene) => runner.submit({ kind: "simulate", scene }).result.then(withoutTime);
      const [first] = await Promise.all(scenes.map(solve));
      const once = await runner.submit({ kind: "trapOnce", scene: scenes[0] }).result.then(withoutTime);
      const afterOnce = runner.stats();
      const lines = [];
      for (const kind of ["panic", "trap", "silence", "script"]) {
        const others = scenes.map(solve);
        lines.push(await message(runner.submit({ kind }, { name: `scene ${kind}` })));
        await Promise.all(others); // the others go on
      }
      lines.push(await message(runner.submit({ kind: "trap" })));
      const afterAll = runner.stats();
      const last = await solve(scenes[0]);
      runner.terminate();
      return { first, once, afterOnce, lines, afterAll, last };
    });
    assert.equal(found.once, found.first);
    assert.deepEqual(found.afterOnce, { workers: 2, alive: 2, jobs: 3, started: 3, restarted: 1, failed: 0 });
    assert.deepEqual(found.lines, [
      "Error: scene panic: internal error, twice: a defect in two lines",
      "Error: scene trap: internal error, twice: unreachable",
      "Error: scene silence: internal error, twice: no answer for 2 s",
      "Error: scene script: internal error, twice: Uncaught Error: a script error",
      "Error: job 15 (trap): internal error, twice: unreachable",
    ]);
    const { jobs, restarted, failed } = found.afterAll;
    assert.deepEqual({ jobs, restarted, failed }, { jobs: 16, restarted: 6, failed: 5 });
    assert.equal(found.last, found.first);
    await finish();
  });

  test("gives the jobs that wait at a stopped worker to others, each once", async () => {
    const { page, finish } = await open();
    const found = await page.evaluate(async () => {
      const { Runner, program, message } = jobs;
      const runner = new Runner({ program, workers: 2 });
      const pieces = [];
      const submitted = [...Array(40).keys()].map((name) =>
        runner.submit(name % 10 === 3 ? { kind: "trap" } : { kind: "name", name }, {
          onPiece: () => pieces.push(name),
          name: `scene ${name}`,
        }),
      );
      const results = await Promise.all(submitted.map((job) => job.result.catch((error) => error.message)));
      return { results, pieces: pieces.toSorted((a, b) => a - b), stats: runner.stats() };
    });
    const isTrap = (name) => name % 10 === 3;
    found.results.forEach((result, name) =>
      assert.equal(result, isTrap(name) ? `scene ${name}: internal error, twice: unreachable` : name),
    );
    assert.deepEqual(found.pieces, [...Array(40).keys()].filter((name) => !isTrap(name)));
    assert.deepEqual([found.stats.restarted, found.stats.failed], [4, 4]);
    await finish();
  });

  test("cancels waiting and running jobs; a long job loses its worker", async () => {
    const { page, finish } = await open();
    const found = await page.evaluate(async () => {
      const { Runner, program, scenes, withoutTime, message } = jobs;
      const runner = new Runner({ program, workers: 1 });
      const submitted = ["silence", ...Array(3).fill("name")].map((kind) => runner.submit({ kind }));
      submitted.forEach((job) => job.cancel());
      const cancelled = await Promise.all(submitted.map(message));
      const after = withoutTime(await runner.submit({ kind: "simulate", scene: scenes[0] }).result);
      // A busy machine may not run a short job within the grace: one of five leaves its worker.
      let next, isKept;
      for (let attempt = 0; attempt < 5 && !isKept; attempt += 1) {
        const { started } = runner.stats();
        const short = runner.submit({ kind: "name", name: 1 });
        short.cancel();
        cancelled.push(await message(short));
        next = await runner.submit({ kind: "name", name: 2 }).result;
        isKept = runner.stats().started === started;
      }
      const stats = runner.stats();
      const last = message(runner.submit({ kind: "simulate", scene: scenes[0] }));
      runner.terminate();
      return { cancelled, after, next, isKept, stats, last: await last, alive: runner.stats().alive };
    });
    for (const text of [...found.cancelled, found.last]) assert.match(text, /^AbortError: /);
    assert.equal(JSON.parse(found.after).status, "converged");
    assert.equal(found.next, 2);
    // A short job leaves its worker, the silent one does not.
    assert.ok(found.isKept && found.stats.started >= 2, JSON.stringify(found.stats));
    const { workers, alive, restarted, failed } = found.stats;
    assert.deepEqual([workers, alive, restarted, failed], [1, 1, 0, 0]);
    assert.equal(found.alive, 0);
    await finish();
  });

  test("rejects all jobs in one line each if no worker starts, and tries again with a later job", async () => {
    const { page, close } = await open();
    await page.context().route("**/*.wasm", (route) => route.fulfill({ status: 404 }));
    const start = () =>
      page.evaluate(async () => {
        const { Runner, program, message } = jobs;
        jobs.runner ??= new Runner({ program, workers: 3 });
        const submitted = [...Array(50).keys()].map((name) => jobs.runner.submit({ kind: "name", name }));
        return { lines: await Promise.all(submitted.map(message)), stats: jobs.runner.stats() };
      });
    const { lines, stats } = await start();
    lines.forEach((line, k) => assert.match(line, new RegExp(`^Error: job ${k} \\(name\\): no worker starts: \\S`)));
    assert.ok(stats.started <= 4, `${stats.started} workers`);
    assert.deepEqual([stats.failed, stats.workers], [50, 3]);
    await page.context().unroute("**/*.wasm");
    assert.deepEqual(new Set((await start()).lines), new Set(["no error"]));
    await close();
  });
});
