// Draws a simulation with a 2D context, where there is no WebGPU to draw with.

import { add, cross, dot, length, unit } from "./camera.js";

// Colours of docs/drawing.md: spheres, fixed spheres, rods, springs, static objects.
const COLOURS = { sphere: [63, 148, 201], fixed: [109, 117, 126], rod: [226, 154, 28], spring: [208, 106, 44], fixture: [211, 207, 198] };
const LIGHT = unit([-0.45, 0.8, 0.4]);
const FACES = [[0, 1, 2], [0, 2, 3], [0, 3, 1]];

const css = ([r, g, b], shade = 1) => `rgb(${Math.round(r * shade)} ${Math.round(g * shade)} ${Math.round(b * shade)})`;

export class FlatView {
    constructor(canvas, simulation) {
        this.context = canvas.getContext("2d");
        this.canvas = canvas;
        this.dark = false;
        this.colours = null;
        this.readShapes(simulation);
    }

    // Shapes that do not move, and the connections of spheres.
    readShapes(simulation) {
        const rows = (array, size) => Array.from({ length: array.length / size }, (_, k) => [...array.subarray(k * size, (k + 1) * size)]);
        this.count = simulation.spheres;
        this.radii = simulation.radii();
        this.fixed = simulation.fixed();
        this.rods = rows(simulation.rods(), 2);
        this.rodRadii = simulation.rodRadii();
        this.springs = rows(simulation.springs(), 2);
        const parts = row => Array.from({ length: row.length / 3 }, (_, k) => row.slice(3 * k, 3 * k + 3));
        const boxes = rows(simulation.boxes(), 12).flatMap(row => this.facesOf(parts(row)));
        const polygons = rows(simulation.polygons(), 12).map(row => this.polygon(parts(row)));
        this.faces = [...boxes, ...polygons];
    }

    face(corner, left, right) {
        const opposite = add(add(corner, left), right);
        return { corners: [corner, add(corner, left), opposite, add(corner, right)], normal: unit(cross(left, right)), solid: false };
    }

    polygon(corners) {
        const [left, right] = [1, 3].map(k => add(corners[k], corners[0], -1));
        return { corners, normal: unit(cross(left, right)), solid: false };
    }

    // The six faces of a box: outward normals.
    facesOf([corner, ...edges]) {
        const faces = [];
        for (const [, a, b] of FACES) {
            const [i, j] = [edges[a - 1], edges[b - 1]];
            const k = edges.find((_, index) => index !== a - 1 && index !== b - 1);
            for (const side of [0, 1]) {
                const face = this.face(add(corner, k, side), i, j);
                const outward = dot(face.normal, k) > 0 === (side === 1) ? 1 : -1;
                faces.push({ ...face, normal: add([0, 0, 0], face.normal, outward), solid: true });
            }
        }
        return faces;
    }

    setColours(colours) {
        this.colours = colours;
    }

    setDark(dark) {
        this.dark = dark;
    }

    async draw(simulation, camera) {
        if (simulation.spheres !== this.count) this.readShapes(simulation);
        const positions = await simulation.positions();
        const { width, height } = this.canvas;
        const { project, scale } = camera.projection(width, height);
        const context = this.context;
        context.fillStyle = this.dark ? "#22272d" : "#e6eaee";
        context.fillRect(0, 0, width, height);
        const place = k => [positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]];
        this.drawFaces(project, camera);
        const items = [];
        for (let k = 0; k < this.count; k += 1) {
            const [x, y, depth] = project(place(k));
            if (depth > 0) items.push({ depth, x, y, radius: (this.radii[k] * scale) / depth, k });
        }
        const line = (ends, radius, colour) => {
            const [a, b] = ends.map(end => project(place(end)));
            const depth = 0.5 * (a[2] + b[2]);
            if (a[2] > 0 && b[2] > 0) items.push({ depth, a, b, width: Math.max(1, (2 * radius * scale) / depth), colour });
        };
        this.rods.forEach((ends, k) => line(ends, this.rodRadii[k], COLOURS.rod));
        this.springs.forEach(ends => line(ends, 0, COLOURS.spring));
        items.sort((one, two) => two.depth - one.depth);
        items.forEach(item => (item.a ? this.drawLine(item) : this.drawBall(item)));
    }

    // Static faces that face the camera, far ones first. All bodies are drawn over them.
    drawFaces(project, camera) {
        const middle = face => add(face.corners[0], add(face.corners[2], face.corners[0], -1), 0.5);
        const seen = this.faces.filter(face => dot(face.normal, add(camera.eye, face.corners[0], -1)) > 0 || !face.solid);
        // A large wall in front of the target would hide everything.
        const isLarge = ({ corners: [a, b, , d] }) => Math.max(length(add(b, a, -1)), length(add(d, a, -1))) > 0.3 * camera.distance;
        const isBefore = face => dot(face.normal, add(camera.target, face.corners[0], -1)) <= 0;
        const behind = seen.filter(face => !(isBefore(face) && isLarge(face)));
        const far = face => -Math.hypot(...add(middle(face), camera.eye, -1));
        for (const face of behind.sort((one, two) => far(one) - far(two))) {
            const points = face.corners.map(project);
            if (points.some(point => point[2] <= 0)) continue;
            this.context.beginPath();
            points.forEach(([x, y]) => this.context.lineTo(x, y));
            this.context.closePath();
            this.context.fillStyle = css(COLOURS.fixture, (this.dark ? 0.45 : 0.75) + 0.22 * Math.abs(dot(face.normal, LIGHT)));
            this.context.strokeStyle = "rgb(120 120 120 / 0.5)";
            this.context.fill();
            this.context.stroke();
        }
    }

    drawBall({ x, y, radius, k }) {
        const own = this.colours && 3 * k + 2 < this.colours.length ? [...this.colours.subarray(3 * k, 3 * k + 3)] : null;
        const colour = own ?? (this.fixed[k] ? COLOURS.fixed : COLOURS.sphere);
        const context = this.context;
        context.beginPath();
        context.arc(x, y, Math.max(0.5, radius), 0, 2 * Math.PI);
        if (radius > 3) {
            const shade = context.createRadialGradient(x - 0.35 * radius, y - 0.45 * radius, 0.1 * radius, x, y, radius);
            shade.addColorStop(0, css(colour.map(channel => 0.6 * channel + 102)));
            shade.addColorStop(0.5, css(colour));
            shade.addColorStop(1, css(colour, 0.6));
            context.fillStyle = shade;
        } else {
            context.fillStyle = css(colour);
        }
        context.fill();
    }

    drawLine({ a, b, width, colour }) {
        const context = this.context;
        context.beginPath();
        context.moveTo(a[0], a[1]);
        context.lineTo(b[0], b[1]);
        context.lineWidth = width;
        context.lineCap = "round";
        context.strokeStyle = css(colour, 0.85);
        context.stroke();
    }
}
