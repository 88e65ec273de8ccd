// Runs around the download of the app: checks what it needs, shows progress, shows a crash.

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

// The app's panic hook calls this; so does a failed start.
globalThis.implantPreviewCrashed = (message) => {
  element("loading")?.remove();
  element("crashed-text").textContent = String(message);
  element("crashed").hidden = false;
  element("crashed-reload").onclick = () => location.reload();
  element("crashed-reload").focus();
};

export default function initializer() {
  return {
    onStart: () => {
      const missing = missingFeature();
      if (missing) {
        showMissing(missing);
        throw new Error(missing);
      }
    },
    onProgress: ({ current, total }) => {
      const bar = element("loading-progress");
      if (!bar) return;
      const megabytes = (bytes) => (bytes / 1e6).toFixed(1);
      // A compressed download has no known total.
      if (total && current <= total) {
        bar.value = current / total;
        element("loading-text").textContent =
          `Loading the preview: ${megabytes(current)} of ${megabytes(total)} MB`;
      } else {
        bar.removeAttribute("value");
        element("loading-text").textContent = `Loading the preview: ${megabytes(current)} MB`;
      }
    },
    onComplete: () => {
      const text = element("loading-text");
      if (text) text.textContent = "Starting…";
    },
    onSuccess: () => {},
    onFailure: (error) => globalThis.implantPreviewCrashed(error?.message ?? error),
  };
}
