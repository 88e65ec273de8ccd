// The camera of the real page, moved by a real mouse: views arrive, the wheel zooms to the pointer.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp();

// Below the buttons.
const PICTURE = { x: 320, y: 130, width: 640, height: 490 };

/** The picture without values at the pointer. */
async function picture(page) {
  await page.mouse.move(5, 5);
  await harness.settled(page);
  return page.screenshot({ clip: PICTURE });
}

describe("the camera", { timeout: 6 * harness.PATIENCE }, () => {
  test("arrives at a view after one click, while the pointer stays on the button over the picture", async () => {
    const { page, finish } = await fixture.openApp({ isResearch: true });
    const opening = await picture(page);
    for (const view of ["Front", "Side", "Top", "All"]) {
      const { x, y, width, height } = await harness.control(page, view);
      const click = async () => {
        await page.mouse.click(x + width / 2, y + height / 2);
        await harness.settled(page);
        return picture(page);
      };
      const [once, twice] = [await click(), await click()];
      assert.equal(await harness.difference(page, once, twice), 0, `${view} stops half-way`);
      const turned = await harness.difference(page, opening, once);
      if (view === "All") assert.equal(turned, 0, "the opening view is another");
      else assert.ok(turned > 10_000, `${view} turns nothing`);
    }
    await finish();
  });

  test("zooms by the wheel and stops before the tissue", async () => {
    const { page, finish } = await fixture.openApp();
    const opening = await picture(page);
    const wheel = async (turns) => {
      await page.mouse.move(560, 300);
      // Three notches at once.
      for (let k = 0; k < turns; k += 1) await page.mouse.wheel(0, -300);
      await harness.settled(page);
      return picture(page);
    };
    const near = await wheel(10);
    assert.ok((await harness.difference(page, opening, near)) > 10_000, "the wheel zooms nothing");
    assert.equal(await harness.difference(page, near, await wheel(2)), 0, "the eye goes on into the tissue");
    await harness.screenshot(page, "zoomed");
    await finish();
  });
});
