// The machine in its plane, and the platform that the user drags. Positions come from the core; millimetres on paper, y upwards.

import type { TakenFigures } from "./taken";

export type Pose = readonly [number, number, number];

const NS = "http://www.w3.org/2000/svg";
const MM = 1000;
/** Radius of what a finger hits, and way from D to the knob that turns the platform, in pixels. */
const GRIP = 24;
const KNOB = 52;
/** Part of the width that a key stroke moves the platform by, and angle that it turns it by. */
const STEP = 1 / 400;
const TURN = Math.PI / 180;

function shape<K extends keyof SVGElementTagNameMap>(kind: K, parent: SVGElement, attributes: Record<string, string> = {}): SVGElementTagNameMap[K] {
    const element = document.createElementNS(NS, kind);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    parent.append(element);
    return element;
}

const at = (values: ArrayLike<number>, joint: number): [number, number] => [(values[2 * joint] ?? 0) * MM, -(values[2 * joint + 1] ?? 0) * MM];

function line(element: SVGElement, [x1, y1]: [number, number], [x2, y2]: [number, number]): void {
    element.setAttribute("x1", String(x1));
    element.setAttribute("y1", String(y1));
    element.setAttribute("x2", String(x2));
    element.setAttribute("y2", String(y2));
}

function dot(element: SVGElement, [x, y]: [number, number]): void {
    element.setAttribute("cx", String(x));
    element.setAttribute("cy", String(y));
}

const corners = (joints: ArrayLike<number>): string => [0, 1, 2].map((joint) => at(joints, joint).join(",")).join(" ");

export class Drawing {
    private readonly grid: SVGPathElement;
    private readonly path: SVGPolylineElement;
    private readonly breach: SVGCircleElement;
    private readonly ghosts: SVGGElement;
    private readonly ghostLegs: SVGGElement;
    private readonly measured: SVGGElement;
    private readonly legs: { far: SVGLineElement; near: SVGLineElement; elbow: SVGCircleElement; base: SVGCircleElement; joint: SVGCircleElement; label: SVGTextElement }[] = [];
    private readonly platform: SVGPolygonElement;
    private readonly spoke: SVGLineElement;
    private readonly knob: SVGCircleElement;
    private readonly centre: SVGCircleElement;
    private readonly handle: SVGGElement;
    private readonly grip: SVGCircleElement;
    private readonly scaleBar: SVGTextElement;
    private frame: [number, number, number, number] = [0, 0, 1, 1];
    private pose: Pose = [0, 0, 0];
    private pending: Pose | undefined;

    constructor(
        private readonly svg: SVGSVGElement,
        private readonly onMove: (pose: Pose) => void,
    ) {
        this.grid = shape("path", svg, { class: "grid-lines" });
        this.scaleBar = shape("text", svg, { class: "scale" });
        this.path = shape("polyline", svg, { class: "way" });
        this.breach = shape("circle", svg, { class: "breach" });
        this.ghosts = shape("g", svg, { class: "ghosts" });
        this.ghostLegs = shape("g", svg, { class: "ghost-legs" });
        this.measured = shape("g", svg, { class: "measured" });
        for (const motor of [1, 2, 3]) {
            const leg = shape("g", svg, { class: `leg m${motor}` });
            const far = shape("line", leg, { class: "distal" });
            const near = shape("line", leg, { class: "proximal" });
            const base = shape("circle", leg, { class: "base" });
            const elbow = shape("circle", leg, { class: "joint" });
            const joint = shape("circle", leg, { class: "joint" });
            const label = shape("text", leg, { class: "label" });
            label.textContent = String(motor);
            this.legs.push({ far, near, elbow, base, joint, label });
        }
        this.handle = shape("g", svg, { class: "platform", tabindex: "0", role: "application", "aria-roledescription": "platform to drag", "aria-label": "Platform. Arrow keys move it, Q and E turn it." });
        this.platform = shape("polygon", this.handle, { class: "body" });
        this.spoke = shape("line", this.handle, { class: "spoke" });
        this.grip = shape("circle", this.handle, { class: "grip" });
        this.centre = shape("circle", this.handle, { class: "centre" });
        this.knob = shape("circle", this.handle, { class: "knob" });
        this.listen();
        new ResizeObserver(() => this.resize()).observe(svg);
    }

