// The page: a scene, its machine in the user's hand, its job.

import { initSync, isDrawing, machineFile, Reading, bitsOf, type Machine } from "../core/core.js";
import type { Answer, JobTable, ModeRow, PlantTable, Source, Trouble } from "./answers";
import { BoardPanel, placeOf } from "./board";
import { Drawing, type Pose } from "./drawing";
import { Editor } from "./editor";
import { textOf } from "./files";
import { number } from "./format";
import { Kept } from "./kept";
import { LivePlots } from "./live";
import { Panel } from "./panel";
import { decompressed } from "./lzma";
import { showPlant } from "./plant";
import { Plots } from "./plots";
import { isJob, Program } from "./program";
import { Reader } from "./reader";
import { bytesOf, fragmentOf, sceneOf } from "./share";
import { taken, takenAssemblies, type TakenLimits, type TakenSample } from "./taken";

/** Pause in the user's writing after which the scene is read whole, ms. */
const PAUSE = 250;

const FIRST = "vertical";

/** Motion of the platform until the user gives another: rates and torques are not all 0. */
const MOTION = [0.1, 0, 0, 1, 0, 0];

const NO_LIMITS: TakenLimits = {
    rates: new Float64Array(),
    accelerations: new Float64Array(),
    torques: new Float64Array(),
    powers: new Float64Array(),
    serial: 0,
    parallel: 0,
};

const STATE_COLUMNS = ["x", "y", "alpha", "vx", "vy", "valpha", "ax", "ay", "aalpha"];

const HAND = "Drag the platform, or focus it and use the arrow keys; Q and E turn it, Shift takes larger steps.";
const FOLLOWING = "The machine is drawn as the board moves it; dotted: as its drives measure it. Disconnect to take it into your hand.";

function page(id: string): HTMLElement {
    const found = document.getElementById(id);
    if (!found) throw new Error(`the page has no #${id}`);
    return found;
}

class Page {
    private machine: Machine | undefined;
    private limits: TakenLimits = NO_LIMITS;
    private state: number[] = [0, 0, 0, ...MOTION];
    private job: JobTable | undefined;
    private jobModes: ModeRow[] | undefined;
    private drawingModule: WebAssembly.Module | undefined;
    private plant: PlantTable | undefined;
    private row = 0;
    /** Files that were opened, by their names: scenes may take their machine from them. */
    private readonly files = new Map<string, string>();
    private timer = 0;
    /** The scene as it was loaded: its name among the shipped ones, and its text. */
    private loaded = { name: "", text: "" };
    private peeked: string | undefined;
    private isDraftGood = false;
    /** The state is that of the job at a time. */
    private isAtJob = false;
    private clock: { since: number; from: number } | undefined;

    private readonly kept = new Kept();
    private readonly drawing = new Drawing(page("drawing") as unknown as SVGSVGElement, (pose) => this.drag(pose));
    private readonly panel = new Panel(page, (state) => this.takeState(state));
    private readonly plots = new Plots(page("plots"), (time) => this.goTo(time));
    private readonly editor = new Editor(page("text") as HTMLTextAreaElement, page("gutter"), page("marks"), page("problems"), () => this.edited());
    private readonly program = new Program(page, this.editor, () => this.file, () => this.ask());
    private readonly time = page("time") as HTMLInputElement;
    private readonly play = page("play") as HTMLButtonElement;
    private readonly reader: Reader;
    private readonly live = new LivePlots(page("live-plots"));
    private readonly board: BoardPanel;

