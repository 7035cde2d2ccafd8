// Measures steps in Chromium: node bench.mjs DIST [--software] [--portions STEPSxDEPTH,...] [--backends] [N ...].
// `scripts/web-bench` calls it.
import path from "node:path";
import { openChromium, serve } from "./browser.mjs";

const DT = 0.02;
const SAMPLES = 21;
// One more than a small scene may have.
const LONE = 1025;
// Steps per portion, portions under way.
const EMPTY = [[1, 1], [4, 1], [4, 2], [8, 2], [16, 2], [32, 2], [4, 4], [8, 4], [16, 4]];
const EMPTY_STEPS = 1600;
// Sizes of piles for the comparison of backends.
const COMPARED = [1, 16, 64, 256, 1024, 4096, 16_384];
// Time in ms after which such a measurement ends.
const LONGEST = 2000;

function read(words) {
    const [dist, ...rest] = words;
    const found = { dist, software: false, portions: [null], backends: false, counts: [] };
    for (let word = rest.shift(); word !== undefined; word = rest.shift()) {
        if (word === "--software") found.software = true;
        else if (word === "--backends") found.backends = true;
        else if (word === "--portions") found.portions = rest.shift().split(",").map(pair => pair.split("x").map(Number));
        else if (Number(word) > 0) found.counts.push(Number(word));
        else throw new Error(`unknown argument ${word}`);
    }
    if (found.counts.length === 0) found.counts = found.backends ? COMPARED : [10_000, 100_000, 1_000_000];
    return found;
}

const median = values => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

// Spheres at rest that never touch.
function lone(count) {
    const side = Math.ceil(Math.cbrt(count));
    const line = k => `S ${3 * (k % side)} ${3 * (Math.floor(k / side) % side)} ${3 * Math.floor(k / side / side)} 0 0 0 0 0 0 0 1 0.5 0\n`;
    return `${Array.from({ length: count }, (_, k) => line(k)).join("")}set gravity 0\n`;
}

// In the page: the adapter, and the times in ms of a copy of 256 bytes on an idle device until the page can read them.
const roundTrips = samples => (async () => {
    const adapter = await navigator.gpu.requestAdapter();
    const device = await adapter.requestDevice();
    const source = device.createBuffer({ size: 256, usage: GPUBufferUsage.COPY_SRC });
    const target = device.createBuffer({ size: 256, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ });
    const times = [];
    for (let k = 0; k < samples; k += 1) {
        await new Promise(done => setTimeout(done, 5));
        const start = performance.now();
        const encoder = device.createCommandEncoder();
        encoder.copyBufferToBuffer(source, 0, target, 0, 256);
        device.queue.submit([encoder.finish()]);
        await target.mapAsync(GPUMapMode.READ);
        times.push(performance.now() - start);
        target.unmap();
    }
    device.destroy();
    const { vendor, architecture, description } = adapter.info;
    return { adapter: [vendor, architecture, description].filter(Boolean).join(" "), times };
})();

// In the page: ms per step of steps that take the device no time, submitted as `Simulation::run` does: portions of `steps` steps,
// `depth` of them under way. A step has 30 dispatches of no workgroup. Also the time to record and submit a portion.
const emptySteps = ([total, steps, depth]) => (async () => {
    const device = await (await navigator.gpu.requestAdapter()).requestDevice();
    const [bindings, kernels, dispatches] = [8, 15, 30];
    const buffers = Array.from({ length: bindings }, () => device.createBuffer({ size: 256, usage: GPUBufferUsage.STORAGE | GPUBufferUsage.COPY_SRC }));
    const targets = Array.from({ length: depth }, () => device.createBuffer({ size: 256, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ }));
    const declarations = buffers.map((_, k) => `@group(0) @binding(${k}) var<storage, read_write> b${k}: array<u32>;\n`).join("");
    const body = buffers.map((_, k) => `b${k}[0] += 1u;`).join(" ");
    const pipelines = Array.from({ length: kernels }, (_, k) => {
        const code = `${declarations}@compute @workgroup_size(1) fn main() { if (b0[1] == ${k}u) { ${body} } }`;
        return device.createComputePipeline({ layout: "auto", compute: { module: device.createShaderModule({ code }) } });
    });
    const entries = buffers.map((buffer, binding) => ({ binding, resource: { buffer } }));
    const groups = pipelines.map(pipeline => device.createBindGroup({ layout: pipeline.getBindGroupLayout(0), entries }));
    const recorded = [];
    const submit = async target => {
        const start = performance.now();
        const encoder = device.createCommandEncoder();
        const pass = encoder.beginComputePass();
        for (let k = 0; k < steps * dispatches; k += 1) {
            pass.setPipeline(pipelines[k % kernels]);
            pass.setBindGroup(0, groups[k % kernels]);
            pass.dispatchWorkgroups(0);
        }
        pass.end();
        encoder.copyBufferToBuffer(buffers[0], 0, target, 0, 256);
        device.queue.submit([encoder.finish()]);
        const read = target.mapAsync(GPUMapMode.READ);
        recorded.push(performance.now() - start);
        await read;
        target.unmap();
        return target;
    };
    const run = async count => {
        const underWay = targets.slice(0, Math.min(depth, count)).map(submit);
        for (let sent = underWay.length; underWay.length > 0; ) {
            const free = await underWay.shift();
            if (sent < count) underWay.push(submit(free));
            sent += 1;
        }
    };
    await run(2 * depth);
    recorded.length = 0;
    const start = performance.now();
    await run(total / steps);
    const ms = (performance.now() - start) / total;
    device.destroy();
    return { ms, recorded: recorded.reduce((sum, value) => sum + value, 0) / total };
})();

