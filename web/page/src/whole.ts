// A scene that is read whole in a worker, with a job in a file of its own.

import { GivenDrawing, JobInputs, Reading } from "../core/core.js";
import { initSync as initDrawings, readDrawing } from "../core/drawing.js";
import type { JobFile, Source } from "./answers";
import { taken } from "./taken";

let hasDrawings = false;

/** Reads a drawing by the module of its own. */
function drawingOf(text: string, module: WebAssembly.Module): GivenDrawing {
    if (!hasDrawings) initDrawings({ module });
    hasDrawings = true;
    const { numbers, names, reason, word, line } = taken(readDrawing(text));
    return reason === undefined ? GivenDrawing.read(numbers, names) : GivenDrawing.refused(line, word, reason);
}

/** Reads the job of the file in place of that of the scene. */
function withJob(scene: Reading, { file, text, inputs }: JobFile, drawings: WebAssembly.Module | undefined): Reading {
    const given = Object.assign(new JobInputs(), inputs);
    try {
        return scene.withJob(text, file, given, drawings && drawingOf(text, drawings));
    } finally {
        given.free();
        scene.free();
    }
}

/** Reads a scene, and the job of its file if the scene is good: the reading, and whether it is about that file. */
export function whole({ text, file, machine, job, drawings }: Source): { reading: Reading; isOfJob: boolean } {
    const scene = Reading.whole(text, file, machine);
    if (job === undefined || scene.refusal !== undefined) return { reading: scene, isOfJob: false };
    return { reading: withJob(scene, job, drawings), isOfJob: true };
}
