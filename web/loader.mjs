// Starts the app: checks what it needs, downloads it with progress, shows what went wrong.
// The app removes #loading once its first frame is painted.

const element = (id) => document.getElementById(id);

// The smallest module with a SIMD instruction: (func (drop (v128.const i32x4 0 0 0 0))).
const SIMD_MODULE = new Uint8Array([
  0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 10, 23, 1, 21, 0, 253, 12, 0, 0, 0, 0,
  0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 26, 11,
]);

function missingFeature() {
  if (typeof WebAssembly !== "object") return "It has no WebAssembly.";
  if (!WebAssembly.validate(SIMD_MODULE)) return "Its WebAssembly has no SIMD instructions.";
  if (!document.createElement("canvas").getContext("webgl2")) {
    return "WebGL 2 is missing or switched off.";
  }
  return null;
}

function showMissing(text) {
  element("loading")?.remove();
  element("missing-text").textContent = text;
  element("missing").hidden = false;
}

// The app's panic hook calls this, and so does a start that failed. The first message is the
// cause: what comes after it is its consequence.
globalThis.implantPreviewCrashed = (message) => {
  if (!element("crashed").hidden) return;
  element("loading")?.remove();
  element("crashed-text").textContent = String(message);
  element("crashed-reload").onclick = () => location.reload();
  element("crashed").hidden = false;
  element("crashed-reload").focus();
};

const megabytes = (bytes) => (bytes / 1e6).toFixed(1);

function showProgress(received, total) {
  const bar = element("loading-progress");
  if (!bar) return;
  if (total) bar.value = Math.min(received / total, 1);
  element("loading-text").textContent =
    `Loading the preview: ${megabytes(received)}${total ? ` of ${megabytes(total)}` : ""} MB`;
}

// The response, its bytes counted as they come in.
async function download(address) {
  const response = await fetch(address);
  if (!response.ok) throw new Error(`${address}: the server answered ${response.status}`);
  // The length is that of the compressed bytes, which are not the ones that can be counted here.
  const compressed = response.headers.get("Content-Encoding");
  const total = compressed ? 0 : Number(response.headers.get("Content-Length"));
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

/** Starts the app: `init` is what wasm-bindgen made, `address` that of the wasm file. */
export async function start(init, address) {
  const missing = missingFeature();
  if (missing) {
    showMissing(missing);
    return;
  }
  try {
    const response = await download(address);
    await init({ module_or_path: response });
    const text = element("loading-text");
    if (text) text.textContent = "Starting…";
  } catch (error) {
    globalThis.implantPreviewCrashed(error?.message ?? error);
  }
}
