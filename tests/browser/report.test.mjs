// What is taken home from the real page: picture, report, meshes, profile, link. Files are read by programs that did not
// write them.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { readFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { describe, test } from "node:test";
import { GLTFLoader } from "three/addons/loaders/GLTFLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
import { PLYLoader } from "three/addons/loaders/PLYLoader.js";
import { STLLoader } from "three/addons/loaders/STLLoader.js";
import * as harness from "./harness.mjs";
import { textsOf } from "./pdf.mjs";
import { trunk } from "./trunk.mjs";

const fixture = harness.setUp();

/** Opens menus one after the other and focuses the last item. */
async function choose(page, ...items) {
  // The previous file may still be on its way, and frames are slow on a busy machine.
  await harness.settled(page);
  for (const item of ["File", ...items]) {
    await harness.control(page, item);
    if (item !== items.at(-1)) {
      await page.keyboard.press("Enter");
      await harness.settled(page);
    }
  }
}

/** Chooses an item of the menu "File" and reads the file that is downloaded. */
async function save(page, ...items) {
  await choose(page, ...items);
  // In front of a report is a dialog, which the Enter key saves.
  if (items.at(-1).startsWith("Save report")) {
    await page.keyboard.press("Enter");
    await harness.control(page, "Save report");
  }
  const [file] = await Promise.all([page.waitForEvent("download"), page.keyboard.press("Enter")]);
  return { name: file.suggestedFilename(), bytes: await readFile(await file.path()) };
}

/** Number of colours of an image of a page, reduced to 64 × 64 pixels, within a part of it (shares of its size). */
const colours = (image, part = [0, 0, 1, 1]) =>
  image.evaluate((img, [x, y, w, h]) => {
    const canvas = Object.assign(document.createElement("canvas"), { width: 64, height: 64 });
    const context = canvas.getContext("2d");
    const { naturalWidth: width, naturalHeight: height } = img;
    context.drawImage(img, x * width, y * height, w * width, h * height, 0, 0, 64, 64);
    const { data } = context.getImageData(0, 0, 64, 64);
    return new Set(Array.from({ length: 4096 }, (_, k) => (data[4 * k] << 16) | (data[4 * k + 1] << 8) | data[4 * k + 2])).size;
  }, part);

/** Volume within the triangles of a geometry; a closed mesh moved far away has the same volume. */
function volume(geometry) {
  const { position } = geometry.attributes;
  const index = geometry.index?.array ?? Array.from({ length: position.count }, (_, k) => k);
  const of = (shift) => {
    let sum = 0;
    for (let k = 0; k < index.length; k += 3) {
      const [a, b, c] = [0, 1, 2].map((i) => {
        const at = index[k + i];
        return [position.getX(at) + shift, position.getY(at) + shift, position.getZ(at) + shift];
      });
      const cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
      sum += (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]) / 6;
    }
    return sum;
  };
  const size = Math.cbrt(Math.abs(of(0)));
  assert.ok(Math.abs(of(size) / of(0) - 1) < 1e-3, "the mesh is not closed");
  return of(0);
}

/** Rows of a table by the grammar of RFC 4180. */
function readCsv(text) {
  const rows = [];
  const sign = /(?:"((?:[^"]|"")*)"|([^",\r\n]*))(,|\r\n)/y;
  for (let row = []; sign.lastIndex < text.length; ) {
    const found = sign.exec(text);
    assert.ok(found, "a sign against the grammar");
    row.push(found[1]?.replaceAll('""', '"') ?? found[2]);
    if (found[3] !== ",") {
      rows.push(row);
      row = [];
    }
  }
  return rows;
}

const buffer = (bytes) => bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);

