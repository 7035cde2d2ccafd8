// The page: gallery, controls, editor, sharing and the loop of frames.

import init, { constants, Scene } from "./rockfall.js";
import { Editor } from "./editor.js";
import { GALLERY } from "./gallery.js";
import { fittingGrains, grains } from "./measure.js";
import { connectMarks, marksQuery } from "./marks-panel.js";
import { paint, readPicture } from "./painting.js";
import { Pointer } from "./pointer.js";
import { fromFragment, toFragment } from "./share.js";
import { Stage } from "./stage.js";

const DEFAULT_STEP = 0.01;
const LARGEST_TEXT = 20_000;
const find = id => document.getElementById(id);
const query = new URLSearchParams(location.search);

function report(text, isWrong = false) {
    find("message").textContent = text;
    find("message").classList.toggle("wrong", isWrong);
}

const stage = new Stage(find("stage"), query.get("backend") ?? "auto", report);
const pointer = new Pointer(stage);
const editor = new Editor(find);
let picture = "picture.svg";

function setRunning(running) {
    stage.running = running;
    find("play").textContent = running ? "Stop" : "Start";
    find("play").setAttribute("aria-pressed", `${running}`);
}

// Opens a scene between two frames. Resolves with whether that was possible; the scene before stays open if not.
async function open(request) {
    try {
        await stage.do(() => stage.open(request));
        const warnings = stage.scene.warnings.map(warning => `Warning: ${warning}`);
        report([stage.marks.problem, ...warnings].filter(text => text).join("\n"), stage.marks.problem !== "");
        return true;
    } catch (error) {
        const names = error.message.startsWith(request.name);
        report(names ? error.message : `${request.name}: ${error.message}`, true);
        if (error.line) {
            editor.text.value = request.text;
            editor.show(error);
            find("editor-part").open = true;
            editor.go(error.line);
        }
        return false;
    }
}

stage.opened = () => {
    const { simulation, scene } = stage;
    const { reason } = simulation;
    const why = simulation.backend === "cpu" ? `: ${reason}${reason.startsWith("no ") ? ". WebGPU would be faster" : ""}` : "";
    find("device").textContent = `${scene.spheres.toLocaleString("en")} spheres, ${scene.objects.toLocaleString("en")} objects, on ${simulation.device}${why}.`;
    editor.set(scene.objects <= LARGEST_TEXT ? (stage.text ?? scene.toText()) : " ".repeat(1e6));
    showConstants();
    showJoints();
};

async function openText(text, name, dt = DEFAULT_STEP) {
    const before = stage.text;
    stage.text = text;
    const opened = await open({ text, name, dt });
    if (!opened) stage.text = before;
    return opened;
}

async function openFromGallery(index) {
    const entry = GALLERY[index];
    find("gallery").value = `${index}`;
    find("about").textContent = entry.about;
    if (entry.grains) return openGrains();
    const answer = await fetch(entry.file);
    if (!answer.ok) return report(`${entry.file}: the server answered ${answer.status}`, true);
    return openText(await answer.text(), entry.title, entry.dt);
}

// As many grains as fit this device; they are measured once.
async function openGrains() {
    const chosen = Number(query.get("grains")) || 0;
    stage.grains ??= chosen || (await fittingGrains(stage.backend, report)).count;
    find("painting-grains").value = `${stage.grains}`;
    stage.text = null;
    return open({ scene: grains(stage.grains), name: "Grains", dt: GALLERY[0].dt });
}

function showConstants() {
    const rows = constants().filter(constant => constant.least !== undefined);
    find("constants").replaceChildren(...rows.map(({ name, unit, doc, least, greatest }) => {
        const label = document.createElement("label");
        const output = document.createElement("output");
        const slider = Object.assign(document.createElement("input"), { type: "range", min: least, max: greatest, step: (greatest - least) / 200 });
        slider.id = `constant-${name}`;
        slider.value = stage.simulation.setting(name);
        output.value = stage.simulation.setting(name);
        label.title = doc;
        label.append(`${name.replaceAll("_", " ")}: `, output, ` ${unit}`, slider);
        slider.addEventListener("input", () => stage.act(() => {
            stage.setConstant(name, slider.value);
            output.value = stage.simulation.setting(name);
        }));
        return label;
    }));
}

