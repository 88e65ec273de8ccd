import { serve, startBrowser, openPage } from "./harness.mjs";
const server = await serve();
const browser = await startBrowser();
const { page, problems } = await openPage(browser, server.address, {});
await page.waitForFunction(() => window.implantPreview?.stats().converged, null, { timeout: 60000 });
console.log("open", await page.evaluate(() => window.implantPreview.stats()));
for (const n of [129, 257]) for (const kind of ["insertion", "radius", "position"]) {
  const result = await page.evaluate(async ({ kind, n }) => {
    const frame = () => new Promise((r) => requestAnimationFrame(r));
    const scene = JSON.parse(window.implantPreview.scene());
    scene.solver.nodes_per_side = n;
    window.implantPreview.setScene(JSON.stringify(scene));
    while (!window.implantPreview.stats().converged) await frame();
    for (let k = 0; k < 240; k++) {
      const t = 0.5 + 0.5 * Math.sin(k * 0.05);
      if (kind === "insertion") scene.insertion = 0.5 + 0.5 * t;
      if (kind === "radius") { scene.implant.base_radius_mm = 50 + 8 * t; scene.implant.projection_mm = 50; }
      if (kind === "position") scene.implant.center_mm = [6 * t + 0.01, -4 * t];
      window.implantPreview.setScene(JSON.stringify(scene));
      await frame(); await frame();
    }
    const stats = window.implantPreview.stats();
    while (!window.implantPreview.stats().converged) await frame();
    window.implantPreview.setScene(window.implantPreview.scene());
    return stats;
  }, { kind, n });
  console.log(n, kind, JSON.stringify(result));
}
console.log(problems);
await browser.close();
await server.close();
