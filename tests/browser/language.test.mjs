// The language of the built page: that of the browser, or the one chosen in the menu.

import assert from "node:assert/strict";
import { describe, test } from "node:test";
import * as harness from "./harness.mjs";

const fixture = harness.setUp({ isPlain: true });

describe("the language of the page", { timeout: 10 * harness.PATIENCE }, () => {
  test("is Spanish in a Spanish browser, and a choice is kept over a reload", async () => {
    const { page, finish } = await fixture.openApp({ viewport: { width: 1000, height: 700 }, options: { locale: "es-ES" } });
    const language = () => page.evaluate(() => document.documentElement.lang);
    assert.equal(await language(), "es");
    const field = page.locator("#implant-preview-canvas + input");
    assert.equal(await field.getAttribute("aria-label"), "Lo que se escribe en la vista previa");
    assert.match(
      await harness.summary(page, "Al día."),
      /^Plan: implante de 300 ml, 12 cm de anchura\. Estiramiento de la piel \d+ por ciento, como la práctica\. .* Al día\./,
    );
    const form = page.getByRole("form", { name: "Plan" });
    assert.deepEqual(await form.locator("label").allTextContents(), [
      "Implante",
      "Relleno",
      "Anchura (cm)",
      "Volumen (ml)",
      "Proyección (cm)",
      "Plenitud",
      "Pellizco (cm)",
      "Tipo de piel",
      "Piel en reposo",
      "Tórax",
      "Margen (cm)",
      "Plano del bolsillo",
      "Surco más bajo (cm)",
      "Hacia el lado (cm)",
      "Hacia arriba (cm)",
      "Insertado (%)",
      "Líquido en el bolsillo",
      "Tiempo tras la operación",
      "Postura",
      "N.º paciente",
      "Lado",
      "Fecha de la visita",
      "Cirujano",
      "Observaciones",
    ]);
    const skin = form.getByLabel("Tipo de piel", { exact: true });
    await skin.selectOption({ label: "flácida" });
    assert.equal((await harness.scene(page)).patient.skin_class, "very_lax");
    await form.getByLabel("Pellizco (cm)", { exact: true }).fill("1e308");
    await page.keyboard.press("Enter");
    assert.equal(await page.locator("#plan-pinch_cm-error").textContent(), "Pellizco: como máximo 12 cm");
    assert.equal(await page.locator("#implant-preview-skip").textContent(), "Ir al resultado en palabras y al plan como formulario");
    await harness.screenshot(page, "spanish");

    for (const name of ["Ver", "English"]) {
      await harness.control(page, name);
      await page.keyboard.press("Enter");
      await harness.drawn(page);
    }
    await page.waitForFunction(() => document.documentElement.lang === "en");
    await form.getByLabel("Skin feels", { exact: true }).waitFor({ state: "attached" });
    await page.reload();
    await harness.summary(page, "12 cm wide");
    assert.equal(await language(), "en");
    await finish();
  });
});
