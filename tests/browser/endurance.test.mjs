// A short run of endurance.mjs. Times are printed, not tested: they depend on the load of the machine.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import { VIEWPORT, endure, growth } from "./endurance.mjs";
import * as harness from "./harness.mjs";

describe("dragging controls", { timeout: 15 * harness.PATIENCE }, () => {
  const fixture = harness.setUp({ isPlain: true });

  test("on and on solves each time, takes no more memory and breaks nothing", async () => {
    const { page, finish } = await fixture.openApp({ viewport: VIEWPORT });
    const samples = await endure(page, { drags: 5 });
    const last = samples.at(-1);
    console.log("endurance:", JSON.stringify(last));
    for (let k = 1; k < samples.length; k += 1) {
      const { name, solves, work_units, converged } = samples[k];
      assert.ok(solves >= samples[k - 1].solves + 3, `${name}: too few solves`);
      assert.ok(work_units > samples[k - 1].work_units + 10, `${name}: too little work`);
      assert.equal(converged, true);
    }
    const grown = growth(samples.map((sample) => sample.wasm));
    assert.ok(grown <= 0.02, `the program's memory changed by ${100 * grown} %`);
    await finish();
  });
});
