// The page without a network: the service worker, a second build, the manifest.

import assert from "node:assert/strict";
import {
  appendFileSync,
  cpSync,
  mkdtempSync,
  readdirSync,
  readFileSync,
  renameSync,
  rmSync,
  writeFileSync,
} from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, afterEach, before, describe, test } from "node:test";
import * as harness from "./harness.mjs";

const FOLDER = /build-[0-9a-f]{16}/;

/** The folder of a build in a folder for a server. */
const buildOf = (folder) => readdirSync(folder).find((name) => FOLDER.test(name));

/** A second build of the page: another folder, changed scripts, marked in the page. */
function buildAgain(folder) {
  const second = mkdtempSync(join(tmpdir(), "implant-preview-build-"));
  cpSync(folder, second, { recursive: true });
  const [old, build] = [buildOf(folder), "build-0123456789abcdef"];
  renameSync(join(second, old), join(second, build));
  for (const file of readdirSync(second).filter((name) => /\.(html|js|mjs)$/.test(name))) {
    const text = readFileSync(join(second, file), "utf8");
    writeFileSync(join(second, file), text.replaceAll(old, build));
  }
  appendFileSync(join(second, build, "crash.js"), "\nglobalThis.secondBuild = true;\n");
  return second;
}

/** Waits until the app has solved its scene. */
async function started(page) {
  await page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
  await page.locator("#loading").waitFor({ state: "detached" });
}

/** Waits until the service worker of a build serves the page and the caches of other builds are gone. */
async function kept(page, build) {
  const isKept = () =>
    page.evaluate(async (build) => {
      const names = await caches.keys();
      const { active, installing, waiting } = (await navigator.serviceWorker.getRegistration()) ?? {};
      const isActive = active?.state === "activated" && navigator.serviceWorker.controller?.state === "activated";
      return isActive && !installing && !waiting && names.length === 1 && names[0].endsWith(build);
    }, build);
  for (const start = Date.now(); !(await isKept()); await harness.pause(50)) {
    assert.ok(Date.now() - start < harness.PATIENCE, "the page is not stored");
  }
}

/** Solves scenes in the workers of the page: the statuses of the results. */
const solveInWorkers = (page) =>
  page.evaluate(async () => {
    const scene = JSON.parse(implantPreviewApi.default_scene());
    scene.solver = { nodes_per_side: 17, tolerance: 1e-3 };
    const statuses = [];
    const receive = (index, result) => statuses.push(JSON.parse(result).status ?? result);
    await implantPreviewApi.simulateMany(JSON.stringify([scene, scene]), receive).done;
    return statuses;
  });

const isSecond = (page) => page.evaluate(() => globalThis.secondBuild === true);

