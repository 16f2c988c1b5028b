// The board: the line to it, its state, the user's commands. Nothing is switched on or moved but by a button or a key of the user.

import { BoardCommand } from "../core/board.js";
import type { Source } from "./answers";
import { number } from "./format";
import { decompressed } from "./lzma";
import { bytesOf } from "./share";
import { openSerial, openSocket, servedBoard, whyNoSerial, type Line } from "./line";
import { TALK, type FromBoard, type ToBoard } from "./talk";
import type { TakenSample, TakenView } from "./taken";

/** Most lines of the log. */
const LINES = 200;

const BUTTONS: [string, BoardCommand][] = [
    ["enable", BoardCommand.Enable],
    ["disable", BoardCommand.Disable],
    ["acknowledge", BoardCommand.Acknowledge],
    ["home", BoardCommand.Home],
    ["run", BoardCommand.Run],
    ["hold", BoardCommand.Hold],
    ["resume", BoardCommand.Resume],
    ["abort", BoardCommand.Stop],
];

/** Steps by hand: button, and direction. */
const STEPS: [string, [number, number, number]][] = [
    ["step-left", [-1, 0, 0]],
    ["step-right", [1, 0, 0]],
    ["step-up", [0, 1, 0]],
    ["step-down", [0, -1, 0]],
    ["step-ccw", [0, 0, 1]],
    ["step-cw", [0, 0, -1]],
];

/** Scene of the page, and the places where the page shows the machine. */
interface Host {
    core: WebAssembly.Module;
    /** The scene, or the reason why it is not for a board. */
    scene: () => Source | string;
    /** The page begins or ends to follow the board. */
    onFollow: (isFollowing: boolean) => void;
    /** The line was lost, or the user has seen that: the machine is not where it is drawn. */
    onLost: (isLost: boolean) => void;
    onSample: (sample: TakenSample) => void;
}

export class BoardPanel {
    private line: Line | undefined;
    private worker: Worker | undefined;
    private view: TakenView | undefined;
    /** The line ended by itself, and the user has not acknowledged that. */
    private isLost = false;
    /** Time of the last sample. */
    private time = NaN;
    /** Counts connections: what an older one says is of no interest. */
    private round = 0;
    private compiled: Promise<WebAssembly.Module> | undefined;
    private readonly script = URL.createObjectURL(new Blob([document.getElementById("main")?.textContent ?? ""], { type: "text/javascript" }));

    constructor(
        private readonly page: (id: string) => HTMLElement,
        private readonly host: Host,
    ) {
        const baud = page("baud") as HTMLInputElement;
        page("connect-serial").addEventListener("click", () => {
            const why = whyNoSerial();
            if (why === undefined) void this.connect((ends) => openSerial(baud.valueAsNumber || 921_600, ends));
            else this.note(why);
        });
        page("connect-served").addEventListener("click", () => void this.connect(openSocket));
        page("disconnect").addEventListener("click", () => this.disconnect("disconnected"));
        for (const [id, command] of BUTTONS) this.button(id, command, () => this.ask({ kind: "command", command }));
        for (const [id, direction] of STEPS) this.button(id, BoardCommand.Step, () => this.ask({ kind: "step", by: this.step(direction) }));
        page("halt").addEventListener("click", () => this.halt());
        page("lost-seen").addEventListener("click", () => {
            this.lose(false);
            this.show();
            page("connect-serial").focus({ preventScroll: true });
        });
        addEventListener(
            "keydown",
            (event) => {
                if (event.key !== "Escape" || !this.isOpen) return;
                event.preventDefault();
                this.halt();
            },
            { capture: true },
        );
        const served = servedBoard();
        page("connect-served").hidden = served === undefined;
        page("connect-served").textContent = `Connect to ${served ?? ""}`;
        const why = whyNoSerial();
        page("connect-serial").setAttribute("aria-disabled", String(why !== undefined));
        page("connect-serial").title = why ?? "";
        page("baud-label").hidden = why !== undefined;
        const other = "To connect by another program, start `trirrr ui SCENE --board PORT` and open the address that it prints.";
        page("connect-hint").textContent = [why, served === undefined ? other : undefined].filter(Boolean).join(" ");
        this.show();
    }

    /** A board is connected, or is about to be. */
    get isOpen(): boolean {
        return this.worker !== undefined;
    }

    private button(id: string, command: BoardCommand, press: () => void): void {
        this.page(id).addEventListener("click", () => {
            // A button that is out of use can be reached by keyboard, so that it can say why.
            const why = this.hindrance(command);
            if (why === "") press();
            else this.note(`${this.page(id).getAttribute("aria-label") ?? this.page(id).textContent}: ${why}`);
        });
    }

    private hindrance(command: BoardCommand): string {
        return this.view ? (this.view.hindrances[command] ?? "") : "no board is connected";
    }

    private step([x, y, turn]: [number, number, number]): [number, number, number] {
        const length = Number((this.page("step-mm") as HTMLSelectElement).value) / 1000;
        const angle = (Number((this.page("step-degrees") as HTMLSelectElement).value) * Math.PI) / 180;
        return [x * length, y * length, turn * angle];
    }

    private halt(): void {
        this.ask({ kind: "halt" });
    }

    private ask(message: ToBoard): void {
        this.worker?.postMessage(message);
    }

