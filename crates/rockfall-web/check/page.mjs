// The page: run, drag, throw, errors, sharing, painting, with and without WebGPU.
import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { kind, open, saved } from "./browser.mjs";
import { colours, hurry, message, picture, pictures, pixel, sphereCount, waitForScene, waitForSteps } from "./helpers.mjs";

const STEPS = 200;
// Where a sphere is on the screen, and where it is in the scene.
const sphereOnScreen = (page, sphere) => page.evaluate(sphere => {
    const { stage } = window.rockfallPage;
    return stage.do(async () => {
        const place = [...(await stage.simulation.positions()).slice(3 * sphere, 3 * sphere + 3)];
        const box = stage.canvas.getBoundingClientRect();
        const [x, y] = stage.camera.projection(box.width, box.height).project(place);
        return { place, x: box.left + x, y: box.top + y };
    });
}, sphere);

// The sphere that is nearest to the camera, so that no other hides it.
const nearestSphere = page => page.evaluate(() => {
    const { stage } = window.rockfallPage;
    return stage.do(async () => {
        const at = await stage.simulation.positions();
        const far = k => Math.hypot(...stage.camera.eye.map((value, axis) => value - at[3 * k + axis]));
        return [...Array(at.length / 3).keys()].reduce((best, k) => (far(k) < far(best) ? k : best));
    });
});

// Pulls a sphere upwards with the mouse.
async function drag(page, sphere) {
    const before = await sphereOnScreen(page, sphere);
    await page.mouse.move(before.x, before.y);
    await page.mouse.down();
    await page.waitForFunction(() => window.rockfallPage.stage.held);
    for (let k = 1; k <= 10; k += 1) await page.mouse.move(before.x, before.y - 10 * k);
    await hurry(page, 100);
    const after = await sphereOnScreen(page, sphere);
    await page.mouse.up();
    await page.waitForFunction(() => !window.rockfallPage.stage.held);
    return [before, after];
}

const drop = (page, name, text) => page.evaluate(([name, text]) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([text], name, { type: "text/plain" }));
    document.dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
}, [name, text]);

const isPng = bytes => bytes.subarray(1, 4).toString() === "PNG";

// Records some frames. Debian's WebKit promises MP4, but records nothing.
async function recording(opened) {
    await opened.page.click("#record");
    await opened.page.waitForTimeout(1500);
    if (kind === "webkit") {
        await opened.page.click("#record");
        await opened.page.waitForFunction(() => document.querySelector("#message").textContent.startsWith("The browser recorded nothing"));
        return;
    }
    const { name, bytes } = await saved(opened, "#record");
    fs.writeFileSync(path.join(pictures, name), bytes);
    assert.deepEqual([name, bytes.readUInt32BE(0)], ["rockfall.webm", 0x1a45dfa3]);
}

