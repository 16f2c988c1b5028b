// Reads scenes whole and plays their jobs, away from the thread that draws.
import { initSync, JobInputs, Reading } from "../core/core.js";
import type { Answer, JobFile, JobTable, ModesAnswer, Question } from "./answers";
import { taken } from "./taken";

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

/** Reads the job of the file in place of that of the scene. */
function withJob(scene: Reading, { file, text, inputs }: JobFile): Reading {
    const given = Object.assign(new JobInputs(), inputs);
    try {
        return scene.withJob(text, file, given);
    } finally {
        given.free();
        scene.free();
    }
}

export function work(): void {
    addEventListener("message", ({ data }: MessageEvent<Question>) => {
        const { id, text, file, module } = data;
        if (module) initSync({ module });
        const scene = Reading.whole(text, file);
        const isOfJob = data.job !== undefined && scene.refusal === undefined;
        const reading = data.job && isOfJob ? withJob(scene, data.job) : scene;
        const { refusal, verdict, warning, notes, breach } = reading;
        const job = refusal === undefined ? table(reading) : undefined;
        const path = isOfJob ? reading.path : undefined;
        const answer: Answer = { id, problems: reading.problems.map(taken), refusal, verdict, warning, isOfJob, notes, path, breach, job };
        postMessage(answer);
        const modes = job ? reading.jobModes().map(taken) : [];
        reading.free();
        if (!job) return;
        const all: ModesAnswer = { id, modes };
        postMessage(all);
    });
}