    constructor(module: WebAssembly.Module) {
        this.board = new BoardPanel(page, {
            core: module,
            scene: () => {
                if (this.job) return this.source();
                const isChecking = this.isDraftGood && !page("verdict").classList.contains("bad");
                return isChecking ? "The job is being checked: connect once that is done." : "The scene is refused: a board takes a scene that is good.";
            },
            onLost: (isLost) => page("drawing").classList.toggle("lost", isLost),
            onFollow: (isFollowing) => this.follow(isFollowing),
            onSample: (sample) => this.showSample(sample),
        });
        this.reader = new Reader(
            module,
            (answer) => this.answered(answer),
            (answer) => {
                this.jobModes = answer.modes;
                this.show();
            },
            ({ plant }) => {
                this.plant = typeof plant === "string" ? undefined : plant;
                showPlant(page, plant);
                this.redrawPlots();
                this.showRow(this.row, this.isAtJob);
            },
            (sentence) => this.program.tell("scene", [atTheTop(sentence)], ""),
        );
        this.listen();
    }

    async start(): Promise<void> {
        const shared = (await sceneOf(location.hash)) ?? (await this.given());
        const { last, job } = this.kept;
        if (shared !== undefined) this.load("", shared);
        else if (last !== undefined && (last.name === "" || SCENES[last.name] === last.base)) this.load(last.name, last.base);
        else this.load(FIRST, SCENES[FIRST] ?? "");
        if (job === undefined || shared !== undefined) return;
        this.program.take(job.file, job.text);
        this.readWhole();
    }

    /** The scene of `trirrr ui`, which serves it beside the page, with the file of its machine. */
    private async given(): Promise<string | undefined> {
        const { scene } = document.documentElement.dataset;
        if (scene === undefined) return undefined;
        const answer = await fetch(scene);
        if (!answer.ok) return undefined;
        const text = await answer.text();
        const name = machineFile(text);
        if (name !== undefined) {
            const machine = await fetch("machine.toml");
            if (machine.ok) this.files.set(name, await machine.text());
        }
        return text;
    }

