// What the user has written, kept in the browser: another scene, a reload or a closed tab loses none of it.

/** Name under which the browser keeps the texts. */
const KEY = "trirrr";

/** Beginning of the keys of the user's own scenes: no file has a name with a space in front. */
const OWN = " ";

/** A scene with the user's edits, and the text that they were made to. */
interface Edited {
    base: string;
    text: string;
}

interface Texts {
    /** Scene that was shown last. */
    last: string;
    /** Scenes by their names among the shipped ones; the user's own by the names that they have in their texts. */
    scenes: Record<string, Edited>;
    job?: { file: string; text: string } | undefined;
}

/** A browser that keeps nothing for a page, or has no room, leaves the page as it is without. */
export class Kept {
    private texts: Texts = { last: "", scenes: {} };

    constructor() {
        try {
            const found: unknown = JSON.parse(localStorage.getItem(KEY) ?? "null");
            if (isTexts(found)) this.texts = found;
        } catch {
            // None, or none of this version.
        }
    }

    /** Scene that was shown last with edits, or the user's own. */
    get last(): { name: string; base: string } | undefined {
        const { last, scenes } = this.texts;
        const edited = scenes[last];
        return edited && { name: last.startsWith(OWN) ? "" : last, base: edited.base };
    }

    get job(): { file: string; text: string } | undefined {
        return this.texts.job;
    }

    /** Text of the scene `name` as the user has left it; none if it was not edited, or was another one. */
    edited(name: string, base: string): string | undefined {
        const edited = this.texts.scenes[keyOf(name, base)];
        return edited?.base === base ? edited.text : undefined;
    }

    keep(name: string, base: string, text: string, job: { file: string; text: string } | undefined): void {
        const key = keyOf(name, base);
        this.texts.last = key;
        // One's own scene stands nowhere else.
        if (name !== "" && text === base) delete this.texts.scenes[key];
        else this.texts.scenes[key] = { base, text };
        this.texts.job = job && { file: job.file, text: job.text };
        try {
            localStorage.setItem(KEY, JSON.stringify(this.texts));
        } catch {
            // No room.
        }
    }
}

function keyOf(name: string, base: string): string {
    return name !== "" ? name : OWN + (/^\s*name\s*=\s*(.*)$/m.exec(base)?.[1] ?? "");
}

function isTexts(found: unknown): found is Texts {
    if (typeof found !== "object" || found === null) return false;
    const { last, scenes } = found as Partial<Texts>;
    return typeof last === "string" && typeof scenes === "object" && scenes !== null && Object.values(scenes).every((each) => typeof each?.base === "string" && typeof each.text === "string");
}
