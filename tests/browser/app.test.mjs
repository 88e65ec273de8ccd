// The app in the built page: what a hand on the keys or the pointer does, and what comes of it.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp();
const { openApp } = fixture;
const { settled, stats } = harness;

/** The scene as text and the result, once the app has solved it. */
async function solved(page) {
  await page.waitForFunction(() => implantPreview.stats().converged);
  return page.evaluate(() => ({
    text: implantPreview.scene(),
    scene: JSON.parse(implantPreview.scene()),
    result: JSON.parse(implantPreview.result()),
  }));
}

/** The app's shape is what the native program computes, within the tolerance of the scene. */
function assertSameAsNative({ text, scene, result }) {
  const expected = harness.native(text);
  assert.equal(result.status, "converged");
  assert.equal(expected.status, "converged");
  assert.equal(result.schema, expected.schema);
  // Moved step by step, the app comes from another shape than the native program.
  const allowed = 2 * scene.solver.tolerance * scene.implant.base_radius_mm;
  // Layered tissue has a profile of the skin too.
  for (const name of ["profile", "profile_skin"].filter((name) => name in expected)) {
    const distance = harness.profileDistance(result[name], expected[name]);
    assert.ok(distance < allowed, `${name} differs by ${distance} mm; allowed: ${allowed}`);
  }
  const ratio = result.area_ratio / expected.area_ratio;
  assert.ok(Math.abs(ratio - 1) < 1e-3, `area ratio ${ratio} times the native one`);
}

