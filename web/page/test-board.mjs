// The page and a board, in a headless Chromium: node test-board.mjs PAGE.html TRIRRR SCENES SHOTS
// TRIRRR is the program: `trirrr device` is the board, behind `trirrr ui`. Screenshots go to SHOTS. Run by `cargo xtask page`.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { createInterface } from "node:readline";
import { launch } from "./browser.mjs";

const [file, trirrr, scenes, shots] = process.argv.slice(2);

/** Longest wait for anything that a machine does, ms: others may use the computer. */
const LONG = 60_000;

/** Host timeout of the board that a page leaves, and duration of its job, s. */
const SILENCE_S = 2.5;
const JOB_S = 7;

const folder = mkdtempSync(join(tmpdir(), "trirrr-board-"));
const programs = [];

/** A shipped scene, with patience for a host on a computer that others use, too. */
const scene = (name, silence) => {
    const text = readFileSync(join(scenes, name), "utf8");
    assert.doesNotMatch(text, /^\[service\]/m);
    return text.replace("[job]", `[service]\nsilence_timeout_s = ${silence.toFixed(1)}\n\n[job]`);
};

/** Starts the program, and waits for a line that `pattern` finds. */
async function start(pattern, ...words) {
    const child = spawn(trirrr, words, { cwd: folder, stdio: ["ignore", "pipe", "inherit"] });
    programs.push(child);
    const lines = [];
    const said = await new Promise((resolve, reject) => {
        child.on("exit", (code) => reject(new Error(`trirrr ${words[0]} ended with ${code}`)));
        createInterface({ input: child.stdout }).on("line", (line) => {
            lines.push(line);
            const found = pattern.exec(line);
            if (found) resolve(found[1]);
        });
    });
    return { said, lines, child };
}

/** A board of the scene in `text`, with the page that may connect to it. */
async function board(name, text) {
    writeFileSync(join(folder, name), text);
    const device = await start(/^tcp:(\S+) plays/, "device", name, "--listen", "tcp:127.0.0.1:0", "--watch", "tcp:127.0.0.1:0");
    const watched = device.lines.concat(await rest(device)).map((line) => /watch\S*\D*tcp:(\S+)|tcp:(\S+) .*watch/.exec(line)).find(Boolean);
    const { said } = await start(/open (http:\S+) /, "ui", name, "--port", "0", "--page", file, "--board", `tcp:${device.said}`);
    return { address: said, watched: watched?.[1] ?? watched?.[2], device };
}

/** Lines that come within a moment. */
const rest = ({ lines }) => new Promise((resolve) => setTimeout(() => resolve(lines), 200));

const { context, close } = await launch();
const faults = [];

async function open(url) {
    const tab = await context.newPage();
    tab.on("pageerror", (error) => faults.push(String(error)));
    await tab.goto(url);
    await tab.waitForSelector("html[data-ready]");
    await tab.waitForFunction(() => !document.querySelector("#verdict").textContent.includes("checking"), undefined, { timeout: LONG });
    return tab;
}

const text = (tab, selector) => tab.textContent(selector);
const state = (tab, words) => tab.waitForFunction((words) => document.querySelector("#board-state").textContent.startsWith(words), words, { timeout: LONG });
const logged = (tab, words) => tab.waitForFunction((words) => document.querySelector("#board-log").textContent.includes(words), words, { timeout: LONG });
const usable = (tab, id) => tab.waitForFunction((id) => document.getElementById(id).getAttribute("aria-disabled") === "false", id, { timeout: LONG });
const place = async (tab) => [...(await text(tab, "#board-pose")).matchAll(/[\u2212-]?\d+(\.\d+)?/g)].map(([value]) => Number(value.replace("\u2212", "-")));
const stands = (tab, x, y) =>
    tab.waitForFunction(
        ([x, y]) => {
            const [px, py] = [...document.querySelector("#board-pose").textContent.matchAll(/(\d+\.?\d*) mm/g)].map((found) => Number(found[1]));
            return Math.abs(px - x) < 0.02 && Math.abs(py - y) < 0.02;
        },
        [x, y],
        { timeout: LONG },
    );

