// The JavaScript package as another site gets it: packed, installed from its tarball, type-checked, run in Chromium.
// js/build.sh builds it; the native program is compared with.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import * as harness from "../browser/harness.mjs";
import { trunk } from "../browser/trunk.mjs";
import { brotliSize } from "../browser/weigh.mjs";

const PACKAGE = join(harness.ROOT, "js");
const HERE = join(harness.ROOT, "tests/js");
const Ajv = createRequire(join(PACKAGE, "package.json"))("ajv/dist/2020").default;

/**
 * Greatest size of the WebAssembly, compressed by brotli with quality 11 [bytes], 48 kB of it a body's surface; what weighs what: docs/performance.md, "Size of the
 * JavaScript package".
 */
const BUDGET = 700_000;
/**
 * Greatest difference of a number from the native program's, relative to the number, of a list to the greatest number of the list.
 * Both solve in f32 and round otherwise: 1e-7 was measured.
 */
const ACCURACY = 1e-5;
/** The insertion of a scene that stops its worker. */
const POISON = 0.765625;
// (module (func (export "f") unreachable))
const TRAP = [
  0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 7, 5, 1, 1, 102, 0, 0, 10, 5, 1, 3, 0, 0, 11,
];

const native = (options, input) =>
  execFileSync(harness.NATIVE, options, { input, encoding: "utf8", stdio: ["pipe", "pipe", "ignore"], maxBuffer: 1 << 28 });

/** Lines of the native program, some of scenes that are invalid or have no shape, which its exit code reports. */
function nativeLines(texts) {
  try {
    return native(["simulate", "-", "--lines"], texts.join("\n"));
  } catch (error) {
    assert.ok([2, 3].includes(error.status), error.message);
    return error.stdout;
  }
}

const grid = { nodes_per_side: 17, tolerance: 1e-3 };

/** Sixty scenes: sheets and layered tissue, centred and not, curved chests, patients, and invalid ones. */
function sixtyScenes() {
  const scenes = Array.from({ length: 60 }, (_, k) => ({
    id: k % 3 === 0 ? { row: k } : `scene ${k}`,
    implant: { base_radius_mm: 45 + (k % 5), projection_mm: 35, center_mm: k % 2 ? [3, 0] : [0, 0] },
    ...[{}, { tissue_model: "sheet" }, { chest: { radius_across_mm: 140 } }, { patient: { pinch_mm: 22, skin_class: "normal" } }][k % 4],
    insertion: 0.5 + k / 120,
    solver: grid,
  }));
  scenes[7].insertion = 7;
  scenes[13].colour = "red";
  scenes[29].implant = { base_radius_mm: "wide" };
  delete scenes[41].implant;
  const texts = scenes.map((scene) => JSON.stringify(scene));
  texts[47] = '{"insertion": ';
  texts[59] = "5";
  return texts;
}

/** The paths at which two values differ: numbers by more than the accuracy. */
function differences(found, expected, path = "", scale = 0) {
  if (typeof found === "number" && typeof expected === "number") {
    const size = Math.max(Math.abs(expected), scale);
    return Math.abs(found - expected) <= ACCURACY * size ? [] : [`${path}: ${found}, natively ${expected}`];
  }
  if (found === null || expected === null || typeof found !== "object" || typeof expected !== "object") {
    return Object.is(found, expected) ? [] : [`${path}: ${found}, natively ${expected}`];
  }
  const numbers = Object.values(expected).filter((value) => typeof value === "number");
  const size = Array.isArray(expected) ? Math.max(0, ...numbers.map(Math.abs)) : 0;
  const names = new Set([...Object.keys(found), ...Object.keys(expected)]);
  return [...names].flatMap((name) => differences(found[name], expected[name], `${path}.${name}`, size));
}

/** A result without what depends on the machine or on rounding alone. */
function comparable({ solver, scene_hash, ...line }) {
  if (!solver) return line;
  const { nodes_per_side, nodes_solved, method } = solver;
  return { ...line, solver: { nodes_per_side, nodes_solved, method } };
}

