// Mouse, touch and keys on the picture: a body under the pointer is dragged, otherwise the camera turns.

import { add, dot } from "./camera.js";

const NOTCH = 0.88;
const KEY_TURN = 40;

// A point of the picture from -1 to 1, y upwards.
function place(stage, event) {
    const box = stage.canvas.getBoundingClientRect();
    return [(2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height];
}

export class Pointer {
    constructor(stage) {
        this.stage = stage;
        this.down = new Map();
        this.last = [0, 0];
        const on = (type, handle, options) => stage.place.addEventListener(type, handle, options);
        on("pointerdown", event => this.press(event));
        on("pointermove", event => this.move(event));
        on("pointerup", event => this.lift(event));
        on("pointercancel", event => this.lift(event));
        on("contextmenu", event => event.preventDefault());
        on("wheel", event => this.wheel(event), { passive: false });
    }

    press(event) {
        if (event.target !== this.stage.canvas) return;
        event.target.setPointerCapture(event.pointerId);
        event.target.focus({ preventScroll: true });
        this.down.set(event.pointerId, event);
        this.last = place(this.stage, event);
        this.moves = event.shiftKey || event.button !== 0;
        this.depth = null;
        if (this.moves || this.down.size > 1) {
            this.release();
            return;
        }
        const { stage } = this;
        const [x, y] = this.last;
        stage.act(async () => {
            const { eye } = stage.camera;
            const point = await stage.simulation.hold(...eye, ...stage.camera.direction(x, y, stage.aspect));
            if (!point) return;
            if (this.down.size !== 1) stage.simulation.release();
            else this.depth = dot(add([...point], eye, -1), stage.camera.axes().forward);
            stage.held = this.depth !== null;
        });
    }

    move(event) {
        const before = this.down.get(event.pointerId);
        this.last = place(this.stage, event);
        if (!before) return;
        const [dx, dy] = [event.clientX - before.clientX, event.clientY - before.clientY];
        const spread = () => {
            const [a, b] = [...this.down.values()];
            return Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
        };
        const apart = this.down.size === 2 ? spread() : 0;
        this.down.set(event.pointerId, event);
        const { camera, canvas } = this.stage;
        if (this.down.size === 2) {
            camera.zoom(apart / Math.max(1, spread()));
            camera.pan(dx / 2 / canvas.clientHeight, dy / 2 / canvas.clientHeight);
        } else if (this.depth !== null) {
            const { stage, depth, last } = this;
            stage.act(() => stage.simulation.drag(...stage.camera.pointAt(...last, stage.aspect, depth)));
        } else if (this.moves) {
            camera.pan(dx / canvas.clientHeight, dy / canvas.clientHeight);
        } else {
            camera.orbit(dx, dy);
        }
    }

    lift(event) {
        this.down.delete(event.pointerId);
        this.release();
    }

    release() {
        this.depth = null;
        this.stage.held = false;
        if (this.stage.simulation) this.stage.act(() => this.stage.simulation.release());
    }

    wheel(event) {
        event.preventDefault();
        this.stage.camera?.zoom(NOTCH ** (-event.deltaY / (event.deltaMode === 0 ? 100 : 3)));
    }

    // Throws a ball from the camera to where the pointer was last.
    throwBall() {
        const { stage, last } = this;
        const { camera } = stage;
        const direction = camera.direction(...last, stage.aspect);
        const start = add(camera.eye, direction, 0.15 * camera.distance);
        const velocity = direction.map(value => value * 1.2 * camera.distance);
        return stage.act(() => stage.simulation.throwBall(...start, ...velocity));
    }

    // Handles a key on the picture; returns whether it did.
    key(name) {
        const { camera } = this.stage;
        const turn = { ArrowLeft: [-KEY_TURN, 0], ArrowRight: [KEY_TURN, 0], ArrowUp: [0, -KEY_TURN], ArrowDown: [0, KEY_TURN] }[name];
        if (turn) camera.orbit(...turn);
        else if (name === "+" || name === "=") camera.zoom(NOTCH);
        else if (name === "-") camera.zoom(1 / NOTCH);
        else return false;
        return true;
    }
}