export async function pageRunsOnCpu(address) {
    // Other browsers have no permission to read the clipboard.
    const permissions = kind === "chromium" ? { permissions: ["clipboard-read", "clipboard-write"] } : {};
    const opened = await open(address, { gpu: false, ...permissions });
    const { browser, page, problems } = opened;
    await page.goto(address);
    // The first scene is chosen by measuring, and runs.
    await waitForSteps(page, STEPS);
    assert.match(await page.textContent("#device"), /on CPU, 1 thread: no hardware GPU was found. WebGPU would be faster/);
    assert.ok((await colours(page)) > 1000, "bodies are drawn");
    await picture(page, "cpu-grains");

    await page.selectOption("#gallery", { label: "Soft cube" });
    await waitForScene(page, "Soft cube");
    await page.click("#play");
    if ((await page.textContent("#play")) === "Start") await page.click("#play");
    const [before, after] = await drag(page, 124);
    assert.ok(after.place[1] > before.place[1] + 0.3, `the pulled sphere rises from ${before.place} to ${after.place}`);
    const spheres = await sphereCount(page);
    await page.click("#throw");
    assert.equal(await sphereCount(page), spheres + 1);
    await picture(page, "cpu-dragged");

    // A motor of a joint, which starts with 3 rad/s.
    assert.ok(await page.isHidden("#joints-part"));
    await page.selectOption("#gallery", { label: "Linkage" });
    await waitForScene(page, "Linkage");
    await page.click("summary:text('Joints')");
    await page.evaluate(() => {
        const slider = Object.assign(document.querySelector("#joint-0"), { value: -6 });
        slider.dispatchEvent(new Event("input"));
    });
    const speed = () => page.evaluate(() => window.rockfallPage.stage.simulation.jointControls()[0].value);
    await page.waitForFunction(() => document.querySelector("#joints output").value === "-6");
    assert.equal(await speed(), -6);
    await waitForSteps(page, STEPS);
    await picture(page, "cpu-linkage");
    await page.click("#reset");
    await page.waitForFunction(() => document.querySelector("#joints output").value === "3");
    await page.selectOption("#gallery", { label: "Soft cube" });
    await waitForScene(page, "Soft cube");

    await drop(page, "bad.txt", "S 1 0 1 0 0 0 0 0 0 0 1 0.5 0\nS 2 0 3 0 0 0 0 0 0 0 -1 0.5 0\n");
    await page.waitForFunction(() => document.querySelector("#message").textContent.includes("bad.txt"));
    assert.match(await message(page), /^bad.txt:2: .*mass/s);
    assert.equal(await page.textContent("#numbers .wrong"), "2");
    assert.equal(await page.evaluate(() => window.rockfallPage.stage.name), "Soft cube", "the scene before stays open");
    await picture(page, "cpu-bad-file");

    await drop(page, "doubtful.txt", "S 1 0 1 0 0 0 0 0 0 0 1 0.5 0\nset gravty 3\n");
    await page.waitForFunction(() => document.querySelector("#message").textContent.startsWith("Warning: line 2"));

    const text = "S 1 0 3 0 0 0 0 0 0 0 1 0.5 0\nB -5 -1 -5 10 0 0 0 1 0 0 0 10\nset gravity 2\n";
    await page.fill("#text", text);
    await page.click("#apply");
    await waitForScene(page, "scene text");
    // The floor reaches behind the camera.
    await page.evaluate(() => Object.assign(window.rockfallPage.stage.camera, { eye: [1, 1.5, 3], target: [0, 1, 0] }));
    const [red, , blue] = await pixel(page, 0.5, 0.95);
    assert.ok(red > blue, `the floor is drawn, unlike the background: ${red} ${blue}`);
    await page.click("summary:text('Share')");
    await page.click("#share");
    await page.waitForFunction(() => location.hash.startsWith("#scene="));
    await page.waitForFunction(() => document.querySelector("#message").textContent.startsWith("The address of this"));
    const here = await page.evaluate(() => location.href);
    const shared = kind === "chromium" ? await page.evaluate(() => navigator.clipboard.readText()) : here;
    assert.equal(shared, here);
    const shot = await saved(opened, "#screenshot");
    assert.deepEqual([shot.name, isPng(shot.bytes)], ["rockfall.png", true]);
    await recording(opened);
    assert.deepEqual(problems, []);
    await page.goto("about:blank");
    await page.goto(shared);
    await waitForScene(page, "shared scene");
    assert.equal(await page.inputValue("#text"), text);
    assert.equal(await page.evaluate(() => window.rockfallPage.stage.simulation.setting("gravity")), "2");
    await page.goto("about:blank");
    await page.goto(`${shared.slice(0, -9)}`);
    await page.waitForFunction(() => document.querySelector("#message").textContent.includes("damaged"));
    // A short address can hold a long text.
    const long = await page.evaluate(async () => (await import(new URL("share.js", location.href).href)).toFragment(" ".repeat(17e6)));
    await page.goto("about:blank");
    await page.goto(`${address}${long}`);
    await page.waitForFunction(() => document.querySelector("#message").textContent.includes("at most 16 MB"));

    // With keys only.
    await page.goto("about:blank");
    await page.goto(`${address}?scene=cradle`);
    await waitForScene(page, "Cradle");
    await page.focus("#stage canvas");
    const eye = await page.evaluate(() => window.rockfallPage.stage.camera.eye[0]);
    await page.keyboard.press("ArrowLeft");
    assert.notEqual(await page.evaluate(() => window.rockfallPage.stage.camera.eye[0]), eye);
    await page.keyboard.press(".");
    await waitForSteps(page, 1);
    await page.keyboard.press(" ");
    await waitForSteps(page, 20);
    await page.keyboard.press("r");
    await page.waitForFunction(() => window.rockfallPage.stage.steps < 20);
    assert.deepEqual(problems, []);

    // The browser notes the refusal on its console.
    const isStrict = await page.evaluate(() => {
        const script = document.createElement("script");
        script.textContent = "window.wasRun = true";
        document.head.append(script);
        return window.wasRun === undefined;
    });
    assert.ok(isStrict, "the page runs only scripts of its own files");
    await browser.close();
}

export async function pagePaintsOnCpu(address) {
    const { browser, page, problems } = await open(address, { gpu: false, colorScheme: "dark" });
    await page.goto(`${address}?grains=1500`);
    await waitForScene(page, "Grains");
    assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), "dark", "the theme of the system");
    await page.click("summary:text('Painting')");
    await page.click("#paint");
    await waitForScene(page, "Painting");
    await waitForSteps(page, 5);
    await picture(page, "painting-begins");
    // The second fall ends where the first one ended, so every grain has the colour of its place in the picture.
    const fall = () => page.evaluate(async () => {
        const { stage, setRunning } = window.rockfallPage;
        setRunning(false);
        return stage.do(async () => {
            await stage.simulation.run(900 - stage.simulation.report.steps, stage.dt);
            return [...await stage.simulation.positions()];
        });
    });
    const first = await fall();
    await page.waitForTimeout(300);
    await picture(page, "painting-ends");
    await page.click("#reset");
    await page.waitForFunction(() => window.rockfallPage.stage.steps === 0);
    assert.deepEqual(await fall(), first);
    assert.ok((await page.evaluate(() => new Set(window.rockfallPage.stage.colours).size)) > 20, "the picture has colours");
    assert.deepEqual(problems, []);
    await browser.close();
}

