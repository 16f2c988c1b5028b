/** Shipped scenes by name; set by build.mjs. */
declare const SCENES: Record<string, string>;

/** Serial port of a browser that has them: https://wicg.github.io/serial/. */
interface SerialPort {
    readonly readable: ReadableStream<Uint8Array> | null;
    readonly writable: WritableStream<Uint8Array> | null;
    open(options: { baudRate: number; bufferSize?: number }): Promise<void>;
    close(): Promise<void>;
}

interface Navigator {
    readonly serial?: { requestPort(): Promise<SerialPort> };
}
