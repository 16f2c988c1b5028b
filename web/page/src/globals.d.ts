/** Shipped scenes by name; set by build.mjs. */
declare const SCENES: Record<string, string>;
