// Starts the app: checks the browser's features, downloads the program with progress, shows errors.
// The app removes #loading after its first frame, and #still with its first shape.

import "./crash.js";
import "./form.js";
import "./pixels.js";
import { inLanguage } from "./language.js";

// Ctrl+K (Cmd+K) opens the list of commands; some browsers would take the key for their search.
document.addEventListener("keydown", (event) => {
  const isList = event.key.toLowerCase() === "k" && (event.ctrlKey || event.metaKey);
  if (isList && !event.shiftKey && !event.altKey) event.preventDefault();
});

const element = (id) => document.getElementById(id);

// The smallest module with a SIMD instruction: (func (drop (v128.const i32x4 0 0 0 0))).
const SIMD_MODULE = new Uint8Array([
  0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 10, 23, 1, 21, 0, 253, 12, 0, 0, 0, 0,
  0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 26, 11,
]);

function missingFeature() {
  if (typeof WebAssembly !== "object") return inLanguage("WebAssembly is not supported.", "Falta WebAssembly.");
  if (!WebAssembly.validate(SIMD_MODULE)) return inLanguage("WebAssembly SIMD instructions are not supported.", "Faltan las instrucciones SIMD de WebAssembly.");
  if (!document.createElement("canvas").getContext("webgl2")) {
    return inLanguage("WebGL 2 is not supported or turned off.", "WebGL 2 falta o está desactivado.");
  }
  return null;
}

/** Shows the still picture of the opening plan, whose words are English, in the place of the app's picture, if the app will
 * open that plan in English. */
function showStill() {
  if (!element("still") || !globalThis.implantPreviewOpens() || inLanguage(false, true)) return;
  element("still").hidden = false;
  element("loading")?.classList.add("below-still");
}

function showMissing(text) {
  element("loading")?.remove();
  element("still")?.remove();
  element("missing-text").textContent = text;
  element("missing").hidden = false;
}

const megabytes = (bytes) => (bytes / 1e6).toFixed(1);

function showProgress(received, total) {
  const bar = element("loading-progress");
  if (!bar) return;
  if (total) bar.value = Math.min(received / total, 1);
  const of = total ? ` ${inLanguage("of", "de")} ${megabytes(total)}` : "";
  const words = inLanguage("Loading the preview", "Cargando la vista previa");
  element("loading-text").textContent = `${words}: ${megabytes(received)}${of} MB`;
}

// Fetches a file and counts its bytes, of which the page may know the number.
async function download(address, bytes) {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${address}: the server answered ${response.status}`);
  // The length header counts compressed bytes, but the stream is decompressed.
  const compressed = response.headers.get("Content-Encoding");
  const total = Number(bytes) || (compressed ? 0 : Number(response.headers.get("Content-Length")));
  let received = 0;
  const counter = new TransformStream({
    transform(chunk, controller) {
      received += chunk.byteLength;
      showProgress(received, total);
      controller.enqueue(chunk);
    },
  });
  return new Response(response.body.pipeThrough(counter), response);
}

/** Stores the page for use without a network, once the app has drawn: the start does not wait for that. */
async function keepOffline() {
  const isPage = window === window.top && location.protocol.startsWith("http");
  if (!isPage || !navigator.serviceWorker) return;
  while (element("loading")) await new Promise(requestAnimationFrame);
  if (!element("crashed").hidden) return;
  try {
    await navigator.serviceWorker.register(new URL("service_worker.js", document.baseURI));
  } catch {
    // Private windows may refuse. The page works without.
  }
}

/** Starts the app from the files named in the page. */
async function start() {
  const missing = missingFeature();
  if (missing) {
    showMissing(missing);
    return;
  }
  showStill();
  try {
    const { program, wasm, wasmBytes } = document.querySelector("script[data-wasm]").dataset;
    const [api, response] = await Promise.all([
      import(new URL(program, document.baseURI)),
      download(wasm, wasmBytes),
    ]);
    await api.default({ module_or_path: response });
    globalThis.implantPreviewApi = api; // The functions can be called from now on.
    const text = element("loading-text");
    if (text) text.textContent = inLanguage("Starting…", "Iniciando…");
    keepOffline();
  } catch (error) {
    globalThis.implantPreviewCrashed(error?.message ?? error);
  }
}

await start();
