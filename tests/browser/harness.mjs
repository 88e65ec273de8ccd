// What the browser tests stand on: a server of the built page, a browser, the native program.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { extname, join, normalize } from "node:path";
import { after, before } from "node:test";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

export const ROOT = fileURLToPath(new URL("../../", import.meta.url));
export const DIST = join(ROOT, "dist");
const OUT = join(ROOT, "tests/browser/out");
const TARGET = process.env.CARGO_TARGET_DIR ?? join(ROOT, "target");
export const NATIVE = join(TARGET, "debug/implant-preview");

// Software rendering on a busy machine: the first frames take seconds.
export const PATIENCE = 120_000;

const QUIET = [
  "--no-sandbox",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];
const WEBGL2 = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];
const NO_WEBGL = ["--disable-gpu", "--disable-3d-apis"];

/** Types of files by their extensions. */
export const TYPES = {
  ".css": "text/css",
  ".html": "text/html; charset=utf-8",
  ".js": "text/javascript",
  ".mjs": "text/javascript",
  ".png": "image/png",
  ".svg": "image/svg+xml",
  ".wasm": "application/wasm",
  ".webp": "image/webp",
  ".webmanifest": "application/manifest+json",
};

/** Serves the built page, or another folder, on 127.0.0.1. Requests for which `refuses(path)` is true get no answer. */
export async function serve({ folder = DIST, port = 0, refuses = () => false } = {}) {
  if (!existsSync(join(folder, "index.html"))) {
    throw new Error("dist/index.html is missing: build the page first (./tests/run.sh does)");
  }
  const server = createServer(async (request, response) => {
    const path = normalize(decodeURIComponent(new URL(request.url, "http://page").pathname));
    const file = join(folder, path.endsWith("/") ? `${path}index.html` : path);
    if (refuses(path)) return request.destroy();
    try {
      const body = await readFile(file);
      response.writeHead(200, { "Content-Type": TYPES[extname(file)] ?? "application/octet-stream" });
      response.end(body);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => server.listen(port, "127.0.0.1", resolve));
  return {
    address: `http://127.0.0.1:${server.address().port}/`,
    close: () =>
      new Promise((resolve) => {
        server.close(resolve);
        server.closeAllConnections();
      }),
  };
}

/**
 * The patient of the opening plan with a flat chest and 300 ml, on a coarse grid: quick to solve, and Chromium, which draws in
 * software, takes half the time for a frame.
 */
const flatPlan = () => {
  const [radius, millilitres] = [60, 300];
  return {
    implant: { base_radius_mm: radius, projection_mm: (1500 * millilitres) / (Math.PI * radius ** 2) },
    pocket_radius_mm: 70,
    layers: [
      { tissue: "skin", curve: { kind: "skin" } },
      { tissue: "adipose", poisson_ratio: 0.49, curve: { kind: "fat" } },
    ],
    patient: { pinch_mm: 20, skin_class: "normal" },
    solver: { nodes_per_side: 33 },
  };
};

/** Options of a context in which the browser has kept the flat plan, and the switch "Research" if on, for the next start of the app. */
export function withCoarsePlan(address, isResearch = false) {
  const value = JSON.stringify({ scene: flatPlan(), choices: { device: "implant", follows: "projection" }, cross_section: true });
  const localStorage = [{ name: "implant-preview/plan/1", value }];
  if (isResearch) localStorage.push({ name: "implant-preview/research/1", value: "on" });
  return { storageState: { cookies: [], origins: [{ origin: new URL(address).origin, localStorage }] } };
}

/** Takes the antialiasing from the canvas, half of the time of a frame, and if asked light and lines from the tissue. */
function drawCheaply(isPlain) {
  const { getContext } = HTMLCanvasElement.prototype;
  HTMLCanvasElement.prototype.getContext = function (kind, options) {
    return getContext.call(this, kind, kind === "webgl2" ? { ...options, antialias: false } : options);
  };
  if (!isPlain) return;
  const { shaderSource } = WebGL2RenderingContext.prototype;
  WebGL2RenderingContext.prototype.shaderSource = function (shader, text) {
    const [declarations, main] = text.split("void main()");
    const isTissue = declarations.includes("u_material") && main;
    shaderSource.call(this, shader, isTissue ? `${declarations}void main() { out_color = vec4(v_color, 1.0); }` : text);
  };
}

/** Starts Chromium, with WebGL 2 (in software) or without any WebGL. */
export function startBrowser({ webgl = true } = {}) {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: [...QUIET, ...(webgl ? WEBGL2 : NO_WEBGL)],
    timeout: PATIENCE,
  });
}

/**
 * A page that records what it must not do. Only tests of the service worker allow it: requests pass by routes there.
 * `prepare`: what is done with it before it opens; `isSmooth`: drawn as the product draws; `isPlain`: with tissue in flat colours, where
 * the picture is not the point.
 */
