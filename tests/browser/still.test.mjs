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

/** Left, right and lower end of the body in the lower half of the picture's area, at the right below the app's legend. */
async function ends(page, { x, y, width, height }) {
  const box = async (share) => {
    const clip = { x, y: Math.round(y + (1 - share) * height), width, height: Math.floor(share * height) };
    return harness.colouredBox(page, await page.screenshot({ clip }));
  };
  const [[left, , , lower], [, , right]] = [await box(0.5), await box(0.38)];
  return [left, right, lower];
}

describe("the still picture of the opening plan", { timeout: 8 * harness.PATIENCE }, () => {
  for (const screen of SCREENS) {
    test(`${screen.name}: is there before the program and makes place without a jump`, async () => {
      const { page, context, release } = await openWaiting(screen);
      const still = page.locator("#still");
      await still.waitFor({ state: "visible" });
      assert.equal(await page.evaluate(() => globalThis.implantPreview), undefined, "the program runs already");
      assert.ok(await still.locator("img").evaluate((image) => image.decode().then(() => image.naturalWidth > 100)));
      const area = await still.boundingBox();
      // The card with the progress would hide the lower end of a phone's picture.
      await page.locator("#loading .card").evaluate((card) => (card.style.visibility = "hidden"));
      const before = await ends(page, area);
      await harness.screenshot(page, `still-${screen.name}`);
      release();
      await still.waitFor({ state: "detached" });
      await page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
      await page.mouse.move(5, 5);
      await harness.settled(page);
      const after = await ends(page, area);
      await harness.screenshot(page, `still-${screen.name}-after`);
      assert.ok(before[1] - before[0] > 100, `nothing is drawn: ${before}`);
      for (let k = 0; k < 3; k += 1) {
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
