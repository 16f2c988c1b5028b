// Figures, modes and inputs beside the drawing.

import type { ModeRow } from "./answers";
import { degrees, number } from "./format";
import type { TakenAssemblies, TakenFigures, TakenLimits, TakenMode } from "./taken";

interface Row {
    name: string;
    unit: string;
    values: (figures: TakenFigures) => Float64Array;
    shown: (value: number) => string;
    limits: (limits: TakenLimits) => Float64Array | undefined;
}

const ROWS: Row[] = [
    { name: "Angle", unit: "\u00b0", values: (figures) => figures.angles, shown: (value) => number(degrees(value), 4), limits: () => undefined },
    { name: "Rate", unit: "rad/s", values: (figures) => figures.rates, shown: number, limits: (limits) => limits.rates },
    { name: "Torque", unit: "N m", values: (figures) => figures.torques, shown: number, limits: (limits) => limits.torques },
    { name: "Power", unit: "W", values: (figures) => figures.powers, shown: number, limits: (limits) => limits.powers },
];

/** Inputs of a state: name, unit, what stands in the input for one SI unit. */
const POSE: [string, string, number, number][] = [
    ["x", "mm", 1000, 1],
    ["y", "mm", 1000, 1],
    ["alpha", "\u00b0", degrees(1), 1],
];
const MOTION: [string, string, number, number][] = [
    ["vx", "m/s", 1, 0.05],
    ["vy", "m/s", 1, 0.05],
    ["turning", "rad/s", 1, 0.1],
    ["ax", "m/s\u00b2", 1, 0.5],
    ["ay", "m/s\u00b2", 1, 0.5],
    ["turning", "rad/s\u00b2", 1, 1],
];

function element<K extends keyof HTMLElementTagNameMap>(kind: K, attributes: Record<string, string> = {}, ...children: (Node | string)[]): HTMLElementTagNameMap[K] {
    const made = document.createElement(kind);
    for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
    made.append(...children);
    return made;
}

/** Cells of a row that can be chosen: the button in its head, and the others. */
function cellsOf(row: HTMLElement): HTMLElement[] {
    const [head, ...others] = [...row.children] as HTMLElement[];
    const button = head?.querySelector("button");
    return button ? [button, ...others] : [];
}

/** Sets text only where it changes: the rest of the page is not laid out again. */
function say(cell: HTMLElement, text: string): void {
    if (cell.textContent !== text) cell.textContent = text;
}

export class Panel {
    private readonly cells: HTMLElement[][];
    private readonly meters: HTMLElement[];
    private readonly inputs: { input: HTMLInputElement; factor: number }[] = [];
    private readonly live: HTMLElement;
    private spoken = 0;

    constructor(
        private readonly page: (id: string) => HTMLElement,
        onState: (state: number[]) => void,
    ) {
        this.cells = ROWS.map((row) => {
            const cells = [1, 2, 3].map(() => element("td"));
            const head = element("th", { scope: "row" }, row.name, " ", element("span", { class: "muted" }, row.unit));
            page("motors").append(element("tr", {}, head, ...cells));
            return cells;
        });
        this.meters = ["leg 1", "leg 2", "leg 3", "parallel"].map((name, index) => {
            const label = index < 3 ? `serial, ${name}` : name;
            const meter = element("div", { class: `meter${index < 3 ? ` m${index + 1}` : ""}`, role: "meter", "aria-label": `Distance from the ${index < 3 ? `serial singularity of ${name}` : "parallel singularity"}`, "aria-valuemin": "0", "aria-valuemax": "1" }, element("i"), element("b"));
            page("distances").append(element("div", { class: "distance" }, element("span", {}, label), meter, element("output")));
            return meter;
        });
        const take = () => {
            const state = this.inputs.map(({ input, factor }) => input.valueAsNumber / factor);
            // A field that is empty or half written is no state yet.
            if (state.every(Number.isFinite)) onState(state);
        };
        for (const [place, list] of [["pose", POSE], ["rates", MOTION]] as const) {
            for (const [name, unit, factor, step] of list) {
                const input = element("input", { type: "number", step: "any", "data-step": String(step) });
                input.addEventListener("input", take);
                page(place).append(element("label", {}, element("span", {}, name, " ", element("span", { class: "muted" }, unit)), input));
                this.inputs.push({ input, factor });
            }
        }
        this.live = page("live");
    }

    /** Shows a state in the inputs, but for the one that the user writes into. */
    showState(state: readonly number[]): void {
        this.inputs.forEach(({ input, factor }, index) => {
            if (document.activeElement === input) return;
            const value = (state[index] ?? 0) * factor;
            const text = String(Number(value.toFixed(factor === 1 ? 4 : 2)));
            if (input.value !== text) input.value = text;
        });
    }