// In the page: one portion at a time of spheres that never touch. Times in ms until the portion is submitted, and until the
// page has its status; and the number of dispatches.
const portions = ([text, dt, steps, samples]) => (async () => {
    const rockfall = await import("/rockfall.js");
    await rockfall.default();
    const simulation = await rockfall.Simulation.create(new rockfall.Scene(text, "lone"), "gpu");
    simulation.setPortions(steps, 1);
    await simulation.run(64, dt);
    const { submit } = GPUQueue.prototype;
    const { dispatchWorkgroups, dispatchWorkgroupsIndirect } = GPUComputePassEncoder.prototype;
    let [submitted, dispatches] = [0, 0];
    GPUQueue.prototype.submit = function (...values) {
        submit.apply(this, values);
        submitted = performance.now();
    };
    GPUComputePassEncoder.prototype.dispatchWorkgroups = function (...values) {
        dispatches += 1;
        dispatchWorkgroups.apply(this, values);
    };
    GPUComputePassEncoder.prototype.dispatchWorkgroupsIndirect = function (...values) {
        dispatches += 1;
        dispatchWorkgroupsIndirect.apply(this, values);
    };
    const [recorded, whole] = [[], []];
    for (let k = 0; k < samples; k += 1) {
        const start = performance.now();
        await simulation.run(steps, dt);
        recorded.push(submitted - start);
        whole.push(performance.now() - start);
    }
    Object.assign(GPUQueue.prototype, { submit });
    Object.assign(GPUComputePassEncoder.prototype, { dispatchWorkgroups, dispatchWorkgroupsIndirect });
    simulation.free();
    return { recorded, whole, dispatches: dispatches / samples / steps };
})();

// In the page: ms per step of a scene text or else of a pile, in rounds of `steps` steps.
const rounds = ([text, count, dt, steps, times, portion]) => (async () => {
    const rockfall = await import("/rockfall.js");
    await rockfall.default();
    const scene = text ? new rockfall.Scene(text, "lone") : rockfall.Scene.generate("pile", count, 1);
    const simulation = await rockfall.Simulation.create(scene, "gpu");
    if (portion) simulation.setPortions(...portion);
    await simulation.run(20, dt);
    const [found, replays] = [[], []];
    for (let k = 0; k < times; k += 1) {
        const before = simulation.report.replays;
        const start = performance.now();
        const report = await simulation.run(steps, dt);
        found.push((performance.now() - start) / steps);
        replays.push(report.replays - before);
    }
    const bits = new Uint32Array((await simulation.positions()).buffer).reduce((hash, word) => (Math.imul(hash, 31) + word) >>> 0, 7);
    simulation.free();
    return { found, replays, bits };
})();