export async function pageRunsOnGpu(address) {
    const { browser, page, problems } = await open(address, { gpu: true, viewport: { width: 760, height: 480 } });
    // Springs would be drawn as coils of many triangles.
    await page.goto(`${address}?backend=gpu&grains=150`);
    await waitForScene(page, "Grains");
    await waitForSteps(page, 3);
    await hurry(page, STEPS);
    await waitForSteps(page, STEPS);
    assert.match(await page.textContent("#device"), /webgpu/);
    assert.ok((await colours(page)) > 1000, "bodies are drawn");
    await picture(page, "gpu-grains");
    const [before, after] = await drag(page, await nearestSphere(page));
    assert.ok(after.place[1] > before.place[1] + 0.3, `the pulled sphere rises from ${before.place} to ${after.place}`);
    await page.check("#dark");
    await picture(page, "gpu-dark");
    assert.deepEqual(problems, []);
    await browser.close();
}

// The CPU for few bodies, the GPU for more. WebGPU draws both. The GPU in software passes for hardware.
export async function autoChoosesTheBackend(address) {
    const { browser, page, problems } = await open(address, { gpu: true, viewport: { width: 400, height: 300 } });
    await page.addInitScript(() => {
        for (const type of [window.GPUAdapterInfo, window.GPUAdapter]) {
            if (type) Object.defineProperty(type.prototype, "isFallbackAdapter", { get: () => false });
        }
    });
    const few = 128;
    for (const [count, backend, text] of [
        [few, "cpu", /on CPU, 1 thread: it is faster than a GPU for up to 128 spheres and rods\.$/],
        [few + 1, "gpu", /webgpu.*\.$/],
    ]) {
        await page.goto(`${address}?grains=${count}`);
        await waitForScene(page, "Grains");
        await waitForSteps(page, 2);
        const found = await page.evaluate(() => {
            const { stage } = window.rockfallPage;
            return stage.do(() => [stage.simulation.spheres, stage.simulation.backend, stage.view.constructor.name]);
        });
        assert.deepEqual(found, [count, backend, "View"]);
        assert.match(await page.textContent("#device"), text);
        assert.ok((await colours(page)) > 100, "bodies are drawn");
        await picture(page, `auto-${backend}`);
    }
    assert.deepEqual(problems, []);
    await browser.close();
}

// Chromium that reports lower limits than the adapter has.
async function withLimits(address, limits, query) {
    const { browser, page } = await open(address, { gpu: true });
    await page.addInitScript(limits => {
        for (const [name, value] of Object.entries(limits)) {
            Object.defineProperty(GPUSupportedLimits.prototype, name, { get: () => value });
        }
    }, limits);
    await page.goto(address + query);
    await page.waitForFunction(() => document.querySelector("#message").classList.contains("wrong"));
    const text = await message(page);
    await browser.close();
    return text;
}

export async function limitsAreNamed(address) {
    const few = await withLimits(address, { maxStorageBuffersPerShaderStage: 4 }, "?backend=gpu&scene=soft-cube");
    assert.match(few, /max_storage_buffers_per_shader_stage is 4, rockfall needs 8/);
    const size = 1 << 20;
    // With more bindings, larger arrays would be split.
    const limits = { maxStorageBufferBindingSize: size, maxBufferSize: size, maxStorageBuffersPerShaderStage: 8 };
    const small = await withLimits(address, limits, "?backend=gpu&grains=30000");
    assert.match(small, /the scene does not fit: .* would take \d+ bytes, the limit is \d+/);
}

export async function pageWorksByTouch(address) {
    const { browser, page, problems } = await open(address, { gpu: false, viewport: { width: 390, height: 800 }, hasTouch: true, isMobile: true });
    await page.goto(`${address}?scene=cradle`);
    await waitForScene(page, "Cradle");
    const distance = () => page.evaluate(() => window.rockfallPage.stage.camera.distance);
    const eye = () => page.evaluate(() => window.rockfallPage.stage.camera.eye);
    const session = await page.context().newCDPSession(page);
    const touch = (type, ...points) => session.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([x, y], id) => ({ x, y, id })) });
    // One finger beside the bodies turns the camera.
    const before = [await eye(), await distance()];
    await touch("touchStart", [30, 60]);
    await page.waitForTimeout(200);
    await touch("touchMove", [90, 60]);
    await touch("touchEnd");
    assert.notDeepEqual(await eye(), before[0]);
    assert.ok(Math.abs((await distance()) - before[1]) < 1e-3 * before[1]);
    // Two fingers that move apart zoom in.
    await touch("touchStart", [150, 200], [240, 200]);
    await touch("touchMove", [110, 200], [280, 200]);
    await touch("touchEnd");
    assert.ok((await distance()) < 0.7 * before[1], `the camera is at ${await distance()}, before at ${before[1]}`);
    await page.tap("#play");
    await waitForSteps(page, 20);
    const width = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(width <= 390, `the page is ${width} pixels wide`);
    await picture(page, "cpu-phone");
    assert.deepEqual(problems, []);
    await browser.close();
}
