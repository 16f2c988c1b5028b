// Decoder of LZMA, as its specification has it: browsers decompress gzip alone, whose window of 32 kB does not see that the core holds the
// same functions for several number types.

const KINDS = 12;
const POSITIONS = 16;
const MATCH_MIN = 2;
/** First bits of a range coder, in 11 bits: nothing is known. */
const HALF = 1024;

const probabilities = (count: number): Uint16Array => new Uint16Array(count).fill(HALF);

/** Lengths of matches: 8 short ones and 8 others for each position, 256 long ones. */
class Lengths {
    readonly choice = probabilities(2);
    readonly low = probabilities(POSITIONS * 8);
    readonly middle = probabilities(POSITIONS * 8);
    readonly high = probabilities(256);
}

/** Decompresses a file of LZMA (`.lzma`) whose header has the length of its content. */
export function decompressed(file: Uint8Array): Uint8Array<ArrayBuffer> {
    const view = new DataView(file.buffer, file.byteOffset);
    const properties = view.getUint8(0);
    const lc = properties % 9;
    const lp = Math.floor(properties / 9) % 5;
    const pb = Math.floor(properties / 45);
    const size = view.getUint32(5, true);
    const out = new Uint8Array(size);

    let at = 18;
    let range = 0xffffffff;
    let code = view.getUint32(14);

    function bit(table: Uint16Array, index: number): number {
        const probability = table[index] as number;
        const bound = (range >>> 11) * probability;
        let result = 0;
        if (code < bound) {
            range = bound;
            table[index] = probability + ((2048 - probability) >>> 5);
        } else {
            range -= bound;
            code -= bound;
            table[index] = probability - (probability >>> 5);
            result = 1;
        }
        if (range < 0x1000000) {
            range = (range << 8) >>> 0;
            code = ((code << 8) | (file[at++] as number)) >>> 0;
        }
        return result;
    }

    /** Bits that are as likely 0 as 1. */
    function direct(count: number): number {
        let result = 0;
        for (let left = count; left > 0; left -= 1) {
            range >>>= 1;
            const one = code >= range ? 1 : 0;
            if (one) code -= range;
            result = result * 2 + one;
            if (range < 0x1000000) {
                range = (range << 8) >>> 0;
                code = ((code << 8) | (file[at++] as number)) >>> 0;
            }
        }
        return result;
    }

    /** A number of `count` bits, the highest first. */
    function tree(table: Uint16Array, base: number, count: number): number {
        let node = 1;
        for (let left = count; left > 0; left -= 1) node = (node << 1) | bit(table, base + node);
        return node - (1 << count);
    }

    /** A number of `count` bits, the lowest first. */
    function reverse(table: Uint16Array, base: number, count: number): number {
        let node = 1;
        let result = 0;
        for (let index = 0; index < count; index += 1) {
            const one = bit(table, base + node);
            node = (node << 1) | one;
            result |= one << index;
        }
        return result;
    }

    function length(lengths: Lengths, position: number): number {
        if (bit(lengths.choice, 0) === 0) return tree(lengths.low, position * 8, 3);
        if (bit(lengths.choice, 1) === 0) return 8 + tree(lengths.middle, position * 8, 3);
        return 16 + tree(lengths.high, 0, 8);
    }

    const literals = probabilities(0x300 << (lc + lp));
    const isMatch = probabilities(KINDS * POSITIONS);
    const isRepeat = probabilities(KINDS);
    const isRepeat0 = probabilities(KINDS);
    const isRepeat1 = probabilities(KINDS);
    const isRepeat2 = probabilities(KINDS);
    const isLong = probabilities(KINDS * POSITIONS);
    const slots = probabilities(4 * 64);
    const near = probabilities(128);
    const aligned = probabilities(16);
    const matches = new Lengths();
    const repeats = new Lengths();

    let kind = 0;
    let [back0, back1, back2, back3] = [1, 1, 1, 1];
    let end = 0;
    while (end < size) {
        const position = end & ((1 << pb) - 1);
        if (bit(isMatch, kind * POSITIONS + position) === 0) {
            const before = end > 0 ? (out[end - 1] as number) : 0;
            const base = 0x300 * (((end & ((1 << lp) - 1)) << lc) + (before >>> (8 - lc)));
            let symbol = 1;
            if (kind >= 7) {
                // Behind a match the literal differs from the byte that the match would have had.
                let matched = out[end - back0] as number;
                while (symbol < 0x100) {
                    const expected = (matched >>> 7) & 1;
                    matched <<= 1;
                    const one = bit(literals, base + ((1 + expected) << 8) + symbol);
                    symbol = (symbol << 1) | one;
                    if (one !== expected) break;
                }
            }
            while (symbol < 0x100) symbol = (symbol << 1) | bit(literals, base + symbol);
            out[end++] = symbol;
            kind = kind < 4 ? 0 : kind < 10 ? kind - 3 : kind - 6;
            continue;
        }
        let count: number;
        if (bit(isRepeat, kind) === 0) {
            [back1, back2, back3] = [back0, back1, back2];
            count = length(matches, position);
            kind = kind < 7 ? 7 : 10;
            const slot = tree(slots, 64 * Math.min(count, 3), 6);
            let distance = slot;
            if (slot >= 4) {
                const bits = (slot >>> 1) - 1;
                distance = (2 | (slot & 1)) << bits;
                if (slot < 14) distance += reverse(near, distance - slot, bits);
                else distance += direct(bits - 4) * 16 + reverse(aligned, 0, 4);
            }
            back0 = distance + 1;
        } else {
            if (bit(isRepeat0, kind) === 0) {
                if (bit(isLong, kind * POSITIONS + position) === 0) {
                    out[end] = out[end - back0] as number;
                    end += 1;
                    kind = kind < 7 ? 9 : 11;
                    continue;
                }
            } else if (bit(isRepeat1, kind) === 0) [back0, back1] = [back1, back0];
            else if (bit(isRepeat2, kind) === 0) [back0, back1, back2] = [back2, back0, back1];
            else [back0, back1, back2, back3] = [back3, back0, back1, back2];
            count = length(repeats, position);
            kind = kind < 7 ? 8 : 11;
        }
        if (back0 > end) throw new Error("the core is damaged");
        const stop = Math.min(end + count + MATCH_MIN, size);
        for (; end < stop; end += 1) out[end] = out[end - back0] as number;
    }
    return out;
}
