// The runner of jobs: module workers of the page.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp({ webgl: false });

describe("the runner", { timeout: 2 * harness.PATIENCE }, () => {
  test("solves scenes in workers as the main thread does, and rejects a bad scene in one line", async () => {
    // The policy of this page allows workers.
    const { page, finish } = await fixture.openPage("bench.html");
    // A kind of job with a panic: the call of the hook, then a trap.
    await page.context().route("**/job_worker.mjs", async (route) => {
      const response = await route.fetch();
      const crash = "implantPreviewCrashed('a defect'); throw new WebAssembly.RuntimeError('unreachable');";
      await route.fulfill({ response, body: `${await response.text()}\nKINDS.crash = () => { ${crash} };` });
    });
    const found = await page.evaluate(async () => {
      const load = (file) => import(new URL(file, location.href));
      const [{ Runner }, { default: init, simulate, wasm }] = await Promise.all(
        ["runner.mjs", "implant-preview.mjs"].map(load),
      );
      await init({ module_or_path: wasm });
      const withoutTime = (json) => JSON.stringify(JSON.parse(json), (key, value) => (key === "time_ms" ? 0 : value));
      const scenes = [40, 55].map((base_radius_mm) =>
        JSON.stringify({ implant: { base_radius_mm }, solver: { nodes_per_side: 33 } }),
      );
      const runner = new Runner(2);
      const job = (scene, kind = "simulate") => runner.submit({ kind, scene });
      const message = ({ result }) => result.then(() => "no error", (error) => `${error.name}: ${error.message}`);
      const workers = (await Promise.all(scenes.map((scene) => job(scene).result))).map(withoutTime);
      const bad = await message(job('{"implant": {"base_radius_mm": 500}}'));
      const unknown = await message(job("{}", "magic"));
      const crashed = await message(job("{}", "crash"));
      // One running job and one waiting job; a third job takes the place of both.
      const one = new Runner(1);
      await message(one.submit({ kind: "crash" }));
      const jobs = scenes.map((scene) => one.submit({ kind: "simulate", scene }));
      jobs.forEach((cancelled) => cancelled.cancel());
      const cancelled = await Promise.all(jobs.map(message));
      const after = withoutTime(await one.submit({ kind: "simulate", scene: scenes[0] }).result);
      const last = message(job(scenes[0]));
      [runner, one].forEach((each) => each.terminate());
      const here = scenes.map((scene) => withoutTime(simulate(scene)));
      return { here, workers, bad, unknown, crashed, cancelled, after, last: await last };
    });
    assert.deepEqual(found.workers, found.here);
    assert.notEqual(found.here[0], found.here[1]);
    assert.match(found.bad, /^Error: implant\.base_radius_mm is 500; allowed: .+$/);
    assert.equal(found.unknown, "Error: kind is magic; allowed: benchmark, simulate, crash");
    assert.equal(found.crashed, "Error: a defect");
    assert.equal(found.after, found.here[0]);
    for (const text of [...found.cancelled, found.last]) assert.match(text, /^AbortError: /);
    await finish();
  });
});
