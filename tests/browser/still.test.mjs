// The still picture of the opening plan: there before the program, gone with the first shape, in the same place.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp();

const SCREENS = [
  { name: "wide", viewport: { width: 1440, height: 900 }, options: { colorScheme: "light" } },
  { name: "dark", viewport: { width: 1024, height: 768 }, options: { colorScheme: "dark" } },
  { name: "phone", viewport: { width: 390, height: 844 }, options: { colorScheme: "light" } },
  { name: "turned", viewport: { width: 844, height: 390 }, options: { colorScheme: "dark" } },
];

/** Opens the page without its program. `release` lets the program load. */
async function openWaiting(screen) {
  let release = () => {};
  const released = new Promise((resolve) => (release = resolve));
  const context = await fixture.browser.newContext({ serviceWorkers: "block", viewport: screen.viewport, ...screen.options });
  context.setDefaultTimeout(harness.PATIENCE);
  const page = await context.newPage();
  await page.route("**/*.wasm", async (route) => {
    await released;
    await route.continue();
  });
  await page.goto(fixture.site.address + (screen.hash ?? ""));
  return { page, context, release };
}

/** The lower half of the picture's area, where the app draws the body only. */
function lowerHalf({ x, y, width, height }) {
  return { x, y: Math.round(y + 0.5 * height), width, height: Math.floor(0.5 * height) };
}

describe("the still picture of the opening plan", { timeout: 8 * harness.PATIENCE }, () => {
  for (const screen of SCREENS) {
    test(`${screen.name}: is there before the program and makes place without a jump`, async () => {
      const { page, context, release } = await openWaiting(screen);
      const still = page.locator("#still");
      await still.waitFor({ state: "visible" });
      assert.equal(await page.evaluate(() => globalThis.implantPreview), undefined, "the program runs already");
      assert.ok(await still.locator("img").evaluate((image) => image.decode().then(() => image.naturalWidth > 100)));
      const clip = lowerHalf(await still.boundingBox());
      // The card with the progress would hide the lower end of a phone's picture.
      await page.locator("#loading .card").evaluate((card) => (card.style.visibility = "hidden"));
      const before = await harness.colouredBox(page, await page.screenshot({ clip }));
      await harness.screenshot(page, `still-${screen.name}`);
      release();
      await still.waitFor({ state: "detached" });
      await page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
      await page.mouse.move(5, 5);
      await harness.settled(page);
      const box = async (clip) => harness.colouredBox(page, await page.screenshot({ clip }));
      // At the upper edge of the half the outline is flat: a pixel down is several to the side.
      const down = (await box(clip))[3] - before[3];
      assert.ok(Math.abs(down) <= 4, `the picture moves by ${down} pixels`);
      const after = await box({ ...clip, y: clip.y + down });
      await harness.screenshot(page, `still-${screen.name}-after`);
      assert.ok(before[2] - before[0] > 100, `nothing is drawn: ${before}`);
      for (let k = 0; k < 4; k += 1) {
        assert.ok(Math.abs(before[k] - after[k]) <= 4, `the picture moves from ${before} to ${after}`);
      }
      await context.close();
    });
  }

  test("is not shown where the app opens another plan", async () => {
    const { page, context, release } = await openWaiting({ ...SCREENS[0], hash: "#plan=none" });
    await page.locator("#loading-text").waitFor({ state: "visible" });
    release();
    let seen = false;
    while (await page.locator("#loading").count()) seen ||= await page.locator("#still").isVisible().catch(() => false);
    assert.equal(seen, false);
    await context.close();
  });
});
