// What an edit costs while a value is dragged in the built page, one edit a frame: the solver's time in the edit's frame, the time
// from frame to frame, how many edits have a measured shape at the end of their frame, and the time from the last edit until the
// scene's own grid is solved, with its frames and the solver's time in them.
//
// node tests/browser/drag.mjs [NODES_PER_SIDE [TISSUE_MODEL]] [--edits 60] [--seconds 20] [--plan opening|default] [--undrawn]
//     [--page FOLDER]...
//
// On its own, for 129 nodes a side of layered tissue unless told otherwise; the other tissue model is `sheet`, which has the default
// plan. A drag goes there and back in so many edits and ends early after so many seconds. Several built pages take turns, drag by drag.
// Without a graphics card the picture is drawn in software, by threads that take every core: they are put behind the page's own, as
// they would not run at all elsewhere. `--undrawn` leaves the calls of WebGL that draw out.

import assert from "node:assert/strict";
import { readdirSync } from "node:fs";
import { setPriority } from "node:os";
import { parseArgs } from "node:util";
import * as harness from "./harness.mjs";

/** What an edit changes, at a place from 0 to 1 of the drag and back; runs in the page. */
const DRAGS = {
  insertion: (scene, at) => (scene.insertion = 0.5 + 0.5 * at),
  radius: (scene, at) => (scene.implant.base_radius_mm = 50 + 8 * at),
  volume: (scene, at) => (scene.implant.projection_mm = 25 + 10 * at),
  pinch: (scene, at) => (scene.layers[1].thickness_mm = 8 + 4 * at),
  "one axis": (scene, at) => (scene.implant.center_mm = [6 * at + 0.01, 0]),
  "both axes": (scene, at) => (scene.implant.center_mm = [6 * at + 0.01, -4 * at - 0.01]),
};

/** Limit of the time from the last edit to the solved grid [s]. */
const REST = 30;

const { values: options, positionals } = parseArgs({
  allowPositionals: true,
  options: {
    edits: { type: "string", default: "60" },
    seconds: { type: "string", default: "20" },
    plan: { type: "string" },
    undrawn: { type: "boolean", default: false },
    page: { type: "string", multiple: true, default: [harness.DIST] },
  },
});
const nodesPerSide = Number(positionals[0] ?? 129);
const tissueModel = positionals[1] ?? "layered";
const plan = options.plan ?? (tissueModel === "sheet" ? "default" : "opening");
const [edits, seconds] = [options.edits, options.seconds].map(Number);
assert.ok(edits > 1 && seconds > 0 && nodesPerSide > 1, "numbers of edits, seconds and nodes");
assert.ok(["opening", "default"].includes(plan), "--plan is opening or default");

/** Puts the threads that draw behind all others. */
async function drawLast(browser) {
  const cdp = await browser.newBrowserCDPSession();
  const { processInfo } = await cdp.send("SystemInfo.getProcessInfo");
  for (const { id } of processInfo.filter(({ type }) => type === "GPU")) {
    for (const thread of readdirSync(`/proc/${id}/task`)) setPriority(Number(thread), 19);
  }
}

/** Leaves out what draws. */
function leaveDrawingOut() {
  for (const name of ["clear", "drawArrays", "drawElements"]) WebGL2RenderingContext.prototype[name] = () => {};
}

/** Drags one value there and back: times [ms] of each edit and of the rest, and the number of edits with a measured shape. */
function drag(page, opening, edit) {
  return page.evaluate(
    async ({ opening, edit, edits, seconds, rest }) => {
      const change = new Function(`return (${edit})`)();
      const scene = JSON.parse(opening);
      const nextFrame = () => new Promise((resolve) => requestAnimationFrame(resolve));
      const until = async (isReached, limit) => {
        const start = performance.now();
        while (!isReached() && performance.now() - start < 1000 * limit) await nextFrame();
        return isReached();
      };
      const isSolved = () => implantPreview.stats().converged;
      const setPlace = (at) => {
        change(scene, at);
        implantPreview.setScene(JSON.stringify(scene));
      };
      setPlace(0);
      await nextFrame();
      if (!(await until(isSolved, rest))) throw new Error("the plan at the start is not solved");
      const [solver, frames] = [[], []];
      let [measured, from, last] = [0, performance.now(), 0];
      const end = from + 1000 * seconds;
      for (let count = 1; count <= edits && performance.now() < end; count += 1) {
        const before = implantPreview.stats().measurements;
        last = performance.now();
        setPlace(0.5 - 0.5 * Math.cos((2 * Math.PI * count) / edits));
        await nextFrame();
        const [stats, now] = [implantPreview.stats(), performance.now()];
        solver.push(stats.solve_ms);
        frames.push(now - from);
        measured += Number(stats.measurements > before);
        from = now;
      }
      const { frames: drawn, solve_ms: spent } = implantPreview.stats();
      const isAtRest = await until(isSolved, rest);
      const stats = implantPreview.stats();
      const own = { frames: stats.frames - drawn, solver: stats.solve_ms - spent };
      return { solver, frames, measured, own, rest: isAtRest ? performance.now() - last : Infinity };
    },
    { opening, edit: edit.toString(), edits, seconds, rest: REST },
  );
}

/** Median and 95th percentile of times, as text. */
function summary(times) {
  const sorted = times.toSorted((a, b) => a - b);
  const at = (part) => sorted[Math.min(sorted.length - 1, Math.floor(part * sorted.length))];
  return [at(0.5), at(0.95)].map((ms) => ms.toFixed(1).padStart(7)).join("");
}

const browser = await harness.startBrowser();
const pages = [];
for (const folder of options.page) {
  const site = await harness.serve({ folder });
  // The page's own policy allows no code from text.
  const { page, problems } = await harness.openApp(browser, site, {
    isOpening: true,
    isSmooth: true,
    options: { bypassCSP: true },
    init: options.undrawn ? leaveDrawingOut : undefined,
  });
  const scene = JSON.parse(await page.evaluate((plan) => implantPreviewApi[`${plan}_scene`](), plan));
  scene.solver = { ...scene.solver, nodes_per_side: nodesPerSide };
  scene.tissue_model = tissueModel;
  if (tissueModel === "sheet") delete scene.chest;
  pages.push({ folder, site, page, problems, opening: JSON.stringify(scene) });
}
if (!options.undrawn) await drawLast(browser);
console.log(`${plan} plan, ${tissueModel}, ${nodesPerSide} nodes a side, ${edits} edits${options.undrawn ? ", not drawn" : ""}`);
console.log("value       solver [ms]: median, 95 %; from frame to frame [ms]: median, 95 %; measured of edits; solved after [ms]: frames, solver [ms]");
for (const [name, edit] of Object.entries(DRAGS)) {
  for (const { folder, page, opening } of pages) {
    await page.bringToFront();
    const { solver, frames, measured, own, rest } = await drag(page, opening, edit);
    const words = pages.length > 1 ? ` ${folder}` : "";
    console.log(`${name.padEnd(10)}${summary(solver)}${summary(frames)}   ${measured} of ${solver.length}${rest.toFixed(0).padStart(6)}: ${own.frames}, ${own.solver.toFixed(0)}${words}`);
    assert.ok(Number.isFinite(rest), `${name}: not solved ${REST} s after the last edit`);
  }
}
await browser.close();
for (const { site, problems } of pages) {
  await site.close();
  assert.deepEqual(problems, []);
}
