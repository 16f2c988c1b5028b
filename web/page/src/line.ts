// Lines to a board: bytes over Web Serial, or over the WebSocket of `trirrr ui`.

export interface Line {
    /** The line as the user knows it. */
    name: string;
    send: (bytes: Uint8Array) => void;
    /** Ends the line without a word to `onEnd`. */
    close: () => void;
}

interface Ends {
    onBytes: (bytes: Uint8Array) => void;
    /** The line is lost, for this reason. */
    onEnd: (reason: string) => void;
}

/** Reason why the page has no Web Serial; none where it has. */
export function whyNoSerial(): string | undefined {
    if (navigator.serial) return undefined;
    if (!isSecureContext) return "Browsers give serial ports only to pages that come by https, from this computer, or from a file.";
    return "This browser has no Web Serial: Chrome and Edge on a computer have.";
}

/** Board of `trirrr ui`, by its name; none where the page came from elsewhere. */
export const servedBoard = (): string | undefined => document.documentElement.dataset.board;

/** Opens the WebSocket to the board behind `trirrr ui`. */
export function openSocket(ends: Ends): Promise<Line> {
    return new Promise((resolve, reject) => {
        const socket = new WebSocket(new URL("board", location.href.replace(/^http/, "ws")));
        socket.binaryType = "arraybuffer";
        let isOpen = false;
        let isOver = false;
        const line: Line = {
            name: servedBoard() ?? "trirrr ui",
            send: (bytes) => {
                if (socket.readyState === WebSocket.OPEN) socket.send(bytes as Uint8Array<ArrayBuffer>);
            },
            close: () => {
                isOver = true;
                socket.close();
            },
        };
        socket.addEventListener("open", () => {
            isOpen = true;
            resolve(line);
        });
        socket.addEventListener("message", ({ data }: MessageEvent<ArrayBuffer>) => ends.onBytes(new Uint8Array(data)));
        socket.addEventListener("close", ({ reason }) => {
            const words = reason || "trirrr ui has gone, or does not let this page to the board";
            if (!isOpen) reject(new Error(words));
            else if (!isOver) ends.onEnd(words);
            isOver = true;
        });
    });
}

/** Lets the user choose a serial port, and opens it. */
export async function openSerial(baudRate: number, ends: Ends): Promise<Line> {
    const why = whyNoSerial();
    if (why !== undefined || !navigator.serial) throw new Error(why);
    const port = await navigator.serial.requestPort();
    // A board sends more in a while than the 255 bytes that a browser keeps by default.
    await port.open({ baudRate, bufferSize: 1 << 16 });
    const writer = port.writable?.getWriter();
    if (!writer) throw new Error("the port cannot be written to");
    let isOver = false;
    let reader: ReadableStreamDefaultReader<Uint8Array> | undefined;
    const end = (reason: string) => {
        if (!isOver) ends.onEnd(reason);
        isOver = true;
    };
    const read = async () => {
        let reason = "the port is closed";
        // After an overrun or a damaged byte the port goes on with another stream; after a pulled cable it has none.
        while (port.readable && !isOver) {
            reader = port.readable.getReader();
            try {
                for (;;) {
                    const { value, done } = await reader.read();
                    if (done) break;
                    ends.onBytes(value);
                }
            } catch (error) {
                reason = String(error instanceof Error ? error.message : error);
            } finally {
                reader.releaseLock();
            }
        }
        end(reason);
        writer.releaseLock();
        await port.close().catch(() => undefined);
    };
    void read();
    return {
        name: "the serial port",
        send: (bytes) => void writer.write(bytes).catch((error: unknown) => end(String(error))),
        close: () => {
            isOver = true;
            void reader?.cancel().catch(() => undefined);
        },
    };
}
