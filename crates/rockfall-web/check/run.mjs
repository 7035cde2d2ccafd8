// Runs the tests of the page one after the other: node run.mjs DIST SCENES. `scripts/web-test` calls it.
import path from "node:path";
import { kind, serve } from "./browser.mjs";
import * as marks from "./marks.mjs";
import * as page from "./page.mjs";
import * as physics from "./physics.mjs";

// Touch events are sent through Chromium's own protocol. WebKitGTK has no WebGPU.
const CPU = ["cpuIsBitwiseEqual", "pageRunsOnCpu", "pagePaintsOnCpu", "pageShowsMarksOnCpu"];
const can = name => ({ chromium: true, firefox: name !== "pageWorksByTouch", webkit: CPU.includes(name) })[kind];

const [dist, scenes, only] = process.argv.slice(2);
const { server, address } = await serve(path.resolve(dist));
let failed = 0;
for (const [name, test] of Object.entries({ ...physics, ...page, ...marks })) {
    if (only && name !== only) continue;
    if (!can(name)) {
        console.log(`not in ${kind}: ${name}`);
        continue;
    }
    const start = performance.now();
    try {
        await test(address, path.resolve(scenes));
        console.log(`ok      ${name} (${((performance.now() - start) / 1000).toFixed(1)} s)`);
    } catch (error) {
        failed += 1;
        console.log(`FAILED  ${name}\n${error.stack}`);
    }
}
server.close();
process.exit(failed > 0 ? 1 : 0);