// In the page: ms per step of a pile on one backend: in rounds of `steps` steps, in calls of one step, and in calls of four.
const onBackend = ([backend, count, dt, steps, times, longest]) => (async () => {
    const rockfall = await import("/rockfall.js");
    await rockfall.default();
    const simulation = await rockfall.Simulation.create(rockfall.Scene.generate("pile", count, 1), backend);
    await simulation.run(20, dt);
    // The clock of a page may be as coarse as 0.1 ms, so calls are measured together.
    const measure = async (calls, each) => {
        const start = performance.now();
        let done = 0;
        while (done < calls && performance.now() - start < longest) {
            await simulation.run(each, dt);
            done += 1;
        }
        return (performance.now() - start) / done / each;
    };
    const [start, found] = [performance.now(), []];
    for (let k = 0; k < times && performance.now() - start < 2 * longest; k += 1) found.push(await measure(1, steps));
    const calls = [await measure(steps, 1), await measure(steps, 4)];
    simulation.free();
    return { found, calls };
})();

// In the page itself: ms per frame of one step and one picture, on the main thread.
const frames = ([count, longest]) => window.rockfallPage.stage.do(async () => {
    const { stage, setRunning } = window.rockfallPage;
    setRunning(false);
    const measure = async () => {
        const start = performance.now();
        let done = 0;
        while (done < count && performance.now() - start < longest) {
            await stage.run(1);
            await stage.draw();
            done += 1;
        }
        return (performance.now() - start) / done;
    };
    await measure();
    return measure();
});

async function measureSteps() {
    console.log("\nsteps of 30 dispatches of no workgroup, three runs:\nportions   ms per step   of which the page records and submits");
    for (const portion of EMPTY) {
        const runs = [];
        for (let k = 0; k < 3; k += 1) runs.push(await page.evaluate(emptySteps, [EMPTY_STEPS, ...portion]));
        console.log(`${portion.join("x")}   ${ms(runs.map(run => run.ms))}   ${ms(runs.map(run => run.recorded))}`);
    }
    console.log(`\n${LONE} spheres that never touch, one portion at a time, medians in ms:`);
    console.log("steps   recorded and submitted   until the status is read   dispatches of a step");
    for (const steps of [1, 4, 8, 16, 32]) {
        const { recorded, whole, dispatches } = await page.evaluate(portions, [lone(LONE), DT, steps, SAMPLES]);
        console.log(`${steps}   ${median(recorded).toFixed(3)}   ${median(whole).toFixed(3)}   ${dispatches.toFixed(1)}`);
    }
    for (const [kind, sizes] of [["lone", [LONE]], ["pile", counts]]) {
        console.log(`\n${kind}: ms per step of ${ROUNDS} times ${STEPS} steps after the first 20; replays; hash of the final positions`);
        for (const count of sizes) {
            for (const portion of lengths) {
                const { found, replays, bits } = await page.evaluate(rounds, [kind === "lone" ? lone(count) : "", count, DT, STEPS, ROUNDS, portion]);
                console.log(`${count}   ${portion ? portion.join("x") : "default"}   ${ms(found)}   ${replays.join(" ")}   ${bits.toString(16)}`);
            }
        }
    }
}

async function compareBackends(sizes) {
    console.log(`\npile: ms per step of ${ROUNDS} times ${STEPS} steps after the first 20; in calls of one and of four steps; ms per frame of the page`);
    for (const count of sizes) {
        for (const backend of ["cpu", "gpu"]) {
            const { found, calls } = await page.evaluate(onBackend, [backend, count, DT, STEPS, ROUNDS, LONGEST]);
            await page.goto(`${address}?backend=${backend}&grains=${count}`);
            await page.waitForFunction(() => window.rockfallPage?.stage.view);
            const frame = await page.evaluate(frames, [STEPS / 4, LONGEST]);
            await page.goto(`${address}check.html`);
            console.log(`${count}   ${backend}   ${ms(found)}   ${ms(calls)}   ${ms([frame])}`);
        }
    }
}

const { dist, software, portions: lengths, backends, counts } = read(process.argv.slice(2));
// A GPU in software takes most of a second for some steps.
const [STEPS, ROUNDS] = software ? [64, 1] : [200, 5];
const { server, address } = await serve(path.resolve(dist));
const browser = await openChromium(software ? "software" : "hardware");
const page = await browser.newPage();
await page.goto(`${address}check.html`);
const ms = values => values.map(value => value.toFixed(4)).join(" ");

const idle = await page.evaluate(roundTrips, SAMPLES);
console.log(`Chromium ${browser.version()}, ${idle.adapter}`);
console.log(`copy of 256 bytes on an idle device, until the page reads it: median ${median(idle.times).toFixed(3)} ms`);
if (backends) await compareBackends(counts);
else await measureSteps();
await browser.close();
server.close();
