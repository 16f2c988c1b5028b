// The conversation with a board, in a worker: it goes on beside whatever the page draws, and a plan holds nothing up. Bytes of the line pass
// through the page, which has it.

import { Board, initSync, type BoardCommand } from "../core/board.js";
import { initSync as initCore } from "../core/core.js";
import type { Source } from "./answers";
import { taken, takenView, type TakenView } from "./taken";
import { whole } from "./whole";

/** Name of the worker. */
export const TALK = "board";

/** From the page. */
export type ToBoard =
    | { kind: "begin"; core: WebAssembly.Module; module: WebAssembly.Module; source: Source }
    | { kind: "bytes"; bytes: Uint8Array }
    | { kind: "command"; command: BoardCommand }
    | { kind: "step"; by: [number, number, number] }
    | { kind: "halt" };

/** To the page. */
export type FromBoard =
    | { kind: "ready" }
    | { kind: "failed"; reason: string }
    | { kind: "bytes"; bytes: Uint8Array }
    | { kind: "view"; view: TakenView; notes: string[] };

/** Longest time without a look at the board, ms. */
const LOOK = 100;

/** Time from one view to the next, ms: as often as samples come. */
const VIEW = 40;

const say = (message: FromBoard) => postMessage(message);

export function talk(): void {
    let board: Board | undefined;
    let timer = 0;
    let shown = -VIEW;

    const turn = (isNews: boolean) => {
        if (!board) return;
        const now = performance.now();
        const bytes = board.poll(now);
        if (bytes.length > 0) say({ kind: "bytes", bytes });
        const notes = board.takeNotes();
        if (isNews || notes.length > 0 || now - shown >= VIEW) {
            shown = now;
            say({ kind: "view", view: takenView(board.view()), notes });
        }
        clearTimeout(timer);
        timer = setTimeout(turn, Math.min(Math.max(board.due - now, 1), LOOK), false);
    };
    const obey = (give: (board: Board) => void) => {
        if (!board) return;
        try {
            give(board);
        } catch (reason) {
            say({ kind: "view", view: takenView(board.view()), notes: [String(reason)] });
        }
        turn(true);
    };

    addEventListener("message", ({ data }: MessageEvent<ToBoard>) => {
        switch (data.kind) {
            case "begin": {
                initCore({ module: data.core });
                initSync({ module: data.module });
                const { reading } = whole(data.source);
                try {
                    const { name, number, key, figures, moves, levels, ranges, outputs, tools, bodies } = taken(reading.boardScene());
                    board = new Board(name, number, key, figures, moves, levels, ranges, outputs, tools, bodies, crypto.getRandomValues(new Uint32Array(1))[0] ?? 0);
                    say({ kind: "ready" });
                } catch (reason) {
                    say({ kind: "failed", reason: String(reason) });
                }
                reading.free();
                break;
            }
            case "bytes":
                board?.receive(data.bytes, performance.now());
                turn(false);
                break;
            case "command":
                obey((board) => board.command(data.command));
                break;
            case "step":
                obey((board) => board.step(...data.by));
                break;
            case "halt":
                obey((board) => board.halt());
                break;
        }
    });
}
