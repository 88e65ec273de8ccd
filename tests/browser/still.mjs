// Makes assets/still.webp and assets/still-narrow.webp from the built page: the body of the opening plan in the app's opening view,
// without ground, in a broad and in a narrow area. The page shows one of them before the program has loaded.
//
// node tests/browser/still.mjs, after a change of the opening plan or of the drawing; then build the page again.

import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { join } from "node:path";
import * as harness from "./harness.mjs";

// The perspective depends on the aspect of the area, which is the width of 1.15 heights or more on a wide screen. The narrow picture
// is a square, which the page shows at the width of every area that is higher than wide.
const PICTURES = [
  { file: "still.webp", viewport: { width: 1442, height: 945 }, aspect: 1.15 },
  { file: "still-narrow.webp", viewport: { width: 1088, height: 887 }, aspect: 0.9, crop: 1 },
];
const MOST_BYTES = 25_000;

/** Keeps the pixels of the body on a ground, black or white, without what the window shows over the body; runs in the page. */
function keepBody() {
  const gl = WebGL2RenderingContext.prototype;
  const { shaderSource, attachShader, useProgram, drawElements } = gl;
  const [shaders, programs] = [new Set(), new Set()];
  const materials = 5;
  let drawn = 0;
  gl.shaderSource = function (shader, text) {
    if (text.includes("u_material")) shaders.add(shader);
    return shaderSource.call(this, shader, text);
  };
  gl.attachShader = function (program, shader) {
    if (shaders.has(shader)) programs.add(program);
    return attachShader.call(this, program, shader);
  };
  gl.useProgram = function (program) {
    this.isBody = programs.has(program);
    if (this.isBody) drawn = 0;
    return useProgram.call(this, program);
  };
  gl.drawElements = function (...values) {
    if (!this.isBody) return drawElements.apply(this, values);
    if (drawn === 0) {
      const ground = globalThis.ground ?? 0;
      this.clearColor(ground, ground, ground, 1);
      this.clear(this.COLOR_BUFFER_BIT);
    }
    drawElements.apply(this, values);
    drawn += 1;
    if (drawn === materials) {
      const [x, y, width, height] = this.getParameter(this.VIEWPORT);
      const bytes = new Uint8Array(4 * width * height);
      this.readPixels(x, y, width, height, this.RGBA, this.UNSIGNED_BYTE, bytes);
      globalThis.bodies ??= [];
      globalThis.bodies[globalThis.ground ?? 0] = { width, height, bytes };
    }
  };
}

/** Rows in the middle of the kept pixels as a WebP picture (base64); runs in the page. */
async function encode(rows) {
  const [{ width, height, bytes }, { bytes: onWhite }] = globalThis.bodies;
  const image = new ImageData(width, rows);
  const first = Math.floor((height - rows) / 2);
  for (let y = 0; y < rows; y += 1) {
    for (let x = 0; x < width; x += 1) {
      // The first row of the graphics is the lowest one; colours on black are multiplied by the coverage.
      const [from, to] = [4 * ((height - 1 - first - y) * width + x), 4 * (y * width + x)];
      const through = Math.max(...[0, 1, 2].map((k) => onWhite[from + k] - bytes[from + k]), 0);
      const coverage = 1 - through / 255;
      for (let k = 0; k < 3; k += 1) image.data[to + k] = coverage > 0 ? bytes[from + k] / coverage : 0;
      image.data[to + 3] = 255 * coverage;
    }
  }
  const canvas = new OffscreenCanvas(width, rows);
  canvas.getContext("2d").putImageData(image, 0, 0);
  const blob = await canvas.convertToBlob({ type: "image/webp", quality: 0.72 });
  return btoa(String.fromCharCode(...new Uint8Array(await blob.arrayBuffer())));
}

/** Draws the opening plan in a window; the picture's area is the window less panels and bars. */
async function make(browser, site, { file, viewport, aspect, crop }) {
  const { page, problems, close } = await harness.openApp(browser, site, {
    viewport,
    init: `(${keepBody})()`,
    isOpening: true,
    isSmooth: true,
  });
  await harness.settled(page);
  await page.evaluate(() => (globalThis.ground = 1));
  await page.mouse.move(20, 20);
  await page.waitForFunction(() => globalThis.bodies[1]);
  const [width, height] = await page.evaluate(() => [globalThis.bodies[0].width, globalThis.bodies[0].height]);
  assert.ok(Math.abs(width / height - aspect) < 0.01, `${file}: ${width} × ${height} pixels: the layout of the page has changed`);
  const rows = Math.round(width / (crop ?? aspect));
  const picture = Buffer.from(await page.evaluate(encode, rows), "base64");
  await close();
  assert.deepEqual(problems, []);
  writeFileSync(join(harness.ROOT, "assets", file), picture);
  console.log(`assets/${file}: ${width} × ${rows}, ${picture.length} bytes`);
  return picture.length;
}

const site = await harness.serve();
const browser = await harness.startBrowser();
let bytes = 0;
for (const picture of PICTURES) bytes += await make(browser, site, picture);
await browser.close();
await site.close();
assert.ok(bytes <= MOST_BYTES, `${bytes} bytes`);
