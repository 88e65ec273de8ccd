// Drags the controls of the built page back and forth, changes colours, takes back and does again, and
// watches what must not grow: memory, the solver's share of a frame, errors.
//
// node tests/browser/endurance.mjs [MINUTES]: on its own, for 10 minutes unless told otherwise, after two
// to warm up.

import assert from "node:assert/strict";
import { fileURLToPath } from "node:url";
import * as harness from "./harness.mjs";

// Controls by their names, in the order of the Tab key, and what of the scene each changes.
const SLIDERS = [
  ["Width (cm)", "implant.base_radius_mm"],
  ["Volume (ml)", "implant.projection_mm"],
  ["Pinch (cm)", "layers.1.thickness_mm"],
  ["Margin (cm)", "pocket_radius_mm"],
];

// The picture is drawn in software: a small one leaves time for what is tested.
export const VIEWPORT = { width: 1100, height: 720 };

/** The leaves of a scene by their path. */
function leaves(value, path = "") {
  if (value === null || typeof value !== "object") return [[path, value]];
  return Object.entries(value).flatMap(([name, inner]) => leaves(inner, path ? `${path}.${name}` : name));
}

const sceneOf = async (page) => new Map(leaves(JSON.parse(await page.evaluate(() => implantPreview.scene()))));

/** Where the sliders are. */
async function findSliders(page) {
  const sliders = [];
  const found = (field, { x, y, width, height }) => {
    const at = (share) => ({ x: x + share * width, y: y + height / 2 });
    sliders.push([field, { from: at(0.1), to: at(0.85) }]);
  };
  for (const [control, field] of SLIDERS) found(field, await harness.control(page, control));
  return sliders;
}

/** Drags a slider from one end to the other and back; the values seen. */
async function drag(page, name, { from, to }) {
  const seen = new Set();
  const at = (share) => [from.x + share * (to.x - from.x), from.y];
  await page.mouse.move(...at(0.5));
  await page.waitForTimeout(60);
  await page.mouse.down();
  for (let step = 0; step <= 16; step += 1) {
    await page.mouse.move(...at(0.5 + 0.5 * Math.sin((2 * Math.PI * step) / 16)));
    await page.waitForTimeout(20);
    if (step % 4 === 2) seen.add((await sceneOf(page)).get(name));
  }
  await page.mouse.up();
  return seen;
}

/** What there is of memory [bytes], after what is not used was collected. */
async function memory(page, cdp) {
  await cdp.send("HeapProfiler.collectGarbage");
  const { metrics } = await cdp.send("Performance.getMetrics");
  return {
    wasm: await page.evaluate(async () => (await implantPreviewApi.default()).memory.buffer.byteLength),
    script: metrics.find((metric) => metric.name === "JSHeapUsedSize").value,
  };
}

/** Rounds of drags after which the warm-up ends even if the program's memory still grows. */
const MAX_WARM_ROUNDS = 6;

/**
 * Solves a plan without an answer to its end: the last method tried there takes the most memory, and only a machine that
 * stalls within a drag gets that far. Memory of a page is never handed back.
 */
async function reachTheMost(page, opening) {
  const scene = JSON.parse(opening);
  scene.implant.projection_mm = 1.75 * scene.implant.base_radius_mm;
  await page.evaluate((text) => implantPreview.setScene(text), JSON.stringify(scene));
  await harness.settled(page);
  const { converged, work_units } = await page.evaluate(() => implantPreview.stats());
  assert.ok(!converged && work_units > 0, "the plan without an answer has one");
}

/**
 * Drags one slider after the other to warm up: each twice, for as long as is asked, and until a whole round has left the
 * program's memory as it was; then for some `seconds` and `drags` more. Gives what there was after the warm-up and after each
 * drag from then on: memory [bytes] and the app's figures.
 */
export async function endure(page, { seconds = 0, drags = 0, warm = 0, report = () => {} }) {
  const cdp = await page.context().newCDPSession(page);
  await cdp.send("Performance.enable");
  const opening = await page.evaluate(() => implantPreview.scene());
  await reachTheMost(page, opening);
  await page.evaluate((scene) => implantPreview.setScene(scene), opening);
  await page.waitForFunction(() => implantPreview.stats().converged);
  const sliders = await findSliders(page);
  const samples = [];
  const warmUp = [];
  const round = sliders.length;
  const isWarm = () => {
    const [before, now] = [warmUp.at(-1 - round), warmUp.at(-1)];
    return warmUp.length >= 2 * round && since() >= warm && (before === now || warmUp.length >= MAX_WARM_ROUNDS * round);
  };
  const start = Date.now();
  const since = () => (Date.now() - start) / 1000;
  let end = Infinity;
  for (let k = 0; since() < end || samples.length <= drags; k += 1) {
    if (k % round === 0) {
      await page.evaluate((scene) => implantPreview.setScene(scene), opening);
      await page.waitForFunction(() => implantPreview.stats().converged);
    }
    const [name, slider] = sliders[k % round];
    const seen = await drag(page, name, slider);
    if (seen.size < 2) await harness.screenshot(page, "endurance");
    assert.ok(seen.size >= 2, `${name} does not move: ${[...seen]}`);
    const colour = String(1 + (k % 5));
    await harness.focusPicture(page);
    for (const key of ["Control+z", "Control+z", "Control+Shift+z", colour]) {
      await page.keyboard.press(key);
      await page.waitForTimeout(20);
    }
    // A slow frame takes the last keys late.
    await harness.settled(page);
    await page.waitForFunction(() => implantPreview.stats().converged);
    const taken = await memory(page, cdp);
    if (samples.length === 0) {
      warmUp.push(taken.wasm);
      if (!isWarm()) continue;
      end = since() + seconds;
    }
    const stats = await page.evaluate(() => implantPreview.stats());
    samples.push({ name, seconds: since(), ...taken, ...stats });
    report(samples.at(-1));
  }
  await cdp.detach();
  return samples;
}

/** How far values reach from the first of them, as a share of it. */
export const growth = (values) => Math.max(...values.map((value) => Math.abs(value / values[0] - 1)));

async function main(minutes) {
  const site = await harness.serve();
  const browser = await harness.startBrowser();
  const { page, problems } = await harness.openApp(browser, site, { viewport: VIEWPORT, isOpening: true, isSmooth: true });
  const samples = await endure(page, {
    seconds: 60 * minutes,
    warm: 120,
    report: (sample) => console.log(JSON.stringify(sample)),
  });
  await browser.close();
  await site.close();
  const wasm = growth(samples.map((sample) => sample.wasm));
  const script = growth(samples.map((sample) => sample.script));
  const longest = samples.at(-1).solver_ms_max;
  const percent = (share) => `${(100 * share).toFixed(2)} %`;
  console.log(`${samples.length - 1} drags in ${minutes} minutes, ${samples.at(-1).solves} solves`);
  console.log(`memory of the program ± ${percent(wasm)}, of scripts ± ${percent(script)}`);
  console.log(`greatest time in the solver of a frame ${longest.toFixed(1)} ms`);
  assert.deepEqual(problems, []);
  assert.ok(wasm <= 0.02, "the program's memory grows");
  assert.ok(script <= 0.02, "the scripts' memory grows");
  assert.ok(longest <= 100, "a frame took too long in the solver");
}

if (process.argv[1] === fileURLToPath(import.meta.url)) await main(Number(process.argv[2] ?? 10));