    private listen(): void {
        const pick = page("scenes") as HTMLSelectElement;
        const names = Object.keys(SCENES).sort();
        pick.append(...names.map((name) => new Option(name, name)));
        pick.addEventListener("change", () => this.load(pick.value, SCENES[pick.value] ?? ""));
        this.time.addEventListener("input", () => {
            this.stop();
            this.showRow(this.time.valueAsNumber);
        });
        this.play.addEventListener("click", () => (this.clock ? this.stop() : this.run()));
        page("reset").addEventListener("click", () => this.program.replaceScene(this.loaded.text));
        const file = page("file") as HTMLInputElement;
        page("open").addEventListener("click", () => file.click());
        file.addEventListener("change", () => {
            void this.open(file.files).finally(() => (file.value = ""));
        });
        addEventListener("dragover", (event) => event.preventDefault());
        addEventListener("drop", (event) => {
            event.preventDefault();
            void this.open(event.dataTransfer?.files);
        });
        addEventListener("pagehide", () => this.keep());
        page("share").addEventListener("click", () => void this.share());
        page("download").addEventListener("click", () => this.download());
        page("theme").addEventListener("click", () => {
            const root = document.documentElement;
            const isDark = root.dataset.theme ? root.dataset.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
            root.dataset.theme = isDark ? "light" : "dark";
            this.redrawPlots();
        });
        matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.redrawPlots());
        addEventListener("hashchange", () => void sceneOf(location.hash).then((text) => text !== undefined && text !== this.program.scene && this.load("", text)));
    }

    /** The scene and the machine on paper are those of the board, or in the user's hand again. */
    private follow(isFollowing: boolean): void {
        this.stop();
        page("drawing").classList.toggle("following", isFollowing);
        page("live-curves").hidden = !isFollowing;
        (page("text") as HTMLTextAreaElement).readOnly = isFollowing;
        for (const id of ["scenes", "open", "reset", "close-job"]) (page(id) as HTMLButtonElement).disabled = isFollowing;
        for (const input of [this.time, this.play]) input.disabled = isFollowing || !this.job;
        for (const input of document.querySelectorAll<HTMLInputElement>("#pose input, #rates input, #inputs input")) input.disabled = isFollowing;
        page("hand-hint").textContent = isFollowing ? FOLLOWING : HAND;
        this.live.clear();
        this.drawing.showMeasured(undefined);
        page("board-pose").textContent = "";
    }

    /** Draws the machine as the board moves it, and as its drives measure it. */
    private showSample(sample: TakenSample): void {
        const { machine } = this;
        if (!machine) return;
        this.isAtJob = true;
        this.state = [...sample.setpoint];
        this.show();
        this.live.add(sample);
        page("board-pose").textContent = placeOf(sample);
        if (!sample.measured) {
            this.drawing.showMeasured(undefined);
            return;
        }
        try {
            // The pose at which the drives stand: of all that fit their angles, the nearest to the one that is asked for.
            const { modes } = takenAssemblies(machine.assemblies(sample.measured.angles, sample.setpoint.slice(0, 3)));
            const here = modes.find(({ isHere }) => isHere);
            const still = new Array<number>(6).fill(0);
            this.drawing.showMeasured(here && taken(machine.figures(Float64Array.from([...here.pose, ...still]))));
        } catch {
            // No pose fits: there is none to draw.
            this.drawing.showMeasured(undefined);
        }
    }

    /** Texts are those of the board while it is connected. */
    private isOfBoard(): boolean {
        if (this.board.isOpen) this.setVerdict("disconnect the board to open another file", true);
        return this.board.isOpen;
    }

    /** Begins with another scene. */
    private load(name: string, text: string): void {
        if (this.isOfBoard()) return;
        if (this.machine !== undefined || this.loaded.text !== "") this.keep();
        this.stop();
        this.loaded = { name, text };
        this.isAtJob = false;
        this.row = 0;
        const edited = this.kept.edited(name, text);
        page("reset").hidden = edited === undefined || edited === text;
        const pick = page("scenes") as HTMLSelectElement;
        pick.querySelector("option[value='']")?.remove();
        if (name === "") pick.prepend(new Option("yours", ""));
        pick.value = name;
        this.program.scene = edited ?? text;
        this.machine?.free();
        this.machine = undefined;
        this.readDraft();
        this.readWhole();
    }

    /** Takes scenes and jobs of files. */
    private async open(files: Iterable<File> | null | undefined): Promise<void> {
        if (this.isOfBoard()) return;
        const opened = [...(files ?? [])];
        const scenes = opened.filter((file) => /\.toml$/i.test(file.name));
        const texts = new Map<string, string>();
        for (const file of opened.filter((each) => scenes.includes(each) || isJob(each.name))) {
            try {
                texts.set(file.name, await textOf(file));
            } catch (error) {
                this.setVerdict(error instanceof Error ? error.message : String(error), true);
                return;
            }
        }
        for (const { name } of scenes) this.files.set(name, texts.get(name) ?? "");
        // The file that a scene waits for is no scene of its own then, and of several the one that names another is the scene.
        const names = scenes.map((file) => file.name);
        const read = names.map((name) => this.files.get(name) ?? "");
        const scene = read.find((text) => names.includes(machineFile(text) ?? "")) ?? read[0];
        const wanted = machineFile(this.program.scene);
        if (scene !== undefined && names.length === 1 && names[0] === wanted) this.edited();
        else if (scene !== undefined) this.load("", scene);
        for (const file of opened.filter((each) => !scenes.includes(each))) {
            if (isJob(file.name)) {
                this.program.take(file.name, texts.get(file.name) ?? "");
                this.row = 0;
                this.keep();
                this.readWhole();
            } else this.setVerdict(`${file.name} is no scene (.toml) and no job in G-code (.gcode, .nc, .ngc, .tap) or SVG; DXF, images and tables are for \`trirrr run ${file.name} --machine SCENE.toml\``, true);
        }
    }

    private edited(): void {
        if (this.program.isSceneShown) {
            page("reset").hidden = this.editor.value === this.loaded.text;
            this.readDraft();
        }
        this.ask();
    }

    /** Keeps the texts over a reload. */
    private keep(): void {
        const { scene, job } = this.program;
        this.kept.keep(this.loaded.name, this.loaded.text, scene, job);
    }

    /** Reads all once the user pauses. */
    private ask(): void {
        this.reader.forget();
        if (this.isDraftGood) this.setVerdict("checking the job \u2026", false);
        clearTimeout(this.timer);
        this.timer = setTimeout(() => {
            this.keep();
            this.readWhole();
        }, PAUSE);
    }

    private get file(): string {
        return `${this.loaded.name.length > 0 ? this.loaded.name : "scene"}.toml`;
    }

    /** Takes the machine as it stands in the text, whatever its job is. */
    private readDraft(): void {
        const reading = Reading.draft(this.program.scene, this.file, this.machineText());
        this.isDraftGood = reading.refusal === undefined;
        if (reading.refusal === undefined) {
            try {
                this.takeMachine(reading.machine());
            } catch (sentence) {
                this.program.tell("scene", [atTheTop(String(sentence))], "");
            }
        } else {
            if (this.machine === undefined) {
                page("name").textContent = "No machine yet";
                page("description").textContent = "The scene is refused: what is wrong stands beside its lines.";
            }
            this.program.tell("scene", reading.problems.map(taken), "");
            this.setVerdict(`${reading.problems.length} to correct`, true);
        }
        reading.free();
    }

    /** Reader of drawings, if the job is one. It is compiled with the first of them. */
    private drawings(): WebAssembly.Module | undefined {
        const { job } = this.program;
        if (job === undefined || !isDrawing(job.file)) return undefined;
        this.drawingModule ??= new WebAssembly.Module(decompressed(bytesOf(page("drawings").textContent ?? "")));
        return this.drawingModule;
    }

    /** Text of the file that the scene takes its machine from: one that was opened, or a shipped one. */
    private machineText(): string | undefined {
        const name = machineFile(this.program.scene);
        return name === undefined ? undefined : (this.files.get(name) ?? SCENES[name.replace(/\.toml$/, "")]);
    }

    /** The texts as they stand in the page. */
    private source(): Source {
        return { text: this.program.scene, file: this.file, machine: this.machineText(), job: this.program.job, drawings: this.drawings() };
    }

    private readWhole(): void {
        if (this.isDraftGood) this.setVerdict("checking the job \u2026", false);
        this.reader.ask(this.source());
    }

    private takeMachine(machine: Machine): void {
        const isNew = this.machine === undefined;
        this.machine?.free();
        this.machine = machine;
        this.limits = taken(machine.limits);
        page("name").textContent = machine.name;
        page("description").textContent = machine.description;
        document.title = `${machine.name} \u00b7 trirrr`;
        this.drawing.show(machine.frame);
        if (isNew) {
            this.job = undefined;
            this.jobModes = undefined;
            this.drawing.showPath(undefined, undefined, undefined);
            this.state = [...machine.start, ...MOTION];
        }
        this.show();
    }

    private answered({ problems, refusal, verdict, warning, isOfJob, notes, path, breach, job, hasPlant }: Answer): void {
        this.setVerdict(verdict ?? `${problems.length} to correct`, refusal !== undefined);
        const good = [isOfJob ? "The job has a plan." : "The scene is good.", warning].filter(Boolean).join(" Warning: ");
        this.program.tell(isOfJob ? "job" : "scene", problems, [good, ...notes].join(" "));
        this.job = job;
        // A job that is refused has no mode to wait for.
        this.jobModes = job === undefined ? [] : undefined;
        this.plant = undefined;
        showPlant(page, hasPlant ? "Simulating the motors, gears and friction \u2026" : undefined);
        const count = job?.columns.t?.length ?? 0;
        for (const input of [this.time, this.play]) input.disabled = count === 0 || this.board.isOpen;
        this.time.max = String(Math.max(count - 1, 0));
        // A path without a plan is drawn as the file has it.
        const drawn = (axis: number) => path?.filter((_, index) => index % 2 === axis);
        this.drawing.showPath(job?.columns.x ?? drawn(0), job?.columns.y ?? drawn(1), breach);
        this.redrawPlots();
        const thinned = job && job.every > 1 ? `The curves hold one tick of ${job.every}.` : "";
        const note = job ? (job.reason ?? thinned) : "The job is refused: correct it to see its curves.";
        page("no-job").hidden = note === "";
        page("no-job").textContent = note;
        if (!job) {
            page("clock").textContent = "no job";
            this.stop();
        } else this.showRow(Math.min(this.row, count - 1), false);
        this.show();
    }

    private redrawPlots(): void {
        this.live.restyle();
        if (this.job) this.plots.show(this.job, this.plant, this.limits);
        else this.plots.clear();
    }

    private setVerdict(words: string, isBad: boolean): void {
        const verdict = page("verdict");
        verdict.textContent = words;
        verdict.classList.toggle("bad", isBad);
    }

    /** The user moves the platform: its motion is the one that stands in the inputs, or the first one after the job. */
    private drag(pose: Pose): void {
        if (this.board.isOpen) return;
        if (this.clock || this.isAtJob) this.state = [...pose, ...MOTION];
        else this.state = [...pose, ...this.state.slice(3)];
        this.stop();
        this.isAtJob = false;
        this.show();
    }

    private takeState(state: number[]): void {
        if (this.board.isOpen) return;
        this.stop();
        this.isAtJob = false;
        this.state = state;
        this.show();
    }

    /** Draws the state and all that the core says about it. */
    private show(): void {
        const { machine, state } = this;
        if (!machine) return;
        const { limits } = this;
        const figures = taken(machine.figures(Float64Array.from(state)));
        const [x = 0, y = 0, alpha = 0] = state;
        this.drawing.draw([x, y, alpha], figures);
        if (!this.isAtJob) this.drawing.showMeasured(undefined);
        this.panel.showState(state);
        this.panel.showFigures(figures, limits);
        const modes = machine.workingModes(Float64Array.from(state)).map(taken);
        this.drawing.showGhostLegs(figures, modes.find(({ name }) => name === this.peeked)?.elbows);
        const peek = (name: string | undefined) => {
            this.peeked = name;
            this.show();
        };
        this.panel.showModes(modes, this.jobModes, peek, (name) => this.takeMode(name));
        if (figures.angles.length === 3) {
            try {
                const list = takenAssemblies(machine.assemblies(figures.angles, Float64Array.of(x, y, alpha)));
                this.drawing.showGhosts(list.modes.filter((mode) => !mode.isHere).map((mode) => mode.platform));
                this.panel.showAssemblies(list, ([px = 0, py = 0, palpha = 0]) => this.drag([px, py, palpha]));
            } catch (sentence) {
                this.drawing.showGhosts([]);
                this.panel.showAssemblies(String(sentence), () => undefined);
            }
        } else {
            this.drawing.showGhosts([]);
            this.panel.showAssemblies("No leg configuration: the pose is out of reach.", () => undefined);
        }
        this.panel.speak(state, figures);
    }

    /** Writes the elbow signs of a working mode into the scene. */
    private takeMode(name: string): void {
        if (this.board.isOpen) return;
        const text = withElbows(this.program.scene, name);
        if (text === undefined) return;
        this.program.replaceScene(text);
    }

    private showRow(row: number, moves = true): void {
        const columns = this.job?.columns;
        const time = columns?.t?.[row];
        if (!columns || time === undefined) return;
        this.row = row;
        this.time.value = String(row);
        const end = columns.t?.at(-1) ?? 0;
        const clock = `${number(time)} of ${number(end)} s`;
        page("clock").textContent = clock;
        this.time.setAttribute("aria-valuetext", clock);
        this.plots.mark(time);
        if (!moves) return;
        this.isAtJob = true;
        this.state = STATE_COLUMNS.map((name) => columns[name]?.[row] ?? 0);
        this.show();
        this.showMeasured(time);
    }

    /** Draws the machine where the plant has it at a time of the job. */
    private showMeasured(time: number): void {
        const { machine, plant } = this;
        const times = plant?.columns.t;
        if (!machine || !times || times.length === 0) return;
        const row = rowAt(times, time);
        const pose = ["x", "y", "alpha"].map((name) => plant.columns[name]?.[row] ?? 0);
        this.drawing.showMeasured(taken(machine.figures(Float64Array.from([...pose, 0, 0, 0, 0, 0, 0]))));
    }

    private goTo(time: number): void {
        const times = this.job?.columns.t;
        if (!times || this.board.isOpen) return;
        this.stop();
        this.showRow(rowAt(times, time));
    }

    private run(): void {
        const times = this.job?.columns.t;
        const end = times?.at(-1) ?? 0;
        if (!times) return;
        const from = this.row >= times.length - 1 ? 0 : (times[this.row] ?? 0);
        this.clock = { since: performance.now(), from };
        this.play.textContent = "Pause";
        const frame = (now: number) => {
            if (!this.clock) return;
            const speed = Number((page("speed") as HTMLSelectElement).value);
            const time = this.clock.from + ((now - this.clock.since) / 1000) * speed;
            // A change of the speed goes on from here.
            this.clock = { since: now, from: Math.max(time, 0) };
            this.showRow(rowAt(times, time));
            if (time < end) requestAnimationFrame(frame);
            else this.stop();
        };
        requestAnimationFrame(frame);
    }

    private stop(): void {
        this.clock = undefined;
        this.play.textContent = "Play";
    }

    private async share(): Promise<void> {
        const fragment = await fragmentOf(this.program.scene);
        history.replaceState(null, "", fragment);
        const button = page("share");
        try {
            await navigator.clipboard.writeText(location.href);
            button.textContent = "Copied";
        } catch {
            button.textContent = "Link is in the address";
        }
        setTimeout(() => (button.textContent = "Copy link"), 2000);
    }

    private download(): void {
        const link = document.createElement("a");
        link.href = URL.createObjectURL(new Blob([this.editor.value], { type: "text/plain" }));
        // The text that stands in the editor.
        link.download = this.program.isSceneShown ? `${this.machine?.name ?? "scene"}.toml` : (this.program.job?.file ?? "job.ngc");
        link.click();
        setTimeout(() => URL.revokeObjectURL(link.href), 1000);
    }
}