export async function openPage(browser, address, { viewport, init, prepare, options, isSmooth = false, isPlain = false } = {}) {
  const context = await browser.newContext({
    viewport: viewport ?? { width: 1280, height: 800 },
    serviceWorkers: "block",
    ...options,
  });
  context.setDefaultTimeout(PATIENCE);
  // Further tabs of a test too.
  if (!isSmooth) await context.addInitScript(drawCheaply, isPlain);
  const page = await context.newPage();
  const problems = [];
  const origin = new URL(address).origin;
  page.on("console", (message) => {
    if (message.type() === "error") problems.push(`console: ${message.text()}`);
  });
  page.on("pageerror", (error) => problems.push(`uncaught: ${error.message}`));
  page.on("crash", () => problems.push("the page crashed"));
  page.on("requestfailed", (request) => {
    // A page that is left cancels what it still loads, for example the script of a worker.
    if (request.failure()?.errorText !== "net::ERR_ABORTED") problems.push(`failed: ${request.url()}`);
  });
  page.on("request", (request) => {
    const url = new URL(request.url());
    if (["http:", "https:", "ws:", "wss:"].includes(url.protocol) && url.origin !== origin) {
      problems.push(`another origin: ${url}`);
    }
  });
  if (init) await page.addInitScript(init);
  await prepare?.(page);
  await page.goto(address);
  const close = async () => {
    // A worker may just be starting.
    await context.unrouteAll({ behavior: "ignoreErrors" });
    await context.close();
  };
  const finish = async () => {
    assert.deepEqual(problems, []);
    await close();
  };
  return { page, problems, close, finish };
}

/**
 * Starts the server and a browser before the tests of a file or suite, and ends both after the tests. `isPlain` is that of all
 * its pages.
 */
export function setUp({ webgl, isPlain } = {}) {
  const fixture = {
    openApp: (options) => openApp(fixture.browser, fixture.site, { isPlain, ...options }),
    openPage: (path = "", options) => openPage(fixture.browser, fixture.site.address + path, { isPlain, ...options }),
  };
  before(async () => {
    fixture.site = await serve();
    fixture.browser = await startBrowser({ webgl });
  });
  after(async () => {
    await fixture.browser?.close();
    await fixture.site?.close();
  });
  return fixture;
}

/** What the native program computes for a scene (JSON text). */
export function native(scene) {
  const text = execFileSync(NATIVE, ["simulate", "-"], { input: scene, encoding: "utf8" });
  return JSON.parse(text);
}

/** The bands that the native program computes for a scene (JSON text) with options of the command line. */
export function nativeBands(scene, options) {
  return JSON.parse(execFileSync(NATIVE, ["bands", "-", ...options], { input: scene, encoding: "utf8" }));
}

/** The table (CSV text) that the native program's quick benchmark writes. */
export function nativeBenchmark() {
  const folder = mkdtempSync(join(tmpdir(), "implant-preview-bench-"));
  try {
    execFileSync(NATIVE, ["bench", "--quick", "--out-dir", folder]);
    return readFileSync(join(folder, "work_precision.csv"), "utf8");
  } finally {
    rmSync(folder, { recursive: true });
  }
}

/** A small picture for people to look at; not compared. */
export async function screenshot(page, name) {
  mkdirSync(OUT, { recursive: true });
  await page.screenshot({ path: join(OUT, `${name}.png`) });
}

/** An empty page of a browser, for the pictures of all pages: without a policy that forbids pictures. */
const blanks = new WeakMap();
function blankPage(browser) {
  if (!blanks.has(browser)) blanks.set(browser, browser.newContext().then((context) => context.newPage()));
  return blanks.get(browser);
}

/** Does something with the bytes of pictures (PNG). */
async function withPixels(page, pictures, look) {
  const blank = await blankPage(page.context().browser());
  const data = pictures.map((picture) => picture.toString("base64"));
  return blank.evaluate(
    async ([data, source]) => {
      const pixels = [];
      let width = 0;
      for (const text of data) {
        const image = new Image();
        image.src = `data:image/png;base64,${text}`;
        await image.decode();
        width = image.width;
        const context = new OffscreenCanvas(image.width, image.height).getContext("2d", { willReadFrequently: true });
        context.drawImage(image, 0, 0);
        pixels.push(context.getImageData(0, 0, image.width, image.height).data);
      }
      return new Function(`return (${source})`)()(...pixels, width);
    },
    [data, look.toString()],
  );
}

