// The summary of a plant: what motors, gears and friction make of the job.

import type { PlantTable } from "./answers";
import { number } from "./format";

/** Rows of the table: title, unit, drawn for one SI unit. */
const ROWS: [string, string, number][] = [
    ["Joint error", "mrad", 1000],
    ["Torque", "N m", 1],
    ["Current", "A", 1],
    ["Power", "W", 1],
];

function row(head: string, cells: string[], kind: "td" | "th"): HTMLElement {
    const made = document.createElement("tr");
    const first = document.createElement("th");
    first.scope = "row";
    first.textContent = head;
    const others = cells.map((text, motor) => {
        const cell = document.createElement(kind);
        cell.textContent = text;
        if (kind === "th") cell.className = `m${motor + 1}`;
        return cell;
    });
    made.append(first, ...others);
    return made;
}

/** Shows the figures of a plant, a sentence in place of them, or nothing. */
export function showPlant(page: (id: string) => HTMLElement, plant: PlantTable | string | undefined): void {
    page("plant").hidden = plant === undefined;
    page("plant-head").replaceChildren();
    page("plant-rows").replaceChildren();
    if (plant === undefined) return;
    if (typeof plant === "string") {
        page("plant-words").textContent = plant;
        return;
    }
    const [off = 0, at = 0, mean = 0, turned = 0] = plant.tool;
    const words = [
        `D is at most ${number(off * 1e6)} \u00b5m off its setpoint, at t = ${number(at)} s, rms ${number(mean * 1e6)} \u00b5m; the platform is turned by at most ${number(turned * 1e6)} \u00b5rad.`,
        ...plant.notes.map((note) => `${note}.`),
        `Energies close to ${number(plant.balance)}.`,
    ];
    page("plant-words").textContent = words.join(" ");
    page("plant-head").append(row("Peak, rms", ["Motor 1", "Motor 2", "Motor 3"], "th"));
    ROWS.forEach(([title, unit, factor], index) => {
        const cells = [0, 1, 2].map((motor) => {
            const from = 2 * (ROWS.length * motor + index);
            const [peak = 0, rms = 0] = plant.loads.subarray(from, from + 2);
            return `${number(peak * factor)}, ${number(rms * factor)}`;
        });
        page("plant-rows").append(row(`${title} ${unit}`, cells, "td"));
    });
}
