#!/usr/bin/env node
// Executes the flashed image of the RP2040 on rp2040js, plays its job by `trirrr stream`, and checks its pins.
//
// Arguments: the folder with `node_modules/rp2040js`, a file of settings that `cargo xtask rp2040 --run` writes, and a case, or none for all. Prints a line for each
// figure; ends with 1 at the first that is out of bounds.
"use strict";

const { spawn } = require("node:child_process");
const fs = require("node:fs");
const net = require("node:net");
const path = require("node:path");
const { Board } = require("./board.js");
const { UsbHost } = require("./usb.js");

const [folder, settingsFile, only] = process.argv.slice(2);
const library = require(path.join(path.resolve(folder), "node_modules", "rp2040js"));
const settings = JSON.parse(fs.readFileSync(settingsFile, "utf8"));
const MS = 1e6;
// IO_BANK0 and PADS_BANK0 in RESETS.
const PORTS = (1 << 5) | (1 << 8);
// All parts that the watchdog resets, but both oscillators, in PSM_WDSEL.
const PARTS = 0x1fffc;
// As in `rp2040.x`: the stack is the first 32 KiB of the RAM.
const STACK = 0x8000;
// Bytes that wait for the background, and their time at 921,600 baud (`firmware/boards/rp2040/src/uart.rs`).
const QUEUE = 1023;
const QUEUE_MS = (QUEUE * 10) / 921.6;
// Longest time without the slots, beyond their own.
const MASKED_US = 1;
const STACK_TOP = 0x2000_0000 + STACK;

function figure(name, measured, bound, holds) {
  console.log(`${name.padEnd(72)} ${String(measured).padStart(12)}   ${bound}`);
  if (!holds) {
    console.error(`rp2040: ${name}: ${measured}, asked ${bound}`);
    process.exit(1);
  }
}

const outputs = () => [
  ...settings.step.map((pin, index) => ({ name: `step ${index + 1}`, pin, on: true })),
  { name: "enable", pin: settings.enable, on: settings.enableHigh },
  { name: "tool", pin: settings.tool, on: settings.toolHigh },
];

/** Outputs that were on in any of the board's edges. */
function everOn(board) {
  const on = ({ pin, on }) => board.edges[pin].some((edge) => edge.level === on);
  return outputs().filter(on).map(({ name }) => name);
}

function powerUp() {
  const board = new Board(library, settings.image);
  board.run(200 * MS);
  const on = everOn(board);
  figure("power-up: outputs that were on within 200 ms, without a host", on.join(", ") || "none", "none", !on.length);
  figure("power-up: bytes in the log", board.logged, "> 0", board.logged > 0);
  const baud = board.rp.uart[0].baudRate;
  figure("line: baud rate", baud, "921600 ± 1 %", Math.abs(baud / 921_600 - 1) <= 0.01);
}

/** A board; with a host at its USB plug. */
function boardOf(image, hasUsb) {
  const board = new Board(library, image);
  if (hasUsb) board.host = new UsbHost(board);
  return board;
}

/** Plays the job by the program. The board goes on until the program ends; or until `until` says so, whatever the program does. */
function play(image, out, { until, hasUsb = false } = {}) {
  const board = boardOf(image, hasUsb);
  return new Promise((resolve) => {
    let said = "";
    let over = false;
    const finish = (code) => {
      over = true;
      server.close();
      resolve({ board, code, said });
    };
    const server = net.createServer((socket) => {
      socket.setNoDelay(true);
      socket.on("data", (bytes) => board.toBoard.push(...bytes));
      socket.on("error", () => {});
      board.host?.open();
      board.onByte = (byte) => socket.write(Buffer.of(byte));
    });
    server.listen(0, "127.0.0.1", () => {
      const port = `tcp:127.0.0.1:${server.address().port}`;
      const client = spawn(settings.trirrr, ["stream", settings.scene, "--port", port, "--out", out]);
      client.stdout.on("data", (text) => (said += text));
      client.stderr.on("data", (text) => (said += text));
      if (!until) client.on("exit", finish);
      const step = () => {
        if (over) return;
        board.run(MS);
        // The start of the program has no interrupts.
        board.watches ||= board.edges[settings.step[0]].length > 1;
        if (board.resetNs !== undefined || until?.(board)) {
          client.removeListener("exit", finish);
          client.kill();
          finish(null);
          return;
        }
        setImmediate(step);
      };
      step();
    });
  });
}

