// The plan as an HTML form behind the app, in the built page.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp({ isPlain: true });

describe("the form of the plan", { timeout: 10 * harness.PATIENCE }, () => {
  test("has no field into which a phone zooms, nor has the app's own; scripts have its fields by name", async () => {
    const { page, finish } = await fixture.openApp({ viewport: { width: 390, height: 844 } });
    await page.locator("form label").first().waitFor({ state: "attached" });
    const { count, small } = await harness.smallFields(page);
    assert.deepEqual(small, []);
    // The fields of the form, and the hidden one that takes the keyboard for the app.
    assert.ok(count > 16, `${count} fields`);

    const seen = await page.evaluate(() => {
      const refusal = (name, text) => {
        try {
          implantPreview.setPlan(name, text);
          return "";
        } catch (error) {
          return error.message;
        }
      };
      const width = JSON.parse(implantPreview.plan()).find(({ name }) => name === "width_cm");
      implantPreview.setPlan("volume_ml", "350 cc");
      return { width, refusals: [refusal("width_cm", "NaN"), refusal("height", "1"), refusal("skin", 3)] };
    });
    const { hint, ...width } = seen.width;
    assert.ok(hint.length > 10);
    const expected = { name: "width_cm", label: "Width", unit: "cm", text: "12.0", range: "7 to 24 cm", least: 7, most: 24 };
    assert.deepEqual(width, expected);
    assert.equal(seen.refusals[0], "Width: “NaN” is not a number");
    assert.match(seen.refusals[1], /^the plan has no field of this name; allowed: shape, fill, width_cm, /);
    assert.equal(seen.refusals[2], "value is not text; allowed: a string");
    const { implant } = await harness.scene(page);
    const volume = (2 / 3) * Math.PI * implant.base_radius_mm ** 2 * implant.projection_mm * 1e-3;
    assert.ok(Math.abs(volume - 350) < 1e-6);
    await page.locator("#plan-volume_ml").focus();
    await harness.screenshot(page, "form-phone");
    await finish();
  });

  test("is filled, sets the plan, refuses in one line and follows the app, as the words do", async () => {
    const { page, finish } = await fixture.openApp({ viewport: { width: 1000, height: 700 } });
    // An edit replaces the result in words at once; the words of the edited plan follow.
    await harness.summary(page, "Up to date.");
    await harness.settled(page);
    await page.evaluate(() => {
      const summary = document.getElementById("implant-preview-summary");
      globalThis.heard = [];
      new MutationObserver(() => heard.push(summary.textContent)).observe(summary, { childList: true });
    });
    await harness.type(page, "Width (cm)", "12.6");
    await harness.summary(page, "12.6 cm wide");
    const heard = await page.evaluate(() => heard);
    assert.equal(heard[0], "Updating.");
    assert.match(heard[1], /^300 ml implant, 12\.6 cm wide\./);

    const form = page.getByRole("form", { name: "Plan" });
    const field = (name) => form.getByLabel(name, { exact: true });
    const names = await form.locator("label").allTextContents();
    const labels = await page.evaluate(() =>
      JSON.parse(implantPreview.plan()).map(({ label, unit }) => (unit ? `${label} (${unit})` : label)),
    );
    assert.deepEqual(names, labels);
    // The numbers that their rows alone show stand between projection and pinch.
    names.splice(names.indexOf("Projection (cm)") + 1, names.indexOf("Pinch (cm)") - names.indexOf("Projection (cm)") - 1);
    assert.deepEqual(names, [
      "Implant",
      "Filled with",
      "Width (cm)",
      "Volume (ml)",
      "Projection (cm)",
      "Pinch (cm)",
      "Skin feels",
      "Skin at rest",
      "Chest",
      "Margin (cm)",
      "Plane of the pocket",
      "New fold lower (cm)",
      "To the side (cm)",
      "Up (cm)",
      "In place (%)",
      "Fluid in the pocket",
      "Time after the operation",
      "Posture",
      "Patient no.",
      "Side",
      "Date of the visit",
      "Surgeon",
      "Remarks",
    ]);
    assert.equal(await field("Width (cm)").inputValue(), "12.6");
    assert.equal(await field("Skin feels").inputValue(), "normal");

    // Behind the result in words by the Tab key; hidden without the focus.
    const box = () => form.boundingBox();
    assert.ok((await box()).width <= 1);
    await page.locator("#implant-preview-summary").focus();
    await harness.tab(page);
    assert.equal(await harness.place(page), "form");
    assert.ok((await box()).width > 300);

    // A typed number becomes one of the scene, the answer follows: behind the implant and its fill is the width.
    await page.keyboard.press("Tab");
    await page.keyboard.press("Tab");
    await page.keyboard.press("Control+a");
    await page.keyboard.type("13,2");
    await page.keyboard.press("Enter");
    assert.equal((await harness.scene(page)).implant.base_radius_mm, 66);
    assert.match(await harness.summary(page, "13.2 cm wide"), /^300 ml implant, 13\.2 cm wide\./);
    await field("Chest").selectOption("usual");
    assert.deepEqual((await harness.scene(page)).chest, { radius_across_mm: 140, radius_along_mm: null });
    await field("Chest").selectOption("flat");
    assert.equal((await harness.scene(page)).chest, undefined);
    await field("Skin feels").selectOption("lax");
    assert.equal((await harness.scene(page)).patient.skin_class, "lax");
    await harness.screenshot(page, "form");

    // A refused number stays with its reason; Escape restores the plan's.
    const pinch = field("Pinch (cm)");
    await pinch.fill("1e308");
    await pinch.press("Enter");
    assert.equal(await form.getByRole("alert").filter({ hasText: "Pinch" }).textContent(), "Pinch: at most 12 cm");
    assert.equal(await pinch.getAttribute("aria-invalid"), "true");
    await harness.screenshot(page, "form-refused");
    await pinch.press("Escape");
    assert.equal(await pinch.inputValue(), "2.0");
    assert.equal((await harness.scene(page)).patient.pinch_mm, 20);

    // The form follows the app: undo, another scene, an expander without a projection.
    await page.mouse.click(380, 140);
    await page.waitForFunction(() => !document.activeElement?.form);
    await page.keyboard.press("Control+z");
    await page.waitForFunction(() => document.getElementById("plan-skin").value === "normal");
    await page.evaluate(() => {
      const scene = JSON.parse(implantPreview.scene());
      scene.insertion = 0.4;
      implantPreview.setScene(JSON.stringify(scene));
    });
    await page.waitForFunction(() => document.getElementById("plan-in_place_percent").value === "40");
    await harness.control(page, "expander");
    await page.keyboard.press("Enter");
    await field("Projection (cm)").waitFor({ state: "hidden" });
    await finish();
  });
});
