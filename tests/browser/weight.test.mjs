// The budget of the download.

import assert from "node:assert/strict";
import { join } from "node:path";
import { test } from "node:test";
import * as harness from "./harness.mjs";
import { brotliSize, files } from "./weigh.mjs";

/** Greatest size of the program, compressed by brotli with quality 11 [bytes]; 110 kB of it are scans: readers, marks, fit, the drawn body, its measures. */
const BUDGET = 2_036_000;

test("the compressed program is within its budget", { timeout: harness.PATIENCE }, () => {
  const programs = files(harness.DIST).filter((file) => file.endsWith(".wasm"));
  assert.equal(programs.length, 1, programs.join());
  const size = brotliSize(join(harness.DIST, programs[0]));
  assert.ok(size <= BUDGET, `${size} bytes, allowed: ${BUDGET}. What weighs what: node tests/browser/weigh.mjs`);
});