    private async connect(open: (ends: { onBytes: (bytes: Uint8Array) => void; onEnd: (reason: string) => void }) => Promise<Line>): Promise<void> {
        if (this.isOpen) return;
        const scene = this.host.scene();
        if (typeof scene === "string") {
            this.note(scene);
            return;
        }
        this.lose(false);
        this.round += 1;
        const { round } = this;
        const isCurrent = () => round === this.round;
        const worker = new Worker(this.script, { name: TALK });
        this.worker = worker;
        this.state("connecting \u2026", false);
        this.host.onFollow(true);
        worker.addEventListener("error", () => isCurrent() && this.disconnect("The core has stopped. That is a defect of trirrr: please report it with the scene."));
        // The worker reads the scene, and plans its job, while the line is opened.
        const isReady = new Promise<void>((resolve, reject) => {
            worker.addEventListener("message", ({ data }: MessageEvent<FromBoard>) => {
                if (!isCurrent()) return;
                if (data.kind === "ready") resolve();
                else if (data.kind === "failed") reject(new Error(data.reason));
                else if (data.kind === "bytes") this.line?.send(data.bytes);
                else this.take(data.view, data.notes);
            });
        });
        try {
            // A browser shows its list of ports only at once after the click.
            const opening = open({
                onBytes: (bytes) => isCurrent() && this.ask({ kind: "bytes", bytes }),
                onEnd: (reason) => isCurrent() && this.disconnect(`the line is lost: ${reason}`),
            });
            opening.catch(() => undefined);
            const module = await this.module();
            this.ask({ kind: "begin", core: this.host.core, module, source: scene });
            const [line] = await Promise.all([opening, isReady.catch((error: unknown) => opening.then((line) => (line.close(), Promise.reject(error))))]);
            if (!isCurrent()) {
                line.close();
                return;
            }
            this.line = line;
            this.note(`${line.name} is open`);
            // The button that was pressed is gone. No other key than that of a halt lies under the finger.
            this.page("halt").focus({ preventScroll: true });
            this.ask({ kind: "bytes", bytes: new Uint8Array() });
        } catch (error) {
            if (isCurrent()) this.disconnect(error instanceof Error ? error.message : String(error));
        }
        this.show();
    }

    /** Ends the conversation. A machine that plays a job comes to rest by its host timeout, and waits. */
    private disconnect(reason: string): void {
        this.round += 1;
        this.lose(this.line !== undefined && reason !== "disconnected");
        this.line?.close();
        this.worker?.terminate();
        this.line = this.worker = this.view = undefined;
        this.time = NaN;
        this.note(reason);
        this.state(reason, reason !== "disconnected");
        this.host.onFollow(false);
        this.show();
    }

    private lose(isLost: boolean): void {
        this.isLost = isLost;
        this.host.onLost(isLost);
    }

    private take(view: TakenView, notes: string[]): void {
        notes.forEach((note) => this.note(note));
        this.view = view;
        if (view.isClosed) {
            this.disconnect(view.sentence);
            return;
        }
        const job = view.isPlaying ? `, ${view.done} of ${view.moves} ${view.moves === 1 ? "move" : "moves"} done` : "";
        this.state(view.sentence + job, view.isBad);
        const { sample } = view;
        if (sample && sample.time !== this.time) {
            this.time = sample.time;
            this.host.onSample(sample);
        }
        this.show();
    }

    /** The module for conversations, which nobody needs before. */
    private async module(): Promise<WebAssembly.Module> {
        this.compiled ??= WebAssembly.compile(decompressed(bytesOf(this.page("board-core").textContent ?? "")));
        return this.compiled;
    }

    private state(words: string, isBad: boolean): void {
        for (const id of ["board-state", "halt-state"]) {
            const place = this.page(id);
            if (place.textContent !== words) place.textContent = words;
            place.classList.toggle("bad", isBad);
        }
    }

    /** Buttons as they are now: those out of use say why. */
    private show(): void {
        const { page, view, isOpen, isLost } = this;
        const isShown = isOpen || isLost;
        const root = document.documentElement.classList;
        if (root.contains("with-board") !== isShown) {
            // A board that is connected comes first, and stays there while the user has to see that its line was lost.
            const card = page("connect").closest("section");
            const side = card?.parentElement;
            if (card) isShown ? side?.prepend(card) : side?.append(card);
        }
        root.toggle("with-board", isShown);
        page("connect").hidden = isOpen;
        page("controls").hidden = !isOpen;
        page("halt-bar").hidden = !isShown;
        page("halt").hidden = !isOpen;
        page("lost-seen").hidden = !isLost;
        const all: [string, BoardCommand][] = [...BUTTONS, ...STEPS.map(([id]): [string, BoardCommand] => [id, BoardCommand.Step])];
        for (const [id, command] of all) {
            const why = this.hindrance(command);
            const button = page(id);
            button.setAttribute("aria-disabled", String(why !== ""));
            button.setAttribute("aria-description", why);
            if (button.title !== why) button.title = why;
        }
        page("home").textContent = view?.isRecovery ? "Recover" : "Home";
        page("board-inputs").textContent = view?.inputs ?? "";
        page("board-inputs").hidden = !view?.inputs;
        const can = (command: BoardCommand) => this.hindrance(command) === "";
        page("halt-word").textContent = can(BoardCommand.Hold) ? "Hold" : can(BoardCommand.Resume) ? "Held" : "Stop";
    }

    private note(text: string): void {
        const log = this.page("board-log");
        const line = document.createElement("li");
        const time = new Date().toLocaleTimeString([], { hour12: false });
        line.append(time, "  ", text);
        log.append(line);
        while (log.childElementCount > LINES) log.firstElementChild?.remove();
        log.scrollTop = log.scrollHeight;
    }
}

/** Pose of a sample in words. */
export function placeOf({ setpoint }: TakenSample): string {
    const [x = 0, y = 0, alpha = 0] = setpoint;
    return `x ${number(x * 1000, 5)} mm, y ${number(y * 1000, 5)} mm, alpha ${number((alpha * 180) / Math.PI, 4)}\u00b0`;
}
