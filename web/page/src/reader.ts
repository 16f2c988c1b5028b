// Asks the worker for the whole reading of a scene; only the newest question is answered.
import type { Answer, ModesAnswer, PlantAnswer, Question, Source } from "./answers";

export class Reader {
    private worker: Worker | undefined;
    private asked = 0;
    private isBusy = false;
    private hasPlant = false;
    private readonly script = URL.createObjectURL(new Blob([document.getElementById("main")?.textContent ?? ""], { type: "text/javascript" }));

    constructor(
        private readonly module: WebAssembly.Module,
        private readonly onAnswer: (answer: Answer) => void,
        private readonly onModes: (answer: ModesAnswer) => void,
        private readonly onPlant: (answer: PlantAnswer) => void,
        private readonly onFailure: (sentence: string) => void,
    ) {}

    ask(source: Source): void {
        this.forget();
        const question: Question = { id: this.asked, ...source };
        if (!this.worker) {
            this.worker = new Worker(this.script);
            this.worker.addEventListener("message", ({ data }: MessageEvent<Answer | ModesAnswer | PlantAnswer>) => this.take(data));
            this.worker.addEventListener("error", () => {
                this.stop();
                this.onFailure("The core has stopped on this scene. That is a defect of trirrr: please report it with the scene.");
            });
            question.module = this.module;
        }
        this.isBusy = true;
        this.worker.postMessage(question);
    }

    /** Ends the question under way: the text has changed. Its answer is none any more, and it may take long. */
    forget(): void {
        this.asked += 1;
        if (this.isBusy) this.stop();
    }

    private stop(): void {
        this.worker?.terminate();
        this.worker = undefined;
        this.isBusy = false;
    }

    private take(data: Answer | ModesAnswer | PlantAnswer): void {
        if (data.id !== this.asked) return;
        if ("modes" in data) {
            this.isBusy = this.hasPlant;
            this.onModes(data);
            return;
        }
        if ("plant" in data) {
            this.isBusy = false;
            this.onPlant(data);
            return;
        }
        this.hasPlant = data.hasPlant;
        this.isBusy = data.job !== undefined;
        this.onAnswer(data);
    }
}
