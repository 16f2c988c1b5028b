// Messages between the page and its worker.

/** A scene to be read whole. */
export interface Question extends Source {
    module?: WebAssembly.Module;
    id: number;
}

/** The texts that make a scene. */
export interface Source {
    text: string;
    file: string;
    /** Text of the file that the scene takes its machine from. */
    machine: string | undefined;
    /** Job in place of that of the scene. */
    job: JobFile | undefined;
    /** Reader of drawings, for a job that is one. */
    drawings: WebAssembly.Module | undefined;
}

/** Choices that a job's file leaves open, by the names of the core. */
export interface JobInputValues {
    x_mm: number;
    y_mm: number;
    alpha_deg: number;
    fit: boolean;
    corner_mm?: number | undefined;
    scale?: number | undefined;
    speed_mm_min?: number | undefined;
    power?: number | undefined;
    hatch_mm?: number | undefined;
    drop_doubles?: boolean;
    tool_by_z_mm?: number | undefined;
    ignore_z?: boolean;
}

/** A job in a file of its own. */
export interface JobFile {
    file: string;
    text: string;
    inputs: JobInputValues;
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
    /** Speeds that the path asks for, m/s. */
    feeds: Float64Array;
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

/** The plant of a scene under its job. */
export interface PlantTable {
    columns: Record<string, Float64Array>;
    /** Peak, its time, root mean square: distance of D, m, then angle, rad. */
    tool: Float64Array;
    /** Peak and root mean square of error, torque, current and power, motor by motor. */
    loads: Float64Array;
    notes: string[];
    balance: number;
}

/** The verdict on a scene, and its job. A second answer brings the job in all working modes, a third one its plant. */
export interface Answer {
    id: number;
    problems: Trouble[];
    refusal: string | undefined;
    verdict: string | undefined;
    warning: string | undefined;
    /** The problems are those of the job's file. */
    isOfJob: boolean;
    notes: string[];
    /** Path in the job's file, x and y in turns, m, and the place at which it has no plan. */
    path: Float64Array | undefined;
    breach: Float64Array | undefined;
    job: JobTable | undefined;
    hasPlant: boolean;
}

/** The plant, or why it cannot be simulated. */
export interface PlantAnswer {
    id: number;
    plant: PlantTable | string;
}

export interface ModesAnswer {
    id: number;
    modes: ModeRow[];
}
