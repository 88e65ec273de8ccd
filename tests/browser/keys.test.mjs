// The app by the keyboard alone, and what is typed, in the built page.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp({ isPlain: true });
const openApp = (options) => fixture.openApp({ viewport: { width: 1000, height: 700 }, ...options });

/** Is a ring in the colour of text drawn around what has the focus? Its left side is looked at. */
async function hasRing(page, { x, y, width, height }) {
  const size = page.viewportSize();
  const isLarge = width * height > 0.1 * size.width * size.height;
  const seen = { top: Math.max(y, 0), bottom: Math.min(y + height, size.height) };
  const clip = {
    x: Math.max(0, x - (isLarge ? 0 : 6)),
    y: Math.round((seen.top + seen.bottom) / 2) - 1,
    width: 8,
    height: 2,
  };
  if (seen.bottom - seen.top < 4) return false;
  const strip = await page.screenshot({ clip });
  return harness.darkest(page, strip).then((level) => level < 70);
}

describe("the Tab key", { timeout: 20 * harness.PATIENCE }, () => {
  test("goes through every control both ways, with a ring that is seen, and leaves the app at both ends", async () => {
    const { page, finish } = await openApp({ isResearch: true });
    const walk = async (back) => {
      const names = [];
      await harness.tab(page, { back });
      for (let presses = 0; presses < 150 && (await harness.place(page)) === "app"; presses += 1) {
        const now = await harness.focused(page);
        assert.ok(now, `the focus is lost after ${names.at(-1)}`);
        assert.ok(now.name, `a control has no name, after ${names.at(-1)}`);
        assert.ok(await hasRing(page, now), `no ring is seen around ${now.name}: ${JSON.stringify(now)}`);
        names.push(now.name);
        await harness.tab(page, { back });
      }
      return names;
    };
    const there = await walk(false);
    assert.equal(await harness.place(page), "behind");
    await harness.screenshot(page, "summary");
    const back = await walk(true);
    assert.equal(await harness.place(page), "before");
    await harness.screenshot(page, "skip");
    assert.deepEqual(back, there.toReversed());
    for (const name of [
      "File",
      "Undo",
      "View",
      "Start over",
      "Help",
      "Width (cm)",
      "Volume (ml)",
      "Projection (cm)",
      "Let the volume follow",
      "Half sphere",
      "Pinch (cm)",
      "very lax",
      "Margin (cm)",
      "Position of the implant",
      "To the side (cm)",
      "Tissue",
      "Advanced",
      "Where limits come from",
      "Details",
      "Front",
      "Stretch",
      "3-D view",
    ]) {
      assert.ok(there.includes(name), `${name} is not among ${there.join(", ")}`);
    }
    // Sliders are two stops: the handle and the number.
    assert.equal(there.filter((name) => name === "Width (cm)").length, 2);
    // The browser goes on from the link to the app, and the link leads to the words.
    await harness.tab(page);
    assert.equal((await harness.focused(page)).name, "File");
    await finish();
  });

  test("does so on a phone's tabs too", async () => {
    const { page, close } = await openApp({ viewport: { width: 390, height: 844 } });
    const names = new Set();
    for (const name of ["Implant", "Patient", "Pocket", "More"]) {
      await harness.control(page, name);
      await page.keyboard.press("Enter");
      await harness.drawn(page);
      for (let presses = 0; presses < 80; presses += 1) {
        await harness.tab(page);
        if ((await harness.place(page)) !== "app") break;
        const now = await harness.focused(page);
        names.add(now.name);
        assert.ok(await hasRing(page, now), `no ring is seen around ${now.name}: ${JSON.stringify(now)}`);
      }
      assert.notEqual(await harness.place(page), "app", `no way out behind the tab ${name}`);
      // From behind the app back into it.
      await harness.tab(page, { back: true });
    }
    for (const name of ["Volume (ml)", "More Volume", "Pinch (cm)", "Margin (cm)", "Details", "3-D view"]) {
      assert.ok(names.has(name), `${name} is not among ${[...names].join(", ")}`);
    }
    await close();
  });
});

describe("keys", { timeout: 20 * harness.PATIENCE }, () => {
  test("step a slider, commit a number and stay, and close what is open", async () => {
    const { page, finish } = await openApp();
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
    await finish();
  });

  test("that are digits colour nothing unless the picture has the focus", async () => {
    const { page, finish } = await openApp({ isPlain: false });
    const picture = () => page.screenshot({ clip: { x: 320, y: 50, width: 350, height: 500 } });
    await harness.settled(page);
    const first = await picture();
    await page.keyboard.type("50", { delay: 60 });
    await harness.settled(page);
    assert.equal(await harness.difference(page, first, await picture()), 0, "digits have changed the picture");
    await harness.focusPicture(page);
    await page.keyboard.press("5");
    await harness.settled(page);
    assert.ok((await harness.difference(page, first, await picture())) > 1000, "the picture does not hear 5");
    await finish();
  });
});

describe("a result", { timeout: 10 * harness.PATIENCE }, () => {
  test("is saved with the scene that it is of, and there is none while that is solved", async () => {
    const { page, finish } = await openApp({ isResearch: true });
    const seen = await page.evaluate(() => {
      const wide = JSON.parse(implantPreview.scene());
      wide.pocket_radius_mm = 178;
      // Its default is that of the wide pocket.
      delete wide.patch_radius_mm;
      implantPreview.setScene(JSON.stringify(wide));
      return [implantPreview.result(), implantPreview.stats().converged];
    });
    assert.deepEqual(seen, [undefined, false]);
    await page.waitForFunction(() => implantPreview.stats().converged);
    const result = JSON.parse(await page.evaluate(() => implantPreview.result()));
    assert.deepEqual(result.scene, await harness.scene(page));
    assert.equal(result.scene.pocket_radius_mm, 178);
    assert.equal(result.scene.patch_radius_mm, 238);
    assert.ok(Math.abs(result.area_before_cm2 - 0.01 * Math.PI * 178 ** 2) < 1e-9);
    assert.equal(result.program_version, await page.evaluate(() => implantPreviewApi.version()));
    assert.ok(Math.abs(Date.parse(result.date) - Date.now()) < 600_000, result.date);
    // The same from the menu.
    await harness.control(page, "File");
    await page.keyboard.press("Enter");
    await harness.drawn(page);
    for (let presses = 0; presses < 4; presses += 1) await harness.tab(page);
    assert.equal((await harness.focused(page)).name, "Save numbers (JSON)…");
    const saved = JSON.parse((await harness.download(page, () => page.keyboard.press("Enter"))).text);
    assert.deepEqual(saved.scene, result.scene);
    assert.equal(saved.contact_force_n, result.contact_force_n);
    await finish();
  });
});
