// The page in a headless Chromium: node test.mjs PAGE.html BITS TICKS SHOTS FILES
// BITS is what `examples/bits.rs` printed for TICKS ticks of each scene: its name, a hash, the moves of a path. Screenshots go to SHOTS; FILES is the folder of
// shipped jobs. Run by `cargo xtask page`.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { launch } from "./browser.mjs";

const [file, bits, ticks, shots, files] = process.argv.slice(2);

/** Least frames per second while the platform is dragged, and latest first paint, ms: for idle machines, on request. Others may be slow. */
const FRAMES_MIN = Number(process.env.TRIRRR_PAGE_FRAMES ?? 1);
const PAINT_MAX = Number(process.env.TRIRRR_PAGE_PAINT ?? 60_000);

const page = readFileSync(file);
const server = createServer((request, response) => {
    response.writeHead(request.url === "/" ? 200 : 404, { "content-type": "text/html; charset=utf-8" });
    response.end(request.url === "/" ? page : "");
});
await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
const address = `http://127.0.0.1:${server.address().port}/`;

const { context, close } = await launch();

const faults = [];
async function open(url, scheme = "light") {
    const tab = await context.newPage();
    tab.on("pageerror", (error) => faults.push(String(error)));
    tab.on("console", (message) => message.type() === "error" && faults.push(message.text()));
    await tab.emulateMedia({ colorScheme: scheme });
    await tab.goto(url);
    await tab.waitForSelector("html[data-ready]");
    await checked(tab);
    return tab;
}

/** Waits for the verdict of the whole reading, and for the job in all modes. */
async function checked(tab) {
    await tab.waitForFunction(() => !document.querySelector("#verdict").textContent.includes("checking"), undefined, { timeout: 60_000 });
}
const choose = async (tab, name) => {
    await tab.selectOption("#scenes", name);
    await checked(tab);
};
const text = (tab, selector) => tab.textContent(selector);
const inputs = (tab) => tab.$$eval("#pose input", (list) => list.map((input) => Number(input.value)));
const shot = (tab, name, options = {}) => tab.screenshot({ path: join(shots, `${name}.png`), ...options });

