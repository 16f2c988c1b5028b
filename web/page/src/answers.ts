// Messages between the page and its worker.

/** A scene to be read whole. */
export interface Question {
    module?: WebAssembly.Module;
    id: number;
    text: string;
    file: string;
}

export interface Trouble {
    line: number;
    column: number;
    sentence: string;
    /** The sentence without key and value. */
    reason: string;
}

/** Table of a job: columns of `ticks.csv` by name. */
export interface JobTable {
    columns: Record<string, Float64Array>;
    /** Times at which moves begin, s. */
    begins: Float64Array;
    every: number;
    reason: string | undefined;
}

export interface ModeRow {
    name: string;
    reason: string | undefined;
    torque: number;
}

/** The verdict on a scene, and its job. A second answer brings the job in all working modes. */
export interface Answer {
    id: number;
    problems: Trouble[];
    refusal: string | undefined;
    verdict: string | undefined;
    warning: string | undefined;
    job: JobTable | undefined;
}

export interface ModesAnswer {
    id: number;
    modes: ModeRow[];
}
