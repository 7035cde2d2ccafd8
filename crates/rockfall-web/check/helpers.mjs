// What the tests of the page share.
import fs from "node:fs";
import path from "node:path";
import { kind } from "./browser.mjs";

// Pictures for a person to look at.
export const pictures = path.join(process.env.WEB_TEST_MODULES, "pictures", process.env.WEB_TEST_SCREEN ? `${kind}-screen` : kind);

export const waitForSteps = (page, steps) => page.waitForFunction(least => window.rockfallPage?.stage.steps >= least, steps);
export const sphereCount = page => page.evaluate(() => window.rockfallPage.stage.do(() => window.rockfallPage.stage.simulation.spheres));
export const waitForScene = (page, name) => page.waitForFunction(wanted => window.rockfallPage?.stage.name === wanted, name);
export const message = page => page.textContent("#message");

export async function picture(page, name) {
    fs.mkdirSync(pictures, { recursive: true });
    await page.screenshot({ path: path.join(pictures, `${name}.png`) });
}

// Number of different colours on the canvas.
export const colours = page => page.evaluate(async () => {
    const bitmap = await createImageBitmap(await window.rockfallPage.stage.screenshot());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    return new Set(new Uint32Array(context.getImageData(0, 0, bitmap.width, bitmap.height).data.buffer)).size;
});

// Red, green and blue of a point of the canvas; `x` and `y` are parts of its width and height.
export const pixel = (page, x, y) => page.evaluate(async ([x, y]) => {
    const bitmap = await createImageBitmap(await window.rockfallPage.stage.screenshot());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    return [...context.getImageData(Math.floor(x * bitmap.width), Math.floor(y * bitmap.height), 1, 1).data.subarray(0, 3)];
}, [x, y]);

// Makes steps without pictures: drawing a picture takes a GPU in software a second.
export const hurry = (page, steps) => page.evaluate(steps => window.rockfallPage.stage.act(() => window.rockfallPage.stage.run(steps)), steps);