async function actions(tab) {
    assert.match(await text(tab, "#verdict"), /^\d+ moves?, /);
    assert.equal(await tab.locator("#modes tr").count(), 8);
    assert.equal(await tab.locator("#plots canvas").count(), 6);

    // Arrow keys move the platform, Q turns it, and a screen reader hears of it.
    await tab.focus(".platform");
    const before = await inputs(tab);
    await tab.keyboard.press("Shift+ArrowRight");
    await tab.waitForFunction((x) => Number(document.querySelector("#pose input").value) > x, before[0]);
    await tab.keyboard.press("q");
    await tab.waitForFunction((alpha) => Number(document.querySelectorAll("#pose input")[2].value) > alpha, before[2]);
    await tab.waitForFunction(() => document.querySelector("#live").textContent.includes("newton metres"));

    // A pose out of reach says by how much.
    await tab.fill("#pose input", "5000");
    assert.match(await text(tab, "#reason"), /unreachable: leg 1 is .* mm too short/);
    await tab.fill("#pose input", String(before[0]));
    await tab.waitForFunction(() => document.querySelector("#reason").hidden);
    // A field that is cleared is no zero: x = 0 is out of reach.
    await tab.fill("#pose input", "");
    assert.ok(await tab.isHidden("#reason"), "an empty field is no pose");
    await tab.fill("#pose input", String(before[0]));

    // A wrong value is told with its place; the same sentence as the host tools have.
    const scene = await tab.inputValue("#text");
    // A long text has numbers where it is seen, and no more.
    const short = scene.split("\n").length;
    await tab.$eval("#text", (field, text) => {
        field.value = text;
        field.dispatchEvent(new Event("input"));
    }, scene + "#\n".repeat(20_000));
    const numbers = () => tab.$$eval("#gutter span", (list) => list.map((each) => Number(each.textContent)));
    assert.equal((await numbers())[0], 1);
    await tab.$eval(".code", (pane) => pane.scrollTo({ top: pane.scrollHeight }));
    await tab.waitForFunction((last) => Number(document.querySelector("#gutter span:last-child").textContent) === last, short + 20_000);
    assert.ok((await numbers()).length < 500, "lines out of view have no number");
    await tab.waitForFunction(() => {
        const [text, number] = ["#text", "#gutter span:last-child"].map((each) => document.querySelector(each).getBoundingClientRect());
        return Math.abs(text.bottom - number.bottom - 8) < 2;
    });
    await tab.fill("#text", scene);
    await tab.$eval(".code", (pane) => pane.scrollTo({ top: 0 }));
    await checked(tab);
    await tab.fill("#text", scene.replace("proximal_m = ", "proximal_m = -"));
    await checked(tab);
    const line = scene.slice(0, scene.indexOf("proximal_m")).split("\n").length;
    assert.match(await text(tab, ".trouble"), new RegExp(`^${line}:14 machine\\.leg\\[1\\]\\.proximal_m = -[0-9.]+: must be greater than 0 \\(m\\)$`));
    assert.equal(await text(tab, ".mark"), "must be greater than 0 (m)");
    const there = await tab.$eval(".mark", (mark) => mark.getBoundingClientRect().top - document.querySelector("#text").getBoundingClientRect().top);
    const height = await tab.$eval("#text", (field) => Number.parseFloat(getComputedStyle(field).lineHeight));
    assert.equal(Math.round((there - 8) / height), line - 1, "the message stands beside its line");
    await tab.click(".trouble");
    const caret = await tab.$eval("#text", (field) => field.value.slice(field.selectionStart, field.selectionStart + 2));
    assert.equal(caret, "-0", "a click on the message goes to the value");
    await shot(tab, "refused");
    // A job that is too fast is refused by the admission; the machine stays in the hand. What the reader says of the text before, which is
    // under way when this one is typed, is not shown.
    await tab.evaluate(([bad, fast]) => {
        const field = document.querySelector("#text");
        const type = (text) => {
            field.value = text;
            field.dispatchEvent(new Event("input"));
        };
        const post = Worker.prototype.postMessage;
        Worker.prototype.postMessage = function (...question) {
            Worker.prototype.postMessage = post;
            post.apply(this, question);
            // The reader has begun once this turn has ended.
            queueMicrotask(() => type(fast));
        };
        type(bad);
    }, [scene.replace("proximal_m = ", "proximal_m = -"), scene.replace(/^duration_s = .*$/m, "duration_s = 0.05")]);
    await tab.waitForFunction(() => document.querySelector("#text").value.includes("duration_s = 0.05"));
    await checked(tab);
    assert.match(await text(tab, ".trouble"), /job\.move\[1\].*would be long enough/);
    await tab.click("#reset");
    await checked(tab);
    assert.match(await text(tab, "#problems"), /^The scene is good\./);
    assert.equal(await tab.isVisible("#reset"), false);

    // Another working mode goes into the scene.
    await tab.click("#modes tr:first-child");
    await checked(tab);
    assert.deepEqual([...(await tab.inputValue("#text")).matchAll(/^elbow = (.*)$/gm)].map(([, sign]) => sign), ["1", "1", "1"]);
    assert.match(await text(tab, "#modes tr.own"), /^\+\+\+/);
    // A scene in a file goes the same way, and what is none says so.
    await tab.setInputFiles("#file", { name: "mine.toml", mimeType: "application/toml", buffer: Buffer.from(scene) });
    await checked(tab);
    assert.equal(await tab.inputValue("#text"), scene);
    await tab.setInputFiles("#file", { name: "plate.dxf", mimeType: "text/plain", buffer: Buffer.from("0") });
    await tab.waitForFunction(() => document.querySelector("#verdict").textContent.includes("plate.dxf is no scene"));

    // The job plays to its end.
    await tab.selectOption("#speed", "4");
    await tab.click("#play");
    await tab.waitForFunction(() => document.querySelector("#play").textContent === "Play" && document.querySelector("#time").value === document.querySelector("#time").max, undefined, { timeout: 20_000 });
}

/** Drops a file on the page, as a file manager does. */
async function drop(tab, name, content) {
    await tab.evaluate(([name, content]) => {
        const dataTransfer = new DataTransfer();
        dataTransfer.items.add(new File([content], name));
        document.querySelector("main").dispatchEvent(new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true }));
    }, [name, content]);
    await tab.waitForFunction((name) => document.querySelector("#show-job").textContent === name && !document.querySelector("#verdict").textContent.includes("checking"), name, { timeout: 60_000 });
    await checked(tab);
}

