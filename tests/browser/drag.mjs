// How long the solver and a whole frame take while a value is dragged in the built page, one edit a frame, and how many of
// the edits have a measured shape, not only one of a coarse grid.
//
// node tests/browser/drag.mjs [NODES_PER_SIDE [TISSUE_MODEL]]: on its own, for 129 nodes a side of layered tissue
// unless told otherwise; the other tissue model is `sheet`.
// Without a graphics card the picture is drawn in software, by threads that take every core: they are put
// behind the page's own, as they would not run at all elsewhere.

import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { setPriority } from "node:os";
import * as harness from "./harness.mjs";

// As many as the page keeps for its percentiles.
const EDITS = 240;

/** What an edit changes, at a place from 0 to 1 of the drag and back; runs in the page. */
const DRAGS = {
  insertion: (scene, at) => (scene.insertion = 0.5 + 0.5 * at),
  radius: (scene, at) => (scene.implant.base_radius_mm = 50 + 8 * at),
  volume: (scene, at) => (scene.implant.projection_mm = 25 + 10 * at),
  pinch: (scene, at) => (scene.layers[1].thickness_mm = 8 + 4 * at),
  "one axis": (scene, at) => (scene.implant.center_mm = [6 * at + 0.01, 0]),
  "both axes": (scene, at) => (scene.implant.center_mm = [6 * at + 0.01, -4 * at - 0.01]),
};

/** Puts the threads that draw behind all others. */
async function drawLast(browser) {
  const cdp = await browser.newBrowserCDPSession();
  const { processInfo } = await cdp.send("SystemInfo.getProcessInfo");
  for (const { id } of processInfo.filter(({ type }) => type === "GPU")) {
    for (const thread of readdirSync(`/proc/${id}/task`)) setPriority(Number(thread), 19);
  }
}

/** Drags one value there and back; the page's figures at the end, and the time until the scene's own grid is solved. */
function drag(page, opening, edit) {
  return page.evaluate(
    async ({ opening, edit, edits }) => {
      const change = new Function(`return (${edit})`)();
      const scene = JSON.parse(opening);
      const nextFrame = () => new Promise((resolve) => requestAnimationFrame(resolve));
      for (let count = 1; count <= edits; count += 1) {
        change(scene, 0.5 - 0.5 * Math.cos((2 * Math.PI * count) / edits));
        implantPreview.setScene(JSON.stringify(scene));
        await nextFrame();
      }
      const start = performance.now();
      while (!implantPreview.stats().converged) await nextFrame();
      return { ...implantPreview.stats(), rest_ms: performance.now() - start };
    },
    { opening, edit: edit.toString(), edits: EDITS },
  );
}

const nodesPerSide = Number(process.argv[2] ?? 129);
const tissueModel = process.argv[3] ?? "layered";
const site = await harness.serve();
const browser = await harness.startBrowser();
// The page's own policy allows no code from text.
const { page, problems } = await harness.openApp(browser, site, { isOpening: true, isSmooth: true, options: { bypassCSP: true } });
await drawLast(browser);
const scene = JSON.parse(await page.evaluate(() => implantPreviewApi.default_scene()));
scene.solver.nodes_per_side = nodesPerSide;
scene.tissue_model = tissueModel;
const opening = JSON.stringify(scene);
console.log(`${tissueModel}, ${nodesPerSide} nodes a side; solver and whole frame [ms]: median, 95 %; measured of ${EDITS} edits; solved at rest after [ms]`);
let measured = await page.evaluate(() => implantPreview.stats().measurements);
for (const [name, edit] of Object.entries(DRAGS)) {
  const stats = await drag(page, opening, edit);
  const figures = [stats.solver_ms_p50, stats.solver_ms_p95, stats.frame_ms_p50, stats.frame_ms_p95];
  const all = stats.measurements;
  console.log(name.padEnd(10), ...figures.map((ms) => ms.toFixed(1).padStart(6)), `${all - measured}`.padStart(5), stats.rest_ms.toFixed(0).padStart(6));
  measured = all;
}
await browser.close();
await site.close();
assert.deepEqual(problems, []);