// Sliders of motors and springs of joints.
function showJoints() {
    const controls = stage.simulation.jointControls();
    find("joints-part").hidden = controls.length === 0;
    find("joints").replaceChildren(...controls.map((control, index) => {
        const { name, title, unit, value, least, greatest } = control;
        control.free();
        const label = document.createElement("label");
        const output = document.createElement("output");
        const slider = Object.assign(document.createElement("input"), { type: "range", min: least, max: greatest, step: (greatest - least) / 200 });
        slider.id = `joint-${index}`;
        slider.value = value;
        const shown = number => `${Number(number.toFixed(2))}`;
        output.value = shown(value);
        label.title = title;
        label.append(`${name}: `, output, ` ${unit}`, slider);
        slider.addEventListener("input", () => stage.act(() => {
            stage.simulation.driveJoint(index, Number(slider.value));
            output.value = shown(Number(slider.value));
        }));
        return label;
    }));
}

function download(blob, name) {
    const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

async function share() {
    const text = stage.text ?? (stage.scene.objects <= LARGEST_TEXT ? stage.scene.toText() : null);
    if (text === null) return report("This scene is too large for an address.", true);
    history.replaceState(null, "", `${location.pathname}${marksQuery(location.search, stage.marks.wanted)}${location.hash}`);
    location.hash = await toFragment(text);
    try {
        await navigator.clipboard.writeText(location.href);
        report("The address of this scene is in the clipboard.");
    } catch {
        report("The address of this page now contains the scene.");
    }
}

function record() {
    if (stage.recorder) {
        stage.recorder.stop();
        return;
    }
    // WebKit on Linux writes MP4 only.
    const mimeType = ["video/webm", "video/mp4"].find(type => window.MediaRecorder?.isTypeSupported(type));
    if (!mimeType) return report("This browser cannot record.", true);
    const recorder = new MediaRecorder(stage.marks.film(stage.canvas).captureStream(30), { mimeType });
    recorder.ondataavailable = ({ data }) => {
        if (data.size > 0) download(data, `rockfall.${mimeType.slice(6)}`);
        else report("The browser recorded nothing. Perhaps it has no encoder for films.", true);
    };
    recorder.onstop = () => {
        stage.recorder = null;
        stage.marks.endFilm();
        find("record").textContent = "Record";
        find("record").setAttribute("aria-pressed", "false");
    };
    recorder.start();
    stage.recorder = recorder;
    find("record").textContent = "Stop recording";
    find("record").setAttribute("aria-pressed", "true");
}

async function startPainting() {
    const count = Math.round(Number(find("painting-grains").value));
    if (!(count >= 100 && count <= 1_000_000)) return report("Grains: expected a number from 100 to 1000000", true);
    setRunning(false);
    find("paint").disabled = true;
    try {
        const request = await paint(count, await readPicture(picture), stage.backend, report);
        stage.text = null;
        if (await open(request)) setRunning(true);
    } catch (error) {
        report(`The painting failed: ${error.message ?? "the picture cannot be read"}`, true);
    } finally {
        find("paint").disabled = false;
    }
}

async function openFile(file) {
    if (file.type.startsWith("image/")) {
        picture = URL.createObjectURL(file);
        return startPainting();
    }
    return openText(await file.text(), file.name);
}

const ACTIONS = {
    play: () => setRunning(!stage.running),
    step: () => {
        setRunning(false);
        return stage.act(() => stage.run(1));
    },
    reset: () => stage.act(() => stage.reset()),
    throw: async () => {
        if ((await pointer.throwBall()) === false) report("There is no room for another ball here.", true);
    },
    home: () => stage.act(() => Object.assign(stage.camera, new stage.camera.constructor(stage.scene.camera(stage.aspect)))),
    apply: () => openText(editor.text.value, "scene text", stage.dt),
    "file-button": () => find("file").click(),
    share,
    screenshot: async () => download(await stage.screenshot(), "rockfall.png"),
    record,
    paint: startPainting,
    "picture-button": () => find("picture").click(),
};

function onKey(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const isControl = event.target.closest?.("button, input, select, textarea, summary, a");
    const action = { " ": "play", ".": "step", r: "reset", t: "throw", Home: "home" }[event.key];
    if (isControl || !stage.simulation) return;
    if (action) ACTIONS[action]();
    else if (!pointer.key(event.key)) return;
    event.preventDefault();
}

function connect() {
    for (const [id, action] of Object.entries(ACTIONS)) find(id).addEventListener("click", action);
    GALLERY.forEach(({ title }, index) => find("gallery").append(new Option(title, `${index}`)));
    find("gallery").addEventListener("change", event => openFromGallery(Number(event.target.value)));
    find("speed").addEventListener("input", event => {
        stage.speed = 2 ** Number(event.target.value);
        find("speed-value").value = `${stage.speed >= 1 ? stage.speed : `1/${1 / stage.speed}`}`;
    });
    for (const id of ["file", "picture"]) {
        find(id).addEventListener("change", event => event.target.files[0] && openFile(event.target.files[0]));
    }
    connectMarks(find, query, wanted => stage.simulation ? stage.act(() => stage.show(wanted)) : (stage.marks.wanted = wanted));
    document.addEventListener("keydown", onKey);
    document.addEventListener("dragover", event => {
        event.preventDefault();
        find("stage").classList.add("dropping");
    });
    document.addEventListener("dragleave", () => find("stage").classList.remove("dropping"));
    document.addEventListener("drop", event => {
        event.preventDefault();
        find("stage").classList.remove("dropping");
        if (event.dataTransfer.files[0]) openFile(event.dataTransfer.files[0]);
    });
    window.addEventListener("hashchange", openFragment);
    const setDark = dark => {
        document.documentElement.dataset.theme = dark ? "dark" : "light";
        find("dark").checked = dark;
        stage.setDark(dark);
    };
    const prefers = matchMedia("(prefers-color-scheme: dark)");
    find("dark").addEventListener("change", event => setDark(event.target.checked));
    prefers.addEventListener("change", event => setDark(event.matches));
    setDark(prefers.matches);
}

// Opens the scene of the address. Resolves with whether there was one, and a message if it could not be opened.
async function openFragment() {
    try {
        const text = await fromFragment(location.hash);
        if (text === null || text === stage.text) return { opened: false };
        return (await openText(text, "shared scene")) ? { opened: true } : { wrong: find("message").textContent };
    } catch (error) {
        report(error.message, true);
        return { wrong: error.message };
    }
}

let last = performance.now();
async function frame(now) {
    const elapsed = Math.min(0.1, (now - last) / 1000);
    last = now;
    try {
        await stage.frame(elapsed);
        if (stage.simulation) {
            const { steps, time, contacts, msPerStep } = stage;
            find("readout").textContent = `${time.toFixed(2)} s   ${steps} steps   ${contacts} contacts   ${msPerStep.toFixed(1)} ms per step`;
        }
    } catch (error) {
        setRunning(false);
        report(error.message ?? `${error}`, true);
    }
    requestAnimationFrame(frame);
}

async function start() {
    connect();
    await init();
    requestAnimationFrame(frame);
    const { opened, wrong } = await openFragment();
    if (opened) return;
    const wanted = GALLERY.findIndex(({ file }) => file === `scenes/${query.get("scene")}.txt`);
    await openFromGallery(Math.max(0, wanted));
    if (wrong) report(wrong, true);
    setRunning(!matchMedia("(prefers-reduced-motion: reduce)").matches && wanted < 0);
}

// For tests.
window.rockfallPage = { stage, setRunning, Scene };
start().catch(error => report(`The page could not start: ${error.message}`, true));
