/** Shipped scenes by name; set by build.mjs. */
declare const SCENES: Record<string, string>;
/** Script of the worker; set by build.mjs. */
declare const WORKER: string;
