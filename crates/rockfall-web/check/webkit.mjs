// WebKitGTK's MiniBrowser through WebKitWebDriver, behind the part of Playwright's interface that the tests use.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import fs from "node:fs";
import net from "node:net";
import os from "node:os";
import path from "node:path";

const POLL = 50;
const KEYS = { ArrowLeft: "\uE012", ArrowUp: "\uE013", ArrowRight: "\uE014", ArrowDown: "\uE015", Home: "\uE011" };
const ELEMENT = "element-6066-11e4-a52e-4f735466cecf";
// Calls a function in the page. JSON has no negative zero, which the comparison of states needs.
const CALL = `const done = arguments[arguments.length - 1];
const pack = value => JSON.stringify(value, (_, part) => (Object.is(part, -0) ? "-0" : part));
Promise.resolve().then(() => (FUNCTION)(...arguments[0])).then(
    value => done({ value: value === undefined ? null : pack(value) }),
    error => done({ error: String(error) + "\\n" + (error && error.stack) }));`;
const unpack = text => JSON.parse(text, (_, part) => (part === "-0" ? -0 : part));
const pause = ms => new Promise(done => setTimeout(done, ms));

function freePort() {
    return new Promise(done => {
        const server = net.createServer().listen(0, "127.0.0.1", () => {
            const { port } = server.address();
            server.close(() => done(port));
        });
    });
}

// Where Debian and Fedora keep MiniBrowser.
function miniBrowser() {
    const folders = ["/usr/lib", "/usr/lib64", "/usr/libexec", `/usr/lib/${process.arch === "arm64" ? "aarch64" : "x86_64"}-linux-gnu`];
    const files = folders.flatMap(folder => ["6.0", "4.1", "4.0"].map(version => path.join(folder, `webkit${version === "6.0" ? "gtk" : "2gtk"}-${version}`, "MiniBrowser")));
    const found = files.find(file => fs.existsSync(file));
    assert.ok(found, "MiniBrowser of WebKitGTK was not found");
    return found;
}

class Page {
    constructor(base) {
        Object.assign(this, { base, timeout: 30_000 });
        this.mouse = {
            move: (x, y) => this.pointer({ type: "pointerMove", x: Math.round(x), y: Math.round(y), duration: 0 }),
            down: () => this.pointer({ type: "pointerDown", button: 0 }),
            up: () => this.pointer({ type: "pointerUp", button: 0 }),
        };
        this.keyboard = { press: key => this.press(KEYS[key] ?? key) };
    }

    async call(method, command, body) {
        const answer = await fetch(this.base + command, { method, body: body && JSON.stringify(body) });
        const { value } = await answer.json();
        if (value?.error) throw new Error(`${command}: ${value.error}: ${value.message}`);
        return value;
    }

    setDefaultTimeout(ms) {
        this.timeout = ms;
    }

    goto(url) {
        return this.call("POST", "/url", { url });
    }

    async evaluate(action, ...values) {
        const script = CALL.replace("FUNCTION", () => action.toString());
        const { value, error } = await this.call("POST", "/execute/async", { script, args: [values] });
        if (error) throw new Error(error);
        return value === null ? undefined : unpack(value);
    }

    async waitUntil(what, condition) {
        const end = performance.now() + this.timeout;
        for (;;) {
            const value = await condition();
            if (value) return value;
            if (performance.now() > end) throw new Error(`timeout: ${what}`);
            await pause(POLL);
        }
    }

    waitForFunction(action, ...values) {
        return this.waitUntil(action.toString(), () => this.evaluate(action, ...values));
    }

    waitForTimeout(ms) {
        return pause(ms);
    }

    async find(selector) {
        const [, tag, text] = /^(\w+):text\('(.*)'\)$/.exec(selector) ?? [];
        const by = tag ? { using: "xpath", value: `//${tag}[contains(., '${text}')]` } : { using: "css selector", value: selector };
        return `/element/${(await this.call("POST", "/element", by))[ELEMENT]}`;
    }

    async click(selector) {
        await this.call("POST", `${await this.find(selector)}/click`, {});
    }

    check(selector) {
        return this.click(selector);
    }

    fill(selector, text) {
        return this.evaluate((selector, text) => {
            const field = document.querySelector(selector);
            field.value = text;
            field.dispatchEvent(new Event("input", { bubbles: true }));
        }, selector, text);
    }

    selectOption(selector, { label }) {
        return this.evaluate((selector, label) => {
            const list = document.querySelector(selector);
            list.selectedIndex = [...list.options].findIndex(option => option.text === label);
            list.dispatchEvent(new Event("change", { bubbles: true }));
        }, selector, label);
    }

    textContent(selector) {
        return this.evaluate(selector => document.querySelector(selector).textContent, selector);
    }

    inputValue(selector) {
        return this.evaluate(selector => document.querySelector(selector).value, selector);
    }

    focus(selector) {
        return this.evaluate(selector => document.querySelector(selector).focus(), selector);
    }

    pointer(action) {
        return this.call("POST", "/actions", { actions: [{ type: "pointer", id: "mouse", parameters: { pointerType: "mouse" }, actions: [action] }] });
    }

    press(value) {
        const actions = [{ type: "keyDown", value }, { type: "keyUp", value }];
        return this.call("POST", "/actions", { actions: [{ type: "key", id: "keyboard", actions }] });
    }

    async screenshot({ path: file }) {
        fs.writeFileSync(file, Buffer.from(await this.call("GET", "/screenshot"), "base64"));
    }
}

// Starts the browser. Errors on its console go to `problems`.
export async function openWebKit(problems, { viewport, colorScheme }) {
    const home = fs.mkdtempSync(path.join(os.tmpdir(), "rockfall-webkit-"));
    const port = await freePort();
    const theme = colorScheme === "dark" ? "Adwaita:dark" : "Adwaita";
    const driver = spawn("WebKitWebDriver", [`--port=${port}`], { env: { ...process.env, HOME: home, GTK_THEME: theme }, stdio: ["ignore", "pipe", "pipe"], detached: true });
    // The browser is in the group of the driver. After a failed test nobody closes it.
    const end = () => {
        process.kill(-driver.pid);
        fs.rmSync(home, { recursive: true, force: true });
    };
    process.once("exit", end);
    const listen = chunk => problems.push(...`${chunk}`.split("\n").filter(line => /CONSOLE.* (ERROR|error)/.test(line)));
    driver.stdout.on("data", listen);
    driver.stderr.on("data", listen);
    const driverPage = new Page(`http://127.0.0.1:${port}`);
    await driverPage.waitUntil("WebKitWebDriver starts", () => driverPage.call("GET", "/status").catch(() => null));
    const args = ["--automation", "--enable-write-console-messages-to-stdout=true"];
    const options = { "webkitgtk:browserOptions": { binary: miniBrowser(), args } };
    const { sessionId, capabilities } = await driverPage.call("POST", "/session", { capabilities: { alwaysMatch: options } });
    const page = new Page(`${driverPage.base}/session/${sessionId}`);
    await page.call("POST", "/timeouts", { script: 300_000 });
    await page.call("POST", "/window/rect", viewport);
    const close = async () => {
        await page.call("DELETE", "");
        process.off("exit", end);
        end();
    };
    // Without settings of the desktop, the home folder is the one for downloads.
    return { browser: { close, version: () => capabilities.browserVersion }, page, downloads: home };
}