/** The last pose that a watcher sees: not through the page. */
async function seen(port) {
    const { child, lines } = await start(/"pose":\[/, "watch", "--port", `tcp:${port}`, "--json");
    child.removeAllListeners("exit");
    child.kill();
    return JSON.parse(lines.findLast((line) => line.includes('"pose":['))).pose;
}

async function bySocket() {
    const given = scene("plant-odrive.toml", SILENCE_S).replace("duration_s = 1.0", `duration_s = ${JOB_S}.0`);
    const { address, watched } = await board("short.toml", given);
    const tab = await open(address);
    await tab.click("#connect-served");
    await state(tab, "disabled");
    await logged(tab, "connected: scene plant-odrive in f32, 500 ticks per second");
    // Connecting switches nothing on, and buttons out of use say why.
    await tab.waitForTimeout(300);
    assert.equal(await text(tab, "#board-state"), "disabled");
    assert.equal(await tab.getAttribute("#run", "title"), "the drives are off: enable them first");
    // Playwright waits for a button that is in use.
    await tab.click("#run", { force: true });
    await logged(tab, "Run job: the drives are off: enable them first");
    assert.equal(await text(tab, "#board-state"), "disabled");

    // A second page does not get the board.
    const other = await open(address);
    await other.click("#connect-served");
    await state(other, "the line is lost: another page has the board");
    await other.close();

    await tab.click("#enable");
    await state(tab, "idle");
    await stands(tab, 210, 220);
    // A step by hand, from the keyboard.
    await tab.selectOption("#step-mm", "10");
    await usable(tab, "step-right");
    await tab.focus("#step-right");
    await tab.keyboard.press("Enter");
    await stands(tab, 220, 220);
    await usable(tab, "run");

    // The job: back to its start first, then held by the key, and resumed.
    await tab.click("#run");
    await logged(tab, "the machine goes to the start of the job first");
    await state(tab, "running");
    await tab.waitForFunction(() => Number(/x ([\d.]+) mm/.exec(document.querySelector("#board-pose").textContent)[1]) > 225, undefined, { timeout: LONG });
    await tab.keyboard.press("Escape");
    await state(tab, "holding (hold)");
    assert.equal(await tab.locator("#drawing .measured polygon").count(), 1, "the measured machine is drawn");
    assert.equal(await tab.locator("#live-plots canvas").count(), 3);
    // The last samples come behind the state.
    await tab.waitForTimeout(300);
    const [held] = await place(tab);
    assert.ok(held > 212 && held < 279, `held on the way, at ${held}`);
    // Once more: the job is not lost.
    await tab.keyboard.press("Escape");
    await tab.waitForTimeout(300);
    await tab.screenshot({ path: join(shots, "board.png") });
    assert.equal((await place(tab))[0], held);

    // The page goes, and comes back: the job goes on at the place.
    await tab.reload();
    await tab.waitForSelector("html[data-ready]");
    await tab.waitForFunction(() => / ticks at /.test(document.querySelector("#verdict").textContent), undefined, { timeout: LONG });
    await tab.click("#connect-served");
    await state(tab, "holding");
    await tab.click("#resume");
    await state(tab, "running");
    await logged(tab, "the job is played to its end");
    await stands(tab, 280, 280);
    const [x, y, alpha] = await seen(watched);
    assert.ok(Math.hypot(x - 0.28, y - 0.28) < 1e-6 && Math.abs(alpha - 0.20943951) < 1e-6, `${x} ${y} ${alpha}`);

    // A page that goes while the machine moves leaves it to the host timeout.
    await tab.click("#run");
    for (const [least, most] of [[209, 210.5], [213, 220]]) {
        const isThere = ([least, most]) => {
            const x = Number(/x ([\d.]+) mm/.exec(document.querySelector("#board-pose").textContent)[1]);
            return least < x && x < most;
        };
        await tab.waitForFunction(isThere, [least, most], { timeout: LONG });
    }
    await tab.click("#disconnect");
    await tab.waitForTimeout(1000 * SILENCE_S + 1000);
    await tab.click("#connect-served");
    await state(tab, "holding (host silent)");
    await tab.click("#abort");
    await state(tab, "idle");
    await tab.click("#disable");
    await state(tab, "disabled");

    // The scene is that of the board while it is connected; another one is none for it.
    assert.equal(await tab.$eval("#text", (field) => field.readOnly), true);
    await tab.click("#disconnect");
    assert.equal(await text(tab, "#board-state"), "disconnected");
    await tab.fill("#text", given.replace("mass_kg = 0.5", "mass_kg = 0.6"));
    await tab.waitForTimeout(500);
    await tab.waitForFunction(() => / ticks at /.test(document.querySelector("#verdict").textContent), undefined, { timeout: LONG });
    await tab.click("#connect-served");
    await state(tab, "the board was built from another version of the scene plant-odrive");
    // A scene for another number type says which.
    await tab.fill("#text", given.replace('number = "f32"', 'number = "f64"'));
    await tab.waitForTimeout(500);
    await tab.waitForFunction(() => / in f64/.test(document.querySelector("#verdict").textContent), undefined, { timeout: LONG });
    await tab.click("#connect-served");
    await state(tab, "the board computes in f32, the scene in f64");
    await tab.close();
    return address;
}

/** Web Serial of a browser that has a port: its streams are those of the WebSocket. */
function serial() {
    const requests = [];
    const serial = {
        async requestPort() {
            const port = { readable: null, writable: null };
            port.open = async (options) => {
                requests.push(options);
                const socket = new WebSocket(new URL("board", location.href.replace(/^http/, "ws")));
                socket.binaryType = "arraybuffer";
                await new Promise((resolve, reject) => {
                    socket.onopen = resolve;
                    socket.onerror = reject;
                });
                port.readable = new ReadableStream({
                    start: (stream) => {
                        socket.onmessage = ({ data }) => stream.enqueue(new Uint8Array(data));
                        socket.onclose = () => {
                            port.readable = null;
                            stream.error(new DOMException("The device has been lost.", "NetworkError"));
                        };
                    },
                    cancel: () => socket.close(),
                });
                port.writable = new WritableStream({ write: (bytes) => socket.send(bytes) });
                globalThis.pull_ = () => socket.close();
            };
            port.close = async () => {
                globalThis.closed_ = true;
            };
            return port;
        },
    };
    Object.defineProperty(navigator, "serial", { value: serial, configurable: true });
    globalThis.requests_ = requests;
}

async function bySerial() {
    // Motors of this scene look for their switches first; it computes in fixed point, in units of its own.
    const { address } = await board("home.toml", scene("pick-home.toml", 10));
    await context.addInitScript(serial);
    const tab = await open(address);
    await tab.click("#connect-serial");
    await state(tab, "disabled");
    assert.deepEqual(await tab.evaluate(() => globalThis.requests_), [{ baudRate: 921600, bufferSize: 65536 }]);
    await tab.click("#enable");
    await state(tab, "not homed");
    assert.equal(await tab.getAttribute("#step-up", "title"), "the machine does not know where its motors are: home it first");
    await tab.click("#home");
    await state(tab, "homing");
    await state(tab, "idle");
    assert.equal(await tab.locator("#drawing .measured polygon").count(), 0, "steppers measure nothing");
    await tab.click("#run");
    await logged(tab, "the job is played to its end");
    // Phone, in the dark.
    await tab.emulateMedia({ colorScheme: "dark" });
    await tab.setViewportSize({ width: 360, height: 780 });
    // The curves take their new width a frame later.
    await tab.waitForFunction(() => document.documentElement.scrollWidth === 360, undefined, { timeout: 10_000 });
    await tab.screenshot({ path: join(shots, "board-360.png"), fullPage: true });
    // The cable is pulled.
    await tab.evaluate(() => globalThis.pull_());
    await state(tab, "the line is lost: The device has been lost.");
    await tab.waitForFunction(() => globalThis.closed_ === true);
    // In view, in red, until the user has seen it.
    assert.equal(await text(tab, "#halt-state"), "the line is lost: The device has been lost.");
    assert.ok(await tab.$eval("#halt-state", (chip) => chip.classList.contains("bad")));
    assert.ok(await tab.isVisible("#lost-seen"));
    assert.equal(await tab.isVisible("#halt"), false);
    assert.ok(await tab.$eval("#drawing", (drawing) => drawing.classList.contains("lost")));
    await tab.click("#lost-seen");
    assert.equal(await tab.isVisible("#halt-bar"), false);
    assert.equal(await tab.$eval("#drawing", (drawing) => drawing.classList.contains("lost")), false);
    await tab.click("#connect-serial");
    await state(tab, "idle");
    await tab.click("#disconnect");
    assert.equal(await text(tab, "#board-state"), "disconnected");
    await tab.close();
}

/** A page of another origin, in the same browser. */
async function hostile(address) {
    const tab = await context.newPage();
    await tab.goto("data:text/html,<title>another</title>");
    const end = await tab.evaluate((url) => {
        const socket = new WebSocket(url);
        return new Promise((resolve) => {
            socket.onopen = () => resolve("open");
            socket.onerror = () => resolve("refused");
        });
    }, `${address.replace(/^http/, "ws")}board`);
    assert.equal(end, "refused");
    await tab.close();
}

let failed = true;
try {
    const begin = performance.now();
    const address = await bySocket();
    await hostile(address);
    await bySerial();
    assert.deepEqual(faults, []);
    console.log(`board: jobs by WebSocket and by Web Serial, held, resumed, aborted, in ${((performance.now() - begin) / 1000).toFixed(0)} s`);
    failed = false;
} finally {
    if (failed) {
        if (faults.length > 0) console.error(faults.join("\n"));
        for (const tab of context.pages()) {
            console.error(await tab.textContent("#board-state").catch(() => ""), await tab.textContent("#board-log").catch(() => ""));
            await tab.screenshot({ path: join(shots, "board-failed.png") }).catch(() => undefined);
        }
    }
    for (const program of programs) {
        program.removeAllListeners("exit");
        program.kill();
    }
    await close();
    rmSync(folder, { recursive: true, force: true });
}
