// Holds the strokes of the reader against the outlines that the browser has. Lengths in px.
const NEAR = 0.01 * 96 / 25.4;
const STEP = 1.5;
const canvas = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
const alphas = new Map();
function alphaOf(colour) {
    if (!alphas.has(colour)) {
        canvas.clearRect(0, 0, 1, 1);
        canvas.fillStyle = "#000";
        canvas.fillStyle = colour;
        canvas.fillRect(0, 0, 1, 1);
        alphas.set(colour, canvas.getImageData(0, 0, 1, 1).data[3] / 255);
    }
    return alphas.get(colour);
}
// Copies become what they copy: the browser tells nothing of what is in them.
function expand(svg) {
    for (const use of [...svg.querySelectorAll("use")]) {
        const target = svg.querySelector(use.getAttribute("href"));
        const group = document.createElementNS(svg.namespaceURI, "g");
        for (const { name, value } of [...use.attributes]) if (!["href", "x", "y", "width", "height"].includes(name)) group.setAttribute(name, value);
        const inner = document.createElementNS(svg.namespaceURI, target.localName === "symbol" ? "svg" : "g");
        const x = use.getAttribute("x"), y = use.getAttribute("y");
        if (target.localName === "symbol") {
            for (const name of ["x", "y", "width", "height"]) inner.setAttribute(name, use.getAttribute(name));
            inner.setAttribute("viewBox", target.getAttribute("viewBox"));
            for (const child of target.children) inner.append(child.cloneNode(true));
        } else {
            inner.setAttribute("transform", `translate(${x} ${y})`);
            inner.append(target.cloneNode(true));
        }
        group.append(inner);
        use.replaceWith(group);
    }
}
function seen(element, svg) {
    let alpha = 1;
    for (let at = element; at && at !== svg.parentNode; at = at.parentNode) {
        const style = getComputedStyle(at);
        if (style.display === "none" || ["defs", "symbol", "clipPath"].includes(at.localName)) return undefined;
        alpha *= Number(style.opacity);
    }
    const style = getComputedStyle(element);
    if (style.visibility !== "visible") return undefined;
    const box = element.getBBox();
    const paint = (value, opacity, needsBox) => {
        if (value === "none") return false;
        if (value.includes("#void")) return false;
        if (value.includes("#grad")) return opacity * alpha > 0.5 / 255 && box.width > 0 && box.height > 0;
        return alphaOf(value) * opacity * alpha > 0.5 / 255;
    };
    const stroke = parseFloat(style.strokeWidth) > 0 && paint(style.stroke, Number(style.strokeOpacity));
    if (stroke) return "stroke";
    return paint(style.fill, Number(style.fillOpacity)) ? "fill" : undefined;
}
const at = (matrix, x, y) => [matrix.a * x + matrix.c * y + matrix.e, matrix.b * x + matrix.d * y + matrix.f];
// True if a place on the screen is in all clips around an element.
function inClips(chain, x, y) {
    return chain.every((test) => test(x, y));
}
function clips(element, svg) {
    const tests = [];
    for (let node = element; node !== svg; node = node.parentNode) {
        const clip = getComputedStyle(node).clipPath;
        if (clip.startsWith("url")) {
            const path = svg.querySelector(clip.slice(clip.indexOf("#"), clip.lastIndexOf(")")).replace(/["']/g, ""));
            let matrix = node.getScreenCTM();
            if (path.getAttribute("clipPathUnits")) {
                const box = node.getBBox();
                if (box.width === 0 || box.height === 0) return [() => false];
                matrix = matrix.translate(box.x, box.y).scaleNonUniform(box.width, box.height);
            }
            const own = path.transform.baseVal.consolidate();
            if (own) matrix = matrix.multiply(own.matrix);
            const inverse = matrix.inverse();
            tests.push((x, y) => [...path.children].some((shape) => {
                const [u, v] = at(inverse, x, y);
                return shape.isPointInFill(new DOMPoint(u, v));
            }));
        }
        if (node.localName === "svg" && getComputedStyle(node).overflow !== "visible") {
            const inverse = node.parentNode.getScreenCTM().inverse();
            const [left, top, width, height] = ["x", "y", "width", "height"].map((name) => node[name].baseVal.value);
            tests.push((x, y) => {
                const [u, v] = at(inverse, x, y);
                return u >= left && v >= top && u <= left + width && v <= top + height;
            });
        }
    }
    return tests;
}
// The browser's arcs are cubic curves over a quarter, off by 2.8e-4 of their radius.
function slackOf(element, { a, b, c, d }) {
    const box = element.getBBox();
    const isRound = ["circle", "ellipse", "rect"].includes(element.localName) || /a/i.test(element.getAttribute("d") ?? "");
    // An arc of a path may be of a larger circle than its box.
    return isRound ? 5e-4 * Math.max(box.width, box.height) * Math.hypot(a, b, c, d) : 0;
}
function dashes(element) {
    const style = getComputedStyle(element);
    if (style.strokeDasharray === "none") return () => true;
    const list = style.strokeDasharray.split(",").map(parseFloat);
    if (list.length % 2) list.push(...list);
    const whole = list.reduce((sum, length) => sum + length, 0);
    const offset = parseFloat(style.strokeDashoffset);
    // Near an end both are right. Lengths of curves are those of some chords, in the browser.
    const isStraight = ["line", "polyline", "polygon"].includes(element.localName) || !/[csqta]/i.test(element.getAttribute("d") ?? "c");
    return (length) => {
        // Of a small curve the browser's length is that of a few chords.
        if (!isStraight && element.getTotalLength() < 25) return undefined;
        const loose = isStraight ? 0.05 : 0.3 + 0.02 * length;
        let place = (((length + offset) % whole) + whole) % whole;
        let near = Math.min(place, whole - place);
        let index = 0;
        while (place >= list[index]) {
            place -= list[index];
            near = Math.min(near, Math.abs(place));
            index += 1;
        }
        near = Math.min(near, list[index] - place);
        return near < loose ? undefined : index % 2 === 0;
    };
}
function segments(strokes) {
    const cells = new Map();
    const key = (x, y) => Math.floor(x / 8) * 65536 + Math.floor(y / 8);
    for (const list of strokes)
        for (let i = 0; i + 3 < list.length; i += 2) {
            const [a, b, c, d] = list.slice(i, i + 4);
            for (let x = Math.floor((Math.min(a, c) - 0.1) / 8); x <= (Math.max(a, c) + 0.1) / 8; x++)
                for (let y = Math.floor((Math.min(b, d) - 0.1) / 8); y <= (Math.max(b, d) + 0.1) / 8; y++) {
                    const place = x * 65536 + y;
                    if (!cells.has(place)) cells.set(place, []);
                    cells.get(place).push([a, b, c, d]);
                }
        }
    return (x, y) => (cells.get(key(x, y)) ?? []).reduce((least, [a, b, c, d]) => {
        const size = (c - a) ** 2 + (d - b) ** 2;
        const t = size > 0 ? Math.max(0, Math.min(1, ((x - a) * (c - a) + (y - b) * (d - b)) / size)) : 0;
        return Math.min(least, Math.hypot(a + t * (c - a) - x, b + t * (d - b) - y));
    }, Infinity);
}
// First difference of a drawing, if there is one.
function difference(text, strokes) {
    if (typeof strokes === "string") return `refused: ${strokes}`;
    const svg = document.importNode(new DOMParser().parseFromString(text, "image/svg+xml").documentElement, true);
    expand(svg);
    document.body.append(svg);
    svg.style.position = "absolute";
    const frame = svg.getBoundingClientRect();
    const high = frame.height;
    const found = segments(strokes.map((list) => list.map((value, index) => (index % 2 ? high - value : value))));
    let count = 0;
    const shapes = [];
    try {
        for (const element of svg.querySelectorAll("path, rect, circle, ellipse, line, polyline, polygon")) {
            const kind = seen(element, svg);
            if (kind === undefined) continue;
            const matrix = element.getScreenCTM();
            const tests = clips(element, svg);
            const length = element.getTotalLength();
            const box = element.getBBox();
            if (length === 0) continue;
            if (kind === "fill" && (box.width === 0 || box.height === 0)) continue;
            shapes.push({ element, matrix, kind, inverse: matrix.inverse() });
            const isDrawn = kind === "stroke" ? dashes(element) : () => true;
            const hasParts = /[zZmM]/.test((element.getAttribute("d") ?? "").slice(1));
            // A fill without an area is not drawn.
            const parts = element.localName === "path" ? element.getAttribute("d").match(/[a-z]/gi).length - 1 : (element.points?.numberOfItems ?? 9) - 1;
            const isFlat = kind === "fill" && (hasParts || parts < 2 || element.localName === "line");
            // Dashes begin anew on each part; the browser's length runs on.
            if (hasParts && getComputedStyle(element).strokeDasharray !== "none") continue;
            const scale = Math.sqrt(Math.abs(matrix.a * matrix.d - matrix.b * matrix.c));
            const steps = Math.max(4, Math.ceil((length * scale) / STEP));
            for (let step = 0; step < steps; step++) {
                const along = ((step + 0.37) / steps) * length;
                const drawn = isDrawn(along);
                if (drawn === undefined) continue;
                const point = element.getPointAtLength(along);
                const [x, y] = at(matrix, point.x, point.y);
                const around = [[0, 0], [0.2, 0], [-0.2, 0], [0, 0.2], [0, -0.2]].map(([u, v]) => inClips(tests, x + u, y + v));
                if (around.some((value) => value !== around[0])) continue;
                if (!drawn || !around[0]) continue;
                count += 1;
                const off = found(x - frame.x, y - frame.y) - slackOf(element, matrix);
                if (off > NEAR && !isFlat) return `lost: ${element.id} (${element.localName}, ${kind}) at ${(x - frame.x).toFixed(3)}, ${(y - frame.y).toFixed(3)}: ${off.toFixed(4)} px off`;
            }
        }
        // The other way: each place that is drawn is on a shape that is seen.
        const dense = 0.4;
        const points = [];
        for (const { element, matrix } of shapes) {
            const length = element.getTotalLength();
            const scale = Math.sqrt(matrix.a ** 2 + matrix.b ** 2 + matrix.c ** 2 + matrix.d ** 2);
            const steps = Math.max(2, Math.ceil((length * scale) / dense));
            const place = (step) => {
                const point = element.getPointAtLength((step / steps) * length);
                const [x, y] = at(matrix, point.x, point.y);
                return [x - frame.x, y - frame.y];
            };
            let before = place(0);
            for (let step = 1; step <= steps; step++) {
                const [x, y] = place(step);
                if (Math.hypot(x - before[0], y - before[1]) < 2 * dense) points.push([before[0], before[1], x, y, place, step, element]);
                else
                    // A gap between parts: as near to it as is told.
                    for (let part = 1, last = before; part <= 256; part++) {
                        const next = place(step - 1 + part / 256);
                        if (Math.hypot(next[0] - last[0], next[1] - last[1]) < dense) points.push([...last, ...next, place, step, element]);
                        last = next;
                    }
                before = [x, y];
            }
        }
        const cells = new Map();
        for (const point of points) {
            const key = Math.floor(point[0] / 2) * 65536 + Math.floor(point[1] / 2);
            if (!cells.has(key)) cells.set(key, []);
            cells.get(key).push(point);
        }
        const toSegment = (x, y, [a, b, c, d]) => {
            const size = (c - a) ** 2 + (d - b) ** 2;
            const t = size > 0 ? Math.max(0, Math.min(1, ((x - a) * (c - a) + (y - b) * (d - b)) / size)) : 0;
            return Math.hypot(a + t * (c - a) - x, b + t * (d - b) - y);
        };
        let nearest;
        const near = (x, y) => {
            let least = Infinity;
            nearest = undefined;
            const around = [];
            for (const u of [-1, 0, 1]) for (const v of [-1, 0, 1]) around.push(...(cells.get((Math.floor(x / 2) + u) * 65536 + Math.floor(y / 2) + v) ?? []));
            for (const segment of around) {
                const off = toSegment(x, y, segment);
                if (off < least) [least, nearest] = [off, segment[6]];
            }
            if (least < NEAR) return least;
            // At a corner a chord is off: closer.
            for (const segment of around) {
                if (toSegment(x, y, segment) > dense) continue;
                const [, , , , place, step] = segment;
                let [a, b] = place(step - 1);
                for (let part = 1; part <= 64; part++) {
                    const [c, d] = place(step - 1 + part / 64);
                    least = Math.min(least, toSegment(x, y, [a, b, c, d]));
                    [a, b] = [c, d];
                }
            }
            return least;
        };
        for (const list of strokes) {
            const every = Math.max(2, 2 * Math.floor(list.length / 120));
            for (let i = 0; i + 3 < list.length; i += every) {
                const [x, y] = [(list[i] + list[i + 2]) / 2, high - (list[i + 1] + list[i + 3]) / 2];
                const off = near(x, y);
                if (off - (nearest ? slackOf(nearest, nearest.getScreenCTM()) : 0) > NEAR) return `added: at ${x.toFixed(3)}, ${y.toFixed(3)}: ${off.toFixed(4)} px off ${nearest?.outerHTML}`;
            }
        }
    } finally {
        svg.remove();
    }
    difference.count += count;
    return undefined;
}
difference.count = 0;
const told = [];
for (const [seed, text, strokes] of CASES) {
    let fault;
    try {
        fault = difference(text, strokes);
    } catch (error) {
        fault = `error: ${error.stack.split("\n").slice(0, 2).join(" ")}`;
    }
    if (fault !== undefined) told.push(`${seed}: ${fault}`);
}
const pre = document.createElement("pre");
pre.textContent = [`${difference.count} places of ${CASES.length} drawings, ${told.length} differ`, ...told].join("\n");
document.body.replaceChildren(pre);