    showFigures(figures: TakenFigures, limits: TakenLimits): void {
        ROWS.forEach((row, index) => {
            const [values, most] = [row.values(figures), row.limits(limits)];
            this.cells[index]?.forEach((cell, motor) => {
                const value = values[motor];
                say(cell, value === undefined ? "\u2013" : row.shown(value));
                const limit = most?.[motor];
                const part = limit && value !== undefined ? Math.abs(value) / limit : 0;
                cell.classList.toggle("over", part > 1);
                cell.style.setProperty("--part", String(Math.min(part, 1)));
            });
        });
        const distances = [...(figures.serial.length === 3 ? figures.serial : [NaN, NaN, NaN]), figures.serial.length === 3 ? figures.parallel : NaN];
        this.meters.forEach((meter, index) => {
            const value = distances[index] ?? NaN;
            const least = index < 3 ? limits.serial : limits.parallel;
            meter.style.setProperty("--part", String(Number.isNaN(value) ? 0 : value));
            meter.style.setProperty("--least", String(least));
            meter.setAttribute("aria-valuenow", Number.isNaN(value) ? "0" : value.toFixed(3));
            meter.classList.toggle("over", value < least);
            say(meter.nextElementSibling as HTMLElement, number(value));
        });
        const reason = this.page("reason");
        const words = figures.reason ?? figures.breaches.join("; ");
        reason.hidden = words === "";
        say(reason, words);
        reason.classList.toggle("soft", figures.reason === undefined);
    }

    /** Tells a screen reader the figures, once the platform rests for a moment. */
    speak(state: readonly number[], figures: TakenFigures): void {
        clearTimeout(this.spoken);
        this.spoken = setTimeout(() => {
            const [x = 0, y = 0, alpha = 0] = state;
            const place = `x ${number(x * 1000, 4)} mm, y ${number(y * 1000, 4)} mm, alpha ${number(degrees(alpha))} degrees. `;
            const torques = [...figures.torques].map((torque) => number(torque)).join(", ");
            say(this.live, place + (figures.reason ?? `Torques ${torques} newton metres. Parallel distance ${number(figures.parallel)}.`));
        }, 500);
    }

    showModes(modes: TakenMode[], job: ModeRow[] | undefined, onPeek: (name: string | undefined) => void, onTake: (name: string) => void): void {
        const body = this.page("modes");
        while (body.childElementCount > modes.length) body.lastElementChild?.remove();
        modes.forEach((mode, index) => {
            const row = (body.children[index] as HTMLElement | undefined) ?? this.row(body, 4);
            const inJob = job?.find(({ name }) => name === mode.name);
            const largest = mode.torques.reduce((most, torque) => Math.max(most, Math.abs(torque)), 0);
            const [name, here, over, parallel] = cellsOf(row);
            if (!name || !here || !over || !parallel) return;
            say(name, mode.name.replaceAll("-", "\u2212"));
            say(here, mode.torques.length > 0 ? number(largest) : "\u2013");
            this.judge(here, mode.reason);
            say(over, job === undefined ? "\u2026" : inJob === undefined ? "\u2013" : inJob.reason !== undefined && inJob.torque === 0 ? "\u2013" : number(inJob.torque));
            this.judge(over, inJob?.reason);
            const isThere = mode.torques.length > 0 || mode.reason === undefined;
            say(parallel, number(isThere ? mode.parallel : NaN));
            row.classList.toggle("own", mode.isOwn);
            row.onpointerenter = name.onfocus = () => onPeek(mode.name);
            row.onpointerleave = name.onblur = () => onPeek(undefined);
            row.onclick = () => onTake(mode.name);
        });
    }

    showAssemblies(list: TakenAssemblies | string, onTake: (pose: Float64Array) => void): void {
        const body = this.page("assemblies");
        const modes = typeof list === "string" ? [] : list.modes;
        say(this.page("assemblies-count"), typeof list === "string" ? list : `${modes.length} ${modes.length === 1 ? "pose fits" : "poses fit"} these motor angles${list.isComplete ? ", there are no others" : "; the list may be incomplete"}. Choose one to go there.`);
        while (body.childElementCount > modes.length) body.lastElementChild?.remove();
        modes.forEach((mode, index) => {
            const row = (body.children[index] as HTMLElement | undefined) ?? this.row(body, 4);
            const [place, angle, elbows, parallel] = cellsOf(row);
            if (!place || !angle || !elbows || !parallel) return;
            const [x = 0, y = 0, alpha = 0] = mode.pose;
            say(place, `${number(x * 1000, 4)}, ${number(y * 1000, 4)}`);
            say(angle, number(degrees(alpha), 4));
            say(elbows, mode.name.replaceAll("-", "\u2212"));
            say(parallel, number(mode.parallel));
            row.classList.toggle("own", mode.isHere);
            const { pose } = mode;
            row.onclick = () => onTake(pose);
        });
    }

    private row(body: HTMLElement, cells: number): HTMLElement {
        const head = element("th", { scope: "row" }, element("button", { type: "button" }));
        const row = element("tr", {}, head, ...Array.from({ length: cells - 1 }, () => element("td")));
        body.append(row);
        return row;
    }

    /** Marks a cell as possible, or not for a reason. */
    private judge(cell: HTMLElement, reason: string | undefined): void {
        cell.classList.toggle("over", reason !== undefined);
        if (reason === undefined) cell.removeAttribute("title");
        else cell.title = reason;
    }
}


