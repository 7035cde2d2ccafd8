// The page: text, arrows, trails and plots over the picture, with and without WebGPU.
import assert from "node:assert/strict";
import { open, saved } from "./browser.mjs";
import { hurry, message, picture, waitForScene, waitForSteps } from "./helpers.mjs";

// The texts over the picture, and how many lines and triangles there are.
const marks = page => page.evaluate(() => window.rockfallPage.stage.do(() => {
    const { marks } = window.rockfallPage.stage;
    const [width, height] = [marks.canvas.width, marks.canvas.height];
    const over = marks.overlay.marks(width, height);
    const plots = marks.overlay.plotMarks(width, height, marks.measure);
    const count = over.lines.length / 9;
    return { over: over.texts, plots: plots.texts, lines: count, arrows: over.triangles.length / 9, plotLines: plots.lines.length / 9 };
}));

// The share of the pixels with a colour in a part of the canvas over the picture (left, top, right, bottom from 0 to 1).
const share = (page, colour, [left, top, right, bottom]) => page.evaluate(([colour, left, top, right, bottom]) => {
    const { canvas, context } = window.rockfallPage.stage.marks;
    const [x, y] = [Math.round(left * canvas.width), Math.round(top * canvas.height)];
    const { data } = context.getImageData(x, y, Math.round(right * canvas.width) - x, Math.round(bottom * canvas.height) - y);
    let found = 0;
    for (let k = 0; k < data.length; k += 4) if (colour.every((value, channel) => data[k + channel] === value)) found += 1;
    return (4 * found) / data.length;
}, [colour, left, top, right, bottom]);

const size = (page, blob) => page.evaluate(async name => {
    const { stage } = window.rockfallPage;
    const bitmap = await createImageBitmap(name === "screenshot" ? await stage.screenshot() : stage.canvas);
    return [bitmap.width / stage.marks.canvas.width, bitmap.height / stage.marks.canvas.height];
}, blob);

export async function pageShowsMarksOnCpu(address) {
    const opened = await open(address, { gpu: false, viewport: { width: 1280, height: 700 } });
    const { browser, page, problems } = opened;
    const shown = "title=A+lesson&clock&scale&label&arrows=velocity&trails=0.5&plot=energy&plot=height%3A1,2";
    await page.goto(`${address}?scene=cradle&${shown}`);
    await waitForScene(page, "Cradle");
    assert.match(await page.getAttribute("#stage canvas", "aria-label"), /A lesson/);
    for (let k = 0; k < 20; k += 1) {
        await hurry(page, 4);
        await waitForSteps(page, 4 * (k + 1));
    }
    const all = await marks(page);
    assert.deepEqual(all.over.filter(text => /lesson|^t = |unit/.test(text)).length, 4, `${all.over}`);
    assert.ok(all.over.includes("t = 0.40 s"), `${all.over}`);
    assert.ok(all.over.includes("1") && all.plots.includes("kinetic") && all.plots.includes("time in s"), `${all.over} ${all.plots}`);
    assert.ok(all.plots.some(text => text.startsWith("height in")), `${all.plots}`);
    assert.ok(all.arrows >= 2 && all.lines > 30 && all.plotLines > 40, JSON.stringify(all));
    // Paper to the right of the picture, where only labels are white, and arrows and trails only in the picture.
    assert.ok((await share(page, [255, 255, 255, 255], [0.65, 0, 1, 1])) > 0.8);
    assert.ok((await share(page, [255, 255, 255, 255], [0, 0.3, 0.63, 1])) < 0.01);
    assert.ok((await share(page, [213, 94, 0, 255], [0, 0, 0.64, 1])) > 1e-5);
    const [part, whole] = [await size(page, "canvas"), await size(page, "screenshot")];
    assert.ok(Math.abs(part[0] - 0.64) < 0.01 && part[1] === 1, `${part}`);
    assert.deepEqual(whole, [1, 1]);
    await picture(page, "marks-cpu");

    // The controls have what the address had, and change what is shown.
    await page.click("summary:text('Text, arrows')");
    assert.equal(await page.inputValue("#mark-plot"), "energy height:1,2");
    await page.selectOption("#mark-arrows", "gravity");
    await page.uncheck("#mark-clock");
    await page.fill("#mark-plot", "hight:1");
    await page.press("#mark-plot", "Enter");
    await page.waitForFunction(() => document.querySelector("#message").textContent.includes("hight is not known"));
    await page.fill("#mark-plot", "speed:77");
    await page.press("#mark-plot", "Enter");
    await page.waitForFunction(() => document.querySelector("#message").textContent === "Plot speed:77: there is no sphere 77");
    await page.fill("#mark-plot", "");
    await page.press("#mark-plot", "Enter");
    await page.waitForFunction(() => window.rockfallPage.stage.marks.wanted.plots.length === 0);
    const fewer = await marks(page);
    assert.deepEqual([fewer.plots, fewer.over.some(text => text.startsWith("t = "))], [[], false]);
    assert.ok(fewer.over.some(text => text.endsWith("mass units/s²")), `${fewer.over}`);
    assert.deepEqual(await size(page, "canvas"), [1, 1]);

    // The address has them.
    await page.fill("#mark-plot", "momentum");
    await page.press("#mark-plot", "Enter");
    await page.click("summary:text('Share')");
    await page.click("#share");
    await page.waitForFunction(() => location.hash.startsWith("#scene="));
    const query = new URL(page.url()).searchParams;
    assert.deepEqual([query.get("title"), query.get("arrows"), query.has("clock"), query.getAll("plot")], ["A lesson", "gravity", false, ["momentum"]]);
    const shot = await saved(opened, "#screenshot");
    assert.ok(shot.bytes.length > 1000);

    // Large scenes have no arrows. A plot of another scene is reported when this one has no such body.
    await page.goto("about:blank");
    await page.goto(`${address}?grains=5001&arrows=velocity&title=Many`);
    await waitForScene(page, "Grains");
    await page.waitForFunction(() => document.querySelector("#message").textContent.startsWith("Labels, arrows and trails are shown for up to 5000"));
    assert.deepEqual((await marks(page)).over, ["Many"]);
    assert.match(await message(page), /has 5001/);
    assert.deepEqual(problems, []);
    await browser.close();
}

export async function pageShowsMarksOnGpu(address) {
    const { browser, page, problems } = await open(address, { gpu: true, viewport: { width: 700, height: 420 } });
    await page.goto(`${address}?backend=gpu&grains=30&label&arrows=force&plot=energy&clock`);
    await waitForScene(page, "Grains");
    await hurry(page, 5);
    await waitForSteps(page, 5);
    const all = await marks(page);
    assert.ok(all.arrows > 20 && all.over.includes("7") && all.plots.includes("potential"), JSON.stringify(all));
    const whole = await size(page, "screenshot");
    assert.deepEqual(whole, [1, 1]);
    await picture(page, "marks-gpu");
    assert.deepEqual(problems, []);
    await browser.close();
}
