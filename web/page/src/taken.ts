// What the core answers, as plain objects. Objects of the core have memory of their own: it is freed here, many times a second, and not when
// a collector comes to it.

import type { BoardView, DriveValues } from "../core/board.js";
import type { AssemblyList, AssemblyMode, Figures, MotorLimits, WorkingMode } from "../core/core.js";

interface CoreObject {
    free(): void;
}

export type Taken<T extends CoreObject> = Omit<T, "free" | symbol>;

export type TakenFigures = Taken<Figures>;
export type TakenLimits = Taken<MotorLimits>;
export type TakenMode = Taken<WorkingMode>;
export interface TakenAssemblies {
    modes: Taken<AssemblyMode>[];
    isComplete: boolean;
}

/** Copies the values of an object of the core, and frees it. */
export function taken<T extends CoreObject>(object: T): Taken<T> {
    const copy: Record<string, unknown> = {};
    const properties: Record<string, PropertyDescriptor> = Object.getOwnPropertyDescriptors(Object.getPrototypeOf(object));
    for (const [name, { get }] of Object.entries(properties)) if (get) copy[name] = get.call(object);
    object.free();
    return copy as Taken<T>;
}

export function takenAssemblies(list: AssemblyList): TakenAssemblies {
    const { modes, isComplete } = taken(list);
    return { modes: modes.map(taken), isComplete };
}

export type TakenDrives = Taken<DriveValues>;
export interface TakenSample {
    time: number;
    setpoint: Float64Array;
    commanded: TakenDrives;
    measured: TakenDrives | undefined;
}
export type TakenView = Omit<Taken<BoardView>, "sample"> & { sample: TakenSample | undefined };

export function takenView(object: BoardView): TakenView {
    const { sample, ...view } = taken(object);
    if (!sample) return { ...view, sample: undefined };
    const { commanded, measured, ...values } = taken(sample);
    return { ...view, sample: { ...values, commanded: taken(commanded), measured: measured && taken(measured) } };
}