/** Rows of the table that the program has written: columns by name. */
function table(file) {
  const [names, ...rows] = fs.readFileSync(file, "utf8").trim().split("\n").map((row) => row.split(","));
  return rows.map((row) => Object.fromEntries(row.map((cell, index) => [names[index], Number(cell)])));
}

/** Pulses of a motor: time, and +1 or -1 by the level of the direction. */
function pulses(board, motor) {
  const directions = board.edges[settings.direction[motor]];
  const forward = !settings.reversed[motor];
  let next = 0;
  let level;
  return board.edges[settings.step[motor]]
    .filter((edge) => edge.level === true)
    .map(({ ns }) => {
      while (directions[next]?.ns <= ns) level = directions[next++].level;
      return { ns, by: level === forward ? 1 : -1 };
    });
}

/** Shortest times of high, low, and of the direction before and behind a step, in us. */
function shortest(board, motor) {
  const steps = board.edges[settings.step[motor]].filter((edge) => edge.level !== undefined);
  const directions = board.edges[settings.direction[motor]];
  const widths = steps.slice(1).map((edge, index) => [steps[index].level, (edge.ns - steps[index].ns) / 1e3]);
  const least = (level) => Math.min(...widths.filter(([of]) => of === level).map(([, us]) => us));
  const rises = steps.filter((edge) => edge.level).map((edge) => edge.ns);
  let [setup, hold] = [Infinity, Infinity];
  for (const { ns } of directions) {
    const after = rises.find((rise) => rise >= ns);
    const before = rises.findLast((rise) => rise < ns);
    if (after !== undefined) setup = Math.min(setup, (after - ns) / 1e3);
    if (before !== undefined) hold = Math.min(hold, (ns - before) / 1e3);
  }
  return [
    ["step high", least(true)],
    ["step low", least(false)],
    ["direction before a step", setup],
    ["direction behind a step", hold],
  ];
}

/** The greatest distance of a motor's position at the ticks from its angle, in microsteps, where the job begins at `from` ns. */
function farthest(rows, moved, motor, from) {
  const angle = (row) => row[`th1_${motor + 1}`] * settings.microstepsPerRad[motor];
  const origin = angle(rows[0]);
  let [next, position, worst] = [0, 0, 0];
  rows.forEach((row, tick) => {
    // The motors reach the angles of a tick at the next one.
    const at = from + (tick + 1) * settings.tickS * 1e9;
    while (moved[next]?.ns <= at) position += moved[next++].by;
    worst = Math.max(worst, Math.abs(position - (angle(row) - origin)));
  });
  return worst;
}

function checkMotion(board, rows) {
  const moved = [0, 1, 2].map((motor) => pulses(board, motor));
  const first = Math.min(...moved.map(([pulse]) => pulse?.ns ?? Infinity));
  const tickNs = settings.tickS * 1e9;
  // The line between board and program does not say when a tick was: the beginning of the job that fits best, in tenths of a tick.
  const beginnings = Array.from({ length: 400 }, (_, index) => first - index * 0.1 * tickNs);
  const worst = (from) => Math.max(...moved.map((of, motor) => farthest(rows, of, motor, from)));
  const best = beginnings.map(worst).reduce((least, one) => Math.min(least, one));
  figure("job: a motor off its angle at any tick by at most, microsteps", best.toFixed(2), "≤ 1", best <= 1);
  moved.forEach((of, motor) => {
    const angle = (row) => row[`th1_${motor + 1}`] * settings.microstepsPerRad[motor];
    const asked = Math.max(...rows.map(angle)) - Math.min(...rows.map(angle));
    figure(`job: motor ${motor + 1}: pulses, against the microsteps between its extremes`, of.length, `≥ ${Math.floor(asked) - 1}`, of.length >= asked - 2);
    for (const [name, us] of shortest(board, motor)) {
      figure(`job: motor ${motor + 1}: ${name}, shortest, µs`, us.toFixed(2), `≥ ${settings.leastUs.toFixed(2)}`, us >= settings.leastUs);
    }
  });
  const enabled = board.edges[settings.enable].find((edge) => edge.level === settings.enableHigh)?.ns;
  figure("job: enable before the first step, ms", ((first - enabled) / MS).toFixed(2), "≥ 0", first >= enabled);
}

