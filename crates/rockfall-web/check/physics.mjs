// The engine in a browser computes what the native CPU backend computes.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";
import { driver, open } from "./browser.mjs";

const STEPS = 200;
// The time step of a scene that has none.
const DT = 0.005;
// Differences of positions in units and of velocities in units/s, as in crates/rockfall/tests/parity/whole.rs.
const TOLERANCE = { positions: 1e-4, velocities: 2e-3 };

const timeStep = scene => Number(/^@run .*\bdt=(\S+)/m.exec(fs.readFileSync(scene, "utf8"))?.[1] ?? DT);

// Final state of a native run: positions and velocities in insertion order. On a GPU it is the one of the browser.
function native(scene, backend) {
    const folder = fs.mkdtempSync(path.join(os.tmpdir(), "rockfall-web-"));
    const out = path.join(folder, "state.csv");
    const steps = ["--steps", `${STEPS}`, "--every", `${STEPS}`, "--dt", `${timeStep(scene)}`];
    execFileSync(process.env.ROCKFALL_BIN, ["run", scene, "--backend", backend, ...steps, "--out", out], {
        env: { ...process.env, ...(backend === "gpu" ? driver() : {}) },
        stdio: ["ignore", "ignore", "pipe"],
    });
    const [head, ...states] = fs.readFileSync(out, "utf8").trim().split("\n").map(line => line.split(","));
    const rows = states.filter(row => row[head.indexOf("step")] === `${STEPS}`);
    fs.rmSync(folder, { recursive: true });
    const columns = names => rows.flatMap(row => names.map(name => Math.fround(row[head.indexOf(name)])));
    return { positions: columns(["x", "y", "z"]), velocities: columns(["vx", "vy", "vz"]) };
}

// The state after the same steps in the page.
function inPage(page, scene, backend) {
    return page.evaluate(async ([name, backend, steps, dt]) => {
        const rockfall = await import("/rockfall.js");
        await rockfall.default();
        const text = await (await fetch(`/scenes/${name}`)).text();
        const simulation = await rockfall.Simulation.create(new rockfall.Scene(text, name), backend);
        const report = await simulation.run(steps, dt);
        const state = { positions: [...await simulation.positions()], velocities: [...await simulation.velocities()] };
        const energy = await simulation.energy();
        return { ...state, backend: simulation.backend, device: simulation.device, steps: report.steps, kinetic: energy.kinetic };
    }, [path.basename(scene), backend, STEPS, timeStep(scene)]);
}

function greatestDifference(a, b) {
    assert.equal(a.length, b.length);
    return a.reduce((most, value, k) => Math.max(most, Math.abs(value - b[k])), 0);
}

export async function cpuIsBitwiseEqual(address, scenes) {
    const { browser, page, problems } = await open(address, { gpu: false });
    await page.goto(`${address}check.html`);
    assert.equal(await page.evaluate(async () => (await navigator.gpu?.requestAdapter()) ?? null), null, "WebGPU is off");
    for (const scene of fs.readdirSync(scenes).filter(name => name.endsWith(".txt"))) {
        const file = path.join(scenes, scene);
        const expected = native(file, "cpu");
        const found = await inPage(page, file, "auto");
        assert.deepEqual([found.backend, found.steps], ["cpu", STEPS]);
        assert.ok(found.kinetic > 0, `${scene} moves`);
        for (const field of ["positions", "velocities"]) {
            assert.deepEqual(found[field], expected[field], `${scene}: ${field}`);
        }
    }
    await browser.close();
    assert.deepEqual(problems, []);
}

export async function gpuIsBitwiseEqualAndAgreesWithCpu(address, scenes) {
    const { browser, page, problems } = await open(address, { gpu: true });
    await page.goto(`${address}check.html`);
    const scene = path.join(scenes, "soft-cube.txt");
    const found = await inPage(page, scene, "gpu");
    assert.deepEqual([found.backend, found.steps], ["gpu", STEPS]);
    const sameAdapter = native(scene, "gpu");
    assert.deepEqual(found.positions, sameAdapter.positions, "positions of the native run on the same adapter");
    assert.deepEqual(found.velocities, sameAdapter.velocities, "velocities of the native run on the same adapter");
    const expected = native(scene, "cpu");
    for (const [field, tolerance] of Object.entries(TOLERANCE)) {
        const difference = greatestDifference(found[field], expected[field]);
        console.log(`  greatest difference of ${field}: ${difference}`);
        assert.ok(difference < tolerance, `${field} differ by ${difference}`);
    }
    await browser.close();
    assert.deepEqual(problems, []);
}

// Browsers check WGSL more strictly than wgpu does.
export async function kernelsCompile(address) {
    const { browser, page, problems } = await open(address, { gpu: true });
    await page.goto(`${address}check.html`);
    const messages = await page.evaluate(async () => {
        const rockfall = await import("/rockfall.js");
        await rockfall.default();
        const device = await (await navigator.gpu.requestAdapter()).requestDevice();
        const found = [];
        for (const all of [false, true]) {
            const texts = rockfall.kernels(all);
            for (let k = 0; k < texts.length; k += 2) {
                const info = await device.createShaderModule({ code: texts[k + 1] }).getCompilationInfo();
                found.push(...info.messages.map(message => `${texts[k]}:${message.lineNum}: ${message.message}`));
            }
        }
        return found;
    });
    await browser.close();
    assert.deepEqual(messages, []);
    assert.deepEqual(problems, []);
}
