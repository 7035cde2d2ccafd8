// Finds how many grains this device can simulate, by running steps.

import { Scene, Simulation } from "./rockfall.js";

const SIZES = [500, 2_000, 8_000, 30_000, 100_000, 300_000, 1_000_000];
// Time of a step in ms that leaves time to draw 60 pictures per second.
const BUDGET = 8;
const STEPS = 8;
export const TIME_STEP = 0.02;

export const grains = count => Scene.generate("pile", count, 1);

async function msPerStep(count, backend) {
    const scene = grains(count);
    const simulation = await Simulation.create(scene, backend);
    try {
        // The first steps compile kernels and build lists.
        await simulation.run(2 * STEPS, TIME_STEP);
        const start = performance.now();
        await simulation.run(STEPS, TIME_STEP);
        return (performance.now() - start) / STEPS;
    } finally {
        simulation.free();
        scene.free();
    }
}

// Resolves with the largest number of grains whose steps fit the budget, and the time of a step in ms.
export async function fittingGrains(backend, report) {
    let best = { count: SIZES[0], ms: 0 };
    for (const count of SIZES) {
        report(`Measuring this device with ${count.toLocaleString("en")} grains ...`);
        let ms;
        try {
            ms = await msPerStep(count, backend);
        } catch (error) {
            if (error.name === "DeviceLimitError" && count > SIZES[0]) break;
            throw error;
        }
        if (ms > BUDGET && count > SIZES[0]) break;
        best = { count, ms };
        // The next size would surely be too slow.
        if (ms > BUDGET / 2) break;
    }
    return best;
}
