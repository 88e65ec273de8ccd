// The built page in a real browser.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const RADIUS_MM = 55;

describe("with WebGL 2", { timeout: 10 * harness.PATIENCE }, () => {
  const fixture = harness.setUp();

  test("the JavaScript API in the page computes what the native program computes", async () => {
    const { page, finish } = await fixture.openPage("", {
      // The functions are there only once they can be called, however long the download is compiled.
      init: () => {
        const instantiate = WebAssembly.instantiateStreaming;
        WebAssembly.instantiateStreaming = async (...source) => {
          await new Promise((resolve) => setTimeout(resolve, 500));
          return instantiate(...source);
        };
      },
    });
    await page.waitForFunction(() => globalThis.implantPreviewApi?.version);
    for (const model of ["layered", "sheet"]) {
      const { scene, result } = await page.evaluate((model) => {
        const scene = JSON.parse(implantPreviewApi.default_scene());
        scene.solver.nodes_per_side = 65;
        scene.tissue_model = model;
        // Pins are no part of what is solved.
        scene.pins = [{ scene: { implant: { base_radius_mm: 50 } } }];
        const text = JSON.stringify(scene);
        return { scene: text, result: JSON.parse(implantPreviewApi.simulate(text)) };
      }, model);
      assert.equal(result.status, "converged");
      const distance = harness.profileDistance(result.profile, harness.native(scene).profile);
      assert.ok(distance < 1e-5 * RADIUS_MM, `profiles of ${model} tissue differ by ${distance} mm`);
    }
    const refused = await page.evaluate(() => {
      try {
        implantPreviewApi.simulate('{"implant":{"base_radius_mm":500}}');
      } catch (error) {
        return { isError: error instanceof Error, message: error.message };
      }
    });
    assert.deepEqual(refused, {
      isError: true,
      message: "implant.base_radius_mm is 500; allowed: 10 to 120 mm",
    });
    await finish();
  });

  test("a download that fails is shown, not swallowed", async () => {
    const context = await fixture.browser.newContext();
    const page = await context.newPage();
    await page.route("**/*.wasm", (route) => route.fulfill({ status: 404 }));
    await page.goto(fixture.site.address);
    await page.locator("#crashed").waitFor({ state: "visible", timeout: harness.PATIENCE });
    assert.match(await page.locator("#crashed-text").textContent(), /answered 404/);
    assert.equal(await page.locator("#crashed-text").isVisible(), true);
    assert.equal(await page.getByRole("button", { name: "Save the scene" }).isVisible(), false);
    await context.close();
  });

  test("a browser without WASM SIMD gets a message", async () => {
    const { page, finish } = await fixture.openPage("", {
      init: () => {
        WebAssembly.validate = () => false;
      },
    });
    await page.locator("#missing").waitFor({ state: "visible" });
    assert.match(await page.locator("#missing-text").textContent(), /SIMD/);
    assert.equal(await page.locator("#loading").count(), 0);
    await finish();
  });
});

describe("without WebGL", { timeout: 4 * harness.PATIENCE }, () => {
  const fixture = harness.setUp({ webgl: false });

  test("the page says what is missing", async () => {
    const { page, finish } = await fixture.openPage();
    await page.locator("#missing").waitFor({ state: "visible" });
    assert.match(await page.locator("#missing-text").textContent(), /WebGL 2/);
    await harness.screenshot(page, "missing");
    await finish();
  });
});
