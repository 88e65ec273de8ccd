// Calls `simulate` of the module built by wasm-pack; the build command is in index.html.
// Scenes and results are JSON text: docs/formats.md. For long solves use a worker: docs/javascript.md.

import init, { default_scene, simulate } from "./pkg/implant_preview.js";

const insertion = document.getElementById("insertion");
const output = document.getElementById("result");

const text = (value, unit) => (value === null ? "-" : `${value.toFixed(2)} ${unit}`);

function solve() {
  const scene = JSON.parse(default_scene());
  scene.insertion = Number(insertion.value) / 100;
  try {
    const result = JSON.parse(simulate(JSON.stringify(scene)));
    output.textContent = [
      `insertion        ${insertion.value} %`,
      `status           ${result.status}`,
      `contact force    ${text(result.contact_force_n, "N")}`,
      `skin projection  ${text(result.skin_projection_mm, "mm")}`,
      `area gain        ${text(result.area_gain_cm2, "cm²")}`,
      `solved in        ${text(result.solver.time_ms, "ms")}`,
      ...result.warnings,
    ].join("\n");
  } catch (error) {
    output.textContent = `Invalid scene: ${error.message}`; // one line: field, value, allowed values
  }
}

await init();
insertion.addEventListener("input", solve);
solve();
