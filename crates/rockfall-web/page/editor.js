// The editor of the scene text: line numbers, and the first error at its line while one types.

import { Scene } from "./rockfall.js";

const LONGEST = 400_000;
const PAUSE = 300;

export class Editor {
    constructor(find) {
        [this.text, this.numbers, this.error] = ["text", "numbers", "text-error"].map(find);
        this.text.addEventListener("input", () => {
            this.number();
            clearTimeout(this.timer);
            this.timer = setTimeout(() => this.check(), PAUSE);
        });
        this.text.addEventListener("scroll", () => (this.numbers.scrollTop = this.text.scrollTop));
    }

    set(text) {
        const fits = text.length <= LONGEST;
        this.text.value = fits ? text : "";
        this.text.placeholder = fits ? "" : "This scene is too long for the editor.";
        this.show(null);
        this.number();
    }

    number(wrong = 0) {
        const lines = this.text.value.split("\n").length;
        const parts = Array.from({ length: lines }, (_, k) => k + 1);
        this.numbers.textContent = parts.join("\n");
        if (wrong > 0 && wrong <= lines) {
            const mark = document.createElement("span");
            mark.className = "wrong";
            mark.textContent = `${wrong}`;
            this.numbers.replaceChildren(parts.slice(0, wrong - 1).map(k => `${k}\n`).join(""), mark, parts.slice(wrong).map(k => `\n${k}`).join(""));
        }
        this.numbers.scrollTop = this.text.scrollTop;
    }

    // Reads the text. Returns whether it is a scene, and shows the first error if not.
    check() {
        try {
            new Scene(this.text.value, "scene").free();
            this.show(null);
            return true;
        } catch (error) {
            this.show(error);
            return false;
        }
    }

    show(error) {
        this.error.textContent = error ? error.message : "";
        this.text.setAttribute("aria-invalid", `${Boolean(error)}`);
        this.number(error?.line ?? 0);
    }

    // Moves the cursor to the line of an error.
    go(line) {
        const lines = this.text.value.split("\n");
        const start = lines.slice(0, line - 1).reduce((sum, text) => sum + text.length + 1, 0);
        this.text.focus();
        this.text.setSelectionRange(start, start + (lines[line - 1]?.length ?? 0));
        this.text.scrollTop = Math.max(0, (line - 4) * 17);
    }
}
