// Reads scenes whole and plays their jobs, away from the thread that draws.
import { initSync, Reading } from "../core/core.js";
import type { Answer, JobTable, ModesAnswer, Question } from "./answers";
import { taken } from "./taken";

/** Most rows of a job's table. */
const ROWS = 20_000;

/** Columns that the page draws. */
const COLUMNS = [
    "t", "x", "y", "alpha", "vx", "vy", "valpha", "ax", "ay", "aalpha",
    ...["th1_", "dth1_", "tau", "P"].flatMap((name) => [1, 2, 3].map((motor) => `${name}${motor}`)),
];

function table(reading: Reading): JobTable {
    const job = reading.job(ROWS);
    const columns: Record<string, Float64Array> = {};
    for (const name of COLUMNS) {
        const values = job.values(name);
        if (values) columns[name] = values;
    }
    const { begins, every, reason } = job;
    job.free();
    return { columns, begins, every, reason };
}

export function work(): void {
    addEventListener("message", ({ data }: MessageEvent<Question>) => {
        const { id, text, file, module } = data;
        if (module) initSync({ module });
        const reading = Reading.whole(text, file);
        const { refusal, verdict, warning } = reading;
        const job = refusal === undefined ? table(reading) : undefined;
        const answer: Answer = { id, problems: reading.problems.map(taken), refusal, verdict, warning, job };
        postMessage(answer);
        const modes = job ? reading.jobModes().map(taken) : [];
        reading.free();
        if (!job) return;
        const all: ModesAnswer = { id, modes };
        postMessage(all);
    });
}