/** Volume [ml] of a mesh, by the reader of its format. */
async function millilitres({ name, bytes }) {
  const format = name.split(".").at(-1);
  const all = (group) => {
    let sum = 0;
    const parts = [];
    group.traverse((object) => object.isMesh && parts.push(object.geometry));
    // The parts of a file are closed together.
    const positions = parts.flatMap((part) => Array.from((part.index ? part.toNonIndexed() : part).attributes.position.array));
    sum += volume({ attributes: { position: positionsOf(positions) } });
    return sum;
  };
  if (format === "stl") return volume(new STLLoader().parse(buffer(bytes))) / 1e3;
  if (format === "ply") return volume(new PLYLoader().parse(buffer(bytes))) / 1e3;
  if (format === "obj") return all(new OBJLoader().parse(bytes.toString())) / 1e3;
  const gltf = await new GLTFLoader().parseAsync(buffer(bytes), "");
  return all(gltf.scene) * 1e6;
}

const positionsOf = (array) => ({
  count: array.length / 3,
  getX: (k) => array[3 * k],
  getY: (k) => array[3 * k + 1],
  getZ: (k) => array[3 * k + 2],
});

describe("a plan on paper", { timeout: 15 * harness.PATIENCE }, () => {
  test("is a composed picture and a report that loads nothing and runs nothing", async () => {
    const { page, finish } = await fixture.openApp();
    await harness.control(page, "Pin as A");
    await page.keyboard.press("Enter");
    // On a slow page key and edit may fall into one frame: the pin first.
    await harness.settled(page);
    await page.evaluate(() => implantPreview.setPlan("volume_ml", "340"));
    const picture = await save(page, "Save picture (PNG)…");
    const today = await page.evaluate(() => new Date().toLocaleDateString("sv"));
    assert.equal(picture.name, `implant-340ml-${today}.png`);
    assert.equal(picture.bytes.toString("latin1", 1, 4), "PNG");
    // Of its own width, whatever the window, and as high as its texts need.
    assert.equal(picture.bytes.readUInt32BE(16), 2000);
    assert.equal(picture.bytes.readUInt32BE(20), 1752);

    const report = await save(page, "Save report (HTML)…");
    assert.equal(report.name, `implant-340ml-${today}.html`);
    const paper = await page.context().newPage();
    const requests = [];
    paper.on("request", (request) => requests.push(request.url().slice(0, 20)));
    await paper.setContent(`<img src="data:image/png;base64,${picture.bytes.toString("base64")}">`);
    await paper.waitForFunction(() => document.images[0].complete);
    assert.ok((await colours(paper.locator("img"), [0.1, 0.1, 0.8, 0.5])) > 100, "the tissue is missing in the picture");
    assert.ok((await colours(paper.locator("img"), [0, 0.7, 1, 0.3])) > 10, "the texts are missing in the picture");

    await paper.setContent(report.bytes.toString());
    assert.equal(await paper.locator("h1").textContent(), "Implant preview");
    const words = await paper.locator("body").textContent();
    assert.match(words, /Not a medical device/);
    assert.match(words, /12 cm|12\.0 cm/);
    const names = await paper.locator("img").evaluateAll((images) => images.map((image) => image.alt));
    const poses = ["From the front", "Three-quarter view", "From the patient's side"];
    assert.deepEqual(names, [...poses, "Pins and plan side by side", "Cross-section"]);
    assert.deepEqual(await paper.locator("figcaption").allTextContents(), poses);
    for (const [k, image] of (await paper.locator("img").all()).entries()) {
      assert.ok(await image.evaluate((img, least) => img.complete && img.naturalWidth >= least, [900, 900, 900, 1600, 1400][k]));
    }
    assert.ok((await colours(paper.locator("img").first())) > 100);
    assert.ok((await colours(paper.locator("img").last())) > 10);
    // The plan's file in the report opens as the plan.
    const { pins, ...plan } = JSON.parse(await paper.locator("details pre").textContent());
    assert.equal(pins.length, 1);
    assert.deepEqual(plan, await harness.scene(page));
    assert.ok(requests.every((address) => address.startsWith("data:image/png")), String(requests));
    // No report waits for the chart of the range: a line of the screen says how to get it.
    assert.match(await paper.locator(".screen").textContent(), /Open the page Range of implants/);
    // Numbers of the pages on all, the running head from the second on; the words of the cards beside the numbers.
    const pages = textsOf(await paper.pdf({ format: "A4" }));
    assert.equal(pages.length, 2, `${pages.length} pages`);
    pages.forEach((text, k) => assert.ok(text.includes(`page${k + 1}of2`), text));
    assert.ok(!pages[0].includes("Implantpreview·340ml,12cm") && pages[1].includes("Implantpreview·340ml,12cm"), pages[1]);
    // A number is aligned to the right, its word has a column of its own.
    const cells = (name) => paper.locator(".numbers tr").filter({ hasText: name }).locator("td").allTextContents();
    const [, stretch, word] = await cells("Most stretch, %");
    assert.ok(/^\d+$/.test(stretch) && /^(below|as|above) practice$/.test(word), `${stretch} ${word}`);
    assert.equal((await cells("Skin's reserve used, %")).length, 5);
    assert.equal(await paper.locator(".numbers td.number").first().evaluate((cell) => getComputedStyle(cell).textAlign), "right");
    // The answers are words with bars: the word is larger than the figure.
    assert.equal(await paper.locator(".answers svg").count(), 3);
    const size = (place) => paper.locator(place).first().evaluate((text) => Number.parseFloat(getComputedStyle(text).fontSize));
    assert.ok((await size(".verdict")) > 1.4 * (await size(".answers p:not(.verdict)")));
    assert.match(await paper.locator(".implant").textContent(), /^Implant: round, 12 cm wide, 340 ml, projection [\d.]+ cm$/);
    // On paper the words in the pictures have at least 5.5 points: a picture has so many points of the screen, its texts 11.5.
    await paper.emulateMedia({ media: "print" });
    await paper.setViewportSize({ width: 700, height: 1000 });
    const widths = await paper.locator("img").evaluateAll((images) => images.map((image) => image.getBoundingClientRect().width));
    const points = [270, 270, 270, 700, 560].map((wide, k) => (0.75 * 11.5 * widths[k]) / wide);
    assert.ok(points.every((size) => size > 5.5), `${points} points`);
    await paper.emulateMedia({ media: "screen" });
    // The poses are the same whatever the screen shows.
    await harness.control(page, "Front");
    await page.keyboard.press("Enter");
    await harness.settled(page);
    const images = (html) => [...html.matchAll(/<figure><img [^>]*src="([^"]+)"/g)].map(([, address]) => address);
    const again = images((await save(page, "Save report (HTML)…")).bytes.toString());
    assert.ok(again.length === 3 && again.every((address, k) => address === images(report.bytes.toString())[k]), "the poses follow the camera");
    await paper.close();

    // All numbers of plan and pin as a table.
    const table = await save(page, "Save numbers (CSV)…");
    assert.equal(table.name, `implant-340ml-${today}-numbers.csv`);
    const [head, ...rows] = readCsv(table.bytes.toString());
    assert.deepEqual(head, ["quantity", "unit", "this plan", "A"]);
    assert.ok(rows.length > 35 && rows.every((row) => row.length === 4));
    const result = JSON.parse(await page.evaluate(() => implantPreview.result()));
    const row = (name, unit) => rows.find(([a, b]) => a === name && b === unit).slice(2).map(Number);
    assert.ok(Math.abs(row("Skin stretch", "%")[0] / (100 * result.strain.max_principal) - 1) < 1e-8);
    assert.ok(Math.abs(row("Pressure, greatest", "mmHg")[0] / result.contact_pressure_mmhg.max - 1) < 1e-8);
    assert.ok(Math.abs(row("Volume", "ml")[0] - 340) < 1e-6 && Math.abs(row("Volume", "ml")[1] - 300) < 1e-6);

    // Without an answer both say so, and that the picture is another plan's.
    await page.evaluate(() => {
      const scene = JSON.parse(implantPreview.scene());
      scene.implant.projection_mm = 105;
      implantPreview.setScene(JSON.stringify(scene));
    });
    const none = (await save(page, "Save report (HTML)…")).bytes.toString();
    assert.match(none, /no answer\./);
    assert.match(none, /The picture is of the last plan with an answer: 340 ml on 12 cm\./);
    await finish();
  });

  test("has the measures of her body before and after, and each body is a file", async () => {
    const folder = mkdtempSync(join(tmpdir(), "implant-preview-body-"));
    const [mesh, marked, plan] = ["body.ply", "marks.json", "plan.json"].map((name) => join(folder, name));
    // Small enough to be kept as it is.
    const { ply, points, marks } = trunk(120, 90);
    writeFileSync(mesh, ply);
    writeFileSync(marked, JSON.stringify(marks));
    const scan = ["scan", mesh, "--marks", marked, "--side", "left", "--keep-surface", "--out", plan];
    execFileSync(harness.NATIVE, scan, { stdio: ["pipe", "pipe", "ignore"] });
    const scene = { ...JSON.parse(readFileSync(plan, "utf8")), solver: { nodes_per_side: 33, tolerance: 1e-3 } };
    rmSync(folder, { recursive: true });
    const { page, finish } = await fixture.openApp({ isPlain: true });
    await page.evaluate((text) => implantPreview.setScene(text), JSON.stringify(scene));
    await harness.settled(page);
    const report = await save(page, "Save report (HTML)…");
    const paper = await page.context().newPage();
    await paper.setContent(report.bytes.toString());
    const rows = await paper.locator(".measures tr").evaluateAll((all) => all.map((row) => Array.from(row.cells, (cell) => cell.textContent)));
    // Heads and 15 of 17 measures: two need the marks of both breasts.
    assert.equal(rows.length, 16);
    assert.deepEqual(rows[0], ["", "before", "after", "gain"]);
    const of = (name) => rows.find(([own]) => own === name).slice(1);
    const [before, after, gain] = of("Notch to nipple, cm").map(Number);
    assert.ok(Math.abs(after - before - gain) < 0.11 && gain > 0 && before > 17 && before < 21, `${before} ${after} ${gain}`);
    assert.match(of("Volume gained, ml").join(), /^,,\+(2[3-9]|3\d)\d$/);
    assert.match(await paper.locator("body").textContent(), /Not computed: lengths under stretch/);
    assert.equal(textsOf(await paper.pdf({ format: "A4" })).length, 2);
    await paper.close();
    const [, ...numbers] = readCsv((await save(page, "Save numbers (CSV)…")).bytes.toString());
    const number = (name) => Number(numbers.find(([own]) => own === name)[2]);
    assert.ok(Math.abs(number("Notch to nipple, after") - after) <= 0.051);
    const today = await page.evaluate(() => new Date().toLocaleDateString("sv"));
    const files = [];
    for (const [body, name] of [["before", "body-before"], ["after", "body-after-12cm-225ml"]]) {
      const file = await save(page, "Save shape (3-D)", `Body ${body} as PLY`);
      assert.equal(file.name, `${name}-${today}.ply`);
      files.push(new PLYLoader().parse(buffer(file.bytes)).attributes.position);
    }
    assert.equal(files[0].count, points.length);
    const moved = Array.from({ length: files[0].count }, (_, k) =>
      Math.hypot(...["getX", "getY", "getZ"].map((axis) => files[1][axis](k) - files[0][axis](k))),
    );
    const most = Math.max(...moved);
    assert.ok(most > 15 && most < 45, `${most} mm`);
    await finish();
  });

  test("shows each side from its own side where each has a plan", async () => {
    const { page, finish } = await fixture.openApp({ isPlain: true });
    const torso = { chest_width_mm: 260 };
    await page.evaluate((torso) => {
      const scene = { ...JSON.parse(implantPreview.scene()), chest: { torso } };
      implantPreview.setScene(JSON.stringify(scene));
    }, torso);
    await harness.settled(page);
    for (const sides of ["both alike", "each own"]) {
      await harness.control(page, sides);
      await page.keyboard.press("Enter");
      await harness.settled(page);
    }
    await page.evaluate(() => implantPreview.setPlan("volume_ml", "260"));
    await harness.settled(page);
    const report = (await save(page, "Save report (HTML)…")).bytes.toString();
    const paper = await page.context().newPage();
    await paper.setContent(report);
    const poses = ["Three-quarter view", "From the patient's side"];
    const [of, ofOther] = ["left", "right"].map((side) => poses.map((pose) => `${pose} · ${side}`));
    assert.deepEqual(await paper.locator("figcaption").allTextContents(), ["From the front", ...of, ...ofOther]);
    const images = await paper.locator("figure img").evaluateAll((all) => all.map((image) => image.src));
    assert.equal(new Set(images).size, 5, "two poses are one picture");
    assert.match(await paper.title(), /left 260 ml, [\d.]+ cm · right \d+ ml, [\d.]+ cm$/);
    // Two plans and their measures take a page more, the plan ends on the first.
    const pages = textsOf(await paper.pdf({ format: "A4" }));
    assert.equal(pages.length, 3);
    assert.ok(pages[0].includes("Inplace100%") && pages[1].includes("Cross-section"), pages[1]);
    await paper.close();
    await finish();
  });

  test("has patient and visit in file, report and picture, and nowhere else", async () => {
    const { page, finish } = await fixture.openApp({ isPlain: true });
    await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
    for (const letter of ["A", "B", "C", "D"]) {
      // The button of the letter before has a new name, which it says only when it gets the focus.
      await harness.control(page, "File");
      await harness.control(page, `Pin as ${letter}`);
      await page.keyboard.press("Enter");
      await harness.drawn(page);
      await page.evaluate((volume) => implantPreview.setPlan("volume_ml", String(volume)), 310 + letter.charCodeAt(0));
      await harness.settled(page);
    }
    // The chart of the range is a part of the report once it is computed.
    await harness.control(page, "Range of implants");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => {
      const { range_done, range_all } = implantPreview.stats();
      return range_all > 0 && range_done === range_all;
    }, null, { timeout: 4 * harness.PATIENCE });
    await harness.control(page, "Picture");
    await page.keyboard.press("Enter");
    const { solves } = await harness.stats(page);
    await harness.control(page, "For the file");
    await page.keyboard.press("Enter");
    const remarks = Array.from({ length: 12 }, (_, k) => `line ${k + 1}: <b>forty characters of remarks</b>`).join("\n").slice(0, 500);
    for (const [name, text] of [["Patient no.", "K. M. 4711"], ["Date of the visit", "2026-01-31"], ["Surgeon", "Dr Å"], ["Remarks", remarks]]) {
      await harness.control(page, name);
      await page.keyboard.type(text);
    }
    await harness.control(page, "left");
    await page.keyboard.press("Enter");
    await harness.settled(page);
    await harness.screenshot(page, "visit");
    const visit = { reference: "K. M. 4711", date: "2026-01-31", surgeon: "Dr Å", remarks };
    assert.deepEqual((await harness.scene(page)).visit, visit);
    assert.equal((await harness.scene(page)).side, "left");
    assert.equal((await harness.stats(page)).solves, solves, "a solve for words");

    const file = await save(page, "Save plan…");
    assert.deepEqual(JSON.parse(file.bytes.toString()).visit, visit);
    const report = await save(page, "Save report (HTML)…");
    const paper = await page.context().newPage();
    await paper.setContent(report.bytes.toString());
    assert.equal(await paper.locator(".visit").first().textContent(), "K. M. 4711 · left side · visit of 2026-01-31 · surgeon Dr Å");
    assert.equal(await paper.locator(".visit").last().textContent(), remarks);
    assert.equal(await paper.locator(".visit b").count(), 0);
    const chart = paper.getByRole("img", { name: "Range of implants: skin stretch" });
    await chart.evaluate((img) => img.decode());
    assert.ok((await colours(chart)) > 60, "the chart is blank");
    assert.equal(await paper.locator(".screen").count(), 0);
    assert.equal(report.name, "implant-378ml-2026-01-31-K-M-4711.html");
    const pages = textsOf(await paper.pdf({ format: "A4" }));
    assert.equal(pages.length, 2, `${pages.length} pages`);
    const head = "K.M.4711·leftside·visitof2026-01-31·surgeonDrÅ·378ml,12cm";
    assert.ok(pages[1].includes(head), pages[1]);
    assert.ok(pages[1].includes("page2of2"), pages[1]);
    assert.equal(await paper.title(), "Implant preview: report · K. M. 4711 · left side · visit of 2026-01-31 · surgeon Dr Å · 378 ml, 12 cm");
    await paper.emulateMedia({ media: "print" });
    await paper.setViewportSize({ width: 700, height: 1000 });
    await harness.screenshot(paper, "visit-report");
    const picture = await save(page, "Save picture (PNG)…");
    await paper.setContent(`<img width="1000" src="data:image/png;base64,${picture.bytes.toString("base64")}">`);
    await paper.waitForFunction(() => document.images[0].complete);
    await harness.screenshot(paper, "visit-picture");
    await paper.close();

    // Neither in numbers nor in a link, nor in what the browser keeps.
    const numbers = await save(page, "Save numbers (CSV)…");
    assert.doesNotMatch(numbers.bytes.toString(), /K\. M\.|"visit"/);
    await choose(page, "Copy link");
    await page.keyboard.press("Enter");
    await harness.settled(page);
    const link = await page.evaluate(() => navigator.clipboard.readText());
    await page.waitForTimeout(1000);
    const kept = await page.evaluate(() => JSON.stringify([{ ...localStorage }, { ...sessionStorage }]));
    assert.match(kept, /implant-preview\/plan\/1/);
    assert.doesNotMatch(kept, /K\. M\.|visit/);
    const { visit: _, ...plan } = await harness.scene(page);
    await page.evaluate((address) => (location.hash = new URL(address).hash), link);
    await harness.settled(page);
    assert.deepEqual(await harness.scene(page), plan);
    await finish();
  });

  test("is a mesh of the tissue, of the skin and of the implant, a profile, and a result with its own scene", async () => {
    const { page, finish } = await fixture.openApp({ isResearch: true, isPlain: true });
    const volumes = {};
    for (const [what, formats] of [["Implant as made", ["STL", "GLB"]], ["Implant in place", ["STL", "OBJ", "PLY", "GLB"]], ["Tissue", ["STL", "GLB"]], ["Skin", ["PLY"]]]) {
      for (const format of formats) {
        const file = await save(page, "Save shape (3-D)", `${what} as ${format}`);
        const size = what === "Implant as made" ? "300ml" : "12cm-300ml";
        const word = what.toLowerCase().replace(" as made", "").replaceAll(" ", "-");
        assert.match(file.name, new RegExp(`^${word}-${size}-\\d{4}-\\d\\d-\\d\\d\\.${format.toLowerCase()}$`));
        (volumes[what] ??= []).push(await millilitres(file));
      }
    }
    for (const volume of [...volumes["Implant as made"], ...volumes["Implant in place"]]) assert.ok(Math.abs(volume - 300) < 1, `${volume} ml`);
    // Fat of Poisson ratio 0.49 and skin keep their volume nearly: a disc of 12 cm radius, 10 mm thick.
    const { patch_radius_mm, layers } = await harness.scene(page);
    const rest = (thickness) => (Math.PI * patch_radius_mm ** 2 * thickness) / 1e3;
    const [skin, fat] = layers.map((layer) => layer.thickness_mm);
    for (const volume of volumes.Tissue) assert.ok(Math.abs(volume / rest(skin + fat) - 1) < 0.05, `tissue ${volume} ml`);
    for (const volume of volumes.Skin) assert.ok(Math.abs(volume / rest(skin) - 1) < 0.08, `skin ${volume} ml`);

    // All parts in one file, each a closed body with unit normals and its own material.
    const all = await save(page, "Save shape (3-D)", "All parts as GLB");
    assert.match(all.name, /^shape-12cm-300ml-\d{4}-\d\d-\d\d.*\.glb$/);
    const bodies = (await new GLTFLoader().parseAsync(buffer(all.bytes), "")).scene.children;
    assert.deepEqual(bodies.map((body) => body.name), ["implant", "skin", "tissue"]);
    assert.deepEqual(bodies.map((body) => body.material.name), ["implant", "skin", "tissue"]);
    for (const { geometry, material } of bodies) {
      assert.ok(volume(geometry) > 0 && material.metalness === 0 && material.roughness > 0);
      const { position, normal } = geometry.attributes;
      assert.equal(normal.count, position.count);
      const length = (k) => Math.hypot(normal.getX(k), normal.getY(k), normal.getZ(k));
      for (let k = 0; k < normal.count; k++) assert.ok(Math.abs(length(k) - 1) < 1e-5);
    }
    assert.equal(new Set(bodies.map((body) => body.material.color.getHex())).size, 3);
    // The skin has the colours of its stretch.
    assert.deepEqual(bodies.map(({ geometry }) => geometry.attributes.color?.count > 0), [false, true, false]);

    const profile = await save(page, "Save profile (CSV)…");
    assert.match(profile.name, /^profile-12cm-300ml-\d{4}-\d\d-\d\d.*\.csv$/);
    const [head, ...rows] = profile.bytes.toString().trim().split("\n");
    assert.equal(head, "surface,direction,s_mm,r_mm,z_mm,stretch_meridional,stretch_hoop");
    const result = JSON.parse(await page.evaluate(() => implantPreview.result()));
    for (const [surface, points] of [["inner_face", result.profile], ["skin_membrane", result.profile_skin]]) {
      assert.equal(rows.filter((row) => row.startsWith(`${surface},side,`)).length, points.length);
    }
    assert.ok(rows.every((row) => row.split(",").slice(2).every((value) => Number.isFinite(Number(value)))));

    // There is no result while its scene is solved.
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
    const wide = JSON.parse(await page.evaluate(() => implantPreview.result()));
    assert.deepEqual(wide.scene, await harness.scene(page));
    assert.equal(wide.scene.pocket_radius_mm, 178);
    assert.equal(wide.scene.patch_radius_mm, 238);
    assert.ok(Math.abs(wide.area_before_cm2 - 0.01 * Math.PI * 178 ** 2) < 1e-9);
    assert.equal(wide.program_version, await page.evaluate(() => implantPreviewApi.version()));
    assert.ok(Math.abs(Date.parse(wide.date) - Date.now()) < 600_000, wide.date);
    // The same from the menu.
    const saved = JSON.parse((await save(page, "Save numbers (JSON)…")).bytes.toString());
    assert.deepEqual(saved.scene, wide.scene);
    assert.equal(saved.contact_force_n, wide.contact_force_n);
    await finish();
  });

  test("is a link that opens to the same result elsewhere", async () => {
    const { page, finish } = await fixture.openApp({ isPlain: true });
    await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
    await page.evaluate(() => implantPreview.setPlan("volume_ml", "345"));
    await harness.settled(page);
    await choose(page, "Copy link");
    await page.keyboard.press("Enter");
    await harness.settled(page);
    const link = await page.evaluate(() => navigator.clipboard.readText());
    assert.match(link, /^http:\/\/[^#]+#plan=[\w-]+$/);
    assert.ok(link.length < 2000, `${link.length} characters`);
    const [scene, result] = await page.evaluate(() => [implantPreview.scene(), implantPreview.result()]);
    await finish();

    const requests = [];
    const other = await fixture.openPage(new URL(link).hash, {
      isPlain: true,
      // A browser sends an address without what follows its #.
      prepare: (page) => page.on("request", (request) => requests.push(request.url().split("#")[0])),
    });
    await other.page.waitForFunction(() => globalThis.implantPreview?.stats().converged);
    assert.equal(await other.page.evaluate(() => implantPreview.scene()), scene);
    const [here, there] = [JSON.parse(result), JSON.parse(await other.page.evaluate(() => implantPreview.result()))];
    assert.equal(there.status, "converged");
    assert.ok(Math.abs(there.contact_force_n / here.contact_force_n - 1) < 5e-3);
    // The address is without the plan, no server has got it, and a damaged link loses nothing.
    assert.equal(await other.page.evaluate(() => location.hash), "");
    await other.page.evaluate(() => (location.hash = "#plan=broken"));
    await harness.settled(other.page);
    assert.equal(await other.page.evaluate(() => implantPreview.scene()), scene);
    assert.ok(requests.every((address) => !address.includes("plan=")), String(requests));
    await other.finish();
  });
});
