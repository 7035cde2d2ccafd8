// Text, arrows, trails and plots over the picture. The module says what to draw, and a canvas above the picture shows it.

import { Overlay } from "./rockfall.js";

const FONT = "system-ui, sans-serif";
// More spheres than this have no labels, arrows and trails: reading and drawing them takes too long.
const MOST = 5000;
// Time in ms of an update above which some states are left out.
const SLOW = 15;
// What is shown at first.
const NOTHING = { title: "", clock: false, scale: false, label: false, arrows: "", trails: 0, plots: [] };

const css = (row, from, opacity = 1) => `rgb(${row[from]} ${row[from + 1]} ${row[from + 2]} / ${opacity})`;
const rows = function* (numbers, size) {
    for (let k = 0; k < numbers.length; k += size) yield numbers.subarray(k, k + size);
};

export class Marks {
    constructor(place) {
        this.canvas = Object.assign(document.createElement("canvas"), { id: "over" });
        this.canvas.setAttribute("aria-hidden", "true");
        place.append(this.canvas);
        this.context = this.canvas.getContext("2d");
        this.wanted = NOTHING;
        this.dark = false;
        this.measure = (text, em) => {
            this.context.font = `${em}px ${FONT}`;
            return this.context.measureText(text).width;
        };
    }

    // Begins the marks of another simulation.
    open(simulation, report) {
        this.overlay = new Overlay();
        this.problem = "";
        this.show(this.wanted, simulation, report);
    }

    close() {
        this.overlay?.free();
        this.overlay = null;
    }

    // Plots that the simulation does not have are reported, and the others stay.
    show(wanted, simulation, report) {
        this.wanted = wanted;
        const { overlay } = this;
        const complain = text => {
            this.problem = text;
            report(text, true);
        };
        const isLarge = simulation.spheres > MOST;
        if (isLarge && (wanted.label || wanted.arrows || wanted.trails > 0)) {
            complain(`Labels, arrows and trails are shown for up to ${MOST} spheres, and this scene has ${simulation.spheres}.`, true);
        }
        overlay.setTitle(wanted.title);
        overlay.setTexts(wanted.clock, wanted.scale, wanted.label && !isLarge);
        overlay.setArrows(isLarge ? "" : wanted.arrows);
        overlay.setTrails(isLarge ? 0 : wanted.trails);
        overlay.setDark(this.dark);
        [this.steps, this.next] = [-1, 0];
        const plots = wanted.plots.join(" ");
        if (plots === this.plots && this.plotted === simulation) return;
        try {
            overlay.setPlots(wanted.plots, simulation);
            [this.plots, this.plotted] = [plots, simulation];
        } catch (error) {
            complain(`Plot ${error.message}`, true);
        }
    }

    setDark(dark) {
        this.dark = dark;
        this.overlay?.setDark(dark);
    }

    // Adapts to the size of the whole picture. Returns the size of the picture of the scene.
    fit(width, height) {
        [this.canvas.width, this.canvas.height] = [width, height];
        return [...this.overlay.sceneSize(width, height)];
    }

    // Takes the present state of the simulation.
    async update(simulation, report) {
        if (this.overlay.isEmpty) return;
        const state = simulation.report;
        const { steps } = state;
        state.free();
        const start = performance.now();
        if (this.steps === steps || start < this.next) return;
        try {
            await this.overlay.update(simulation);
            this.steps = steps;
            // Quantities of large scenes take long, so they are computed less often.
            const took = performance.now() - start;
            this.next = took > SLOW ? start + 5 * took : 0;
        } catch (error) {
            report(`This cannot be shown here: ${error.message}`, true);
            this.show({ ...this.wanted, arrows: "", plots: [] }, simulation, report);
        }
    }

    draw(scene, camera) {
        const { context, canvas } = this;
        context.clearRect(0, 0, canvas.width, canvas.height);
        if (!this.overlay.isEmpty) {
            this.overlay.setCamera(...camera.eye, ...camera.target);
            const size = [canvas.width, canvas.height];
            context.save();
            context.beginPath();
            context.rect(0, 0, scene.width, scene.height);
            context.clip();
            this.drawAll(this.overlay.marks(...size));
            context.restore();
            this.drawAll(this.overlay.plotMarks(...size, this.measure));
        }
        if (this.copy) this.compose(scene);
    }

    drawAll(marks) {
        this.drawShapes(marks);
        this.drawTexts(marks);
        marks.free();
    }

    drawShapes(marks) {
        const { context } = this;
        for (const row of rows(marks.rectangles, 7)) {
            context.fillStyle = css(row, 4);
            context.fillRect(row[0], row[1], row[2] - row[0], row[3] - row[1]);
        }
        context.lineCap = "round";
        for (const row of rows(marks.lines, 9)) {
            context.strokeStyle = css(row, 5, row[8]);
            context.lineWidth = row[4];
            context.beginPath();
            context.moveTo(row[0], row[1]);
            context.lineTo(row[2], row[3]);
            context.stroke();
        }
        for (const row of rows(marks.triangles, 9)) {
            context.fillStyle = css(row, 6);
            context.beginPath();
            for (const k of [0, 2, 4]) context.lineTo(row[k], row[k + 1]);
            context.fill();
        }
    }

    drawTexts(marks) {
        const { context } = this;
        context.textBaseline = "middle";
        const { texts, places } = marks;
        let k = 0;
        for (const [x, y, across, down, em, red, green, blue, panel] of rows(places, 9)) {
            const text = texts[k];
            k += 1;
            const margin = panel ? 0.3 * em : 0;
            const size = [this.measure(text, em) + 2 * margin, em + 2 * margin];
            const [left, top] = [x - across * size[0], y - down * size[1]];
            if (panel) {
                context.fillStyle = "rgb(255 255 255 / 0.82)";
                context.beginPath();
                context.roundRect(left, top, ...size, 0.4 * em);
                context.fill();
            }
            context.fillStyle = `rgb(${red} ${green} ${blue})`;
            context.fillText(text, left + margin, top + 0.55 * size[1]);
        }
    }

    // A canvas with the picture and all that is over it, as it is now.
    whole(scene) {
        if (this.overlay.isEmpty) return scene;
        const copy = document.createElement("canvas");
        this.compose(scene, copy);
        return copy;
    }

    // A canvas that shows every later picture and all that is over it.
    film(scene) {
        this.copy = document.createElement("canvas");
        this.compose(scene);
        return this.copy;
    }

    endFilm() {
        this.copy = null;
    }

    compose(scene, copy = this.copy) {
        const [width, height] = [this.canvas.width, this.canvas.height];
        if (copy.width !== width || copy.height !== height) [copy.width, copy.height] = [width, height];
        const context = copy.getContext("2d");
        context.drawImage(scene, 0, 0);
        context.drawImage(this.canvas, 0, 0);
    }
}
