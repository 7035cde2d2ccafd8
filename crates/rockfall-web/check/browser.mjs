// Starts a local server and a browser for the tests. WebGPU runs on a GPU in software: SwiftShader in Chromium, lavapipe in
// Firefox.
import assert from "node:assert/strict";
import fs from "node:fs";
import http from "node:http";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import { openWebKit } from "./webkit.mjs";

const TYPES = { ".css": "text/css", ".html": "text/html", ".js": "text/javascript", ".svg": "image/svg+xml", ".txt": "text/plain", ".wasm": "application/wasm" };
const CHROMIUM_GPU = {
    software: ["--enable-unsafe-webgpu", "--enable-features=Vulkan", "--use-vulkan=swiftshader", "--use-angle=swiftshader", "--use-webgpu-adapter=swiftshader"],
    hardware: ["--enable-unsafe-webgpu", "--enable-features=Vulkan", "--use-angle=vulkan", "--disable-vulkan-surface", "--ignore-gpu-blocklist", "--disable-gpu-watchdog"],
    none: ["--disable-gpu", "--disable-features=WebGPU"],
};
// Descriptions of these drivers for the loader of Vulkan.
const SWIFTSHADER = ["/usr/lib/chromium", "/opt/google/chrome"].map(folder => path.join(folder, "vk_swiftshader_icd.json"));
const LAVAPIPE = ["x86_64", "aarch64"].flatMap(machine => [`lvp_icd.${machine}.json`, "lvp_icd.json"]).map(name => path.join("/usr/share/vulkan/icd.d", name));

function driverOf(files) {
    const file = files.find(file => fs.existsSync(file));
    assert.ok(file, `the driver is in none of ${files}`);
    return { VK_DRIVER_FILES: file, VK_ICD_FILENAMES: file };
}

// Variables with which a native program uses the same GPU as the browser.
export const driver = () => driverOf(kind === "firefox" ? LAVAPIPE : SWIFTSHADER);

// Serves the files of a folder, and nothing else.
export function serve(folder) {
    const server = http.createServer((request, response) => {
        const name = decodeURIComponent(new URL(request.url, "http://local").pathname);
        const file = path.join(folder, name.endsWith("/") ? `${name}index.html` : name);
        if (!file.startsWith(folder) || !fs.existsSync(file) || fs.statSync(file).isDirectory()) {
            response.writeHead(404).end();
            return;
        }
        response.writeHead(200, { "content-type": TYPES[path.extname(file)] ?? "application/octet-stream" }).end(fs.readFileSync(file));
    });
    return new Promise(done => server.listen(0, "127.0.0.1", () => done({ server, address: `http://127.0.0.1:${server.address().port}/` })));
}

// `chromium`, `firefox` or `webkit`.
export const kind = process.env.WEB_TEST_BROWSER ?? "chromium";

// Firefox has no option for the theme of the system in its remote protocol. On Linux it offers WebGPU only on request, here on
// Mesa's lavapipe, a GPU in software.
const firefoxPreferences = (gpu, colorScheme) => ({
    "dom.webgpu.enabled": gpu,
    "gfx.webgpu.ignore-blocklist": gpu,
    "layout.css.prefers-color-scheme.content-override": colorScheme === "dark" ? 0 : 1,
});

const playwright = () => createRequire(path.join(process.env.WEB_TEST_MODULES, "/"))("playwright-core");
const executablePath = process.env.WEB_TEST_PROGRAM;
const headless = !process.env.WEB_TEST_SCREEN;

// `gpu` is `software`, `hardware` or `none`.
export const openChromium = gpu => playwright().chromium.launch({ executablePath, headless, args: ["--no-sandbox", ...CHROMIUM_GPU[gpu]] });

function launch(gpu, colorScheme, downloadsPath) {
    if (kind === "firefox") {
        const env = { ...process.env, ...driverOf(LAVAPIPE) };
        const firefoxUserPrefs = firefoxPreferences(gpu, colorScheme);
        return playwright().firefox.launch({ channel: "moz-firefox", executablePath, headless, env, firefoxUserPrefs, downloadsPath });
    }
    return openChromium(gpu ? "software" : "none");
}

// Clicks on a button and resolves with the file that the page saves.
export async function saved({ page, downloads }, button) {
    if (kind === "chromium") {
        const [file] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
        return { name: file.suggestedFilename(), bytes: fs.readFileSync(await file.path()) };
    }
    // The other drivers do not report downloads, so the folder is read until the file in it is complete.
    const before = fs.readdirSync(downloads);
    await page.click(button);
    for (const end = performance.now() + 40_000; performance.now() < end; ) {
        await page.waitForTimeout(500);
        const names = fs.readdirSync(downloads).filter(name => !name.startsWith(".") && !before.includes(name));
        const isPart = name => /\.(part|wkdownload)$/.test(name) || fs.statSync(path.join(downloads, name)).size === 0;
        if (names.length > 0 && !names.some(isPart)) return { name: names[0], bytes: fs.readFileSync(path.join(downloads, names[0])) };
    }
    throw new Error(`${button}: no file was saved`);
}

// Opens a browser with or without WebGPU. `problems` collects errors on the console, failed requests, and requests to other hosts.
export async function open(address, { gpu, ...options }) {
    const context = { viewport: { width: 1100, height: 700 }, ...options };
    const problems = [];
    if (kind === "webkit") return { ...(await openWebKit(problems, context)), problems };
    const downloads = fs.mkdtempSync(path.join(os.tmpdir(), "rockfall-web-"));
    const browser = await launch(gpu, context.colorScheme, downloads);
    browser.on("disconnected", () => fs.rmSync(downloads, { recursive: true, force: true }));
    const page = await (await browser.newContext(context)).newPage();
    // A GPU in software takes half a minute to compile kernels.
    page.setDefaultTimeout(gpu ? 180_000 : 40_000);
    page.on("console", message => {
        if (message.type() === "error") problems.push(`console: ${message.text()}`);
    });
    page.on("pageerror", error => problems.push(`exception: ${error}`));
    page.on("requestfailed", request => problems.push(`request failed: ${request.url()}`));
    page.on("request", request => {
        if (!/^(data|blob):/.test(request.url()) && !request.url().startsWith(address)) problems.push(`request to another host: ${request.url()}`);
    });
    return { browser, page, problems, downloads };
}
