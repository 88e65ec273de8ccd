// The language of the page's own texts: English in the page, Spanish beside it (`data-es`, `data-es-label`). The app's texts are in
// src/app/texts/table.tsv; the app stores the user's choice under this key.

const KEY = "implant-preview/language/1";

/** The chosen language; without a choice that of the browser: Spanish or English. */
function preferred() {
  let chosen = null;
  try {
    chosen = localStorage.getItem(KEY);
  } catch {
    // Without a storage there is no choice.
  }
  const [language] = (chosen ?? navigator.language ?? "").toLowerCase().split("-");
  return language === "es" ? "es" : "en";
}

/** The text of the page's language. */
export const inLanguage = (english, spanish) => (document.documentElement.lang === "es" ? spanish : english);

// Called by the app after a choice.
globalThis.implantPreviewLanguage = (language) => {
  document.documentElement.lang = language;
  for (const element of document.querySelectorAll("[data-es]")) {
    element.dataset.en ??= element.textContent;
    element.textContent = inLanguage(element.dataset.en, element.dataset.es);
  }
  for (const element of document.querySelectorAll("[data-es-label]")) {
    element.dataset.enLabel ??= element.getAttribute("aria-label");
    element.setAttribute("aria-label", inLanguage(element.dataset.enLabel, element.dataset.esLabel));
  }
  // The field that the program adds behind its canvas for what is typed.
  const field = document.querySelector("#implant-preview-canvas + input");
  field?.setAttribute("aria-label", inLanguage("What is typed into the preview", "Lo que se escribe en la vista previa"));
};
globalThis.implantPreviewLanguage(preferred());
