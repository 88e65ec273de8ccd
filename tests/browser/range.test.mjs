// The range of implants in the built page: workers fill the chart, a click takes an implant, an edit restarts the chart.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp();
const { openApp } = fixture;
const { pause, scene, stats } = harness;

const CHART = "Range of implants, chart";

/** Opens the range by its button, on a phone by the menu, and gives the place of the chart. */
async function openRange(page) {
  if (page.viewportSize().width < 760) {
    await harness.control(page, "View");
    await page.keyboard.press("Enter");
    await harness.drawn(page);
  }
  const button = await harness.control(page, "Range of implants");
  await page.mouse.click(button.x + button.width / 2, button.y + button.height / 2);
  await page.waitForFunction(() => implantPreview.stats().range_all > 0);
  return harness.control(page, CHART);
}

const filled = (page) =>
  page.waitForFunction(() => {
    const { range_done, range_all } = implantPreview.stats();
    return range_all > 0 && range_done === range_all;
  }, null, { timeout: 4 * harness.PATIENCE });

/** The place of a column and row of the first chart on the page: 17 widths, 17 projections. */
const at = ({ x, y, width, height }, i, j) => [x + (width * i) / 16, y + height * (1 - j / 16)];

describe("the range of implants", { timeout: 20 * harness.PATIENCE }, () => {
  test("is of a dropped shelf kept over a reload, fills in workers, starts again with an edit; clicks and keys take an implant", async () => {
    const { page, finish } = await openApp();
    const table = "name;width_cm;volume_ml\nRound 310;12,3;310\n";
    await page.evaluate((table) => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([table], "shelf.csv", { type: "text/csv" }));
      for (const type of ["dragover", "drop"]) {
        document.querySelector("canvas").dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
      }
    }, table);
    await harness.control(page, "Take 1 size");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => localStorage.getItem("implant-preview/shelf/1")?.includes("Round 310"));
    await page.reload();
    await page.waitForFunction(() => globalThis.implantPreview?.stats().converged);

    // An edit cancels the chart and starts it again.
    const chart = await openRange(page);
    await page.waitForFunction(() => implantPreview.stats().range_done > 8);
    const { solves } = await stats(page);
    await harness.type(page, "Margin (cm)", "2.5");
    await page.waitForFunction((solves) => implantPreview.stats().solves > solves, solves);
    const before = await scene(page);
    assert.equal(before.pocket_radius_mm, 85);
    await filled(page);
    // Some of the points, and those of the border of no answer, if there is one.
    const { range_all: solved } = await stats(page);
    assert.ok(solved >= 17 && solved < (17 * 17) / 2, `${solved} points are solved`);
    assert.ok((await harness.colours(page)) > 60, "the chart is blank");
    await harness.screenshot(page, "range");

    // Keys choose a point, the words follow, the Enter key takes.
    await harness.control(page, CHART);
    for (const key of ["ArrowRight", "ArrowRight", "ArrowUp"]) {
      await page.keyboard.press(key);
      await pause(100);
    }
    await page.waitForFunction(() =>
      /^Width 12\.25 cm, projection 4\.25 cm: Skin stretch: \d+ percent/.test(
        document.getElementById("implant-preview-summary").textContent,
      ),
    );
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => JSON.parse(implantPreview.scene()).implant.base_radius_mm === 61.25);
    // The words follow once they rest.
    await page.waitForFunction(() => /^Width 12\.25 cm/.test(document.getElementById("implant-preview-summary").textContent));
    await page.keyboard.press("Control+z");
    await page.waitForFunction(() => JSON.parse(implantPreview.scene()).implant.base_radius_mm === 60);

    // A click takes an implant in one step.
    await page.mouse.click(...at(chart, 10, 10));
    await page.waitForFunction(() => JSON.parse(implantPreview.scene()).implant.base_radius_mm === 62.5);
    const taken = await scene(page);
    assert.equal(taken.implant.projection_mm, 45);
    const margin = ({ pocket_radius_mm, implant }) => pocket_radius_mm - implant.base_radius_mm;
    assert.ok(Math.abs(margin(taken) - margin(before)) < 1e-9);
    // The chart stays: its points are the same.
    const { range_done, range_all } = await stats(page);
    assert.equal(range_done, range_all);
    await page.keyboard.press("Control+z");
    await page.waitForFunction(() => JSON.parse(implantPreview.scene()).implant.base_radius_mm === 60);
    assert.deepEqual(await scene(page), before);

    // On the shelf's size it takes exactly the listed one.
    const { x, y, width, height } = chart;
    const radius = 61.5;
    const projection = (1500 * 310) / (Math.PI * radius * radius);
    await page.mouse.click(x + (width * 23) / 40, y + height * (1 - (projection - 20) / 40));
    await page.waitForFunction(() => JSON.parse(implantPreview.scene()).implant.base_radius_mm === 61.5);
    assert.ok(Math.abs((await scene(page)).implant.projection_mm - projection) < 1e-9);
    await finish();
  });

  test("has room on a phone", async () => {
    const { page, finish } = await openApp({ viewport: { width: 390, height: 844 }, isPlain: true });
    const chart = await openRange(page);
    assert.ok(chart.width > 240 && chart.height > 170, JSON.stringify(chart));
    await harness.screenshot(page, "range-phone");
    await finish();
  });
});
