// Numbers in words.

/** `value` with `digits` significant digits; a true minus sign. */
export function number(value: number, digits = 3): string {
    if (!Number.isFinite(value)) return "\u2013";
    const size = Math.abs(value);
    let text: string;
    if (size !== 0 && (size < 1e-3 || size >= 1e6)) text = value.toExponential(digits - 1);
    else {
        const before = size === 0 ? 0 : Math.floor(Math.log10(size));
        text = value.toFixed(Math.min(Math.max(0, digits - 1 - before), 6));
    }
    // A negative number that rounds to 0 has no sign.
    if (Number(text) === 0) text = text.replace("-", "");
    return text.replace("-", "\u2212");
}

/** `value` as it stands at a tick of an axis. */
export function round(value: number): string {
    return String(Number(value.toPrecision(6))).replace("-", "\u2212");
}

export const degrees = (radians: number): number => (radians * 180) / Math.PI;
