// The simulation with its picture: opens scenes, runs steps and draws. Only one call to the engine is under way at a time, so
// everything that changes the simulation waits in a queue.

import { Scene, Simulation, View } from "./rockfall.js";
import { Camera } from "./camera.js";
import { FlatView } from "./flat.js";
import { Marks } from "./marks.js";

// Time in ms that the steps of a frame may take. A slow simulation runs slower than real time, but the page answers.
const FRAME = 25;

export class Stage {
    constructor(place, backend, report) {
        this.place = place;
        this.backend = backend;
        this.report = report;
        this.running = false;
        // Of the last frame. While a call is under way, the simulation itself cannot be asked.
        [this.steps, this.time, this.contacts] = [0, 0, 0];
        this.speed = 1;
        this.owed = 0;
        this.queue = [];
        this.msPerStep = 0;
        this.dark = false;
        this.after = () => {};
        this.marks = new Marks(place);
        new ResizeObserver(() => (this.resized = true)).observe(place);
    }

    // Calls `action` between two steps, when a simulation is open. Resolves with its result.
    do(action) {
        return new Promise((done, failed) => this.queue.push(() => Promise.resolve().then(action).then(done, failed)));
    }

    // The same, with errors reported.
    act(action) {
        return this.do(action).catch(error => this.report(error.message, true));
    }

    // Opens a scene; the one before stays open if that fails. The time step of a scene text overrides `dt`. `settings` are constants that differ from those of the scene.
    async open({ text, scene, name, dt, camera, colours }) {
        const parsed = scene ?? new Scene(text, name);
        const simulation = await Simulation.create(parsed, this.backend);
        this.close();
        const own = scene ? undefined : parsed.timeStep;
        Object.assign(this, { scene: parsed, simulation, name, dt: own ?? dt, colours, settings: new Map(), owed: 0 });
        this.marks.open(simulation, this.report);
        const focused = this.makeCanvas();
        this.camera = new Camera(camera ?? parsed.camera(this.canvas.width / this.canvas.height));
        await this.makeView();
        if (focused) this.canvas.focus();
        this.opened?.();
    }

    close() {
        this.marks.close();
        this.view?.free?.();
        this.simulation?.free();
        this.scene?.free();
        this.view = this.simulation = this.scene = null;
    }

    // A canvas keeps the kind of its first context, so every simulation gets its own. Returns whether the last one had the focus.
    makeCanvas() {
        const focused = document.activeElement === this.canvas;
        this.canvas?.remove();
        this.canvas = document.createElement("canvas");
        this.canvas.tabIndex = 0;
        this.canvas.setAttribute("role", "img");
        this.describe();
        this.fit();
        this.place.prepend(this.canvas);
        return focused;
    }

    // Draws with WebGPU where there is a GPU, also what the CPU simulates.
    async makeView() {
        try {
            this.view = await View.create(this.canvas, this.scene, this.simulation);
        } catch (error) {
            if (this.simulation.backend === "gpu") throw error;
            this.view = new FlatView(this.canvas, this.simulation);
        }
        this.view.setDark(this.dark);
        // A GPU in software draws slowly.
        this.view.setShadows?.(!this.simulation.device.includes("software"));
        if (this.colours) this.view.setColours(this.colours);
    }

    describe() {
        this.canvas.setAttribute("aria-label", `Simulation: ${this.marks.wanted.title || this.name}`);
    }

    // Plots take a part of the place.
    fit() {
        const ratio = Math.min(2, window.devicePixelRatio || 1);
        const size = [this.place.clientWidth, this.place.clientHeight].map(side => Math.max(1, Math.round(side * ratio)));
        const scene = this.marks.fit(...size);
        [this.canvas.width, this.canvas.height] = scene;
        this.canvas.style.width = `${(100 * scene[0]) / size[0]}%`;
        this.canvas.style.height = `${(100 * scene[1]) / size[1]}%`;
    }

    // Shows other text, arrows, trails and plots over the picture.
    show(wanted) {
        this.marks.show(wanted, this.simulation, this.report);
        this.describe();
        this.resized = true;
    }

    get aspect() {
        return this.canvas.width / this.canvas.height;
    }

    setDark(dark) {
        this.dark = dark;
        this.marks.setDark(dark);
        this.view?.setDark(dark);
    }

    setConstant(name, value) {
        this.simulation.setSetting(name, value);
        this.settings.set(name, value);
    }

    // Sets the initial state again, with the constants that were changed.
    async reset() {
        const settings = this.settings;
        const scene = new Scene(this.scene.toText(), this.name);
        const { name, dt, colours, camera } = this;
        await this.open({ scene, name, dt, colours, camera: camera.numbers });
        settings.forEach((value, key) => this.setConstant(key, value));
        // The sliders show the constants of the scene otherwise.
        this.opened?.();
    }

    async run(steps) {
        const start = performance.now();
        await this.simulation.run(steps, this.dt);
        const ms = (performance.now() - start) / steps;
        this.msPerStep = this.msPerStep ? 0.8 * this.msPerStep + 0.2 * ms : ms;
    }

    // One frame: what is queued, the steps that are due, and the picture.
    async frame(elapsed) {
        for (const action of this.queue.splice(0)) await action();
        if (!this.simulation) return;
        if (this.running) {
            const most = Math.max(1, Math.floor(FRAME / Math.max(0.05, this.msPerStep)));
            this.owed = Math.min(this.owed + (elapsed * this.speed) / this.dt, most);
            const steps = Math.floor(this.owed);
            this.owed -= steps;
            if (steps > 0) await this.run(steps);
        }
        await this.draw();
        const report = this.simulation.report;
        [this.steps, this.time, this.contacts] = [report.steps, report.time, report.contacts];
        report.free();
    }

    async draw() {
        if (this.resized) {
            this.resized = false;
            this.fit();
            this.view.resize?.(this.canvas.width, this.canvas.height);
        }
        const { camera } = this;
        await this.marks.update(this.simulation, this.report);
        this.view.setCamera?.(...camera.eye, ...camera.target);
        await this.view.draw(this.simulation, camera);
        this.marks.draw(this.canvas, camera);
        // The picture of a canvas is there only until the browser shows it.
        this.after();
        this.after = () => {};
    }

    // Resolves with the next picture as a PNG file.
    screenshot() {
        return new Promise(done => (this.after = () => this.marks.whole(this.canvas).toBlob(done, "image/png")));
    }
}