function checkTool(board, rows) {
  const changes = rows.slice(1).filter((row, index) => row.tool > 0 !== rows[index].tool > 0).length;
  const edges = board.edges[settings.tool].filter((edge) => edge.level !== undefined).slice(1);
  figure("job: changes of the tool's pin, against those of its power", edges.length, changes, edges.length === changes);
}

async function job(image, hasUsb) {
  const out = path.join(folder, "streamed");
  fs.rmSync(out, { recursive: true, force: true });
  const { board, code, said } = await play(image, out, { hasUsb });
  if (code !== 0) {
    console.error(said);
  }
  const rows = code === 0 ? table(path.join(out, "ticks.csv")) : [];
  figure("job: ticks in the table of trirrr stream", rows.length, settings.ticks, rows.length === settings.ticks);
  checkMotion(board, rows);
  checkTool(board, rows);
  const longest = /longest took ([0-9.]+)/.exec(said)?.[1];
  figure("job: longest tick, µs", longest, `< ${settings.tickS * 1e6}`, longest < settings.tickS * 1e6);
  const awayMs = board.longestAwayNs / MS;
  figure("job: longest time from one look at the line to the next, ms", awayMs.toFixed(2), `< ${QUEUE_MS.toFixed(2)}`, awayMs > 0 && awayMs < QUEUE_MS);
  return board;
}

/** Hangs the tick in mid-move: no interrupt comes any more. */
async function hang() {
  let hungNs;
  const moving = (board) => {
    if (hungNs === undefined && board.edges[settings.step[0]].length > 100) {
      hungNs = board.ns;
      board.rp.core.enabledInterrupts = 0;
      board.rp.core.pendingSystick = false;
      board.rp.ppb.systickTimer.enable = false;
    }
    return hungNs !== undefined && board.ns > hungNs + 1e9;
  };
  const { board } = await play(settings.image, path.join(folder, "hung"), { until: moving });
  const after = ((board.resetNs ?? Infinity) - hungNs) / MS;
  const bound = settings.watchdogS * 1e3 + 2 * settings.tickS * 1e3;
  figure("hung tick: the watchdog resets the chip after, ms", after.toFixed(1), `≤ ${bound}`, after <= bound);
  const reset = board.resetParts & PARTS;
  figure("hung tick: parts of the chip that it resets", `0x${reset.toString(16)}`, "all but the oscillators", reset === PARTS);
}

/** The crystal stops in mid-move, and the PLL goes on at a part of its clock: every tick seems to be in time. */
async function freeRun(part) {
  let sinceNs;
  const moving = (board) => {
    if (sinceNs === undefined && board.edges[settings.step[0]].length > 100) {
      sinceNs = board.ns;
      board.runFree(part);
    }
    return sinceNs !== undefined && board.ns > sinceNs + 2e9;
  };
  const { board } = await play(settings.image, path.join(folder, "slow"), { until: moving });
  const after = ((board.resetNs ?? Infinity) - sinceNs) / MS;
  // It may be fed once more, after ticks that were counted before.
  const bound = 2 * settings.watchdogS * 1e3;
  figure(`free-run: core ${part} times too slow: the watchdog resets the chip after, ms`, after.toFixed(1), `≤ ${bound}`, after <= bound);
}

/** An image that panics in its 50th tick. */
async function panic() {
  const board = new Board(library, settings.panicking);
  board.run(1000 * MS);
  figure("panic: the chip is reset after its start, ms", ((board.resetNs ?? Infinity) / MS).toFixed(1), "≤ 1000", board.resetNs !== undefined);
  figure("panic: ports in reset before that", (board.inReset & PORTS) === PORTS, "true", (board.inReset & PORTS) === PORTS);
}

/** The board at a host without a program. */
function plugIn() {
  const board = boardOf(settings.overUsb, true);
  board.run(300 * MS);
  const { device, configuredNs, wrongToggles } = board.host;
  figure("usb: enumerated after its start, ms", ((configuredNs ?? Infinity) / MS).toFixed(1), "≤ 150", configuredNs <= 150 * MS);
  figure("usb: the address that the host gave", device.address, 7, device.address === 7);
  figure("usb: manufacturer, product, serial number", device.texts.join(", "), "trirrr, trirrr, ", device.texts.join() === "trirrr,trirrr,");
  figure("usb: packets out of turn", wrongToggles, 0, wrongToggles === 0);
  const on = everOn(board);
  figure("usb: outputs that were on within 300 ms, without a program", on.join(", ") || "none", "none", !on.length);
}

