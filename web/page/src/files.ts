// Files that the user opens, with the texts that the command reads: what one refuses the other refuses.

/** Text of a file, or a sentence on the line that is none. */
export async function textOf(file: File): Promise<string> {
    const bytes = new Uint8Array(await file.arrayBuffer());
    if (/\.svgz?$/i.test(file.name)) return drawingOf(file.name, bytes);
    if (/\.(gcode|nc|ngc|tap)$/i.test(file.name)) return program(bytes);
    let text: string;
    try {
        text = new TextDecoder("utf-8", { fatal: true }).decode(bytes);
    } catch {
        throw new Error(`${file.name}: line ${lineOf(bytes)}: the line is no UTF-8`);
    }
    // The editor would make a line of each.
    const at = text.search(/\r(?!\n)/);
    if (at >= 0) throw new Error(`${file.name}: line ${text.slice(0, at).split("\n").length}: the line has a line break in it`);
    return text;
}

/** Text of a drawing: plain or packed, in the encoding of its byte order mark or of its head. */
async function drawingOf(name: string, bytes: Uint8Array<ArrayBuffer>): Promise<string> {
    if (bytes[0] === 0x1f && bytes[1] === 0x8b) {
        const unpacked = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
        bytes = new Uint8Array(await new Response(unpacked).arrayBuffer());
    }
    const [first, second] = bytes;
    const isLow = (first === 0xff && second === 0xfe) || (first === 0x3c && second === 0);
    const isHigh = (first === 0xfe && second === 0xff) || (first === 0 && second === 0x3c);
    const head = new TextDecoder("latin1").decode(bytes.subarray(0, 256));
    const named = /^<\?xml[^>]*\sencoding\s*=\s*["']([^"']*)/.exec(head)?.[1];
    const encoding = isLow ? "utf-16le" : isHigh ? "utf-16be" : (named ?? "utf-8");
    try {
        return new TextDecoder(encoding, { fatal: true }).decode(bytes);
    } catch {
        throw new Error(`${name}: line ${lineOf(bytes)}: the line is not in ${encoding}; save the file as UTF-8`);
    }
}

/** Text of G-code: in UTF-16 by its mark, in UTF-8, or in letters of eight bits; its lines end as lines of the editor do. */
function program(bytes: Uint8Array): string {
    const mark = (bytes[0] ?? 0) * 256 + (bytes[1] ?? 0);
    const decoded = (form: string, fatal = false): string => new TextDecoder(form, { fatal }).decode(bytes);
    const text = (): string => {
        if (mark === 0xfffe) return decoded("utf-16le");
        if (mark === 0xfeff) return decoded("utf-16be");
        try {
            return decoded("utf-8", true);
        } catch {
            return decoded("windows-1252");
        }
    };
    return text().replace(/\r+\n/g, "\n").replace(/\r/g, "\n");
}

/** Number of the first line that is no UTF-8. */
function lineOf(bytes: Uint8Array): number {
    const decoder = new TextDecoder("utf-8", { fatal: true });
    const FEED = 10;
    let line = 1;
    for (let begin = 0; begin < bytes.length; line += 1) {
        const end = bytes.indexOf(FEED, begin);
        try {
            decoder.decode(bytes.subarray(begin, end < 0 ? bytes.length : end));
        } catch {
            break;
        }
        if (end < 0) break;
        begin = end + 1;
    }
    return line;
}