/** How many colours the page shows, as 4 bits a channel. */
export async function colours(page) {
  return withPixels(page, [await page.screenshot()], (bytes) => {
    const seen = new Set();
    for (let k = 0; k < bytes.length; k += 4) {
      seen.add(((bytes[k] >> 4) << 8) | (bytes[k + 1] & 0xf0) | (bytes[k + 2] >> 4));
    }
    return seen.size;
  });
}

/** The darkest pixel of a picture, 0 to 255. */
export function darkest(page, picture) {
  return withPixels(page, [picture], (bytes) => {
    let least = 255;
    for (let k = 0; k < bytes.length; k += 4) least = Math.min(least, Math.max(bytes[k], bytes[k + 1], bytes[k + 2]));
    return least;
  });
}

/** How many pixels of two pictures of one size differ by more than 4 of 255 in a channel (rounding). */
export function difference(page, a, b) {
  return withPixels(page, [a, b], (x, y) => {
    if (x.length !== y.length) return Infinity;
    let count = 0;
    for (let k = 0; k < x.length; k += 4) {
      if ([0, 1, 2].some((channel) => Math.abs(x[k + channel] - y[k + channel]) > 4)) count += 1;
    }
    return count;
  });
}

/** The box around the coloured pixels of a picture: left, top, right and bottom [pixels]. Letters and grounds are grey. */
export function colouredBox(page, picture) {
  return withPixels(page, [picture], (bytes, width) => {
    const box = [Infinity, Infinity, -1, -1];
    for (let k = 0; k < bytes.length; k += 4) {
      const pixel = [bytes[k], bytes[k + 1], bytes[k + 2]];
      if (Math.max(...pixel) - Math.min(...pixel) < 20) continue;
      const [x, y] = [(k / 4) % width, Math.floor(k / 4 / width)];
      box.splice(0, 4, Math.min(box[0], x), Math.min(box[1], y), Math.max(box[2], x), Math.max(box[3], y));
    }
    return box;
  });
}

/** Waits until nothing is computed or drawn any more; the frames drawn so far. */
export async function settled(page) {
  let frames = -1;
  for (let tries = 0; tries < 100; tries += 1) {
    // A frame of the page may take longer than the pause, and a study longer than both.
    const now = await drawn(page);
    if (now === frames && (await stats(page)).jobs === 0) return frames;
    frames = now;
    await page.waitForTimeout(700);
  }
  throw new Error(`still drawing after ${frames} frames`);
}

/**
 * Opens the app and waits until its scene is solved. `isOpening`: with its opening plan, not with the flat one on a coarse grid;
 * `isResearch`: with the switch "Research" on.
 */
export async function openApp(browser, site, { isOpening = false, isResearch = false, options, ...others } = {}) {
  const plan = isOpening ? {} : withCoarsePlan(site.address, isResearch);
  const opened = await openPage(browser, site.address, { ...others, options: { ...plan, ...options } });
  await opened.page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
  await opened.page.locator("#loading").waitFor({ state: "detached" });
  return opened;
}

/**
 * A tab that really is hidden while another one is in front: playwright keeps its own pages visible.
 * `init` is a script that runs before those of the page.
 */
export async function openTab(browser, { init } = {}) {
  const root = await browser.newBrowserCDPSession();
  const { targetId } = await root.send("Target.createTarget", { url: "about:blank" });
  const { sessionId } = await root.send("Target.attachToTarget", { targetId, flatten: false });
  const waiting = new Map();
  root.on("Target.receivedMessageFromTarget", ({ message }) => {
    const { id, ...answer } = JSON.parse(message);
    waiting.get(id)?.(answer);
    waiting.delete(id);
  });
  let sent = 0;
  const send = (method, params = {}) =>
    new Promise((resolve, reject) => {
      sent += 1;
      waiting.set(sent, ({ result, error }) => (error ? reject(new Error(error.message)) : resolve(result)));
      const message = JSON.stringify({ id: sent, method, params });
      root.send("Target.sendMessageToTarget", { sessionId, message }).catch(reject);
    });
  const evaluate = async (expression) => {
    const { result, exceptionDetails } = await send("Runtime.evaluate", {
      expression,
      awaitPromise: true,
      returnByValue: true,
    });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  };
  const waitFor = async (expression) => {
    for (const start = Date.now(); Date.now() - start < PATIENCE; await pause(100)) {
      if (await evaluate(expression)) return;
    }
    throw new Error(`never true: ${expression}`);
  };
  await send("Page.enable");
  // As in openPage: no service worker.
  const source = `delete Navigator.prototype.serviceWorker; (${drawCheaply})(true); ${init ?? ""}`;
  await send("Page.addScriptToEvaluateOnNewDocument", { source });
  return {
    evaluate,
    waitFor,
    open: (url) => send("Page.navigate", { url }),
    press: async (key, text) => {
      for (const type of ["keyDown", "keyUp"]) {
        await send("Input.dispatchKeyEvent", { type, key, code: key === " " ? "Space" : key, text });
      }
    },
    click: async (x, y) => {
      for (const type of ["mouseMoved", "mousePressed", "mouseReleased"]) {
        await pause(150);
        await send("Input.dispatchMouseEvent", { type, x, y, button: "left", clickCount: 1 });
      }
    },
    show: () => root.send("Target.activateTarget", { targetId }),
    close: () => root.send("Target.closeTarget", { targetId }),
  };
}

