// Curves of the job against the limits.

import uPlot from "uplot";
import type { JobTable, PlantTable } from "./answers";
import { degrees, number, round } from "./format";
import type { TakenLimits } from "./taken";

interface Curve {
    title: string;
    unit: string;
    columns: string[];
    /** Drawn for one SI unit. */
    factor: number;
    limit: (limits: TakenLimits, job: JobTable) => Float64Array | undefined;
    colours: string[];
}

/** Curve of each motor. */
function ofMotors(title: string, unit: string, column: string, limit: Curve["limit"] = () => undefined, factor = 1): Curve {
    const motors = [1, 2, 3];
    return { title, unit, columns: motors.map((motor) => `${column}${motor}`), factor, limit, colours: motors.map((motor) => `--motor${motor}`) };
}

const CURVES: Curve[] = [
    { title: "Speed along the path", unit: "m/s", columns: ["speed"], factor: 1, limit: (_, job) => job.feeds, colours: ["--path"] },
    ofMotors("Angle", "\u00b0", "th1_", undefined, degrees(1)),
    ofMotors("Rate", "rad/s", "dth1_", (limits) => limits.rates),
    ofMotors("Acceleration", "rad/s\u00b2", "ddth1_", (limits) => limits.accelerations),
    ofMotors("Torque", "N m", "tau", (limits) => limits.torques),
    ofMotors("Power", "W", "P", (limits) => limits.powers),
];

/** Curves of the plant: what is measured against what is commanded. */
const OF_PLANT: Curve[] = [
    { title: "Tracking error of D", unit: "mm", columns: ["off"], factor: 1000, limit: () => undefined, colours: ["--path"] },
    ofMotors("Tracking error of the joints", "mrad", "error", undefined, 1000),
    ofMotors("Torque of the plant's motors", "N m", "tau", (limits) => limits.torques),
];

const HEIGHT = 190;

const colour = (name: string): string => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class Plots {
    private plots: uPlot[] = [];
    private time = 0;

    constructor(
        private readonly place: HTMLElement,
        private readonly onTime: (time: number) => void,
    ) {
        new ResizeObserver(() => {
            for (const plot of this.plots) {
                const width = plot.root.parentElement?.clientWidth ?? 0;
                if (width > 0) plot.setSize({ width, height: HEIGHT });
            }
        }).observe(place);
    }

    clear(): void {
        for (const plot of this.plots) plot.destroy();
        this.plots = [];
        this.place.replaceChildren();
    }

    show(job: JobTable, plant: PlantTable | undefined, limits: TakenLimits): void {
        this.clear();
        // All boxes first: a curve is as wide as its box is then.
        const made: (() => uPlot)[] = [];
        const ofPlant = plant ? OF_PLANT.map((curve) => [curve, plant.columns] as const) : [];
        for (const [curve, columns] of [...CURVES.map((each) => [each, job.columns] as const), ...ofPlant]) {
            const time = columns.t;
            if (!time) continue;
            const values = curve.columns.flatMap((name) => columns[name]?.map((value) => value * curve.factor) ?? []);
            if (values.length < curve.columns.length) continue;
            const box = document.createElement("figure");
            const caption = document.createElement("figcaption");
            const peak = Math.max(...values.map((each) => each.reduce((most, value) => Math.max(most, Math.abs(value)), 0)));
            const unit = document.createElement("span");
            unit.className = "muted";
            unit.textContent = `${curve.unit}, at most ${number(peak)}`;
            caption.append(curve.title, " ", unit);
            box.append(caption);
            this.place.append(box);
            made.push(() => this.plot(box, [time, ...values], curve.colours, curve.limit(limits, job), job.begins));
        }
        this.plots = made.map((make) => make());
    }

    /** Marks a time. */
    mark(time: number): void {
        this.time = time;
        for (const plot of this.plots) plot.redraw(false, false);
    }

    private plot(box: HTMLElement, data: [Float64Array, ...Float64Array[]], colours: string[], limits: Float64Array | undefined, begins: Float64Array): uPlot {
        const axis = { stroke: colour("--muted"), grid: { stroke: colour("--grid"), width: 1 }, ticks: { stroke: colour("--grid"), width: 1 }, font: "12px system-ui, sans-serif" };
        const largest = limits && limits.length > 0 ? Math.max(...limits) : undefined;
        const options: uPlot.Options = {
            width: Math.max(box.clientWidth, 200),
            height: HEIGHT,
            legend: { show: false },
            cursor: { drag: { x: false, y: false }, points: { size: 6 }, y: false },
            scales: {
                x: { time: false },
                y: {
                    range: (_, least, most) => {
                        // A limit belongs into the picture unless the curves would be flat beside it.
                        const size = Math.max(Math.abs(least), Math.abs(most));
                        const isNear = largest !== undefined && largest < 4 * size;
                        const low = isNear && least < 0 ? Math.min(least, -largest) : least;
                        const high = isNear ? Math.max(most, largest) : most;
                        const margin = 0.08 * Math.max(high - low, 1e-9);
                        return [low - margin, high + margin];
                    },
                },
            },
            axes: [{ ...axis, size: 28, values: (_, values) => values.map((value) => `${round(value)} s`) }, { ...axis, size: 56, values: (_, values) => values.map(round) }],
            series: [{}, ...colours.map((name) => ({ stroke: colour(name), width: 1.75, points: { show: false } }))],
            hooks: {
                drawClear: [(plot) => this.drawBegins(plot, begins)],
                draw: [(plot) => this.drawMarks(plot, limits)],
                ready: [
                    (plot) =>
                        plot.over.addEventListener("click", () => {
                            const { left } = plot.cursor;
                            if (left !== undefined && left >= 0) this.onTime(plot.posToVal(left, "x"));
                        }),
                ],
            },
        };
        return new uPlot(options, data, box);
    }

    /** Light lines where moves begin, unless they are too many to be told apart. */
    private drawBegins(plot: uPlot, begins: Float64Array): void {
        if (begins.length < 2 || begins.length > 40) return;
        const { ctx, bbox } = plot;
        ctx.save();
        ctx.strokeStyle = colour("--grid");
        ctx.lineWidth = devicePixelRatio * 1.5;
        ctx.beginPath();
        for (const begin of begins.subarray(1)) {
            const x = Math.round(plot.valToPos(begin, "x", true));
            ctx.moveTo(x, bbox.top);
            ctx.lineTo(x, bbox.top + bbox.height);
        }
        ctx.stroke();
        ctx.restore();
    }

    private drawMarks(plot: uPlot, limits: Float64Array | undefined): void {
        const { ctx, bbox } = plot;
        ctx.save();
        ctx.beginPath();
        ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
        ctx.clip();
        ctx.lineWidth = devicePixelRatio * 1.25;
        ctx.strokeStyle = colour("--limit");
        ctx.setLineDash([6 * devicePixelRatio, 4 * devicePixelRatio]);
        ctx.beginPath();
        for (const limit of new Set(limits ?? [])) {
            for (const value of [limit, -limit]) {
                const y = plot.valToPos(value, "y", true);
                ctx.moveTo(bbox.left, y);
                ctx.lineTo(bbox.left + bbox.width, y);
            }
        }
        ctx.stroke();
        ctx.setLineDash([]);
        ctx.strokeStyle = colour("--path");
        ctx.beginPath();
        const x = plot.valToPos(this.time, "x", true);
        ctx.moveTo(x, bbox.top);
        ctx.lineTo(x, bbox.top + bbox.height);
        ctx.stroke();
        ctx.restore();
    }
}
