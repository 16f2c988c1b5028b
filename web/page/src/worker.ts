// Reads scenes whole and plays their jobs, away from the thread that draws.
import { initSync, type Reading } from "../core/core.js";
import type { Answer, JobTable, ModesAnswer, PlantAnswer, PlantTable, Question } from "./answers";
import { taken } from "./taken";
import { whole } from "./whole";

/** Most rows of a job's table. */
const ROWS = 20_000;

/** Columns that the page draws. */
const COLUMNS = [
    "t", "x", "y", "alpha", "vx", "vy", "valpha", "ax", "ay", "aalpha",
    ...["th1_", "dth1_", "ddth1_", "tau", "P"].flatMap((name) => [1, 2, 3].map((motor) => `${name}${motor}`)),
];

function table(reading: Reading): JobTable {
    const job = reading.job(ROWS);
    const columns: Record<string, Float64Array> = {};
    for (const name of COLUMNS) {
        const values = job.values(name);
        if (values) columns[name] = values;
    }
    columns.speed = job.speeds();
    const { begins, every, feeds, reason } = job;
    job.free();
    return { columns, begins, every, feeds, reason };
}

/** Columns of a plant. */
const PLANT = ["t", "x", "y", "alpha", "off", ...["error", "tau"].flatMap((name) => [1, 2, 3].map((motor) => `${name}${motor}`))];

/** Simulates the plant, or says why that is not possible. */
function plantOf(reading: Reading): PlantTable | string {
    try {
        const plant = reading.plant(ROWS);
        if (!plant) return "The scene has no plant.";
        const columns: Record<string, Float64Array> = {};
        for (const name of PLANT) columns[name] = plant.values(name) ?? new Float64Array();
        const { tool, loads, notes, balance } = plant;
        plant.free();
        return { columns, tool, loads, notes, balance };
    } catch (sentence) {
        return `The plant is refused: ${String(sentence)}.`;
    }
}

export function work(): void {
    addEventListener("message", ({ data }: MessageEvent<Question>) => {
        const { id, module } = data;
        if (module) initSync({ module });
        const { reading, isOfJob } = whole(data);
        const { refusal, verdict, warning, notes, breach } = reading;
        const job = refusal === undefined ? table(reading) : undefined;
        const path = isOfJob ? reading.path : undefined;
        const answer: Answer = { id, problems: reading.problems.map(taken), refusal, verdict, warning, isOfJob, notes, path, breach, job, hasPlant: reading.hasPlant };
        postMessage(answer);
        if (job) {
            const all: ModesAnswer = { id, modes: reading.jobModes().map(taken) };
            postMessage(all);
        }
        if (answer.hasPlant) {
            const simulated: PlantAnswer = { id, plant: plantOf(reading) };
            postMessage(simulated);
        }
        reading.free();
    });
}
