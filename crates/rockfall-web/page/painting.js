// A painting: the fall is computed once, every grain gets the colour of the picture at the place where it comes to rest, and the
// same fall is shown again. It ends in the picture, because the same steps give the same result.

import { Simulation } from "./rockfall.js";
import { Camera } from "./camera.js";
import { grains, TIME_STEP } from "./measure.js";

const STEPS = 900;
const PORTION = 30;
const SIDE = 512;

// Colours of the picture at an address. It fills a square with its middle part.
export async function readPicture(source) {
    const image = new Image();
    image.src = source;
    await image.decode();
    const canvas = new OffscreenCanvas(SIDE, SIDE);
    const context = canvas.getContext("2d");
    const side = Math.min(image.width, image.height);
    context.drawImage(image, (image.width - side) / 2, (image.height - side) / 2, side, side, 0, 0, SIDE, SIDE);
    return context.getImageData(0, 0, SIDE, SIDE).data;
}

// Computes the fall of `count` grains and returns what `Stage.open` takes. The picture appears in the view from above.
export async function paint(count, pixels, backend, report) {
    const scene = grains(count);
    const simulation = await Simulation.create(scene, backend);
    let positions;
    try {
        for (let step = 0; step < STEPS; step += PORTION) {
            report(`Computing where the grains come to rest: ${Math.round((100 * step) / STEPS)} %`);
            await simulation.run(PORTION, TIME_STEP);
            await new Promise(done => setTimeout(done));
        }
        positions = await simulation.positions();
    } finally {
        simulation.free();
    }
    const camera = above(positions);
    return { scene, name: "Painting", dt: TIME_STEP, camera: [...camera.eye, ...camera.target], colours: colours(positions, camera, pixels) };
}

// Range of the middle 98 % of every third number.
function range(positions, from) {
    const sorted = positions.filter((_, k) => k % 3 === from).sort();
    return [sorted[Math.floor(0.01 * sorted.length)], sorted[Math.ceil(0.99 * sorted.length) - 1]];
}

// A camera that looks down on the grains, a little from the front.
function above(positions) {
    const [x, y, z] = [0, 1, 2].map(from => range(positions, from));
    const middle = [x, y, z].map(([least, most]) => 0.5 * (least + most));
    const size = Math.max(x[1] - x[0], z[1] - z[0], 1);
    return new Camera([middle[0], middle[1] + 2.1 * size, middle[2] + 0.35 * size, ...middle]);
}

function colours(positions, camera, pixels) {
    const { project } = camera.projection(1, 1);
    const seen = new Float32Array(positions.length);
    for (let k = 0; k < positions.length; k += 3) {
        seen.set(project([positions[k], positions[k + 1], positions[k + 2]]), k);
    }
    const [left, right] = range(seen, 0);
    const [top, bottom] = range(seen, 1);
    const side = Math.max(right - left, bottom - top);
    const [middleX, middleY] = [0.5 * (left + right), 0.5 * (top + bottom)];
    const found = new Uint8Array(positions.length);
    const pixel = (value, middle) => Math.max(0, Math.min(SIDE - 1, Math.floor(((value - middle) / side + 0.5) * SIDE)));
    for (let k = 0; k < positions.length; k += 3) {
        const at = 4 * (pixel(seen[k + 1], middleY) * SIDE + pixel(seen[k], middleX));
        found.set(pixels.subarray(at, at + 3), k);
    }
    return found;
}
