// The benchmark's page: the study of the command line, in a worker.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const HEADER =
  "method,springs,scene,nodes_per_side,work_units,time_ms,error_vs_own_grid,error_vs_reference,status";
// The colours of the methods' lines in the picture.
const COLOURS = {
  multigrid: "#0072B2",
  newton: "#009E73",
};

const fixture = harness.setUp({ webgl: false });
const open = (query = "", options) => fixture.openPage(`bench.html${query}`, options);

const press = (page, name) => page.getByRole("button", { name }).click();

const isDone = (page) => page.getByRole("status").getByText("Done in").waitFor();

/** Name and text of the file that a button downloads. */
const saved = (page, name) => harness.download(page, () => press(page, name));

/** The rows of a table, their numbers read. */
function rows(csv) {
  const [header, ...lines] = csv.trimEnd().split("\n");
  assert.equal(header, HEADER);
  const names = header.split(",");
  const numbers = ["nodes_per_side", "work_units", "time_ms", "error_vs_own_grid", "error_vs_reference"];
  return lines.map((line) => {
    const row = Object.fromEntries(line.split(",").map((field, k) => [names[k], field]));
    for (const name of numbers) row[name] = Number(row[name]);
    return row;
  });
}

/** How many lines of each colour the panels of the picture in the document have. */
const lines = (page) =>
  page.evaluate(
    (colours) =>
      colours.map((colour) => {
        const all = document.querySelectorAll(`#picture polyline[stroke="${colour}"][opacity="1"]`);
        // Those of the legend have two points.
        const isLine = (line) => line.getAttribute("points").trim().split(" ").length !== 2;
        return [...all].filter(isLine).length;
      }),
    Object.values(COLOURS),
  );

describe("the benchmark", { timeout: 6 * harness.PATIENCE }, () => {
  test("has no field into which a phone zooms", async () => {
    const { page, finish } = await open();
    const { count, small } = await harness.smallFields(page);
    assert.deepEqual(small, []);
    assert.ok(count > 3, `${count} fields`);
    await finish();
  });

  test("measures in the browser what the command line measures", async () => {
    const { page, finish } = await open("?nodes_per_side=17,33&cases=default");
    await press(page, "Start");
    // The page answers while the study runs: seen in one look, as the study may end between two.
    await page.waitForFunction(() => {
      const isRunning = document.querySelector("#now").textContent.includes("of 10: ");
      return isRunning && [...document.querySelectorAll("input[type=radio]")].every((radio) => radio.matches(":disabled"));
    });
    await isDone(page);

    const { name, text } = await saved(page, "Download CSV");
    assert.equal(name, "work_precision.csv");
    const here = rows(text);
    for (const row of here) {
      assert.ok(row.method !== "multigrid_8" || row.error_vs_own_grid < 1e-3, JSON.stringify(row));
    }
    const natively = rows(harness.nativeBenchmark()).filter((row) => row.nodes_per_side <= 33);
    assert.equal(here.length, natively.length);
    here.forEach((row, k) => {
      const other = natively[k];
      for (const field of ["method", "springs", "scene", "nodes_per_side", "status"]) {
        assert.equal(row[field], other[field]);
      }
      const work = Math.abs(row.work_units - other.work_units);
      assert.ok(work <= 1e-5 * other.work_units, `${row.method}: ${work} units more or less`);
      for (const field of ["error_vs_own_grid", "error_vs_reference"]) {
        const difference = Math.abs(row[field] - other[field]);
        assert.ok(difference < 1e-5, `${row.method}: ${field} differs by ${difference}`);
      }
    });

    const picture = await saved(page, "Download SVG");
    assert.equal(picture.name, "work_precision_default.svg");
    assert.match(picture.text, /^<svg [^]*17 nodes a side[^]*33 nodes a side[^]*<\/svg>\s*$/);
    assert.deepEqual(await lines(page), [2, 2]);
    assert.equal(await page.locator("#times tr").count(), 5);
    const times = await page.locator("#times td").allTextContents();
    assert.equal(times.length, 10);
    // One cycle may not be enough on the coarsest grid: the table says so.
    const methods = await page.locator("#times th").allTextContents();
    const [oneCycle] = here.filter((row) => row.method === "multigrid_1");
    assert.match(methods[0], /1 cycle/);
    assert.equal(times[0] === "–", oneCycle.error_vs_own_grid > 1e-3, times[0]);
    assert.ok(times.slice(1).every((time) => /^(< )?[\d.]+ m?s$/.test(time)), times.join());
    await harness.screenshot(page, "benchmark");
    await finish();
  });

  test("shows one line for each method that was measured, scene by scene", async () => {
    const { page, finish } = await open(
      "?nodes_per_side=17&cases=default,skin-equator&methods=newton,multigrid_1",
      { viewport: { width: 390, height: 844 } },
    );
    // By keyboard: the link, the choice, the button.
    for (const key of ["Tab", "Tab", "Tab", "Enter"]) await page.keyboard.press(key);
    await isDone(page);
    assert.deepEqual(await lines(page), [1, 1]);
    await page.getByRole("combobox", { name: "Scene" }).selectOption("skin-equator");
    assert.match(await page.locator("#picture").textContent(), /skin-equator/);
    const { scrollWidth, clientWidth } = await page.evaluate(() => document.documentElement);
    assert.equal(scrollWidth, clientWidth, "the page scrolls sideways");
    await harness.screenshot(page, "benchmark-narrow");
    await finish();
  });

  test("stops at once, keeps what was measured and starts anew", async () => {
    const { page, finish } = await open();
    await page.getByRole("radio", { name: /^full/ }).check();
    await press(page, "Start");
    await page.locator("#times td").first().waitFor();
    await press(page, "Stop");
    assert.match(await page.getByRole("status").textContent(), /^Stopped\. Measured: \d+ of 150\.$/);
    const measured = (await saved(page, "Download CSV")).text;
    await page.waitForTimeout(500);
    assert.equal((await saved(page, "Download CSV")).text, measured);
    await page.getByRole("radio", { name: /^quick/ }).check();
    await press(page, "Start");
    // A fast machine is done before the next look.
    await page.locator("body").getByText(/of 15: |^Done in/).first().waitFor();
    await finish();
  });

  test("a choice that is not possible is refused in one line", async () => {
    for (const [query, expected] of [
      ["?methods=magic", /methods\[0\]: unknown variant `magic`; allowed: `multigrid_1`/],
      ["?nodes_per_side=5", /nodes_per_side\[0\] is 5; allowed: 17 to 1025/],
      ["?nodes_per_side=many", /nodes_per_side\[0\]: invalid type/],
    ]) {
      const { page, finish } = await open(query);
      await press(page, "Start");
      const alert = page.getByRole("alert");
      await alert.waitFor();
      assert.match(await alert.textContent(), expected);
      assert.equal(await page.getByRole("button", { name: "Start" }).isVisible(), true);
      await finish();
    }
  });

  test("a download that fails is shown, not swallowed", async () => {
    for (const file of ["*.wasm", "implant-preview.mjs"]) {
      const { page, close } = await open();
      await page.context().route(`**/${file}`, (route) => route.fulfill({ status: 404 }));
      await press(page, "Start");
      const alert = page.getByRole("alert");
      await alert.waitFor();
      assert.match(await alert.textContent(), /^The benchmark stopped: \S/);
      await close();
    }
  });

  test("leads back to the preview", async () => {
    const { page, close } = await open();
    await page.getByRole("link", { name: /preview/ }).click();
    await page.waitForURL(fixture.site.address);
    await close();
  });
});
