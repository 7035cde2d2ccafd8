// Runs the tests of the page one after the other: node run.mjs DIST SCENES. `scripts/web-test` calls it.
import path from "node:path";
import { serve } from "./browser.mjs";
import * as page from "./page.mjs";
import * as physics from "./physics.mjs";

const [dist, scenes, only] = process.argv.slice(2);
const { server, address } = await serve(path.resolve(dist));
let failed = 0;
for (const [name, test] of Object.entries({ ...physics, ...page })) {
    if (only && name !== only) continue;
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
