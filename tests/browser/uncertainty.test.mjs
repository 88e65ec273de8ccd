// What is not known, in the built page: workers sample patients, an edit restarts them, the bands are the native ones.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp({ isPlain: true });
const { openApp } = fixture;
const { scene, sceneText, stats } = harness;

const SAMPLES = 16;
const SWITCH = "Show what is not known";

const summary = (page) => page.locator("#implant-preview-summary").textContent();

/** Types into a number field without a slider. */
async function typeInto(page, name, text) {
  await harness.control(page, name);
  await page.keyboard.type(text, { delay: 40 });
  await page.keyboard.press("Enter");
}

/** Presses a control by the Space key. */
async function press(page, name) {
  await harness.control(page, name);
  await page.keyboard.press("Space");
  // A Tab key in the same frame would move the focus first.
  await harness.drawn(page);
}

/** Opens the fold, switches the section on and reduces the samples by the keyboard. */
async function showUnknown(page) {
  await press(page, "Uncertainty");
  await press(page, SWITCH);
  await press(page, "What is varied");
  await typeInto(page, "Sampled patients", String(SAMPLES));
}

/** Waits until all patients are sampled; the sentence of the summary. */
async function sampled(page) {
  await page.waitForFunction(
    () => {
      const { samples_done, samples_all } = implantPreview.stats();
      return samples_all > 0 && samples_done === samples_all;
    },
    null,
    { timeout: 6 * harness.PATIENCE },
  );
  // Not the sentence of the patients before they became fewer.
  await page.waitForFunction(
    (words) => document.getElementById("implant-preview-summary").textContent.includes(words),
    `Of ${SAMPLES} sampled patients`,
  );
  return summary(page);
}

/** The report of the API's bands for a scene, computed in the workers of the page. */
const bandsOfPage = (page, text) =>
  page.evaluate(
    async ([scene, samples]) => {
      const options = { scene: JSON.parse(scene), samples, importance_rows: samples };
      return JSON.parse(await implantPreviewApi.bands(JSON.stringify(options), () => {}).done);
    },
    [text, SAMPLES],
  );

const band = (report, name) => report.bands.find(({ quantity }) => quantity === name);

describe("what is not known", { timeout: 20 * harness.PATIENCE }, () => {
  test("is sampled in workers as by the API and natively; an edit samples the new plan, the switch ends the study", async () => {
    const { page, finish } = await openApp();
    const text = await sceneText(page);
    const { solves } = await stats(page);
    await showUnknown(page);
    const words = await sampled(page);
    const [report, native] = [await bandsOfPage(page, text), harness.nativeBands(text, ["--samples", String(SAMPLES)])];
    for (const name of ["greatest_strain", "least_cover_mm", "greatest_pressure_mmhg"]) {
      const [found, expected] = [band(report, name), band(native, name)];
      assert.ok(words.includes(found.text), `${found.text} in: ${words}`);
      for (const percentile of ["p10", "p50", "p90"]) {
        const ratio = found[percentile] / expected[percentile];
        // The samples are computed to a tolerance of 0.1 % of the base radius.
        assert.ok(Math.abs(ratio - 1) < 5e-3, `${name} ${percentile}: ${ratio} times the native one`);
      }
    }
    assert.match(words, /not a prediction for a person/);
    assert.equal((await stats(page)).solves, solves, "the session solved something for the samples");
    await harness.screenshot(page, "uncertainty");
    await harness.type(page, "Width (cm)", "13");
    await page.waitForFunction(() => implantPreview.stats().samples_done < implantPreview.stats().samples_all);
    assert.equal((await scene(page)).implant.base_radius_mm, 65);
    const after = await sampled(page);
    assert.notEqual(after, words);
    await harness.control(page, SWITCH);
    await page.keyboard.press("Space");
    await page.waitForFunction(() => implantPreview.stats().samples_all === 0);
    await page.waitForFunction(
      () => !document.getElementById("implant-preview-summary").textContent.includes("sampled"),
    );
    await finish();
  });
});
