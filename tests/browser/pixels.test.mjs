// The size of the canvas where a browser imitates a screen of more pixels per point.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { startBrowser } from "./harness.mjs";

const SCRIPT = readFileSync(new URL("../../web/pixels.js", import.meta.url), "utf8");

let browser;
before(async () => (browser = await startBrowser({ webgl: false })));
after(() => browser.close());

test("an imitated screen reports its pixels, not its points", async () => {
  for (const deviceScaleFactor of [1, 1.5, 2, 3]) {
    const context = await browser.newContext({ viewport: { width: 390, height: 844 }, deviceScaleFactor, isMobile: true });
    const page = await context.newPage();
    await page.setContent(
      '<meta name="viewport" content="width=device-width"><canvas style="position: fixed; inset: 0; width: 100%; height: 50%"></canvas>',
    );
    await page.addScriptTag({ content: SCRIPT, type: "module" });
    const size = await page.evaluate(
      () =>
        new Promise((done) => {
          const observer = new ResizeObserver(([entry]) => {
            const pixels = entry.devicePixelContentBoxSize.at(0);
            done([pixels instanceof ResizeObserverSize, pixels.inlineSize, pixels.blockSize]);
          });
          observer.observe(document.querySelector("canvas"));
        }),
    );
    assert.deepEqual(size, [true, 390 * deviceScaleFactor, 422 * deviceScaleFactor]);
    await context.close();
  }
});
