// Pins and plan in the real page: a hand pins, edits and compares; a reload and a saved file keep the pins, a reload the plan.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp();
const { openApp } = fixture;
const { stats } = harness;

const KEY = "implant-preview/pins/1";

/** Clicks the control of a name. */
async function click(page, name) {
  const { x, y, width, height } = await harness.control(page, name);
  await page.mouse.click(x + width / 2, y + height / 2);
  await harness.drawn(page);
}

const volume = (page) => page.evaluate(() => JSON.parse(implantPreview.plan()).find((f) => f.name === "volume_ml").text);
const insertion = (page) => page.evaluate(() => JSON.parse(implantPreview.scene()).insertion);
const converged = (page) => page.waitForFunction(() => implantPreview.stats().converged);
const summary = (page) => page.locator("#implant-preview-summary").textContent();
const stored = (page) => page.evaluate((key) => localStorage.getItem(key), KEY);
const pinned = (page, pins) =>
  page.waitForFunction((pins) => document.getElementById("implant-preview-summary").textContent.endsWith(pins), pins);

/** Steps the insertion down by a key until the insertion is the given one. */
async function lower(page, to) {
  await harness.focusPicture(page);
  while ((await insertion(page)) > to + 1e-9) {
    const before = await insertion(page);
    await page.keyboard.press("[");
    await page.waitForFunction((before) => JSON.parse(implantPreview.scene()).insertion < before, before);
  }
  await converged(page);
}

describe("pins", { timeout: 20 * harness.PATIENCE }, () => {
  test("are compared, opened without a solve, kept over a reload and saved", async () => {
    const { page, finish } = await openApp();
    await click(page, "Pin as A");
    await pinned(page, "Pinned: A.");
    await lower(page, 0.9);
    await click(page, "Pin as B");
    await pinned(page, "Pinned: A, B.");
    await page.waitForFunction((key) => localStorage.getItem(key)?.includes('"B"'), KEY);
    const text = await stored(page);
    assert.deepEqual(JSON.parse(text).pins.map((pin) => [pin.letter, pin.scene.insertion]), [["A", 1], ["B", 0.9]]);
    const solves = (await stats(page)).solves;
    await click(page, "Open A");
    assert.equal(await insertion(page), 1);
    await converged(page);
    assert.equal((await stats(page)).solves, solves);
    await harness.settled(page);
    await harness.screenshot(page, "compare");

    await click(page, "Side by side");
    await harness.settled(page);
    assert.ok((await harness.colours(page)) > 200, "the pictures are blank");
    const before = await page.screenshot({ clip: { x: 320, y: 60, width: 640, height: 560 } });
    await harness.screenshot(page, "side-by-side");
    // One camera: a drag in one picture turns all of them.
    await page.mouse.move(450, 250);
    await page.mouse.down();
    await page.mouse.move(500, 270, { steps: 4 });
    await page.mouse.up();
    await page.mouse.move(5, 5);
    await harness.settled(page);
    const after = await page.screenshot({ clip: { x: 320, y: 60, width: 640, height: 560 } });
    assert.ok((await harness.difference(page, before, after)) > 20_000, "a drag turns nothing");
    await harness.screenshot(page, "side-by-side-turned");

    const saved = await harness.download(page, () => page.keyboard.press("Control+s"));
    assert.deepEqual(JSON.parse(saved.text).pins, JSON.parse(text).pins);

    // The opening scene is that of A: only B is solved.
    await page.reload();
    await page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
    await pinned(page, "Pinned: A, B.");
    await harness.settled(page);
    assert.equal((await stats(page)).solves, 2);
    assert.equal(await stored(page), text);
    await click(page, "Open B");
    assert.equal(await insertion(page), 0.9);
    await converged(page);
    assert.equal((await stats(page)).solves, 2);

    // A change directly before a reload is kept too.
    await click(page, "Remove A");
    await page.reload();
    await page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
    await pinned(page, "Pinned: B.");
    await finish();
  });

  test("and the plan of two tabs stay apart; a new tab starts with the last written ones", async () => {
    const { page, finish } = await openApp({ isPlain: true });
    const set = async (page, volume) => {
      await page.evaluate((volume) => implantPreview.setPlan("volume_ml", volume), volume);
      await page.waitForFunction(() => implantPreview.stats().converged);
      await page.waitForTimeout(800);
    };
    const open = async () => {
      const other = await page.context().newPage();
      await other.goto(page.url());
      await other.waitForFunction(() => globalThis.implantPreview?.stats().converged);
      return other;
    };
    await set(page, "333");
    await click(page, "Pin as A");
    await harness.settled(page);
    const second = await open();
    assert.equal(await volume(second), "333");
    await set(second, "250");
    await click(second, "Remove A");
    await harness.settled(second);
    await page.reload();
    await page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
    assert.equal(await volume(page), "333");
    await pinned(page, "Pinned: A.");
    await second.reload();
    await second.waitForFunction(() => globalThis.implantPreview?.stats().converged);
    assert.equal(await volume(second), "250");
    const third = await open();
    assert.equal(await volume(third), "250");
    await finish();
  });

  test("and a plan of a corrupt or forbidden storage are ignored with a line", async () => {
    // A plan of another program is ignored too: the opening one is there.
    const corrupt = await openApp({
      isPlain: true,
      init: `localStorage.setItem("${KEY}", "\\u0000{[corrupt"); sessionStorage.setItem("implant-preview/plan/1", "{");`,
    });
    await harness.settled(corrupt.page);
    await harness.screenshot(corrupt.page, "pins-corrupt");
    assert.equal(await stored(corrupt.page), "\0{[corrupt");
    assert.doesNotMatch(await summary(corrupt.page), /Pinned/);
    assert.equal(await volume(corrupt.page), "225");
    await click(corrupt.page, "Close message");
    await corrupt.finish();
    const forbidden = await openApp({
      isPlain: true,
      init: 'Object.defineProperty(window, "localStorage", { get() { throw new DOMException("no"); } })',
    });
    await click(forbidden.page, "Pin as A");
    await pinned(forbidden.page, "Pinned: A.");
    await click(forbidden.page, "Close message");
    await harness.settled(forbidden.page);
    await forbidden.finish();
  });
});