/** Time of the last step before `until`, from `since` on, ms, and the number of these steps. */
function lastStep(board, since, until = Infinity) {
  const edges = settings.step.flatMap((pin) => board.edges[pin]).filter(({ level, ns }) => level && ns < until);
  return [(Math.max(...edges.map(({ ns }) => ns)) - since) / MS, edges.length];
}

/** Breaks the line by `cut` in mid-move: the machine comes to rest on its path, and the board goes on. `mend` follows. Returns the board. */
async function breakOff(name, cut, mend) {
  const bound = (settings.silenceS + settings.holdRampS + 3 * settings.tickS) * 1e3;
  let cutNs;
  let mendNs;
  let seen = 0;
  const broken = (board) => {
    if (cutNs === undefined && board.edges[settings.step[0]].length > 100) {
      cutNs = board.ns;
      cut(board);
    }
    // Long after the job would have ended.
    if (mendNs === undefined && board.ns > cutNs + (bound + 1500) * MS) {
      mendNs = board.ns;
      board.onByte = () => seen++;
      mend(board);
    }
    return board.ns > mendNs + 400 * MS;
  };
  const { board } = await play(settings.overUsb, path.join(folder, "broken"), { until: broken, hasUsb: true });
  // A client that still waits when the line is mended resumes the job.
  const [last, count] = lastStep(board, cutNs, mendNs);
  figure(`usb: ${name}: the last step after, ms`, last.toFixed(1), `≤ ${bound.toFixed(1)}`, last <= bound);
  figure(`usb: ${name}: steps, of those of the job`, count, `< ${jobSteps}`, count < jobSteps);
  figure(`usb: ${name}: the board is reset`, board.resetNs !== undefined, false, board.resetNs === undefined);
  figure(`usb: ${name}: bytes once it is mended`, seen, "> 0", seen > 0);
  return board;
}

/** Steps of the whole job. */
let jobSteps = 0;

/** The controller hangs in mid-move, as by erratum RP2040-E15: no frame is counted, and nothing tells that the bus rests. */
function hangUsb() {
  const board = boardOf(settings.overUsb, true);
  board.run(300 * MS);
  const { host } = board;
  const sinceNs = board.ns;
  host.hang();
  board.run(1000 * MS);
  const goneMs = ((host.goneNs ?? Infinity) - sinceNs) / MS;
  figure("usb: the controller hangs: reset after, ms", goneMs.toFixed(1), "≤ 250", goneMs <= 250);
  const anewMs = (host.configuredNs - sinceNs) / MS;
  figure("usb: the controller hangs: enumerated anew after, ms", anewMs.toFixed(1), "≤ 500", anewMs > 0 && anewMs <= 500);
  figure("usb: the controller hangs: the board is reset", board.resetNs !== undefined, false, board.resetNs === undefined);
}

async function usb() {
  plugIn();
  hangUsb();
  const played = await job(settings.overUsb, true);
  jobSteps = lastStep(played, 0)[1];
  figure("usb: packets out of turn", played.host.wrongToggles, 0, played.host.wrongToggles === 0);
  const pulled = await breakOff(
    "cable pulled in mid-move",
    ({ host }) => host.unplug(),
    ({ host }) => host.plugIn(),
  );
  const stopped = await breakOff(
    "a program that stops in mid-move",
    ({ host }) => host.stop(true),
    ({ host }) => host.stop(false),
  );
  const boards = [played, pulled, stopped];
  const masked = Math.max(...boards.map((board) => board.longestMaskedNs)) / 1e3;
  figure("usb: longest time without interrupts, µs", masked.toFixed(2), `≤ ${MASKED_US}`, masked <= MASKED_US);
  const stack = STACK_TOP - Math.min(...boards.map((board) => board.lowestStack));
  figure("usb: bytes of the stack in use at most", stack, `≤ ${STACK / 2}`, stack <= STACK / 2);
}

(async () => {
  const freeRuns = async () => {
    for (const part of [4, 24]) await freeRun(part);
  };
  const cases = { "power-up": powerUp, job: () => job(settings.image, false), "hung-tick": hang, "free-run": freeRuns, panic, usb };
  for (const [name, run] of Object.entries(cases)) {
    if (!only || only === name) await run();
  }
})();
