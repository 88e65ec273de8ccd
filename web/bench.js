// The benchmark's page: starts and stops the study and shows its progress.
// Query of the address, all parts optional:
// ?nodes_per_side=17,33&cases=default&methods=newton,multigrid_1.

import { Runner } from "./runner.js";

const element = (id) => document.getElementById(id);

// In order of speed, the fastest first.
const METHODS = {
  multigrid_1: "full multigrid, 1 cycle",
  multigrid_2: "full multigrid, 2 cycles",
  multigrid_4: "full multigrid, 4 cycles",
  multigrid_8: "full multigrid, 8 cycles",
  newton: "Newton, nested",
  automatic: "automatic (layered tissue)",
};

// One worker: the study measures one thread.
const runner = new Runner({ program: new URL("implant-preview.mjs", import.meta.url), workers: 1 });
let isRunning = false;
let startedAt = 0;
let clockStep = 0;
let progress = null;
let csv = "";
// Chart and times by the name of the scene, and the displayed scene.
const measured = new Map();
let shown = null;

/** The options of the API in the address, or null. */
function optionsInAddress() {
  const query = new URLSearchParams(location.search);
  const options = {};
  for (const name of ["cases", "methods", "nodes_per_side"]) {
    const list = query.get(name)?.split(",");
    if (!list) continue;
    // The API rejects values that are not numbers.
    const number = (text) => (/^\d+$/.test(text) ? Number(text) : text);
    options[name] = name === "nodes_per_side" ? list.map(number) : list;
  }
  return Object.keys(options).length ? { quick: true, ...options } : null;
}

function makeElement(tag, text, attributes = {}) {
  const created = document.createElement(tag);
  created.textContent = text;
  for (const [name, value] of Object.entries(attributes)) created.setAttribute(name, value);
  return created;
}

function timeText(ms) {
  if (ms === undefined) return "";
  if (ms === null) return "–";
  if (ms < clockStep) return `< ${timeText(clockStep)}`;
  const digits = (value) => value.toFixed(value < 9.95 ? 1 : 0);
  return ms < 999.5 ? `${digits(ms)} ms` : `${digits(ms / 1000)} s`;
}

function showTimes(times) {
  const grids = [...new Set(times.map((time) => time.nodes_per_side))];
  const head = document.createElement("tr");
  head.append(makeElement("th", "nodes per side", { scope: "col" }));
  head.append(...grids.map((grid) => makeElement("th", grid, { scope: "col" })));
  element("grids").replaceChildren(head);
  const known = Object.keys(METHODS).filter((name) => times.some((time) => time.method === name));
  const rows = known.map((name) => {
    const row = document.createElement("tr");
    row.append(makeElement("th", METHODS[name], { scope: "row" }));
    for (const grid of grids) {
      const of = ({ method, nodes_per_side }) => method === name && nodes_per_side === grid;
      row.append(makeElement("td", timeText(times.find(of)?.time_ms)));
    }
    return row;
  });
  element("times").replaceChildren(...rows);
}

function showScene(name) {
  shown = name;
  const { svg, times } = measured.get(name);
  const picture = new DOMParser().parseFromString(svg, "image/svg+xml").documentElement;
  picture.setAttribute("role", "img");
  picture.setAttribute("aria-label", `Run time against error, scene ${name}; the table below lists the times`);
  element("picture").replaceChildren(document.adoptNode(picture));
  showTimes(times);
  element("scene").value = name;
  element("results").hidden = false;
}

function showProgress() {
  const { done, all, next } = progress;
  element("progress").max = all;
  element("progress").value = done;
  element("now").textContent = next
    ? `${done + 1} of ${all}: ${METHODS[next.method]}; ${next.nodes_per_side} nodes per side; scene ${next.scene}`
    : "";
}

function showPiece({ scene, svg, times, csv: table }) {
  csv = table;
  if (!measured.has(scene)) {
    element("scene").append(makeElement("option", scene));
    element("scenes").hidden = measured.size === 0;
  }
  measured.set(scene, { svg, times });
  if (shown === null || shown === scene) showScene(scene);
}

/** Terminates the worker, if there is one, and shows the final state of the study. */
function end(text) {
  isRunning = false;
  runner.terminate();
  element("choices").disabled = false;
  element("run").textContent = "Start";
  element("running").hidden = true;
  element("state").textContent = text;
}

function fail(message) {
  end("");
  element("error").textContent = `The benchmark stopped: ${message}`;
  element("error").hidden = false;
}

function onPiece(data) {
  if (data.progress) {
    progress = data.progress;
    showProgress();
  }
  switch (data.type) {
    case "warming":
      element("state").textContent = "Warming up: browsers optimise code that has run for some time…";
      break;
    case "begun":
      clockStep = data.clockStep;
      element("clock").textContent = `; clock resolution ${Number(clockStep.toPrecision(2))} ms`;
      element("state").textContent = "Measuring. Other programs on this machine make the times longer.";
      break;
    case "piece":
      showPiece(data);
      break;
  }
}

function start() {
  const size = new FormData(element("form")).get("size");
  const options = size === "chosen" ? optionsInAddress() : { quick: size === "quick" };
  measured.clear();
  shown = null;
  progress = null;
  element("scene").replaceChildren();
  for (const id of ["scenes", "results", "error"]) element(id).hidden = true;
  element("choices").disabled = true;
  element("run").textContent = "Stop";
  element("running").hidden = false;
  element("progress").removeAttribute("value");
  element("now").textContent = "";
  element("state").textContent = "Loading…";
  startedAt = performance.now();
  isRunning = true;
  runner.submit({ kind: "benchmark", options: JSON.stringify(options) }, { onPiece }).result.then(
    () => end(`Done in ${timeText(performance.now() - startedAt)}.`),
    (error) => {
      if (error.name !== "AbortError") fail(error.message);
    },
  );
}

function save(text, type, name) {
  // The address is not revoked: some browsers read the data only after the click.
  const address = URL.createObjectURL(new Blob([text], { type }));
  makeElement("a", "", { href: address, download: name }).click();
}

element("form").onsubmit = (event) => {
  event.preventDefault();
  if (!isRunning) return start();
  const done = progress ? `${progress.done} of ${progress.all}` : "none";
  end(`Stopped. Measured: ${done}.`);
};
element("scene").onchange = (event) => showScene(event.target.value);
element("save-table").onclick = () => save(csv, "text/csv", "work_precision.csv");
element("save-picture").onclick = () =>
  save(measured.get(shown).svg, "image/svg+xml", `work_precision_${shown}.svg`);
element("browser").textContent = navigator.userAgent;

const chosen = optionsInAddress();
if (chosen) {
  const { quick, ...lists } = chosen;
  element("chosen-text").textContent = Object.entries(lists)
    .map(([name, list]) => `${name.replaceAll("_", " ")} ${list.join(", ")}`)
    .join("; ");
  element("chosen").hidden = false;
  element("chosen").querySelector("input").checked = true;
}
