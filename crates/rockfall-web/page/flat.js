// Draws a simulation with a 2D context, where there is no WebGPU to draw with.

import { add, cross, dot, length, unit } from "./camera.js";

// Colours of docs/drawing.md: spheres, fixed spheres, rods, springs, static objects.
const COLOURS = { sphere: [63, 148, 201], fixed: [109, 117, 126], rod: [226, 154, 28], spring: [208, 106, 44], fixture: [211, 207, 198] };
const LIGHT = unit([-0.45, 0.8, 0.4]);
const FACES = [[0, 1, 2], [0, 2, 3], [0, 3, 1]];

// Opacity of walls that hide bodies.
const PANE = 0.08;

const css = (colour, shade = 1, opacity = 1) => `rgb(${colour.map(channel => Math.round(channel * shade)).join(" ")} / ${opacity})`;

// Number of bodies that walls must not hide.
const MOST_TESTED = 64;

// Whether the line between two points goes through a face.
function crosses({ corners: [corner, next, , last], normal, isTriangle }, from, to) {
    const [start, end] = [from, to].map(point => dot(normal, add(point, corner, -1)));
    if (start * end >= 0) return false;
    const point = add(add(from, add(to, from, -1), start / (start - end)), corner, -1);
    const [left, right] = [next, last].map(edge => add(edge, corner, -1));
    // The coordinates along the edges, from the areas of the triangles.
    const all = cross(left, right);
    const [u, v] = [cross(point, right), cross(left, point)].map(area => dot(area, all) / dot(all, all));
    return u >= 0 && v >= 0 && (isTriangle ? u + v <= 1 : Math.max(u, v) <= 1);
}

// The part of a polygon whose depth is at least `near`.
function clipped(corners, depth, near) {
    return corners.flatMap((corner, k) => {
        const next = corners[(k + 1) % corners.length];
        const [here, there] = [corner, next].map(point => depth(point) - near);
        const crossing = here * there < 0 ? [add(corner, add(next, corner, -1), here / (here - there))] : [];
        return here >= 0 ? [corner, ...crossing] : crossing;
    });
}

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
        const isTriangle = corners[2].every((number, axis) => number === corners[3][axis]);
        return { corners, normal: unit(cross(left, right)), solid: false, isTriangle };
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
        const stride = Math.ceil(this.count / MOST_TESTED);
        const some = Array.from({ length: Math.ceil(this.count / stride) || 0 }, (_, k) => place(k * stride));
        const faces = this.facesSeen(project, camera, some);
        // The painter's order: walls, bodies, and panes for the walls in front of them.
        faces.filter(face => !face.hides).forEach(face => this.drawFace(face));
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
        faces.filter(face => face.hides).forEach(face => this.drawFace(face, PANE));
    }

    // The static faces that are seen: those in front of the camera, cut off where they reach behind it.
    // `hides` says whether one hides one of some bodies.
    facesSeen(project, camera, bodies) {
        const forward = camera.axes().forward;
        const depth = point => dot(add(point, camera.eye, -1), forward);
        const near = 1e-3 * camera.distance;
        const { eye } = camera;
        return this.faces.filter(face => dot(face.normal, add(eye, face.corners[0], -1)) > 0 || !face.solid).flatMap(face => {
            const corners = clipped(face.corners, depth, near);
            if (corners.length < 3) return [];
            // A floor and a wall at the back reach farther than what is before them.
            const far = Math.max(...corners.map(corner => length(add(corner, eye, -1))));
            const hides = bodies.some(body => crosses(face, eye, body));
            return [{ ...face, hides, far, points: corners.map(project) }];
        }).sort((one, two) => two.far - one.far);
    }

    drawFace({ points, normal, isTriangle }, opacity = 1) {
        const context = this.context;
        context.beginPath();
        points.forEach(([x, y]) => context.lineTo(x, y));
        context.closePath();
        context.fillStyle = css(COLOURS.fixture, (this.dark ? 0.45 : 0.75) + 0.22 * Math.abs(dot(normal, LIGHT)), opacity);
        context.fill();
        // The edges of the triangles of a mesh would be all that is seen. A line of the same colour closes the seams between them.
        context.lineWidth = 1;
        context.strokeStyle = isTriangle ? context.fillStyle : "rgb(120 120 120 / 0.5)";
        if (!isTriangle || opacity === 1) context.stroke();
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