/** Name and text of the file that an action downloads. */
export async function download(page, action) {
  const [file] = await Promise.all([page.waitForEvent("download"), action()]);
  return { name: file.suggestedFilename(), text: await readFile(await file.path(), "utf8") };
}

/** The present scene as JSON text, and as an object. */
export const sceneText = (page) => page.evaluate(() => implantPreview.scene());
export const scene = async (page) => JSON.parse(await sceneText(page));

/** Counters and times of the running app. */
export const stats = (page) => page.evaluate(() => implantPreview.stats());

export const pause = (ms) => new Promise((resolve) => setTimeout(resolve, ms));

/** Waits until something is true, at most as long as a frame may take on a busy machine. */
async function until(isTrue) {
  for (const start = Date.now(); Date.now() - start < PATIENCE / 2 && !(await isTrue()); await pause(30));
}

/** The control that has the keyboard's focus. */
export const focused = (page) => page.evaluate(() => implantPreview.focused());

/** The answer in words for screen readers, once it contains some words. */
export async function summary(page, words) {
  const text = () => page.locator("#implant-preview-summary").textContent();
  await until(async () => (await text()).includes(words));
  return text();
}

/** What of the page has the keyboard's focus: the app, what is before or behind it, or the form of the plan. */
export const place = (page) =>
  page.evaluate(() => {
    const id = document.activeElement?.id;
    if (document.activeElement?.form) return "form";
    if (id === "implant-preview-skip") return "before";
    if (id === "implant-preview-summary") return "behind";
    return id === "implant-preview-canvas" || document.activeElement?.tagName === "INPUT" ? "app" : "page";
  });

/** Waits for three frames of the page, which are slow where they are drawn in software; the app's frames so far. */
export const drawn = (page) =>
  page.evaluate(async () => {
    for (let frames = 0; frames < 3; frames += 1) await new Promise(requestAnimationFrame);
    return implantPreview.stats().frames;
  });

/** Presses the Tab key and waits until the focus is elsewhere. */
export async function tab(page, { back = false } = {}) {
  const state = async () => JSON.stringify([await focused(page), await place(page)]);
  const before = await state();
  await page.keyboard.press(back ? "Shift+Tab" : "Tab");
  await until(async () => (await state()) !== before);
  // Out of the app it takes a frame more, and scrolling too: until nothing more is drawn.
  for (let last = -1, now; (now = await drawn(page)) !== last; last = now);
}

/** Gives the first control of a name the keyboard focus, and gives its place: the app is one canvas. */
export async function control(page, name) {
  for (let tries = 0; tries < 20; tries += 1) {
    await page.evaluate((name) => implantPreview.focus(name), name);
    // The frame of the request, that of the focus, those of a scroll: until nothing more is drawn.
    for (let last = -1, now; (now = await drawn(page)) !== last; last = now);
    const now = await focused(page);
    if (now?.name === name) return now;
  }
  throw new Error(`no control is called ${name}`);
}

/** Types into the number field of a name, in place of what is there, and presses Enter. */
export async function type(page, name, text) {
  // The slider before it has the same name.
  await control(page, name);
  await tab(page);
  await page.keyboard.type(text, { delay: 40 });
  await page.keyboard.press("Enter");
  await drawn(page);
}

/** Gives the picture the focus, by a click on its empty corner: single keys are for it. */
export async function focusPicture(page) {
  const { width, height } = page.viewportSize();
  const at = width < 760 ? [16, 0.35 * height] : [0.38 * width, 0.2 * height];
  await page.mouse.click(...at);
  await until(async () => (await focused(page))?.name === "3-D view");
}

/** The greatest distance [mm] between the points of two profiles. */
export function profileDistance(a, b) {
  if (a.length !== b.length) return Infinity;
  return Math.max(...a.map((p, k) => Math.hypot(p.r_mm - b[k].r_mm, p.z_mm - b[k].z_mm)));
}

/** Fields of the document with letters of less than 16 px, into which a phone zooms; all of them are counted. */
export const smallFields = (page) =>
  page.evaluate(() => {
    const fields = [...document.querySelectorAll("input, select, textarea")];
    const size = (field) => Number.parseFloat(getComputedStyle(field).fontSize);
    return { count: fields.length, small: fields.filter((field) => size(field) < 16).map((field) => field.outerHTML) };
  });
