// The app by the keyboard alone, and what is typed, in the built page.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp({ isPlain: true });

describe("keys", { timeout: 20 * harness.PATIENCE }, () => {
  test("enter and leave the app at both ends, step a slider, commit a number, close what is open and find a command", async () => {
    const { page, finish } = await fixture.openApp({ isResearch: true, viewport: { width: 1000, height: 700 } });
    // Behind the last control are the words, before the first one is the link to them.
    await harness.control(page, "Before | after");
    await harness.tab(page);
    assert.equal(await harness.place(page), "behind");
    await harness.screenshot(page, "summary");
    await harness.tab(page, { back: true });
    assert.equal((await harness.focused(page)).name, "Before | after");
    await harness.control(page, "File");
    await harness.tab(page, { back: true });
    assert.equal(await harness.place(page), "before");
    await harness.screenshot(page, "skip");
    await harness.tab(page);
    assert.equal((await harness.focused(page)).name, "File");

    const pocket = async () => (await harness.scene(page)).pocket_radius_mm;
    await harness.control(page, "Margin (cm)");
    for (const [key, value] of [
      ["ArrowRight", 71],
      ["PageUp", 81],
      ["PageDown", 71],
      ["End", 100],
      ["Home", 60],
    ]) {
      await page.keyboard.press(key);
      await page.waitForFunction(
        (expected) => Math.abs(JSON.parse(implantPreview.scene()).pocket_radius_mm - expected) < 1e-9,
        value,
      );
    }
    await harness.tab(page);
    await page.keyboard.type("0,642", { delay: 40 });
    await page.keyboard.press("Enter");
    await harness.drawn(page);
    assert.equal(await pocket(), 66.42);
    assert.equal((await harness.focused(page)).name, "Margin (cm)");
    // What is not allowed changes nothing.
    await page.keyboard.type("-5", { delay: 40 });
    await page.keyboard.press("Enter");
    await harness.drawn(page);
    assert.equal(await pocket(), 66.42);
    await harness.screenshot(page, "refused");
    await page.keyboard.press("Escape");
    // A window that is open closes, and the focus is where it was.
    await harness.control(page, "Help");
    await page.keyboard.press("Enter");
    await harness.settled(page);
    const open = await page.screenshot();
    await page.keyboard.press("Escape");
    await harness.settled(page);
    assert.ok((await harness.difference(page, open, await page.screenshot())) > 5000, "Help stays open");
    assert.equal((await harness.focused(page)).name, "Help");
    // The list opens from a number field, also right after its Enter.
    await harness.control(page, "Volume (ml)");
    await harness.tab(page);
    await page.keyboard.type("340");
    // No wait: Enter and the key of the list may fall into one frame.
    await page.keyboard.press("Enter");
    await page.keyboard.press("Control+k");
    await page.keyboard.type("undo the");
    await harness.settled(page);
    assert.equal((await harness.focused(page))?.name, "Search a command");
    await harness.screenshot(page, "commands");
    const { implant } = await harness.scene(page);
    const volume = (2 / 3) * Math.PI * implant.base_radius_mm ** 2 * implant.projection_mm * 1e-3;
    assert.ok(Math.abs(volume - 340) < 1e-6, `${volume} ml`);
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
});