    /** Shows another machine: its frame in m, and the path of D. */
    show(frame: ArrayLike<number>): void {
        const [left = 0, low = 0, right = 1, high = 1] = Array.from(frame);
        const margin = 0.04 * Math.max(right - left, high - low);
        this.frame = [(left - margin) * MM, -(high + margin) * MM, (right - left + 2 * margin) * MM, (high - low + 2 * margin) * MM];
        this.svg.setAttribute("viewBox", this.frame.join(" "));
        this.drawGrid();
        this.resize();
    }

    /** Shows a path, and the place at which it has no plan. */
    showPath(x: ArrayLike<number> | undefined, y: ArrayLike<number> | undefined, breach: ArrayLike<number> | undefined): void {
        this.breach.style.display = breach ? "" : "none";
        if (breach) dot(this.breach, at(breach, 0));
        const points: string[] = [];
        if (x && y) {
            // A screen has no more points than that.
            const every = Math.max(1, Math.floor(x.length / 4000));
            for (let row = 0; row < x.length; row += every) points.push(`${((x[row] ?? 0) * MM).toFixed(2)},${(-(y[row] ?? 0) * MM).toFixed(2)}`);
        }
        this.path.setAttribute("points", points.join(" "));
    }

    showGhosts(platforms: ArrayLike<number>[]): void {
        while (this.ghosts.childElementCount > platforms.length) this.ghosts.lastElementChild?.remove();
        platforms.forEach((joints, index) => {
            const ghost = this.ghosts.children[index] ?? shape("polygon", this.ghosts);
            ghost.setAttribute("points", corners(joints));
        });
    }

    showGhostLegs(figures: TakenFigures | undefined, elbows: ArrayLike<number> | undefined): void {
        this.ghostLegs.replaceChildren();
        if (!figures || !elbows || elbows.length < 6) return;
        for (const leg of [0, 1, 2]) {
            const points = [at(figures.base, leg), at(elbows, leg), at(figures.platform, leg)].map((point) => point.join(","));
            shape("polyline", this.ghostLegs, { class: `m${leg + 1}`, points: points.join(" ") });
        }
    }

    /** Shows the machine as drives measure it, or where a plant has it, beside the one that is drawn. */
    showMeasured(figures: TakenFigures | undefined): void {
        this.measured.replaceChildren();
        if (!figures || figures.elbows.length < 6) return;
        for (const leg of [0, 1, 2]) {
            const points = [at(figures.base, leg), at(figures.elbows, leg), at(figures.platform, leg)].map((point) => point.join(","));
            shape("polyline", this.measured, { class: `m${leg + 1}`, points: points.join(" ") });
        }
        shape("polygon", this.measured, { points: corners(figures.platform) });
    }

    draw(pose: Pose, figures: TakenFigures): void {
        this.pose = pose;
        const { base, elbows, platform } = figures;
        const isReached = elbows.length === 6;
        this.svg.classList.toggle("unreached", !isReached);
        this.legs.forEach((leg, index) => {
            const [a, c] = [at(base, index), at(platform, index)];
            dot(leg.base, a);
            dot(leg.joint, c);
            leg.label.setAttribute("x", String(a[0]));
            leg.label.setAttribute("y", String(a[1]));
            const b = isReached ? at(elbows, index) : a;
            line(leg.near, a, b);
            line(leg.far, b, isReached ? c : a);
            dot(leg.elbow, b);
        });
        this.platform.setAttribute("points", corners(platform));
        const d: [number, number] = [pose[0] * MM, -pose[1] * MM];
        const way = KNOB * this.perPixel();
        const knob: [number, number] = [d[0] + way * Math.cos(pose[2]), d[1] - way * Math.sin(pose[2])];
        line(this.spoke, d, knob);
        for (const mark of [this.grip, this.centre]) dot(mark, d);
        dot(this.knob, knob);
    }

    /** Length on paper of a pixel. */
    private perPixel(): number {
        const { width, height } = this.svg.getBoundingClientRect();
        return Math.max(this.frame[2] / Math.max(width, 1), this.frame[3] / Math.max(height, 1));
    }