describe("the page without a network", { timeout: 8 * harness.PATIENCE }, () => {
  const first = harness.DIST;
  let second;
  let browser;
  let site;
  before(async () => {
    second = buildAgain(first);
    browser = await harness.startBrowser();
  });
  after(async () => {
    await browser?.close();
    rmSync(second, { recursive: true });
  });
  afterEach(() => site.close());
  const open = () => {
    const options = { serviceWorkers: "allow", ...harness.withCoarsePlan(site.address) };
    return harness.openPage(browser, site.address, { options, isPlain: true });
  };

  test("is stored whole by one visit, can be installed, starts, solves and runs its workers", async () => {
    site = await harness.serve();
    const { page, finish } = await open();
    await started(page);
    await kept(page, buildOf(first));

    // The files of the build and nothing else, after an edit too.
    await page.evaluate(() => implantPreview.setPlan("width_cm", "12.5"));
    await started(page);
    const stored = await page.evaluate(async () => {
      const [name] = await caches.keys();
      const requests = await (await caches.open(name)).keys();
      return requests.map(({ url }) => url.slice(document.baseURI.length)).sort();
    });
    const isSent = (file) => /\.\w+$/.test(file) && !/\.(br|gz)$/.test(file) && !file.startsWith(".");
    const files = readdirSync(first, { recursive: true }).filter(
      (file) => isSent(file) && file !== "service_worker.js",
    );
    assert.deepEqual(stored, files.map((file) => (file === "index.html" ? "" : file)).sort());

    // The manifest.
    const session = await page.context().newCDPSession(page);
    const { url, errors } = await session.send("Page.getAppManifest");
    assert.equal(url, `${site.address}manifest.webmanifest`);
    assert.deepEqual(errors, []);
    const { installabilityErrors } = await session.send("Page.getInstallabilityErrors");
    // Contexts of tests are those of private windows.
    assert.deepEqual(
      installabilityErrors.filter(({ errorId }) => errorId !== "in-incognito"),
      [],
    );
    const sizes = await page.evaluate(async () => {
      const { icons } = await (await fetch("manifest.webmanifest")).json();
      const load = async ({ src, sizes }) => {
        const image = new Image();
        image.src = src;
        await image.decode();
        return [sizes, `${image.naturalWidth}x${image.naturalHeight}`];
      };
      return Promise.all(icons.map(load));
    });
    assert.equal(sizes.length, 3);
    for (const [stated, found] of sizes) assert.ok(stated === "any" || stated === found, `${stated}: ${found}`);

    await site.close();
    // Without a reload: the first worker of this page.
    assert.deepEqual(await solveInWorkers(page), ["converged", "converged"]);
    await page.reload();
    await started(page);
    assert.deepEqual(await solveInWorkers(page), ["converged", "converged"]);
    await page.goto(`${site.address}index.html?from=elsewhere#top`);
    await started(page);
    await page.goto(`${site.address}bench.html?nodes_per_side=17&cases=default&methods=multigrid_1`);
    await page.getByRole("button", { name: "Start" }).click();
    await page.getByRole("status").getByText("Done in").waitFor();

    // A changed page of the same address comes from the network at once.
    site = await harness.serve({ folder: second, port: Number(new URL(site.address).port) });
    await page.goto(`${site.address}bench.html`);
    const script = () => page.locator("script[src]").getAttribute("src");
    assert.ok((await script()).includes(buildOf(second)));
    await finish();
  });

  test("shows a new build at the next load, and never files of two builds", async () => {
    site = await harness.serve({ folder: first });
    const port = Number(new URL(site.address).port);
    const { page, close } = await open();
    // The builds whose files the loaded page requests. The page that is left may request a worker until the new one is there.
    const builds = new Set();
    page.on("framenavigated", () => builds.clear());
    page.on("request", (request) => {
      const [build] = request.url().match(FOLDER) ?? [];
      if (build) builds.add(build);
    });
    await started(page);
    await kept(page, buildOf(first));

    // The connection breaks within the download of the second build.
    await site.close();
    site = await harness.serve({ folder: second, port, refuses: (path) => path.endsWith(".wasm") });
    await page.reload();
    await page.locator("#crashed").waitFor({ state: "visible" });
    assert.deepEqual([...builds], [buildOf(second)]);
    await site.close();
    await page.reload();
    await started(page);
    assert.equal(await isSecond(page), false);
    assert.deepEqual(await solveInWorkers(page), ["converged", "converged"]);
    assert.deepEqual([...builds], [buildOf(first)]);

    // The whole second build.
    site = await harness.serve({ folder: second, port });
    await page.reload();
    await started(page);
    assert.equal(await isSecond(page), true);
    assert.deepEqual(await solveInWorkers(page), ["converged", "converged"]);
    assert.deepEqual([...builds], [buildOf(second)]);
    await kept(page, buildOf(second));
    await site.close();
    await page.reload();
    await started(page);
    assert.equal(await isSecond(page), true);
    assert.deepEqual([...builds], [buildOf(second)]);
    await close();
  });

  test("is not stored from a frame of another page", async () => {
    site = await harness.serve();
    const folder = mkdtempSync(join(tmpdir(), "implant-preview-frame-"));
    writeFileSync(join(folder, "index.html"), `<iframe src="${site.address}" width="800" height="600"></iframe>`);
    const outer = await harness.serve({ folder });
    try {
      const context = await browser.newContext();
      context.setDefaultTimeout(harness.PATIENCE);
      const page = await context.newPage();
      await page.goto(outer.address);
      const [, frame] = page.frames();
      await started(frame);
      await page.waitForTimeout(500);
      assert.equal(await frame.evaluate(async () => (await navigator.serviceWorker.getRegistrations()).length), 0);
      await context.close();
    } finally {
      await outer.close();
      rmSync(folder, { recursive: true });
    }
  });
});
