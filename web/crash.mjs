// What is left when the app has stopped: the message, and its scene.
//
// The app hands over each new scene after the frame that first showed it. Only a crash writes it down,
// for this tab alone (sessionStorage: it stays on this machine); the next start takes it, once. A
// scene that stops the app again after that is offered for saving and not opened any more.

const KEY = "implant-preview/kept-scene/1";

const element = (id) => document.getElementById(id);

// Some browsers refuse their storage in private windows, by throwing.
function tryStorage(use) {
  try {
    return use(sessionStorage);
  } catch {
    return null;
  }
}

const reopened = tryStorage((storage) => {
  const text = storage.getItem(KEY);
  storage.removeItem(KEY);
  return text;
});
let newest = null;

/** Keeps a scene for the next start of this tab. Returns whether it will be there. */
function keep(scene) {
  return tryStorage((storage) => {
    storage.setItem(KEY, scene);
    return storage.getItem(KEY) === scene;
  }) === true;
}

function save(scene) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([scene], { type: "application/json" }));
  link.download = "scene.json";
  link.click();
}

// The app calls these two: with each new scene, and at its start for the one to open.
globalThis.implantPreviewKeep = (scene) => {
  newest = scene;
};
globalThis.implantPreviewKept = () => reopened;

function fateOf(scene) {
  if (scene === null) return "";
  if (scene === reopened) {
    return "The preview has stopped twice with this scene. After a reload it opens the default scene; save this scene if you need it.";
  }
  return keep(scene)
    ? "After a reload the preview opens this scene again."
    : "This browser cannot keep the scene for a reload: save the scene first.";
}

// The app's panic hook calls this, and so does a start that failed. The first message is the
// cause: what comes after it is its consequence.
globalThis.implantPreviewCrashed = (message) => {
  if (!element("crashed").hidden) return;
  const scene = newest ?? reopened;
  element("loading")?.remove();
  element("lost").hidden = true;
  element("crashed-scene").textContent = fateOf(scene);
  element("crashed-text").textContent = String(message);
  // Where nothing was shown yet, the message is all there is: a download that failed, say.
  element("crashed-details").open = newest === null;
  element("crashed-save").hidden = scene === null;
  element("crashed-save").onclick = () => save(scene);
  element("crashed-reload").onclick = () => location.reload();
  element("crashed").hidden = false;
  element("crashed-reload").focus();
};

/** Is the app there, but stopped in the middle of something? */
function isStuck() {
  try {
    globalThis.implantPreview?.stats();
    return false;
  } catch {
    return true;
  }
}

// A lack of memory ends in a trap without a panic. An exception of the browser in the middle of a
// frame leaves the app stuck; other scripts may throw what they like.
function heard(error) {
  if (error instanceof WebAssembly.RuntimeError || isStuck()) {
    globalThis.implantPreviewCrashed(error?.message ?? error);
  }
}
addEventListener("error", (event) => heard(event.error ?? event.message));
addEventListener("unhandledrejection", (event) => heard(event.reason));

// While the graphics are gone the canvas is blank. The app comes back by itself; if it does not, a
// reload helps.
const canvas = element("implant-preview-canvas");
canvas.addEventListener("webglcontextlost", () => {
  element("lost-reload").onclick = () => {
    if (newest !== null) keep(newest);
    location.reload();
  };
  element("lost").hidden = !element("crashed").hidden;
});
canvas.addEventListener("webglcontextrestored", () => {
  element("lost").hidden = true;
});
