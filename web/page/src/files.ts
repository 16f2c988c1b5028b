// Files that the user opens, with the texts that the command reads: what one refuses the other refuses.

/** Text of a file, or a sentence on the line that is none. */
export async function textOf(file: File): Promise<string> {
    const bytes = new Uint8Array(await file.arrayBuffer());
    let text: string;
    try {
        text = new TextDecoder("utf-8", { fatal: true }).decode(bytes);
    } catch {
        throw new Error(`${file.name}: line ${lineOf(bytes)}: the line is no UTF-8`);
    }
    // The editor would make a line of each.
    const at = text.search(/\r(?!\n)/);
    if (at >= 0 && !/\.svg$/i.test(file.name)) throw new Error(`${file.name}: line ${text.slice(0, at).split("\n").length}: the line has a line break in it`);
    return text;
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
