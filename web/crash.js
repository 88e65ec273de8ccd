// The page after a crash of the app: the message, and the scene.
//
// The app passes each new scene after the first frame with it. Only a crash stores the scene, for this
// tab (sessionStorage, on this machine); the next start takes it, once. A scene with which the app
// crashes again can be saved, but is not opened again.

import { inLanguage } from "./language.js";

const KEY = "implant-preview/kept-scene/1";
// The app's key of the plan from one start to the next, in the storage of the tab and in that of the origin.
const PLAN = "implant-preview/plan/1";

const element = (id) => document.getElementById(id);

// Some browsers throw an exception on access to the storage in private windows.
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

/** Stores a scene for the next start of this tab. Returns whether the scene is stored. */
function keep(scene) {
  return tryStorage((storage) => {
    storage.setItem(KEY, scene);
    return storage.getItem(KEY) === scene;
  }) === true;
}

/** Removes the kept plan, which may be the cause: only the scene of this tab is opened again. */
function forgetPlan() {
  try {
    sessionStorage.removeItem(PLAN);
    localStorage.removeItem(PLAN);
  } catch {
    // Without a storage there is no plan.
  }
}

function save(scene) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([scene], { type: "application/json" }));
  link.download = "scene.json";
  link.click();
}

// Called by the app: with each new scene, and at its start for the scene to open.
globalThis.implantPreviewKeep = (scene) => {
  newest = scene;
};
globalThis.implantPreviewKept = () => reopened;

// Called by the loader: will the app open the opening plan, rather than a kept plan or that of a link?
globalThis.implantPreviewOpens = () => {
  if (reopened !== null || location.hash !== "") return false;
  try {
    // A tab that has started once has a plan of its own; an empty text is the opening plan.
    return !(sessionStorage.getItem(PLAN) ?? localStorage.getItem(PLAN));
  } catch {
    return true;
  }
};

function reloadMessage(scene) {
  if (scene === null) return "";
  if (scene === reopened) {
    return inLanguage(
      "The preview has stopped twice with this scene. After a reload it opens the default scene; save this scene if you need it.",
      "La vista previa se ha detenido dos veces con esta escena. Al recargar se abre la escena inicial; esta escena puede guardarse antes.",
    );
  }
  return keep(scene)
    ? inLanguage(
        "After a reload the preview opens this scene again.",
        "Al recargar, la vista previa abre de nuevo esta escena.",
      )
    : inLanguage(
        "This browser cannot keep the scene for a reload: save the scene first.",
        "Este navegador no puede conservar la escena al recargar: conviene guardarla antes.",
      );
}

// Called by the app's panic hook, and after a failed start. The first message is the cause; later ones
// are consequences.
globalThis.implantPreviewCrashed = (message) => {
  if (!element("crashed").hidden) return;
  const scene = newest ?? reopened;
  element("loading")?.remove();
  element("still")?.remove();
  element("lost").hidden = true;
  element("crashed-scene").textContent = reloadMessage(scene);
  element("crashed-text").textContent = String(message);
  // Before the first scene only the message is available, for example of a failed download.
  element("crashed-details").open = newest === null;
  element("crashed-save").hidden = scene === null;
  element("crashed-save").onclick = () => save(scene);
  element("crashed-reload").onclick = () => location.reload();
  element("crashed").hidden = false;
  forgetPlan();
  element("crashed-reload").focus();
};

/** Is the app loaded, but stuck after an exception within a frame? */
function isStuck() {
  try {
    globalThis.implantPreview?.stats();
    return false;
  } catch {
    return true;
  }
}

// Lack of memory ends in a trap without a panic. An exception of the browser within a frame leaves the
// app stuck; exceptions of other scripts are ignored.
function onError(error) {
  if (error instanceof WebAssembly.RuntimeError || isStuck()) {
    globalThis.implantPreviewCrashed(error?.message ?? error);
  }
}
addEventListener("error", (event) => onError(event.error ?? event.message));
addEventListener("unhandledrejection", (event) => onError(event.reason));

// While the graphics context is lost the canvas is blank. The app restores itself; otherwise a reload
// helps.
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
