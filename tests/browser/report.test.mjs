// Picture and report in the real page: what is saved, and how the report opens without the program.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp();

/** Chooses an item of the menu "File" and reads the file that is downloaded, with its path. */
async function save(page, item) {
  // The previous file may still be on its way, and frames are slow on a busy machine.
  await harness.settled(page);
  await harness.control(page, "File");
  await page.keyboard.press("Enter");
  await harness.settled(page);
  for (let presses = 0; presses < 8 && (await harness.focused(page)).name !== item; presses += 1) await harness.tab(page);
  assert.equal((await harness.focused(page)).name, item);
  const [file] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("Enter")]);
  return { name: file.suggestedFilename(), path: await file.path() };
}

describe("a plan on paper", { timeout: 15 * harness.PATIENCE }, () => {
  test("is a picture of the window and a report that loads nothing and runs nothing", async () => {
    const { page, finish } = await fixture.openApp();
    const picture = await save(page, "Save picture (PNG)…");
    assert.equal(picture.name, "plan.png");
    const bytes = await readFile(picture.path);
    assert.equal(bytes.toString("latin1", 1, 4), "PNG");
    const { width, height } = page.viewportSize();
    assert.deepEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], [width, height]);

    const report = await save(page, "Save report (HTML)…");
    assert.equal(report.name, "report.html");
    const text = await readFile(report.path, "utf8");
    const paper = await page.context().newPage();
    const requests = [];
    paper.on("request", (request) => requests.push(request.url().slice(0, 20)));
    await paper.setContent(text);
    assert.equal(await paper.locator("h1").textContent(), "Implant preview");
    assert.match(await paper.locator("body").textContent(), /Not a medical device/);
    assert.match(await paper.locator("body").textContent(), /12 cm|12\.0 cm/);
    const image = paper.locator("img");
    const [shown, part] = await image.evaluate((img) => [img.complete && img.naturalWidth, img.naturalHeight]);
    assert.ok(shown > 0.3 * width && shown < width && part < height, `${shown} × ${part}`);
    // The picture is not empty: the tissue has many colours.
    const colours = await image.evaluate((img) => {
      const canvas = Object.assign(document.createElement("canvas"), { width: 64, height: 64 });
      const context = canvas.getContext("2d");
      context.drawImage(img, 0, 0, 64, 64);
      const { data } = context.getImageData(0, 0, 64, 64);
      return new Set(Array.from({ length: 4096 }, (_, k) => (data[4 * k] << 16) | (data[4 * k + 1] << 8) | data[4 * k + 2])).size;
    });
    assert.ok(colours > 100, `${colours} colours`);
    // The plan's file in the report opens as the plan.
    const plan = await paper.locator("details pre").textContent();
    assert.deepEqual(JSON.parse(plan), await harness.scene(page));
    assert.ok(requests.every((address) => address.startsWith("data:image/png")), String(requests));
    await paper.close();
    await finish();
  });
});
