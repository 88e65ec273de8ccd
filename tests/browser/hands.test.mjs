// Hands on the picture with a real mouse, real fingers and real keys: values at a point, ruler, drag of the implant, commands.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp();

/** Where the handle is that moves the implant: over the implant's highest point. */
async function handle(page) {
  const { x, y, width, height } = await harness.control(page, "Move the implant");
  return { x: x + width / 2, y: y + height / 2 };
}

/** A point of the skin over the implant, left of the cut and of the handles. */
async function skin(page) {
  const { x, y } = await handle(page);
  return { x: x - 40, y: y + 8 };
}

const clipped = (page, { x, y }) =>
  page.screenshot({ clip: { x: x - 20, y: y - 20, width: 320, height: 220 } });

describe("hands on the picture", { timeout: 8 * harness.PATIENCE }, () => {
  test("the pointer shows values, a click keeps them, Escape removes them", async () => {
    const { page, finish } = await fixture.openApp();
    const SKIN = await skin(page);
    await harness.focusPicture(page);
    await page.mouse.move(5, 5);
    await harness.settled(page);
    const bare = await clipped(page, SKIN);
    await page.mouse.move(SKIN.x, SKIN.y);
    await harness.settled(page);
    await harness.screenshot(page, "hands-hover");
    assert.ok((await harness.difference(page, bare, await clipped(page, SKIN))) > 2000, "no values are shown");
    await page.mouse.click(SKIN.x, SKIN.y);
    await page.mouse.move(5, 5);
    await harness.settled(page);
    const kept = await clipped(page, SKIN);
    assert.ok((await harness.difference(page, bare, kept)) > 2000, "the values go with the pointer");
    await harness.screenshot(page, "hands-kept");
    await page.keyboard.press("Escape");
    await harness.settled(page);
    assert.ok((await harness.difference(page, bare, await clipped(page, SKIN))) < 200, "the values stay");
    await finish();
  });

  test("the ruler has two ends and a label", async () => {
    const { page, finish } = await fixture.openApp();
    const { x, y } = await skin(page);
    await harness.focusPicture(page);
    await page.keyboard.press("r");
    await harness.drawn(page);
    await page.mouse.click(x - 60, y + 30);
    await harness.drawn(page);
    await page.mouse.click(x + 20, y - 4);
    await page.mouse.move(5, 5);
    await harness.settled(page);
    await harness.screenshot(page, "hands-ruler");
    const clip = { x: 320, y: 130, width: 640, height: 400 };
    const measured = await page.screenshot({ clip });
    await page.keyboard.press("Escape");
    await harness.settled(page);
    const bare = await page.screenshot({ clip });
    assert.ok((await harness.difference(page, measured, bare)) > 2000, "no ruler is drawn");
    await finish();
  });

  test("a drag moves the implant in one step, Escape cancels one", async () => {
    const { page, finish } = await fixture.openApp();
    const before = await harness.sceneText(page);
    const at = await handle(page);
    await page.mouse.move(at.x, at.y);
    await harness.settled(page);
    await harness.screenshot(page, "hands-handle");
    await page.mouse.down();
    for (let k = 1; k <= 8; k += 1) await page.mouse.move(at.x + 5 * k, at.y);
    await harness.drawn(page);
    await harness.screenshot(page, "hands-drag");
    await page.mouse.up();
    await harness.settled(page);
    const [x, y] = (await harness.scene(page)).implant.center_mm;
    assert.ok(Math.hypot(x, y) > 2, `the implant is at ${x}, ${y}`);
    await page.keyboard.press("Control+z");
    await harness.settled(page);
    assert.equal(await harness.sceneText(page), before);

    const again = await handle(page);
    await page.mouse.move(again.x, again.y);
    await page.mouse.down();
    for (let k = 1; k <= 8; k += 1) await page.mouse.move(again.x + 5 * k, again.y);
    await harness.drawn(page);
    assert.notEqual(await harness.sceneText(page), before, "the tissue does not follow live");
    await page.keyboard.press("Escape");
    await harness.drawn(page);
    await page.mouse.move(again.x, again.y + 30);
    await page.mouse.up();
    await harness.settled(page);
    assert.equal(await harness.sceneText(page), before);
    await finish();
  });

  test("Ctrl+K finds a command by its name", async () => {
    const { page, finish } = await fixture.openApp({ isResearch: true });
    await harness.focusPicture(page);
    await page.keyboard.press("Control+k");
    await harness.settled(page);
    assert.equal((await harness.focused(page))?.name, "Search a command");
    await page.keyboard.type("half sphere", { delay: 40 });
    await harness.drawn(page);
    await harness.screenshot(page, "hands-commands");
    await page.keyboard.press("Enter");
    await harness.settled(page);
    assert.equal((await harness.scene(page)).implant.base_radius_mm, 55);
    await page.keyboard.press("Control+k");
    await harness.drawn(page);
    await page.keyboard.press("Escape");
    await harness.settled(page);
    assert.notEqual((await harness.focused(page))?.name, "Search a command");
    await finish();
  });

  test("Ctrl+K opens the list from a number field, also right after its Enter", async () => {
    const { page, finish } = await fixture.openApp();
    await harness.control(page, "Volume (ml)");
    const slider = await harness.focused(page);
    // The field behind the slider of the same name.
    await page.mouse.click(slider.x + slider.width + 34, slider.y + slider.height / 2);
    await harness.settled(page);
    assert.equal((await harness.focused(page))?.name, "Volume (ml)");
    await page.keyboard.type("340");
    // No wait: Enter and the key of the list may fall into one frame.
    await page.keyboard.press("Enter");
    await page.keyboard.press("Control+k");
    await page.keyboard.type("undo the");
    await harness.settled(page);
    assert.equal((await harness.focused(page))?.name, "Search a command");
    const height = (await harness.scene(page)).implant.projection_mm;
    assert.ok(Math.abs(height / 45.09 - 1) < 1e-3, `${height} mm`);
    await page.keyboard.press("Control+a");
    await page.keyboard.type("redo");
    // The notice is in the page for screen readers, and leaves by itself.
    const isNotice = (words) => document.getElementById("implant-preview-notice").textContent === words;
    const said = page.waitForFunction(isNotice, "Redo: Nothing to redo.");
    await page.keyboard.press("Enter");
    await said;
    await page.waitForFunction(isNotice, "");
    await finish();
  });

  test("a finger keeps values and moves the implant", async () => {
    const { page, finish } = await fixture.openApp({
      viewport: { width: 390, height: 844 },
      options: { hasTouch: true },
    });
    const place = await skin(page);
    await harness.settled(page);
    const clip = { x: 0, y: 130, width: 390, height: 300 };
    const bare = await page.screenshot({ clip });
    await page.touchscreen.tap(place.x, place.y);
    await harness.settled(page);
    const kept = await page.screenshot({ clip });
    await harness.screenshot(page, "hands-phone");
    assert.ok((await harness.difference(page, bare, kept)) > 2000, "a tap keeps no values");
    const at = await handle(page);
    const touch = await page.context().newCDPSession(page);
    const send = (type, x, y) =>
      touch.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x, y }] });
    await send("touchStart", at.x, at.y);
    for (let k = 1; k <= 8; k += 1) {
      await send("touchMove", at.x + 6 * k, at.y);
      await page.waitForTimeout(40);
    }
    await send("touchEnd");
    await harness.settled(page);
    const [x, y] = (await harness.scene(page)).implant.center_mm;
    assert.ok(Math.hypot(x, y) > 2, `the implant is at ${x}, ${y}`);
    await harness.screenshot(page, "hands-phone-drag");
    await finish();
  });
});