/** Jobs in files: G-code and a drawing, with their messages, and back to the scene. */
async function jobs(tab) {
    await choose(tab, "engraving");
    const scene = await tab.inputValue("#text");
    const plate = readFileSync(join(files, "plate.ngc"), "utf8");
    await drop(tab, "plate.ngc", plate);
    assert.equal(await tab.inputValue("#text"), plate);
    // Its zero is out of reach: the message stands beside the line of the program.
    assert.match(await text(tab, ".trouble"), /^\d+:1 /);
    assert.ok(await tab.isVisible(".breach"));
    await tab.fill("#inputs [name=x_mm]", "180");
    await tab.fill("#inputs [name=y_mm]", "245");
    await tab.waitForFunction(() => /^\d+ moves, /.test(document.querySelector("#verdict").textContent), undefined, { timeout: 60_000 });
    assert.equal(await text(tab, "#command"), "trirrr run plate.ngc --machine engraving.toml --origin 180,245");
    assert.match(await text(tab, "#problems"), /^The job has a plan\./);
    assert.equal(await tab.locator("#plots canvas").count(), 6);
    await tab.waitForTimeout(300);
    await shot(tab, "job", { fullPage: true });
    // A word that is not known, with line and column.
    await tab.fill("#text", plate.replace("G1 Y70", "G1 Q70"));
    await tab.waitForFunction(() => document.querySelector(".trouble"), undefined, { timeout: 60_000 });
    assert.match(await text(tab, ".trouble"), /^\d+:4 Q70: /);
    assert.equal(await tab.isDisabled("#play"), true);
    await shot(tab, "job-refused");
    await drop(tab, "badge.svg", readFileSync(join(files, "badge.svg"), "utf8"));
    assert.match(await text(tab, "#verdict"), /^\d+ moves, /);
    assert.match(await text(tab, "#problems"), /--fit: as --scale [0-9.]+ --origin [-0-9.]+,[-0-9.]+/);
    await shot(tab, "badge", { fullPage: true });
    const [download] = await Promise.all([tab.waitForEvent("download"), tab.click("#download")]);
    assert.equal(download.suggestedFilename(), "badge.svg");
    // Back to the scene, which is as it was.
    await tab.click("#close-job");
    assert.equal(await tab.inputValue("#text"), scene);
    await tab.waitForFunction(() => document.querySelector("#problems").textContent.startsWith("The scene is good."), undefined, { timeout: 60_000 });
}

/** A plant plays along: tracking errors, and its summary. */
async function plants(tab) {
    await choose(tab, "plant-thesis");
    await tab.waitForFunction(() => document.querySelectorAll("#plant-rows tr").length === 4, undefined, { timeout: 120_000 });
    assert.match(await text(tab, "#plant-words"), /^D is at most [0-9.]+ \u00b5m off its setpoint, at t = /);
    assert.equal(await tab.locator("#plots canvas").count(), 9);
    await tab.fill("#time", "50");
    assert.equal(await tab.locator("#drawing .measured polygon").count(), 1, "the machine is drawn where the plant has it");
    await tab.waitForTimeout(300);
    await shot(tab, "plant", { fullPage: true });
}

/** A machine in a file of its own: asked for, added, or dropped together with its scene. */
async function machines(tab) {
    await choose(tab, "plotter");
    const scene = (await tab.inputValue("#text")).replace(/^machine = .*$/m, 'machine = "own.toml"');
    const machine = await tab.evaluate(() => globalThis.trirrr.scenes.thesis);
    const file = (name, content) => ({ name, mimeType: "application/toml", buffer: Buffer.from(content) });
    await tab.setInputFiles("#file", file("one.toml", scene));
    await tab.waitForFunction(() => document.querySelector(".trouble")?.textContent.includes("own.toml"));
    assert.match(await text(tab, ".trouble"), /the page has no file own\.toml: open or drop own\.toml, too$/);
    await tab.setInputFiles("#file", file("own.toml", machine));
    await tab.waitForFunction(() => /^\d+ moves?, /.test(document.querySelector("#verdict").textContent), undefined, { timeout: 60_000 });
    assert.equal(await tab.inputValue("#text"), scene);
    const other = scene.replaceAll("own.toml", "other.toml");
    await tab.setInputFiles("#file", [file("other.toml", machine), file("two.toml", other)]);
    await tab.waitForFunction((text) => document.querySelector("#text").value === text, other);
    await tab.waitForFunction(() => /^\d+ moves?, /.test(document.querySelector("#verdict").textContent), undefined, { timeout: 60_000 });
}

