// A perspective camera that orbits around a point; lengths are in units of the scene.

const FIELD_OF_VIEW = 0.6;
const TURN = 0.006;
const STEEPEST = 1.5;

const add = (a, b, t = 1) => [a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const length = a => Math.hypot(...a);
const unit = a => add([0, 0, 0], a, 1 / (length(a) || 1));

export { add, cross, dot, length, unit };

export class Camera {
    // `numbers`: x, y, z of the eye, then of the target, then of the unit vector upwards, +y by default.
    constructor(numbers) {
        this.eye = [...numbers.slice(0, 3)];
        this.target = [...numbers.slice(3, 6)];
        this.vertical = numbers.length > 6 ? [...numbers.slice(6, 9)] : [0, 1, 0];
        this.tangent = Math.tan(0.5 * FIELD_OF_VIEW);
    }

    get distance() {
        return length(add(this.eye, this.target, -1));
    }

    axes() {
        const forward = unit(add(this.target, this.eye, -1));
        const right = unit(cross(forward, this.vertical));
        return { forward, right, up: cross(right, forward) };
    }

    get numbers() {
        return [...this.eye, ...this.target, ...this.vertical];
    }

    // Turns the camera around its target by a drag of so many pixels.
    orbit(dx, dy) {
        const { forward, right } = this.axes();
        const rise = Math.max(-1, Math.min(1, dot(forward, this.vertical)));
        const pitch = Math.max(-STEEPEST, Math.min(STEEPEST, Math.asin(rise) - TURN * dy));
        const level = cross(this.vertical, right);
        const heading = add(add([0, 0, 0], level, Math.cos(TURN * dx)), right, Math.sin(TURN * dx));
        const ahead = add(add([0, 0, 0], heading, Math.cos(pitch)), this.vertical, Math.sin(pitch));
        this.eye = add(this.target, ahead, -this.distance);
    }

    // Moves the picture by parts of its height, to the right and down.
    pan(dx, dy) {
        const { right, up } = this.axes();
        const height = 2 * this.tangent * this.distance;
        const moved = add(add([0, 0, 0], right, -dx * height), up, dy * height);
        this.eye = add(this.eye, moved);
        this.target = add(this.target, moved);
    }

    zoom(factor) {
        this.eye = add(this.target, add(this.eye, this.target, -1), Math.max(0.01, Math.min(100, factor)));
    }

    // Unit vector through a point of the picture; x and y from -1 to 1, y upwards.
    direction(x, y, aspect) {
        const { forward, right, up } = this.axes();
        return unit(add(add(forward, right, x * aspect * this.tangent), up, y * this.tangent));
    }

    // The point at a depth along the viewing direction that is seen at a point of the picture.
    pointAt(x, y, aspect, depth) {
        const direction = this.direction(x, y, aspect);
        return add(this.eye, direction, depth / Math.max(1e-3, dot(direction, this.axes().forward)));
    }

    // Returns a function that projects a point to the picture: x, y in pixels, and depth. A length at that depth is `scale`
    // pixels long, divided by the depth.
    projection(width, height) {
        const { forward, right, up } = this.axes();
        const scale = (0.5 * height) / this.tangent;
        const project = point => {
            const seen = add(point, this.eye, -1);
            const depth = dot(seen, forward);
            return [0.5 * width + (scale * dot(seen, right)) / depth, 0.5 * height - (scale * dot(seen, up)) / depth, depth];
        };
        return { project, scale };
    }
}
