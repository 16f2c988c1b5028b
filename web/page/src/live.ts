// Curves of a board as it goes on: asked for, and measured.

import uPlot from "uplot";
import { degrees, round } from "./format";
import type { TakenDrives, TakenSample } from "./taken";

interface Curve {
    title: string;
    unit: string;
    factor: number;
    values: (values: TakenDrives) => Float64Array;
}

const CURVES: Curve[] = [
    { title: "Angle", unit: "\u00b0", factor: degrees(1), values: (values) => values.angles },
    { title: "Rate", unit: "rad/s", factor: 1, values: (values) => values.rates },
    { title: "Torque", unit: "N m", factor: 1, values: (values) => values.torques },
];

/** Time that the curves show, s. */
const SPAN = 10;

/** Least time between two drawings, ms. */
const DRAW = 100;

const HEIGHT = 170;

const colour = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class LivePlots {
    private plots: uPlot[] = [];
    private times: number[] = [];
    /** By curve: three motors asked for, three measured. */
    private columns: (number | null)[][][] = [];
    private drawn = 0;

    constructor(private readonly place: HTMLElement) {
        new ResizeObserver(() => {
            for (const plot of this.plots) {
                const width = plot.root.parentElement?.clientWidth ?? 0;
                if (width > 0) plot.setSize({ width, height: HEIGHT });
            }
        }).observe(place);
    }

    clear(): void {
        this.restyle();
        this.times = [];
        this.columns = CURVES.map(() => Array.from({ length: 6 }, () => []));
    }

    /** Draws anew in the colours that hold now. */
    restyle(): void {
        for (const plot of this.plots) plot.destroy();
        this.plots = [];
        this.place.replaceChildren();
    }

    add({ time, commanded, measured }: TakenSample): void {
        const last = this.times.at(-1);
        // A board that was switched on again counts from 0.
        if (last !== undefined && time <= last) this.clear();
        this.times.push(time);
        CURVES.forEach((curve, index) => {
            const columns = this.columns[index] ?? [];
            const shown = measured && curve.values(measured);
            const asked = curve.values(commanded);
            for (const motor of [0, 1, 2]) {
                columns[motor]?.push((asked[motor] ?? 0) * curve.factor);
                columns[motor + 3]?.push(shown ? (shown[motor] ?? 0) * curve.factor : null);
            }
        });
        const old = this.times.findIndex((each) => each >= time - SPAN);
        if (old > 0) for (const list of [this.times, ...this.columns.flat()]) list.splice(0, old);
        const now = performance.now();
        if (now - this.drawn < DRAW) return;
        this.drawn = now;
        if (this.plots.length === 0) this.begin();
        this.plots.forEach((plot, index) => plot.setData([this.times, ...(this.columns[index] ?? [])] as uPlot.AlignedData));
    }

    private begin(): void {
        const boxes = CURVES.map((curve) => {
            const box = document.createElement("figure");
            const caption = document.createElement("figcaption");
            const unit = document.createElement("span");
            unit.className = "muted";
            unit.textContent = curve.unit;
            caption.append(curve.title, " ", unit);
            box.append(caption);
            this.place.append(box);
            return box;
        });
        const axis = { stroke: colour("--muted"), grid: { stroke: colour("--grid"), width: 1 }, ticks: { stroke: colour("--grid"), width: 1 }, font: "12px system-ui, sans-serif" };
        this.plots = boxes.map((box, index) => {
            const line = (motor: number, dash?: number[]) => ({ stroke: colour(`--motor${motor}`), width: dash ? 2.5 : 1.5, points: { show: false }, ...(dash ? { dash } : {}) });
            const options: uPlot.Options = {
                width: Math.max(box.clientWidth, 200),
                height: HEIGHT,
                legend: { show: false },
                cursor: { show: false },
                scales: { x: { time: false, range: (_, __, most) => [most - SPAN, most] }, y: { range: (_, least, most) => [least - 0.08 * Math.max(most - least, 1e-3), most + 0.08 * Math.max(most - least, 1e-3)] } },
                axes: [{ ...axis, size: 28, values: (_, values) => values.map((value) => `${round(value)} s`) }, { ...axis, size: 56, values: (_, values) => values.map(round) }],
                series: [{}, ...[1, 2, 3].map((motor) => line(motor)), ...[1, 2, 3].map((motor) => line(motor, [2, 6]))],
            };
            return new uPlot(options, [this.times, ...(this.columns[index] ?? [])] as uPlot.AlignedData, box);
        });
    }
}
