// Starts a local server and headless Chromium for the tests. WebGPU runs on SwiftShader, a GPU in software.
import fs from "node:fs";
import http from "node:http";
import { createRequire } from "node:module";
import path from "node:path";

const TYPES = { ".css": "text/css", ".html": "text/html", ".js": "text/javascript", ".svg": "image/svg+xml", ".txt": "text/plain", ".wasm": "application/wasm" };
const SOFTWARE_GPU = ["--enable-unsafe-webgpu", "--enable-features=Vulkan", "--use-vulkan=swiftshader", "--use-angle=swiftshader", "--use-webgpu-adapter=swiftshader"];
const NO_GPU = ["--disable-gpu", "--disable-features=WebGPU"];

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

// Opens a browser with or without WebGPU. `problems` collects errors on the console, failed requests, and requests to other hosts.
export async function open(address, { gpu, ...context }) {
    const { chromium } = createRequire(path.join(process.env.WEB_TEST_MODULES, "/"))("playwright-core");
    const executablePath = process.env.CHROMIUM ?? "/usr/bin/chromium";
    const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", ...(gpu ? SOFTWARE_GPU : NO_GPU)] });
    const page = await (await browser.newContext({ viewport: { width: 1100, height: 700 }, ...context })).newPage();
    // A GPU in software takes half a minute to compile kernels.
    page.setDefaultTimeout(gpu ? 180_000 : 40_000);
    const problems = [];
    page.on("console", message => {
        if (message.type() === "error") problems.push(`console: ${message.text()}`);
    });
    page.on("pageerror", error => problems.push(`exception: ${error}`));
    page.on("requestfailed", request => problems.push(`request failed: ${request.url()}`));
    page.on("request", request => {
        if (!/^(data|blob):/.test(request.url()) && !request.url().startsWith(address)) problems.push(`request to another host: ${request.url()}`);
    });
    return { browser, page, problems };
}
