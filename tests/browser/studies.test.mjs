// Studies of the JavaScript API in the page of the app: many scenes, maps, bands, in workers.

import assert from "node:assert/strict";
import { after, before, describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp({ isPlain: true });

// (module (func (export "f") unreachable))
const TRAP = [
  0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 7, 5, 1, 1, 102, 0, 0, 10, 5, 1, 3, 0, 0, 11,
];

/** Lets the workers trap in each scene with this insertion, those of the app's own studies included. */
const POISON = 0.765625;
const trapAtPoison = (page) =>
  page.context().route("**/job_worker.js", async (route) => {
    const response = await route.fetch();
    const trap = `new WebAssembly.Instance(new WebAssembly.Module(new Uint8Array([${TRAP}]))).exports.f()`;
    const wrapped = `for (const [kind, run] of Object.entries(KINDS)) {
      KINDS[kind] = (job, send) => (JSON.stringify(job).includes("${POISON}") ? ${trap} : run(job, send));
    }`;
    await route.fulfill({ response, body: `${await response.text()}\n${wrapped}` });
  });

/** What bands contain besides computed numbers. */
const shape = ({ bands, unknowns, counts, samples, seed, scenes_planned }) => ({
  quantities: bands.map(({ quantity, unit }) => [quantity, unit]),
  rest: { unknowns, counts, samples, seed, scenes_planned },
});

/** The greatest difference of percentiles, scenarios and profiles, relative to the greatest number of each. */
function greatestDifference(a, b) {
  const lists = ({ bands, profile }) => [
    ...bands.map(({ scene, p10, p50, p90, scenarios }) => [scene, p10, p50, p90, ...scenarios.map(({ value }) => value)]),
    ...[0, 1, 2].flatMap((k) => ["r_mm", "z_mm"].map((name) => profile.map((point) => point[name][k]))),
  ];
  const other = lists(b);
  return Math.max(
    ...lists(a).map((list, n) => {
      const size = Math.max(...other[n].map(Math.abs));
      return Math.max(...list.map((value, k) => Math.abs(value - other[n][k]))) / (size || 1);
    }),
  );
}

/** The app, at rest, whose workers trap at the poison; `study` there has a coarse scene and helpers. */
async function open() {
  const opened = await fixture.openApp({ prepare: trapAtPoison });
  const names = await opened.page.evaluate(() => performance.getEntriesByType("resource").map((r) => r.name));
  assert.equal(names.filter((name) => name.endsWith("_bg.wasm")).length, 1);
  await opened.page.evaluate(() => {
    const scene = JSON.parse(implantPreviewApi.default_scene());
    scene.solver = { nodes_per_side: 17, tolerance: 1e-3 };
    globalThis.study = {
      scene,
      message: (done) => done.then(() => "no error", (error) => `${error.name}: ${error.message}`),
      thrown: (run) => {
        try {
          run();
        } catch (error) {
          return `${error.name}: ${error.message}`;
        }
      },
    };
  });
  return opened;
}

describe("studies in the page", { timeout: 8 * harness.PATIENCE }, () => {
  let page;
  let finish;
  before(async () => ({ page, finish } = await open()));
  after(() => finish?.());

  test("many scenes: results as they come, one line for each scene without a result", async () => {
    const found = await page.evaluate(async (poison) => {
      const { scene, message, thrown } = study;
      const { simulate, simulateMany } = implantPreviewApi;
      const scenes = [0.5, 1, poison, 0.9, 7, 0.8].map((insertion) => ({ ...scene, insertion }));
      const withoutTime = (json) => JSON.stringify(JSON.parse(json), (key, value) => (key === "time_ms" ? 0 : value));
      const results = {};
      const study1 = simulateMany(JSON.stringify(scenes), (index, result) => {
        if (index in results) throw new Error("twice");
        results[index] = result;
      });
      const done = await message(study1.done);
      const here = [0, 1, 3, 5].map((k) => [withoutTime(results[k]), withoutTime(simulate(JSON.stringify(scenes[k])))]);
      // JSON lines.
      const lines = [];
      await simulateMany(`${JSON.stringify(scenes[0])}\n{\n`, (index, result) => lines.push([index, result])).done;
      const bad = [
        () => simulateMany("[{}, {]", () => {}),
        () => simulateMany(5, () => {}),
        () => simulateMany("[]", null),
      ].map(thrown);
      const empty = await message(simulateMany("[]", () => {}).done);
      const failing = await message(
        simulateMany(JSON.stringify(scenes), () => {
          throw new RangeError("of the receiver");
        }).done,
      );
      return { done, results, here, lines, bad, empty, failing };
    }, POISON);
    assert.equal(found.done, "no error");
    assert.equal(Object.keys(found.results).length, 6);
    for (const [worker, here] of found.here) assert.equal(worker, here);
    assert.equal(found.results[2], '{"error":"scene 2: internal error, twice: unreachable"}');
    assert.match(found.results[4], /^\{"error":"insertion is 7; allowed: [^\n]+"\}$/);
    found.lines.sort();
    assert.equal(JSON.parse(found.lines[0][1]).status, "converged");
    assert.match(JSON.parse(found.lines[1][1]).error, /ends too early/);
    assert.match(found.bad[0], /^Error: scenes: key must be a string at line 1 column 7$/);
    assert.equal(found.bad[1], "Error: scenes is not text; allowed: a string");
    assert.equal(found.bad[2], "Error: onResult is not a function; allowed: a function");
    assert.equal(found.empty, "no error");
    assert.equal(found.failing, "RangeError: of the receiver");
    // As many workers as cores less one.
    await page.evaluate(() => implantPreviewApi.simulateMany(JSON.stringify([study.scene]), () => {}).done);
    const cores = await page.evaluate(() => navigator.hardwareConcurrency);
    const alive = page.workers().length;
    assert.ok(alive >= 1 && alive <= Math.max(1, cores - 1), `${alive} workers on ${cores} cores`);
    assert.equal(await page.locator("#crashed").isVisible(), false);
  });

  test("a cancelled study ends at once, without further results, and the next study runs", async () => {
    const found = await page.evaluate(async () => {
      const { scene, message } = study;
      const { simulateMany, map, bands } = implantPreviewApi;
      const scenes = JSON.stringify(Array(2000).fill(scene));
      let results = 0;
      const many = simulateMany(scenes, () => {
        results += 1;
        if (results === 3) many.cancel();
      });
      const ends = [await message(many.done)];
      const x = { field: "insertion", from: 0.5, to: 1, count: 400 };
      let points = 0;
      const mapped = map(JSON.stringify({ scene, x }), () => {
        points += 1;
        if (points === 2) mapped.cancel();
      });
      ends.push(await message(mapped.done));
      let progress = 0;
      const banded = bands(JSON.stringify({ scene, samples: 512, importance_rows: 0 }), (done) => (progress = done));
      banded.cancel();
      banded.cancel();
      ends.push(await message(banded.done));
      const before = [results, progress];
      let next = 0;
      await simulateMany(JSON.stringify([scene, scene]), () => (next += 1)).done;
      return { ends, before, after: [results, progress], points, next };
    });
    for (const end of found.ends) assert.match(end, /^AbortError: The (job|study) was cancelled\.$/);
    assert.deepEqual(found.before, found.after);
    assert.equal(found.before[0], 3);
    assert.ok(found.points >= 2 && found.points < 400, `${found.points} points`);
    assert.equal(found.next, 2);
  });

  test("a map has each point once, and names the point that stops its workers", async () => {
    const found = await page.evaluate(async (poison) => {
      const { scene, thrown } = study;
      const { map, simulate } = implantPreviewApi;
      // 5 × 3 points; the insertion of the second column is the poison, the last radius does not fit its pocket.
      const x = { field: "insertion", from: 0.6875, to: 1, count: 5 };
      const y = { field: "layers[1].thickness_mm", from: 8, to: 12, count: 3 };
      const points = [];
      const options = { scene, x, y, grid: { nodes_per_side: 17, tolerance: 1e-3 }, show: "force_n" };
      const file = await map(JSON.stringify(options), (point) => points.push(JSON.parse(point))).done;
      const [one] = points.filter(({ i, j }) => i === 4 && j === 1);
      const alone = structuredClone(scene);
      alone.layers[1].thickness_mm = 10;
      const bad = [
        "{}",
        JSON.stringify({ scene }),
        JSON.stringify({ scene, x: { ...x, count: 1 } }),
        JSON.stringify({ scene, x, colour: 1 }),
        JSON.stringify({ scene: { ...scene, insertion: 7 }, x }),
      ].map((options) => thrown(() => map(options, () => {})));
      return { points, file: JSON.parse(file), one, alone: JSON.parse(simulate(JSON.stringify(alone))), bad };
    }, POISON);
    const places = found.points.map(({ i, j }) => `${i} ${j}`);
    assert.equal(new Set(places).size, 15);
    assert.equal(places.length, 15);
    for (const { i, at, status, error, values } of found.points) {
      assert.equal(status, at[0] === POISON ? "invalid" : "converged");
      if (i === 1) assert.match(error, /^job \d+, scene \d+: internal error, twice: unreachable$/);
      else assert.ok(values.force_n > 0);
    }
    const { contact_force_n: force } = found.alone;
    assert.ok(Math.abs(found.one.values.force_n - force) < 1e-9 * force);
    assert.equal(found.file.points.length, 15);
    assert.deepEqual(found.file.counts, { converged: 12, invalid: 3 });
    assert.ok(found.file.contours.length > 0);
    assert.deepEqual(found.bad.map((line) => typeof line), Array(5).fill("string"));
    assert.equal(found.bad[0], "Error: options: scene is missing; allowed: the scene around which the study varies");
    assert.match(found.bad[1], /^Error: options: missing field `x`/);
    assert.match(found.bad[2], /^Error: insertion: count is 1; allowed: 2 to 3600$/);
    assert.match(found.bad[3], /colour/);
    assert.match(found.bad[4], /^Error: insertion is 7; allowed: /);
  });

  test("bands of a seed are those of the native program", async () => {
    const { scene, report, progress, other } = await page.evaluate(async () => {
      const { bands } = implantPreviewApi;
      // A sheet: every sample has an answer. Which state a sample without one has may depend on the last bit.
      const scene = { ...JSON.parse(implantPreviewApi.opening_scene()), chest: undefined, tissue_model: "sheet" };
      const progress = [];
      const run = (seed) =>
        bands(
          JSON.stringify({ scene, samples: 32, seed, importance_rows: 16, grid: { nodes_per_side: 17, tolerance: 1e-3 } }),
          (done, all) => progress.push([done, all]),
        ).done.then(JSON.parse);
      return { scene, report: await run(3), other: await run(4), progress };
    });
    const native = harness.nativeBands(JSON.stringify(scene), [
      "--samples=32", "--seed=3", "--importance=16", "--nodes=17",
    ]);
    assert.deepEqual(shape(report), shape(native));
    assert.deepEqual(report.counts, { converged: 32 });
    assert.ok(report.bands.length > 8 && report.profile.length === 41);
    const difference = greatestDifference(report, native);
    assert.ok(difference < 1e-4, `a number differs by ${difference} of its band`);
    assert.ok(greatestDifference(other, native) > 1e-2);
    const [done, all] = progress.at(-1);
    assert.equal(done, all);
    assert.ok(progress.length > 5 && progress.every(([done], k) => k === 0 || done >= progress[k - 1][0] || done === 0));
  });
});