    private resize(): void {
        const pixel = this.perPixel();
        const radius = (element: SVGElement, pixels: number) => element.setAttribute("r", String(pixels * pixel));
        for (const leg of this.legs) {
            radius(leg.base, 11);
            radius(leg.elbow, 5);
            radius(leg.joint, 4);
            leg.label.style.fontSize = `${13 * pixel}px`;
        }
        radius(this.breach, 9);
        radius(this.grip, GRIP);
        radius(this.centre, 3.5);
        radius(this.knob, 8);
        this.scaleBar.style.fontSize = `${12 * pixel}px`;
        const [left, top, , height] = this.frame;
        this.scaleBar.setAttribute("x", String(left + 8 * pixel));
        this.scaleBar.setAttribute("y", String(top + height - 8 * pixel));
    }

    /** Lines at round lengths, and the length between two. */
    private drawGrid(): void {
        const [left, top, width, height] = this.frame;
        const decade = 10 ** Math.floor(Math.log10(width / 4));
        const pitch = [5, 2, 1].map((times) => times * decade).find((each) => width / each >= 4) ?? decade;
        let path = "";
        // As far again on each side: the paper has another shape than the frame.
        for (let x = Math.ceil((left - width) / pitch) * pitch; x <= left + 2 * width; x += pitch) path += `M${x} ${top - height}v${3 * height}`;
        for (let y = Math.ceil((top - height) / pitch) * pitch; y <= top + 2 * height; y += pitch) path += `M${left - width} ${y}h${3 * width}`;
        this.grid.setAttribute("d", path);
        this.scaleBar.textContent = `grid ${pitch >= 1 ? pitch : pitch.toPrecision(1)} mm`;
    }

    private point(event: PointerEvent): [number, number] {
        const matrix = this.svg.getScreenCTM();
        if (!matrix) return [this.pose[0], this.pose[1]];
        const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix.inverse());
        return [x / MM, -y / MM];
    }

    private listen(): void {
        let move: ((point: [number, number]) => Pose) | undefined;
        this.handle.addEventListener("pointerdown", (event) => {
            const from = this.point(event);
            const [x, y, alpha] = this.pose;
            const off = [x - from[0], y - from[1]] as const;
            move =
                event.target === this.knob
                    ? ([px, py]) => {
                          // The nearest of the angles that are the same: alpha is not wrapped.
                          const turned = Math.atan2(py - y, px - x) - alpha;
                          return [x, y, alpha + turned - 2 * Math.PI * Math.round(turned / (2 * Math.PI))];
                      }
                    : ([px, py]) => [px + off[0], py + off[1], alpha];
            this.handle.setPointerCapture(event.pointerId);
            this.handle.focus({ preventScroll: true });
            event.preventDefault();
        });
        this.handle.addEventListener("pointermove", (event) => {
            if (move) this.ask(move(this.point(event)));
        });
        for (const end of ["pointerup", "pointercancel"]) this.handle.addEventListener(end, () => (move = undefined));
        this.handle.addEventListener("keydown", (event) => {
            const times = event.shiftKey ? 10 : 1;
            const step = (times * STEP * this.frame[2]) / MM;
            const turn = times * TURN;
            const [x, y, alpha] = this.pending ?? this.pose;
            const poses: Record<string, Pose> = {
                ArrowLeft: [x - step, y, alpha],
                ArrowRight: [x + step, y, alpha],
                ArrowUp: [x, y + step, alpha],
                ArrowDown: [x, y - step, alpha],
                q: [x, y, alpha + turn],
                e: [x, y, alpha - turn],
            };
            const pose = poses[event.key] ?? poses[event.key.toLowerCase()];
            if (!pose || event.ctrlKey || event.metaKey || event.altKey) return;
            this.ask(pose);
            event.preventDefault();
        });
    }

    /** Moves the platform once per frame, however many events come. */
    private ask(pose: Pose): void {
        const isNew = this.pending === undefined;
        this.pending = pose;
        if (!isNew) return;
        requestAnimationFrame(() => {
            const asked = this.pending;
            this.pending = undefined;
            if (asked) this.onMove(asked);
        });
    }
}