/** The scene with the elbow signs of `mode`; none of a text that does not give three of them, each on a line of its own. */
function withElbows(text: string, mode: string): string | undefined {
    const elbow = /^(\s*elbow\s*=\s*)[-+]?[0-9][0-9_.]*/gm;
    if (text.match(elbow)?.length !== mode.length) return undefined;
    let leg = 0;
    return text.replace(elbow, (_, before: string) => {
        const sign = mode[leg] === "-" ? "-1" : "1";
        leg += 1;
        return before + sign;
    });
}

/** A sentence about the whole scene. */
function atTheTop(sentence: string): Trouble {
    return { line: 1, column: 1, sentence, reason: sentence };
}

/** Row at `time`, or the last before it. */
function rowAt(times: Float64Array, time: number): number {
    let [low, high] = [0, times.length - 1];
    while (low < high) {
        const middle = Math.ceil((low + high) / 2);
        if ((times[middle] ?? 0) <= time) low = middle;
        else high = middle - 1;
    }
    return low;
}

async function start(): Promise<void> {
    // The first paint comes before the work.
    await new Promise((painted) => setTimeout(painted));
    const bytes = decompressed(bytesOf(page("core").textContent ?? ""));
    const module = await WebAssembly.compile(bytes);
    initSync({ module });
    await new Page(module).start();
    // The core, for the console and for tests.
    Object.assign(globalThis, { trirrr: { Reading, bitsOf, machineFile, scenes: SCENES } });
    document.documentElement.dataset.ready = "";
}

export function begin(): void {
    start().catch((error: unknown) => {
        page("name").textContent = "The page cannot start";
        page("description").textContent = `${String(error)}. It needs a browser with WebAssembly and DecompressionStream, of 2023 or later.`;
    });
}