/** A link opens the same scene, also one that is edited. */
async function share(tab) {
    const scene = (await tab.inputValue("#text")).replace(/^name = .*$/m, 'name = "shared_\u{2713}"').replace("\u{2713}", "by-link");
    await tab.fill("#text", scene);
    await checked(tab);
    await tab.click("#share");
    await tab.waitForFunction(() => location.hash.startsWith("#scene="));
    const link = tab.url();
    assert.equal(await tab.evaluate(() => navigator.clipboard.readText()), link);
    const other = await open(link);
    assert.equal(await other.inputValue("#text"), scene);
    assert.equal(await text(other, "#name"), "shared_by-link");
    const [download] = await Promise.all([other.waitForEvent("download"), other.click("#download")]);
    assert.equal(download.suggestedFilename(), "shared_by-link.toml");
    assert.equal(readFileSync(await download.path(), "utf8"), scene);
    await other.close();
    const damaged = await open(`${address}#scene=${link.split("=")[1].slice(9)}`);
    assert.match(await damaged.inputValue("#text"), /^# The link is damaged/);
    assert.match(await text(damaged, ".trouble"), /^1:1 /);
    await damaged.close();
    console.log(`link of ${link.length} characters opens the same scene`);
}

/** What the user has written survives another scene, a reload, and a slip of the hand; files are read as the command reads them. */
async function keeps() {
    const tab = await open(address);
    await choose(tab, "thesis");
    const scene = await tab.inputValue("#text");
    const edited = scene.replace(/^description = .*$/m, 'description = "mine"');
    assert.notEqual(edited, scene);
    await tab.fill("#text", edited);
    await checked(tab);
    await choose(tab, "chained");
    await choose(tab, "thesis");
    assert.equal(await tab.inputValue("#text"), edited, "after another scene");
    await tab.reload();
    await tab.waitForSelector("html[data-ready]");
    await checked(tab);
    assert.equal(await tab.inputValue("#text"), edited, "after a reload");
    await tab.click("#reset");
    assert.equal(await tab.inputValue("#text"), scene);
    await tab.focus("#text");
    await tab.keyboard.press("Control+z");
    assert.equal(await tab.inputValue("#text"), edited, "after the browser's undo");
    const refused = async (name, bytes, words) => {
        await tab.setInputFiles("#file", { name, mimeType: "text/plain", buffer: Buffer.from(bytes, "latin1") });
        await tab.waitForFunction((words) => document.querySelector("#verdict").textContent === words, words);
    };
    await refused("latin.toml", "a = 1\n# caf\xe9\n", "latin.toml: line 2: the line is no UTF-8");
    await refused("returns.toml", "a = 1\r\nb = 2\r\r\n", "returns.toml: line 2: the line has a line break in it");
    // G-code is read in letters of any form, and with any ends of lines.
    await tab.setInputFiles("#file", { name: "latin.nc", mimeType: "text/plain", buffer: Buffer.from("G21\r\r\n(caf\xe9)\rG0 X1", "latin1") });
    await tab.waitForFunction(() => document.querySelector("#text").value === "G21\n(caf\xe9)\nG0 X1");
    await tab.close();
}

/** Drags the platform around for two seconds; returns frames per second and the longest frame, ms. */
async function drag(tab) {
    const box = await (await tab.$(".platform .centre")).boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await tab.mouse.move(x, y);
    await tab.mouse.down();
    await tab.evaluate(() => {
        const times = [];
        const frame = (now) => {
            times.push(now);
            globalThis.frames_ = requestAnimationFrame(frame);
        };
        globalThis.times_ = times;
        requestAnimationFrame(frame);
    });
    const from = await inputs(tab);
    const begin = performance.now();
    let moved = 0;
    for (let angle = 0; performance.now() - begin < 2000; angle += 0.15, moved += 1) {
        await tab.mouse.move(x + 45 * Math.sin(angle), y + 45 * (1 - Math.cos(angle)));
    }
    const times = await tab.evaluate(() => {
        cancelAnimationFrame(globalThis.frames_);
        return globalThis.times_;
    });
    await shot(tab, "dragged");
    await tab.mouse.move(x + 40, y + 10);
    await tab.mouse.up();
    const to = await inputs(tab);
    assert.ok(Math.hypot(to[0] - from[0], to[1] - from[1]) > 5, "the platform follows the pointer");
    const spans = times.slice(1).map((time, index) => time - times[index]);
    const rate = (1000 * spans.length) / (times.at(-1) - times[0]);
    return { rate, longest: Math.max(...spans), moved };
}

/** Time that the core takes for a pose with its modes, ms. */
async function core(tab) {
    return tab.evaluate(() => {
        const { Reading, scenes } = globalThis.trirrr;
        const machine = Reading.draft(scenes.vertical, "vertical.toml", undefined).machine();
        const [x, y, alpha] = machine.start;
        const count = 300;
        const begin = performance.now();
        for (let index = 0; index < count; index += 1) {
            const state = Float64Array.of(x + index * 1e-5, y, alpha, 0.1, 0, 0, 1, 0, 0);
            const figures = machine.figures(state);
            machine.workingModes(state);
            machine.assemblies(figures.angles, state.subarray(0, 3));
        }
        return (performance.now() - begin) / count;
    });
}

/** No element sticks out of the page at this width. */
async function narrow(tab, width) {
    await tab.setViewportSize({ width, height: 780 });
    await tab.waitForTimeout(150);
    const wide = await tab.evaluate(() => {
        const most = document.documentElement.clientWidth;
        const inside = (element) => element.closest(".code, .hidden, svg, .u-wrap");
        const out = [...document.body.querySelectorAll("*")].filter((element) => !inside(element) && element.getBoundingClientRect().right > most + 0.5);
        return { scroll: document.documentElement.scrollWidth, most, out: out.map((element) => element.outerHTML.slice(0, 120)) };
    });
    assert.deepEqual(wide.out, [], `elements beyond the page at ${width} px`);
    assert.equal(wide.scroll, wide.most);
}

/** The bits of all jobs, against the native core. */
async function compare(tab) {
    const rows = readFileSync(bits, "utf8").trim().split("\n");
    const native = new Map(rows.map((row) => row.split(" ")));
    const scenes = await tab.evaluate(() => Object.keys(globalThis.trirrr.scenes).sort());
    assert.deepEqual(scenes, [...native.keys()].sort(), "both have the same scenes");
    for (const name of scenes) {
        const here = await tab.evaluate(([name, ticks]) => {
            const { bitsOf, machineFile, scenes } = globalThis.trirrr;
            const machine = machineFile(scenes[name])?.replace(/\.toml$/, "");
            return bitsOf(scenes[name], `${name}.toml`, machine && scenes[machine], ticks);
        }, [name, Number(ticks)]);
        assert.equal(here, native.get(name), `${name}: bits in WebAssembly and native`);
    }
    console.log(`${scenes.length} scenes, ${scenes.length * Number(ticks)} ticks: the bits of the native core`);
}

let failed = true;
try {
    const tab = await open(address);
    const paint = await tab.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime ?? Infinity);
    const usable = await tab.evaluate(() => performance.now());
    await shot(tab, "light", { fullPage: true });
    await actions(tab);
    const pose = await core(tab);
    const { rate, longest, moved } = await drag(tab);
    await jobs(tab);
    await plants(tab);
    await machines(tab);
    await choose(tab, "vertical");
    await share(tab);
    await keeps();
    await compare(tab);
    // Every shipped scene is read, and played; from a file, as the page is shipped.
    const other = await open(pathToFileURL(file).href, "dark");
    for (const name of await other.$$eval("#scenes option", (options) => options.map((option) => option.value))) {
        await choose(other, name);
        assert.match(await text(other, "#verdict"), /^\d+ moves?, /, name);
    }
    await choose(other, "engraving");
    await other.waitForTimeout(300);
    await shot(other, "dark", { fullPage: true });
    for (const width of [768, 360]) {
        await narrow(other, width);
        await shot(other, `dark-${width}`, { fullPage: true });
    }
    await other.emulateMedia({ colorScheme: "light" });
    await shot(other, "light-360", { fullPage: true });
    assert.deepEqual(faults, []);
    console.log(`first paint ${paint.toFixed(0)} ms, ready ${usable.toFixed(0)} ms; ${rate.toFixed(1)} frames/s while dragging, longest ${longest.toFixed(0)} ms, ${moved} moves of the pointer; ${pose.toFixed(2)} ms for a pose with all its modes`);
    assert.ok(paint <= PAINT_MAX, `first paint after ${paint} ms, at most ${PAINT_MAX} are allowed`);
    assert.ok(rate >= FRAMES_MIN, `${rate} frames/s, at least ${FRAMES_MIN} are asked for`);
    failed = false;
} finally {
    if (failed && faults.length > 0) console.error(faults.join("\n"));
    await close();
    server.close();
}