/** A schema of which no object has further fields. */
function closed(schema) {
  if (Array.isArray(schema)) return schema.map(closed);
  if (schema === null || typeof schema !== "object") return schema;
  const parts = Object.fromEntries(Object.entries(schema).map(([name, part]) => [name, closed(part)]));
  const isObject = parts.properties && typeof parts.properties === "object" && parts.type === "object";
  return isObject ? { additionalProperties: false, ...parts } : parts;
}

/** Checks a value against the schema of a format. */
function assertFits(format, value) {
  const schema = closed(JSON.parse(native(["schema", "--of", format])));
  const fits = new Ajv({ strict: false, validateFormats: false, allErrors: true }).compile(schema);
  assert.ok(fits(value), `${format}: ${JSON.stringify(fits.errors, null, 1)}`);
}

describe("the package", { timeout: 4 * harness.PATIENCE }, () => {
  const site = mkdtempSync(join(tmpdir(), "implant-preview-site-"));
  const installed = join(site, "node_modules/implant-preview");
  let complaints; // of the compiler on consumer.ts
  let server;
  let browser;

  before(async () => {
    const npm = (...options) => execFileSync("npm", [...options, "--loglevel=error"], { cwd: site, encoding: "utf8" });
    const tarball = npm("pack", PACKAGE, "--ignore-scripts").trim().split("\n").at(-1);
    npm("install", `./${tarball}`, "--offline", "--no-audit", "--no-fund");
    cpSync(join(harness.ROOT, "examples/js/index.html"), join(site, "index.html"));
    mkdirSync(join(site, "src"));
    cpSync(join(HERE, "consumer.ts"), join(site, "src/consumer.ts"));
    complaints = tsc("--outDir", ".", "src/consumer.ts");
    // A page whose scripts name the package.
    const names = { imports: { "implant-preview": "./node_modules/implant-preview/dist/index.js" } };
    const page = `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
      <script type="importmap">${JSON.stringify(names)}</script>`;
    writeFileSync(join(site, "empty.html"), page);
    server = await harness.serve({ folder: site });
    browser = await harness.startBrowser({ webgl: false });
  });
  after(async () => {
    await browser?.close();
    await server?.close();
    rmSync(site, { recursive: true });
  });

  /** Type-checks a file of the site; returns the complaints. */
  function tsc(...more) {
    const options = ["--strict", "--target", "ES2022", "--module", "ES2022", "--moduleResolution", "bundler", ...more];
    try {
      return execFileSync(join(PACKAGE, "node_modules/.bin/tsc"), options, { cwd: site, encoding: "utf8" });
    } catch (error) {
      return error.stdout;
    }
  }

  /** An empty page of the site. */
  const open = (options) => harness.openPage(browser, `${server.address}empty.html`, options);

  test("has the version and the licence of the crate, and its files only", () => {
    const cargo = readFileSync(join(harness.ROOT, "Cargo.toml"), "utf8");
    const [, workspace] = cargo.split("[workspace.package]");
    const of = (field) => workspace.match(new RegExp(`^${field} = "(.+)"$`, "m"))[1];
    const read = JSON.parse(readFileSync(join(installed, "package.json"), "utf8"));
    assert.equal(read.version, of("version"));
    assert.equal(read.license, of("license"));
    const lock = JSON.parse(readFileSync(join(PACKAGE, "package-lock.json"), "utf8"));
    assert.equal(lock.version, read.version);
    assert.deepEqual(readdirSync(installed).sort(), ["LICENSE-APACHE", "LICENSE-MIT", "README.md", "dist", "package.json"]);
    assert.equal(read.dependencies, undefined);
  });

  test("its compressed WebAssembly is within its budget", () => {
    const file = join(installed, "dist/wasm/implant_preview_bg.wasm");
    const size = brotliSize(file);
    console.log(`# ${statSync(file).size} bytes, by brotli ${size}`);
    assert.ok(size <= BUDGET, `${size} bytes, allowed: ${BUDGET}`);
  });

  test("its types accept each function, and refuse what the program refuses", () => {
    assert.equal(complaints, "");
    // A mistake that nothing expects is an error: the check above can fail.
    writeFileSync(join(site, "src/wrong.ts"), 'import { simulate } from "implant-preview";\nsimulate({ implant: { radius: 5 } });\n');
    assert.match(tsc("--noEmit", "src/wrong.ts"), /^src\/wrong\.ts\(2,\d+\): error TS\d+: .*'radius'/);
  });

  test("each function returns what its type promises", async () => {
    const { page, finish } = await open();
    const found = await page.evaluate(async () => (await import("./consumer.js")).useAll());
    assert.equal(found.version, JSON.parse(readFileSync(join(installed, "package.json"), "utf8")).version);
    assert.equal(found.result.status, "converged");
    assert.ok(found.force > 0);
    assert.deepEqual(comparable(found.fromText), comparable(found.result));
    assert.equal(found.points.length, 3);
    assert.equal(found.map.points.length, 3);
    assert.ok(found.progress.some(([done, all]) => done === found.bands.scenes_planned && all === done));
    assert.deepEqual(found.progress.at(-1), [7, 7]);
    assert.deepEqual(found.times.times.map(({ when }) => when), ["on_the_table", "week", "six_months"]);
    assert.ok(found.later > 0 && found.later < found.times.times[0].values.force_n.value);
    assert.equal(found.forces[0], found.force);
    assert.match(found.forces[1], /^insertion is 7; allowed: /);
    assertFits("scene", found.opening);
    assertFits("result", found.result);
    assertFits("map", found.map);
    assertFits("bands", found.bands);
    assertFits("times", found.times);
    assert.deepEqual(found.schema, JSON.parse(native(["schema"])));
    await finish();
  });

  test("a body is read, fitted and lies over its implant as by the native program", async () => {
    const { ply, points, faces, marks } = trunk();
    const [mesh, marked, fitted, coarse, after] = ["body.ply", "marks.json", "scene.json", "coarse.json", "after.obj"].map((name) =>
      join(site, name),
    );
    writeFileSync(mesh, ply);
    writeFileSync(marked, JSON.stringify(marks));
    native(["scan", mesh, "--marks", marked, "--side", "left", "--out", fitted]);
    const scene = JSON.parse(readFileSync(fitted, "utf8"));
    writeFileSync(coarse, JSON.stringify({ ...scene, solver: { nodes_per_side: 33, tolerance: 1e-3 } }));
    native(["simulate", coarse, "--body", mesh, "--after", after]);
    const expected = readFileSync(after, "utf8").split("\n").filter((line) => line.startsWith("v "));
    const { page, finish } = await open();
    const found = await page.evaluate(
      async ([ply, marks]) => (await import("./consumer.js")).useBody(new TextEncoder().encode(ply), "body.ply", marks),
      [ply, marks],
    );
    assert.deepEqual([found.positions, found.triangles, found.unit], [points.flat(), faces.flat(), "mm"]);
    assert.deepEqual(differences(found.fitted.scene, scene), []);
    assert.ok(found.radius > 100 && found.radius < 200 && Array.isArray(found.fitted.quality.warnings));
    assertFits("scene", found.fitted.scene);
    assert.equal(found.status, "converged");
    assert.deepEqual(found.rest, found.positions);
    const moved = (to) => points.map((point, k) => Math.hypot(...point.map((x, axis) => to[3 * k + axis] - x)));
    const most = Math.max(...moved(found.after));
    assert.ok(most > 15 && most < 45, `${most} mm`);
    assert.ok(moved(found.after).filter((by) => by === 0).length > points.length / 2);
    const natively = expected.flatMap((line) => line.split(" ").slice(1, 4).map(Number));
    assert.equal(natively.length, found.after.length);
    const apart = Math.max(...natively.map((x, k) => Math.abs(x - found.after[k])));
    assert.ok(apart < 1e-3, `${apart} mm from the native program's`);
    const words = [
      /^Error: the file is damaged: a PLY file begins with "ply"; /,
      /^Error: positions has \d+ numbers; allowed: three of each$/,
      /^Error: triangles\[0\] is \[0, 1, 4294967295\]; allowed: vertices 0 to \d+$/,
      /^Error: triangles is empty; /,
      /^Error: positions\[0\] is \[NaN, NaN, NaN\]; allowed: numbers up to 1e7 mm$/,
      /^Error: marks: sternal_notch is missing; /,
      /^Error: side is "middle"; /,
      /^Error: cover_mm is 3; allowed: 6 to 30 mm$/,
      /^Error: the scene has no member body; /,
    ];
    found.refused.forEach((line, k) => assert.match(line, words[k]));
    await finish();
  });

  test("results, maps and bands of the native program fit their schemas", () => {
    const scene = JSON.stringify({ implant: { base_radius_mm: 45 }, solver: grid });
    const folder = join(site, "map");
    native(["map", "-", "--x=insertion=0.5:1:3", "--y=projection_mm=30:40:3", "--nodes=17", `--out-dir=${folder}`], scene);
    assertFits("map", JSON.parse(readFileSync(join(folder, "map.json"), "utf8")));
    assertFits("bands", JSON.parse(native(["bands", "-", "--samples=16", "--importance=16", "--nodes=17"], scene)));
    assertFits("times", JSON.parse(native(["times", "-"], scene)));
    const choices = { samples: 16, grid, unknowns: { projection: null, pocket_radius: { normal: { mean: 0, sd: 1 } } } };
    assertFits("bands-options", choices);
    assertFits("map-options", { x: { field: "insertion", from: 0, to: 1, count: 2 } });
    // Unstable, without a shape: most fields are null.
    const unstable = { ...JSON.parse(scene), tissue_model: "sheet", springs: "nikolaev", layers: [{ tissue: "adipose", poisson_ratio: 0.45, curve: { kind: "adipose" } }] };
    const texts = [unstable, ...["sheet", "layered"].map((tissue_model) => ({ ...JSON.parse(scene), schema: "implant-preview/scene/1", tissue_model }))];
    for (const line of nativeLines(texts.map((text) => JSON.stringify(text))).trim().split("\n")) {
      const { scene_hash, ...result } = JSON.parse(line);
      assertFits("result", result);
    }
    assert.throws(() => assertFits("result", { status: "converged" }), /must have required property/);
    assert.throws(() => assertFits("scene", { implant: { base_radius_mm: 45 }, colour: 1 }), /additional/);
  });

  test("sixty scenes have the lines of the native program, in order, the invalid ones in one line each", async () => {
    const { page, finish } = await open();
    const texts = sixtyScenes();
    const { lines, here, unordered } = await page.evaluate(async (texts) => {
      const { init, simulate, simulateMany } = await import("implant-preview");
      await init();
      const collect = async (options) => {
        const lines = [];
        // Scenes as objects and as text.
        const scenes = texts.map((text, k) => (k % 2 && k < 40 ? JSON.parse(text) : text));
        for await (const line of simulateMany(scenes, options)) lines.push(line);
        return lines;
      };
      return { lines: await collect({ workers: 3 }), here: simulate(texts[0]), unordered: await collect({ ordered: false }) };
    }, texts);
    assert.deepEqual(lines.map(({ index }) => index), [...Array(60).keys()]);
    const expected = nativeLines(texts).trim().split("\n").map((line) => JSON.parse(line));
    assert.equal(expected.length, 60);
    const invalid = [7, 13, 29, 41, 47, 59];
    lines.forEach(({ index, ...line }, k) => {
      if (invalid.includes(k)) {
        assert.deepEqual(Object.keys(line).sort(), k < 47 ? ["error", "id"] : ["error"], `scene ${k}`);
        // A line that ends too early ends in the next line of a file.
        const [error, nativeError] = [line.error, expected[k].error].map((text) => text.replace(/in line \d+/, "in line"));
        assert.equal(error, nativeError);
        assert.ok(!line.error.includes("\n"));
        if (k < 47) assert.deepEqual(line.id, expected[k].id);
      } else {
        assert.deepEqual(differences(comparable(line), comparable(expected[k])), [], `scene ${k}`);
      }
    });
    assert.deepEqual(comparable({ index: 0, id: { row: 0 }, ...here }), comparable(lines[0]));
    const sorted = unordered.toSorted((a, b) => a.index - b.index);
    assert.deepEqual(sorted.map(comparable), lines.map(comparable));
    await finish();
  });

  test("a stream ends when it is aborted, left or without a source, with its workers; a source is read ahead by eight", async () => {
    const { page, finish } = await open();
    const found = await page.evaluate(async (solver) => {
      const { init, simulateMany, terminate } = await import("implant-preview");
      await init();
      const scene = { implant: { base_radius_mm: 45 }, solver };
      const ends = [];
      let read = 0;
      function* endless() {
        try {
          for (;;) {
            read += 1;
            yield scene;
          }
        } finally {
          ends.push("source");
        }
      }
      const message = async (run) => {
        try {
          await run();
          return "no error";
        } catch (error) {
          return `${error.name}: ${error.message}`;
        }
      };
      const aborted = async (scenes, options = {}) => {
        const stop = new AbortController();
        let lines = 0;
        const end = await message(async () => {
          setTimeout(() => stop.abort(), 2000);
          for await (const line of simulateMany(scenes, { workers: 2, signal: stop.signal, ...options })) lines += line.index >= 0;
        });
        return { end, lines };
      };
      const left = await message(async () => {
        for await (const { index } of simulateMany(endless(), { workers: 2 })) if (index === 3) break;
      });
      const readAhead = read;
      const never = { [Symbol.asyncIterator]: () => ({ next: () => new Promise(() => {}) }) };
      // A solve of minutes.
      const long = { ...scene, insertion: 1, implant: { ...scene.implant, center_mm: [3, 2] }, solver: { nodes_per_side: 1025, tolerance: 1e-7 } };
      return {
        left,
        readAhead,
        forever: await aborted(endless()),
        waiting: await aborted(never),
        solving: await aborted([long, long, long]),
        terminated: await message(async () => {
          for await (const { index } of simulateMany(endless())) if (index === 3) terminate();
        }),
        before: await message(() => simulateMany([scene], { signal: AbortSignal.abort() }).next()),
        broken: await message(async () => {
          const source = (function* () {
            yield scene;
            throw new RangeError("of the source");
          })();
          for await (const line of simulateMany(source, { workers: 1 })) line;
        }),
        workers: await message(async () => simulateMany([scene], { workers: 0 }).next()),
        empty: await message(async () => simulateMany([]).next()),
        ends,
      };
    }, grid);
    assert.equal(found.left, "no error");
    // Index 3 was the fourth line; eight for each of two workers after it, and one that waits to be submitted.
    assert.ok(found.readAhead >= 4 && found.readAhead <= 4 + 16 + 1, `${found.readAhead} scenes read`);
    for (const name of ["forever", "waiting", "solving"]) assert.match(found[name].end, /^AbortError: /, name);
    assert.ok(found.forever.lines > 16, `${found.forever.lines} lines`);
    assert.deepEqual([found.waiting.lines, found.solving.lines], [0, 0]);
    assert.match(found.terminated, /^AbortError: /);
    assert.match(found.before, /^AbortError: /);
    assert.equal(found.broken, "RangeError: of the source");
    assert.equal(found.workers, "Error: workers is 0; allowed: 1 to 64");
    assert.equal(found.empty, "no error");
    assert.deepEqual(found.ends, ["source", "source", "source"]);
    for (const start = Date.now(); page.workers().length > 0; await harness.pause(50)) {
      assert.ok(Date.now() - start < 10_000, `${page.workers().length} workers are left`);
    }
    await finish();
  });

  test("a source may wait for the line of its last scene", async () => {
    const { page, finish } = await open();
    const insertions = await page.evaluate(async (solver) => {
      const { init, simulateMany } = await import("implant-preview");
      await init();
      let answer;
      let insertion = 0.5;
      async function* search() {
        for (let k = 0; k < 4; k += 1) {
          const line = new Promise((resolve) => (answer = resolve));
          yield { implant: { base_radius_mm: 45 }, insertion, solver };
          insertion += (await line).contact_force_n > 0 ? 0.125 : 1;
        }
      }
      const found = [];
      for await (const line of simulateMany(search())) {
        found.push(insertion);
        answer(line);
      }
      return found;
    }, grid);
    assert.deepEqual(insertions, [0.5, 0.625, 0.75, 0.875]);
    await finish();
  });

  test("a scene that stops its workers has one line, the others go on", async () => {
    const { page, finish } = await open();
    await page.context().route("**/job_worker.js", async (route) => {
      const response = await route.fetch();
      const trap = `new WebAssembly.Instance(new WebAssembly.Module(new Uint8Array([${TRAP}]))).exports.f()`;
      const poisoned = `const { simulate } = KINDS;
        KINDS.simulate = (job) => (job.scene.includes("${POISON}") ? ${trap} : simulate(job));`;
      await route.fulfill({ response, body: `${await response.text()}\n${poisoned}` });
    });
    const lines = await page.evaluate(
      async ([solver, poison]) => {
        const { init, simulateMany, terminate } = await import("implant-preview");
        await init();
        const scenes = [0.5, poison, 0.75, 1].map((insertion) => ({ implant: { base_radius_mm: 45 }, insertion, solver }));
        const lines = [];
        for await (const line of simulateMany(scenes)) lines.push(line.error ?? line.status);
        terminate();
        return lines;
      },
      [grid, POISON],
    );
    assert.deepEqual(lines, ["converged", "scene 1: internal error, twice: unreachable", "converged", "converged"]);
    await finish();
  });

  test("a call before init, and invalid input, throw one line", async () => {
    const { page, finish } = await open();
    const found = await page.evaluate(async () => {
      const { init, simulate, map, bands, times, openingScene } = await import("implant-preview");
      const line = async (run) => {
        try {
          return JSON.stringify(await run());
        } catch (error) {
          return `${error.name}: ${error.message}`;
        }
      };
      const before = await line(() => openingScene());
      await init();
      const scene = openingScene();
      const stop = AbortSignal.timeout(1000);
      const x = { field: "insertion", from: 0.5, to: 1, count: 400 };
      return [
        before,
        await line(() => simulate({ ...scene, insertion: 7 })),
        await line(() => simulate("{")),
        await line(() => map({ scene, x: { ...x, count: 1 } })),
        await line(() => bands({ scene, samples: 3 })),
        await line(() => map({ scene, x, all: true }, { signal: stop })),
        await line(() => bands({ scene }, { signal: AbortSignal.abort() })),
        await line(() => times({ ...scene, tissue_model: "sheet", chest: undefined })),
      ];
    });
    assert.equal(found[0], "Error: the program is not loaded; allowed: calls after `await init()`");
    assert.match(found[1], /^Error: insertion is 7; allowed: /);
    assert.match(found[2], /^Error: .*ends too early/);
    assert.match(found[3], /^Error: insertion: count is 1; allowed: 2 to 3600$/);
    assert.match(found[4], /^Error: samples is 3; allowed: /);
    assert.match(found[5], /^TimeoutError: /);
    assert.match(found[6], /^AbortError: /);
    assert.equal(found[7], "Error: times: a sheet; allowed: layered tissue");
    for (const line of found) assert.ok(!line.includes("\n"), line);
    await finish();
  });

  test("the example page solves on a change of the slider, and a sweep in workers", async () => {
    assert.ok(readFileSync(join(site, "index.html"), "utf8").trimEnd().split("\n").length <= 30);
    const { page, problems, close } = await harness.openPage(browser, server.address);
    await page.waitForFunction(() => /^80 %: \d+\.\d\d N, converged$/.test(document.querySelector("#result").textContent));
    await page.locator("#insertion").fill("100");
    await page.waitForFunction(() => /^100 %: \d+\.\d\d N, converged$/.test(document.querySelector("#result").textContent));
    await page.locator("#sweep").click();
    await page.waitForFunction(() => document.querySelector("#forces").textContent.trim().split("\n").length === 21);
    const forces = (await page.locator("#forces").textContent()).trim().split("\n");
    forces.forEach((line, k) => assert.match(line, new RegExp(`^${5 * k} %  \\d+\\.\\d\\d N$`)));
    assert.equal(forces.at(-1).split("  ")[1], (await page.locator("#result").textContent()).match(/: (.+),/)[1]);
    assert.deepEqual(problems.filter((problem) => !problem.includes("404")), []); // an icon of the site
    await close();
  });
});
