// A job in a file of its own beside the scene: which of the two texts the editor shows, and what the file leaves open.

import { isDrawing } from "../core/core.js";
import type { JobFile, JobInputValues, Trouble } from "./answers";
import type { Editor } from "./editor";

export type Shown = "scene" | "job";

/** Speed of a drawing until the user gives another, mm/min: a drawing has none. */
const SPEED = 1500;

/** Inputs by their names in the core, with the argument of the command line. */
const INPUTS: [keyof JobInputValues, string][] = [
    ["scale", "--scale"],
    ["corner_mm", "--corner"],
    ["speed_mm_min", "--speed"],
    ["power", "--power"],
    ["hatch_mm", "--hatch"],
    ["tool_by_z_mm", "--tool-by-z"],
];

/** Choices by their names in the core, with the argument of the command line. */
const CHOICES: [keyof JobInputValues, string][] = [
    ["drop_doubles", "--drop-doubles"],
    ["ignore_z", "--ignore-z"],
];

/** True for the name of a file that may hold a job. */
export const isJob = (file: string): boolean => /\.(gcode|nc|ngc|tap|svg)$/i.test(file);

export class Program {
    /** Name of the job's file; none without a job. */
    private file: string | undefined;
    private shown: Shown = "scene";
    /** Text that the editor does not show. */
    private hidden = "";
    private readonly troubles: Record<Shown, Trouble[]> = { scene: [], job: [] };

    constructor(
        private readonly page: (id: string) => HTMLElement,
        private readonly editor: Editor,
        private readonly sceneFile: () => string,
        onChange: () => void,
    ) {
        for (const shown of ["scene", "job"] as const) page(`show-${shown}`).addEventListener("click", () => this.show(shown));
        page("inputs").addEventListener("input", () => {
            this.showInputs();
            onChange();
        });
        page("close-job").addEventListener("click", () => {
            this.show("scene");
            this.file = undefined;
            this.troubles.job = [];
            this.showTabs();
            onChange();
        });
    }

    get isSceneShown(): boolean {
        return this.shown === "scene";
    }

    get scene(): string {
        return this.isSceneShown ? this.editor.value : this.hidden;
    }

    set scene(text: string) {
        if (this.isSceneShown) this.editor.value = text;
        else this.hidden = text;
        this.showInputs();
    }

    /** Puts another text in place of the scene, as an edit that can be undone. */
    replaceScene(text: string): void {
        this.show("scene");
        this.editor.replace(text);
    }

    /** The job's file with its inputs. */
    get job(): JobFile | undefined {
        if (this.file === undefined) return undefined;
        return { file: this.file, text: this.isSceneShown ? this.hidden : this.editor.value, inputs: this.inputs() };
    }

    /** Takes the text of a job's file, and shows it. */
    take(file: string, text: string): void {
        this.show("scene");
        this.file = file;
        this.hidden = text;
        const drawing = isDrawing(file);
        this.box("fit").checked = drawing;
        this.box("speed_mm_min").value = drawing ? String(SPEED) : "";
        for (const label of this.page("inputs").querySelectorAll<HTMLElement>(".drawing")) label.hidden = !drawing;
        this.page("alpha").hidden = drawing;
        for (const label of this.page("inputs").querySelectorAll<HTMLElement>(".gcode")) label.hidden = drawing;
        this.show("job");
    }

    /** Shows problems of one of the texts; the other one has none. */
    tell(shown: Shown, troubles: Trouble[], good: string): void {
        this.troubles.scene = shown === "scene" ? troubles : [];
        this.troubles.job = shown === "job" ? troubles : [];
        const elsewhere = shown !== this.shown && troubles.length > 0;
        this.editor.show(this.troubles[this.shown], elsewhere ? `${troubles.length} to correct in the ${shown}.` : good);
        this.showTabs();
    }

    private show(shown: Shown): void {
        if (shown === this.shown) return;
        [this.hidden, this.editor.value] = [this.editor.value, this.hidden];
        this.shown = shown;
        this.editor.show(this.troubles[shown], "");
        this.showTabs();
    }

    private showTabs(): void {
        this.page("documents").hidden = this.file === undefined;
        this.page("inputs").hidden = this.file === undefined;
        this.page("show-job").textContent = this.file ?? "";
        this.page("scene-title").textContent = this.isSceneShown ? "Scene" : "Job";
        for (const shown of ["scene", "job"] as const) {
            const tab = this.page(`show-${shown}`);
            tab.setAttribute("aria-pressed", String(shown === this.shown));
            tab.classList.toggle("bad", this.troubles[shown].length > 0);
        }
        this.showInputs();
    }

    /** Writes the command that does the same. */
    private showInputs(): void {
        const { file } = this;
        if (file === undefined) return;
        const { x_mm, y_mm, alpha_deg, fit, ...others } = this.inputs();
        for (const name of ["x_mm", "y_mm"] as const) this.box(name).disabled = fit;
        const words = ["trirrr run", file, "--machine", this.sceneFile()];
        if (fit) words.push("--fit");
        else if (x_mm !== 0 || y_mm !== 0 || alpha_deg !== 0) words.push("--origin", [x_mm, y_mm, ...(alpha_deg === 0 ? [] : [alpha_deg])].join(","));
        for (const [name, argument] of INPUTS) {
            const value = name in others ? others[name as keyof typeof others] : undefined;
            if (value !== undefined) words.push(argument, String(value));
        }
        for (const [name, argument] of CHOICES) if (name in others && others[name as keyof typeof others] === true) words.push(argument);
        this.page("command").textContent = words.join(" ");
    }

    private inputs(): JobInputValues {
        const drawing = isDrawing(this.file ?? "");
        const value = (name: string): number | undefined => {
            const { valueAsNumber } = this.box(name);
            return Number.isNaN(valueAsNumber) ? undefined : valueAsNumber;
        };
        const common = { x_mm: value("x_mm") ?? 0, y_mm: value("y_mm") ?? 0, corner_mm: value("corner_mm") };
        if (!drawing) {
            const tool_by_z_mm = value("tool_by_z_mm");
            this.box("ignore_z").disabled = tool_by_z_mm !== undefined;
            return { ...common, alpha_deg: value("alpha_deg") ?? 0, fit: false, tool_by_z_mm, ignore_z: tool_by_z_mm === undefined && this.box("ignore_z").checked };
        }
        return { ...common, alpha_deg: 0, fit: this.box("fit").checked, drop_doubles: this.box("drop_doubles").checked, scale: value("scale"), speed_mm_min: value("speed_mm_min"), power: value("power"), hatch_mm: value("hatch_mm") };
    }

    private box(name: string): HTMLInputElement {
        return this.page("inputs").querySelector<HTMLInputElement>(`[name=${name}]`) as HTMLInputElement;
    }
}
