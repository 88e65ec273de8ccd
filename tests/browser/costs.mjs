// What calls and studies cost in the built page, on a machine with nothing else to do:
//
// node tests/browser/costs.mjs
//
// Whole calls of simulate() beside their solver, a map of 400 scenes and its first points, bands of 256 samples, and the
// frames of the page while a study runs.

import assert from "node:assert/strict";
import * as harness from "./harness.mjs";

const RUNS = 5;

const site = await harness.serve();
const browser = await harness.startBrowser();
const { page, problems } = await harness.openApp(browser, site, { isOpening: true, isSmooth: true });
await page.waitForFunction(() => implantPreview.stats().converged);

/** Whole calls and their solver [ms]: medians of 60 calls after 40 to warm up. */
const calls = await page.evaluate(() => {
  const { default_scene, simulate } = implantPreviewApi;
  const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
  const of = (nodes, model, center) => {
    const scene = JSON.parse(default_scene());
    scene.tissue_model = model;
    scene.solver = { nodes_per_side: nodes, tolerance: 1e-3 };
    scene.pocket_radius_mm = 75;
    delete scene.patch_radius_mm;
    scene.implant.center_mm = center;
    const text = JSON.stringify(scene);
    const [whole, solver] = [[], []];
    for (let run = 0; run < 100; run += 1) {
      const start = performance.now();
      const result = JSON.parse(simulate(text));
      if (run >= 40) whole.push(performance.now() - start), solver.push(result.solver.time_ms);
    }
    return { whole: median(whole), solver: median(solver) };
  };
  return [
    ["sheet, quarter, 129", of(129, "sheet", [0, 0])],
    ["sheet, quarter, 257", of(257, "sheet", [0, 0])],
    ["sheet, whole, 129", of(129, "sheet", [5, 3])],
    ["layered, quarter, 33", of(33, "layered", [0, 0])],
    ["layered, quarter, 65", of(65, "layered", [0, 0])],
    ["layered, quarter, 129", of(129, "layered", [0, 0])],
  ];
});
for (const [name, { whole, solver }] of calls) {
  console.log(`${name}: call ${whole.toFixed(2)} ms, solver ${solver.toFixed(2)} ms, × ${(whole / solver).toFixed(2)}`);
}

/** Runs a study some times: times of its first results and of all [ms], greatest time between two frames [ms]. */
const study = (name, choices) =>
  page.evaluate(
    async ({ name, choices, runs }) => {
      const nextFrame = () => new Promise((resolve) => requestAnimationFrame(resolve));
      const scene = JSON.parse(implantPreviewApi.opening_scene());
      scene.tissue_model = choices.model;
      // A sheet has a flat wall.
      if (choices.model === "sheet") delete scene.chest;
      const found = [];
      for (let run = 0; run < runs; run += 1) {
        // Another scene for each run: workers keep no results, but nothing should be known.
        scene.layers[0].thickness_mm = 1.5 + 1e-3 * run;
        const start = performance.now();
        let [first, all, isRunning, last, longest, points] = [0, 0, true, start, 0, 0];
        // A map passes its points, bands their progress; the check of a map and the scenarios of bands are not counted.
        const onProgress = (done) => {
          points = typeof done === "number" ? done : points + 1;
          if (first === 0 && points >= choices.first) first = performance.now() - start;
          if (all === 0 && points >= choices.all) all = performance.now() - start;
        };
        const handle = implantPreviewApi[name](JSON.stringify({ scene, ...choices.settings }), onProgress);
        const frames = (async () => {
          while (isRunning) {
            await nextFrame();
            const now = performance.now();
            [longest, last] = [Math.max(longest, now - last), now];
          }
        })();
        await handle.done;
        isRunning = false;
        await frames;
        found.push({ first, all, longest });
      }
      return found;
    },
    { name, choices, runs: RUNS },
  );

const x = { field: "base_width_mm", from: 100, to: 140, count: 20 };
const y = { field: "projection_mm", from: 25, to: 50, count: 20 };
const median = (values) => values.sort((a, b) => a - b)[values.length >> 1];
for (const [words, name, choices] of [
  ["map of 400 sheets, 33 nodes", "map", { model: "sheet", first: 25, all: 400, settings: { x, y } }],
  ["map of 400 layered, 33 nodes", "map", { model: "layered", first: 25, all: 400, settings: { x, y } }],
  ["bands of 256 sheets, 65 nodes", "bands", { model: "sheet", first: 16, all: 256, settings: { samples: 256, importance_rows: 0 } }],
  ["bands of 256 layered, 33 nodes", "bands", { model: "layered", first: 16, all: 256, settings: { samples: 256, importance_rows: 0 } }],
]) {
  const found = await study(name, choices);
  const of = (key) => median(found.map((run) => run[key])).toFixed(0);
  console.log(`${words}: first ${choices.first} after ${of("first")} ms, all ${of("all")} ms, longest frame ${of("longest")} ms`);
}
assert.deepEqual(problems, []);
await browser.close();
await site.close();
