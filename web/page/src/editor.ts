// The text of the scene, its problems beside their lines.

import type { Trouble } from "./answers";

/** Lines above and below the view that are numbered, too: a scroll may be shown before it is told. */
const SPARE = 40;

export class Editor {
    private troubles: Trouble[] = [];
    private readonly pane: HTMLElement;
    private rows = 1;

    constructor(
        private readonly text: HTMLTextAreaElement,
        private readonly gutter: HTMLElement,
        private readonly marks: HTMLElement,
        private readonly list: HTMLElement,
        onEdit: () => void,
    ) {
        this.pane = text.closest(".code") as HTMLElement;
        this.pane.addEventListener("scroll", () => this.number(), { passive: true });
        new ResizeObserver(() => this.number()).observe(this.pane);
        text.addEventListener("input", () => {
            // Places of the last reading are no longer those of the text.
            this.marks.replaceChildren();
            this.fit();
            onEdit();
        });
    }

    get value(): string {
        return this.text.value;
    }

    set value(text: string) {
        this.text.value = text;
        this.fit();
    }

    /** Puts another text in place as the user would, so that the browser's undo brings the one before back. */
    replace(text: string): void {
        const before = document.activeElement;
        this.text.focus({ preventScroll: true });
        this.text.select();
        // Nothing newer writes into the list of what can be undone.
        if (this.text.readOnly || !document.execCommand("insertText", false, text)) {
            this.value = text;
            this.text.dispatchEvent(new Event("input"));
        }
        if (before instanceof HTMLElement) before.focus({ preventScroll: true });
    }

    /** Shows problems, or `good` if there are none. */
    show(troubles: Trouble[], good: string): void {
        this.troubles = troubles;
        this.fit();
        this.marks.replaceChildren(...this.byLine().map(([line, reasons, width]) => this.mark(line, reasons, width)));
        const items = troubles.map((trouble) => this.item(trouble));
        this.list.classList.toggle("bad", troubles.length > 0);
        this.list.replaceChildren(...(items.length > 0 ? items : [good]));
    }

    /** Lines with problems: number, reasons, characters of the line. */
    private byLine(): [number, string, number][] {
        const lines = this.text.value.split("\n");
        const found = new Map<number, string[]>();
        for (const { line, reason } of this.troubles) found.set(line, [...(found.get(line) ?? []), reason]);
        return [...found].map(([line, reasons]) => [line, reasons.join("; "), lines[line - 1]?.length ?? 0]);
    }

    private mark(line: number, reasons: string, width: number): HTMLElement {
        const mark = document.createElement("div");
        mark.className = "mark";
        mark.style.setProperty("--line", String(line - 1));
        const words = document.createElement("span");
        words.style.setProperty("--width", String(width + 2));
        words.textContent = reasons;
        mark.append(words);
        return mark;
    }

    private item({ line, column, sentence }: Trouble): HTMLElement {
        const button = document.createElement("button");
        button.type = "button";
        button.className = "trouble";
        const place = document.createElement("b");
        place.textContent = `${line}:${column}`;
        button.append(place, " ", sentence);
        button.addEventListener("click", () => this.goTo(line, column));
        return button;
    }

    private goTo(line: number, column: number): void {
        const before = this.text.value.split("\n").slice(0, line - 1);
        const begin = before.reduce((sum, each) => sum + each.length + 1, 0) + column - 1;
        this.text.focus();
        this.text.setSelectionRange(begin, begin);
        const height = Number.parseFloat(getComputedStyle(this.text).lineHeight);
        this.pane.scrollTo({ top: (line - 4) * height, left: 0 });
    }

    /** Makes the text as large as what it holds, and numbers its lines. */
    private fit(): void {
        let [rows, longest, begin] = [0, 0, 0];
        const text = this.text.value;
        while (begin <= text.length) {
            const end = text.indexOf("\n", begin);
            const stop = end < 0 ? text.length : end;
            longest = Math.max(longest, stop - begin);
            rows += 1;
            begin = stop + 1;
        }
        this.rows = rows;
        this.text.style.setProperty("--rows", String(rows));
        this.text.style.setProperty("--columns", String(longest + 2));
        this.gutter.style.setProperty("--digits", String(String(rows).length));
        this.number();
    }

    /** Numbers the lines in view: a text may have a hundred thousand. */
    private number(): void {
        const height = Number.parseFloat(getComputedStyle(this.text).lineHeight);
        const first = Math.max(0, Math.floor(this.pane.scrollTop / height) - SPARE);
        const last = Math.min(this.rows, Math.ceil((this.pane.scrollTop + this.pane.clientHeight) / height) + SPARE);
        const wrong = new Set(this.troubles.map((trouble) => trouble.line));
        const numbers: HTMLElement[] = [];
        for (let line = first + 1; line <= last; line++) {
            const number = document.createElement("span");
            number.textContent = String(line);
            number.classList.toggle("bad", wrong.has(line));
            numbers.push(number);
        }
        this.gutter.style.setProperty("--line", String(first));
        this.gutter.replaceChildren(...numbers);
    }
}
