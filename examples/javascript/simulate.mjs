// Calls `simulate` and `simulateMany` of the module built by wasm-pack; the build command is in index.html.
// Scenes and results are JSON text: docs/formats.md. `simulateMany` solves in workers: docs/javascript.md.

import init, { default_scene, simulate, simulateMany } from "./pkg/implant_preview.js";

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

const forces = document.getElementById("forces");
let study = null;

async function sweep() {
  study?.cancel();
  const scenes = [...Array(21).keys()].map((k) => ({ ...JSON.parse(default_scene()), insertion: k / 20 }));
  const lines = scenes.map(({ insertion }) => `${(100 * insertion).toFixed(0).padStart(3)} %`);
  const own = simulateMany(JSON.stringify(scenes), (index, resultJson) => {
    const { error, contact_force_n: force } = JSON.parse(resultJson);
    lines[index] += `  ${error ?? text(force, "N")}`;
    forces.textContent = lines.join("\n");
  });
  study = own;
  try {
    await own.done;
  } catch (error) {
    if (study === own) forces.textContent = error.message; // cancelled
  }
}

await init();
document.getElementById("sweep").addEventListener("click", sweep);
document.getElementById("cancel").addEventListener("click", () => study?.cancel());
insertion.addEventListener("input", solve);
solve();
