#!/usr/bin/env node
// Drives `trirrr grbl` by cncjs, without its page: connect, unlock, home, jog, run a file, hold, resume, abort.
//
// Needs `npm install cncjs`. Arguments: the folder with its `node_modules`, and the program `trirrr`. Prints what cncjs saw; ends with 1
// at the first surprise.
"use strict";

const { spawn } = require("node:child_process");
const fs = require("node:fs");
const net = require("node:net");
const os = require("node:os");
const path = require("node:path");

const SCENE = path.join(__dirname, "..", "..", "scenes", "engraving.toml");
const PATIENCE_MS = 60_000;
const [folder, trirrr] = process.argv.slice(2);
const modules = path.join(path.resolve(folder), "node_modules");
const connect = require(path.join(modules, "socket.io-client"));

const children = [];
// The user's own settings are left alone: neither read nor written.
const home = fs.mkdtempSync(path.join(os.tmpdir(), "cncjs-"));
const said = [];
let machine = {};
let workflow = "idle";
let sender = {};
let socket;

function end(failure) {
  children.forEach((child) => child.kill());
  fs.rmSync(home, { recursive: true, force: true });
  if (failure) {
    console.error(`cncjs: ${failure}; state ${state()}, place ${place()}, ${said.slice(-20).join(" | ")}`);
    process.exit(1);
  }
  console.log("cncjs: good");
  process.exit(0);
}

const state = () => machine.status?.activeState;
const place = () => ["x", "y"].map((axis) => Number(machine.status?.mpos?.[axis]));
const sleep = (ms) => new Promise((done) => setTimeout(done, ms));

async function until(what, wanted) {
  const last = Date.now() + PATIENCE_MS;
  while (!wanted()) {
    if (Date.now() > last) end(`no ${what}`);
    await sleep(20);
  }
  console.log(`${what}: ${state()} at ${place()}`);
}

// Six polls: the state before may be one that is over.
async function idle(what) {
  await sleep(1500);
  await until(what, () => state() === "Idle");
}

function near(where) {
  const off = Math.hypot(...place().map((value, axis) => value - where[axis]));
  if (!(off < 0.01)) end(`at ${place()}, and not at ${where}`);
}

function freePort() {
  return new Promise((done) => {
    const server = net.createServer().listen(0, "127.0.0.1", () => {
      const { port } = server.address();
      server.close(() => done(port));
    });
  });
}

// First line that `child` prints.
function firstLine(child) {
  return new Promise((done) => {
    let text = "";
    child.stdout.on("data", (data) => {
      text += data;
      if (text.includes("\n")) done(text.split("\n")[0]);
    });
  });
}

async function signIn(address) {
  const last = Date.now() + PATIENCE_MS;
  for (;;) {
    try {
      const answer = await fetch(`${address}/api/signin`, { method: "POST" });
      return (await answer.json()).token;
    } catch (error) {
      if (Date.now() > last) end(`its server does not answer: ${error}`);
      await sleep(100);
    }
  }
}

async function run(port) {
  const command = (...words) => socket.emit("command", port, ...words);
  const start = [250, 245];
  await until("report", () => state() === "Alarm");
  command("unlock");
  await idle("unlocked");
  near(start);
  command("homing");
  await idle("home");
  command("gcode", "$J=G91 X5 F1200");
  await idle("jogged");
  near([255, 245]);

  // A file: a square, with the laser on.
  const square = "G21 G91\nM4 S500\nG1 X20 F1200\nG1 Y20\nG1 X-20\nG1 Y-20\nM5\nG90\n";
  command("gcode:load", "square.ngc", square);
  await until("loaded", () => sender.name === "square.ngc");
  command("gcode:start");
  await until("running", () => state() === "Run");
  await until("sent", () => sender.received === sender.total && workflow === "idle");
  await idle("file played");
  near([255, 245]);

  // Hold, resume and abort of a file, by the buttons of the page.
  command("gcode:load", "line.ngc", "G91\nG1 X-40 F60\nG90\n");
  await until("loaded", () => sender.name === "line.ngc");
  command("gcode:start");
  await until("running", () => state() === "Run" && place()[0] < 253);
  command("gcode:pause");
  await until("hold", () => state() === "Hold");
  const held = place();
  await sleep(500);
  near(held);
  command("gcode:resume");
  await until("resumed", () => state() === "Run" && place()[0] < held[0] - 0.5);
  command("gcode:stop", { force: true });
  await idle("aborted");
  const [stopped] = place();
  if (!(215.5 < stopped && stopped < held[0])) end(`stopped at ${stopped}`);
  command("gcode", "G90 G1 X250 Y245 F3000");
  await idle("back");
  near(start);
}

async function main() {
  const grbl = spawn(trirrr, ["grbl", SCENE, "--pty"], { stdio: ["ignore", "pipe", "ignore"] });
  children.push(grbl);
  const pty = (await firstLine(grbl)).split(" ")[0];
  const http = await freePort();
  const server = path.join(modules, "cncjs", "bin", "cncjs");
  const options = ["--host", "127.0.0.1", "--port", http, "--config", path.join(home, "cncrc")];
  children.push(spawn(process.execPath, [server, ...options], { stdio: "ignore", env: { ...process.env, HOME: home } }));
  const address = `http://127.0.0.1:${http}`;
  const token = await signIn(address);
  socket = connect(address, { query: `token=${token}` });
  socket.on("controller:state", (kind, seen) => (machine = seen));
  socket.on("workflow:state", (seen) => (workflow = seen));
  socket.on("sender:status", (seen) => (sender = seen));
  socket.on("serialport:error", ({ err }) => end(err));
  socket.on("serialport:read", (line) => {
    said.push(line);
    if (/^(error|ALARM)/.test(line)) end(line);
  });
  socket.on("startup", () => {
    socket.emit("open", pty, { controllerType: "Grbl", baudrate: 115200 }, (error) => {
      if (error) end(error);
    });
  });
  await run(pty);
  end();
}

main().catch((error) => end(error.stack));