describe("the app", { timeout: 20 * harness.PATIENCE }, () => {
  test("opens on a plan below practice, solved as natively, in one download, and then rests", async () => {
    const { page, finish } = await openApp({ isOpening: true, isSmooth: true });
    const { opening, downloads } = await page.evaluate(() => ({
      opening: JSON.parse(implantPreviewApi.opening_scene()),
      downloads: performance.getEntriesByType("resource").filter((r) => r.name.endsWith(".wasm")),
    }));
    const opened = await solved(page);
    assert.deepEqual(opened.scene, opening);
    assert.equal(opened.scene.tissue_model, "layered");
    assert.equal(opened.result.schema, "implant-preview/result/1");
    assert.equal(downloads.length, 1);
    assertSameAsNative(opened);
    // The words follow once they rest.
    const words = await harness.summary(page, ", below practice.");
    assert.match(words, /^225 ml implant, 12 cm wide\. Skin stretch 1\d percent, below practice\. Cover 8\.\d mm, at rest 10\.0 mm\. Pressure \d+/);
    const frames = await settled(page);
    const before = await stats(page);
    await page.waitForTimeout(2000);
    const later = await stats(page);
    assert.equal(later.frames, frames, "frames were drawn at rest");
    assert.equal(later.work_units, before.work_units, "something was solved at rest");
    assert.ok((await harness.colours(page)) > 200, "the picture is blank");
    await harness.screenshot(page, "desktop");
    console.log("at rest:", JSON.stringify(later));
    await finish();
  });

  test("follows keys, the pointer and a script with the native answer; undo takes keys back, a refused scene changes nothing", async () => {
    const { page, finish } = await openApp({ isPlain: true });
    const before = await solved(page);
    await harness.focusPicture(page);
    const press = async (key, insertion) => {
      await page.keyboard.press(key);
      await page.waitForFunction(
        (expected) => Math.abs(JSON.parse(implantPreview.scene()).insertion - expected) < 1e-9,
        insertion,
      );
    };
    for (const insertion of [0.98, 0.96, 0.94, 0.92, 0.9]) await press("[", insertion);
    const lowered = await solved(page);
    assert.ok(lowered.result.area_ratio < before.result.area_ratio - 0.01);
    assertSameAsNative(lowered);
    for (const insertion of [0.92, 0.94, 0.96, 0.98, 1]) await press("Control+z", insertion);
    assert.deepEqual((await solved(page)).scene, before.scene);

    // The slider of the insertion.
    const insertion = () => page.evaluate(() => JSON.parse(implantPreview.scene()).insertion);
    await harness.control(page, "Tissue");
    await page.keyboard.press("Enter");
    await settled(page);
    const rail = await harness.control(page, "In place (%)");
    // The handle is at the right end.
    const slider = { x: rail.x + rail.width - 7, y: rail.y + rail.height / 2 };
    await page.mouse.move(slider.x, slider.y);
    await page.waitForTimeout(300);
    await page.mouse.down();
    const values = [];
    for (let k = 0; k < 6; k += 1) {
      await page.mouse.move(slider.x - 8 * k, slider.y);
      await page.waitForTimeout(200);
      values.push(await insertion());
    }
    await page.mouse.up();
    assert.ok(new Set(values).size >= 4, `insertions seen: ${values}`);
    const dragged = await solved(page);
    assert.ok(dragged.scene.insertion < before.scene.insertion);
    assertSameAsNative(dragged);
    await harness.screenshot(page, "half");

    // A scene from a script.
    const refused = await page.evaluate(() => {
      try {
        implantPreview.setScene('{"implant":{"base_radius_mm":50,"colour":1}}');
      } catch (error) {
        return { isError: error instanceof Error, message: error.message };
      }
    });
    assert.ok(refused?.isError);
    assert.match(refused.message, /^[^\n]*colour[^\n]*$/);
    assert.deepEqual((await solved(page)).scene, dragged.scene);
    const asked = {
      tissue_model: "sheet",
      // Values between the steps of the sliders: they must stay.
      implant: { base_radius_mm: 60.123, projection_mm: 30.456, center_mm: [5.0123, 0] },
      insertion: 0.87654,
      layers: [{ thickness_mm: 2.123, poisson_ratio: 0.3123, curve: { kind: "linear", modulus_kpa: 80 } }],
      solver: { nodes_per_side: 65 },
    };
    await page.evaluate((text) => implantPreview.setScene(text), JSON.stringify(asked));
    await page.waitForFunction(() => JSON.parse(implantPreview.result() ?? "{}").solver?.nodes_per_side === 65);
    const scripted = await solved(page);
    await settled(page);
    const { scene } = await solved(page);
    assert.equal(scene.tissue_model, asked.tissue_model);
    assert.deepEqual(scene.implant, asked.implant);
    assert.equal(scene.insertion, asked.insertion);
    assert.equal(scene.layers[0].thickness_mm, asked.layers[0].thickness_mm);
    assert.equal(scene.layers[0].poisson_ratio, asked.layers[0].poisson_ratio);
    assertSameAsNative(scripted);
    await finish();
  });

  test("fits a phone, in the dark; a finger scrolls, moves sliders and the implant, and reads values", async () => {
    const { page, finish } = await openApp({
      viewport: { width: 390, height: 844 },
      isSmooth: true,
      // One pixel a point: software would draw four times as many at a scale of 2.
      options: { hasTouch: true, isMobile: true, deviceScaleFactor: 1, colorScheme: "dark" },
    });
    const fit = await page.evaluate(() => {
      const canvas = document.getElementById("implant-preview-canvas").getBoundingClientRect();
      return {
        width: canvas.width,
        height: canvas.height,
        scrollable: document.documentElement.scrollWidth > innerWidth || document.documentElement.scrollHeight > innerHeight,
        inner: [innerWidth, innerHeight],
      };
    });
    assert.deepEqual(fit, { width: 390, height: 844, scrollable: false, inner: [390, 844] });
    await settled(page);
    await harness.screenshot(page, "phone");
    const finger = await page.context().newCDPSession(page);
    /** A finger that goes down, rests [ms], travels and goes up; then the panel comes to rest. */
    const swipe = async ([x, y], dx, dy, rest = 0) => {
      const touch = (type, at) =>
        finger.send("Input.dispatchTouchEvent", { type, touchPoints: at ? [{ x: at[0], y: at[1] }] : [] });
      await touch("touchStart", [x, y]);
      await page.waitForTimeout(rest);
      for (let k = 1; k <= 8; k += 1) {
        await page.waitForTimeout(60);
        await touch("touchMove", [x + (dx * k) / 8, y + (dy * k) / 8]);
      }
      await page.waitForTimeout(60);
      await touch("touchEnd");
      await settled(page);
    };
    const before = await page.evaluate(() => implantPreview.scene());
    for (const name of ["Patient", "Tissue"]) {
      await harness.control(page, name);
      await page.keyboard.press("Enter");
      await settled(page);
    }
    let rail = await harness.control(page, "In place (%)");
    const beside = (at) => [at.x + 0.3 * at.width, at.y + at.height / 2];
    // Up and down on a slider, the panel scrolls; nothing else moves.
    await swipe(beside(rail), 4, 36);
    assert.equal(await page.evaluate(() => implantPreview.scene()), before);
    const down = (await harness.focused(page)).y - rail.y;
    assert.ok(down > 20, `the panel was scrolled by ${down} pixels`);
    // From the slider's upper edge: its lower part may be behind the status line.
    rail = await harness.focused(page);
    await swipe([rail.x + 0.3 * rail.width, rail.y + 3], 4, -90);
    assert.equal(await page.evaluate(() => implantPreview.scene()), before);
    // Along it, it moves, at once and after a rest.
    const insertion = async () => JSON.parse(await page.evaluate(() => implantPreview.scene())).insertion;
    rail = await harness.focused(page);
    await swipe(beside(rail), -40, 3);
    const moved = await insertion();
    assert.ok(moved < 0.9, `the insertion is ${moved}`);
    await swipe(beside(rail), 40, 3, 1500);
    assert.ok((await insertion()) > moved + 0.1, `the insertion is ${await insertion()} after ${moved}`);
    // A number field asks for the keyboard with digits, nothing else does.
    const keyboard = () => page.locator("#implant-preview-canvas + input").getAttribute("inputmode");
    assert.notEqual(await keyboard(), "decimal");
    rail = await harness.focused(page);
    await page.touchscreen.tap(rail.x + rail.width + 40, rail.y + rail.height / 2);
    await settled(page);
    assert.equal(await keyboard(), "decimal");
    assert.equal(await page.evaluate(() => document.activeElement.tagName), "INPUT");
    // A tap on the breast shows the values there, and puts the keyboard away.
    const still = await page.screenshot({ clip: { x: 0, y: 80, width: 390, height: 380 } });
    await page.touchscreen.tap(190, 262);
    await settled(page);
    const tapped = await page.screenshot({ clip: { x: 0, y: 80, width: 390, height: 380 } });
    assert.ok((await harness.difference(page, still, tapped)) > 2000, "a tap shows no values");
    assert.equal(await keyboard(), "text");
    await harness.screenshot(page, "phone-values");
    // Along the picture the finger moves the implant by its handle.
    const handle = await harness.control(page, "Move the implant");
    await swipe([handle.x + handle.width / 2, handle.y + handle.height / 2], 48, 0);
    const center = JSON.parse(await page.evaluate(() => implantPreview.scene())).implant.center_mm;
    assert.ok(Math.hypot(...center) > 2, `the implant is at ${center}`);
    assertSameAsNative(await solved(page));
    // Natural skin on a phone has few colours.
    await harness.control(page, "Stretch");
    await page.keyboard.press("Enter");
    await settled(page);
    const colours = await harness.colours(page);
    assert.ok(colours > 200, `the picture is blank: ${colours} colours`);
    await finish();
  });
});
