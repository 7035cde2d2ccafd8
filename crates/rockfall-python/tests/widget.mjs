// Runs the widget's JavaScript without a browser: stand-ins for the document and for the model record what it does. Prints what
// was sent to Python, as JSON.
import { pathToFileURL } from "node:url";

class Node {
  constructor(name) {
    Object.assign(this, { name, children: [], style: {}, listeners: {}, clientHeight: 400 });
  }
  appendChild(child) {
    this.children.push(child);
  }
  addEventListener(name, call) {
    this.listeners[name] = call;
  }
  setPointerCapture() {}
  fire(name, event = {}) {
    this.listeners[name]({ preventDefault() {}, ...event });
  }
}
globalThis.document = { createElement: (name) => new Node(name) };
URL.createObjectURL = () => "blob:picture";
URL.revokeObjectURL = () => {};

const values = { frame: new Uint8Array(3), shown: 2, last: 5, caption: "step 2", playing: false, width: 640 };
const calls = {};
const sent = [];
const model = {
  get: (name) => values[name],
  set: (name, value) => {
    values[name] = value;
    (calls[`change:${name}`] ?? []).forEach((call) => call());
  },
  save_changes: () => {},
  send: (message) => sent.push(message),
  on: (name, call) => (calls[name] ??= []).push(call),
  off: (name, call) => (calls[name] = calls[name].filter((other) => other !== call)),
};
const answer = () => calls["msg:custom"].forEach((call) => call({ kind: "done" }));

const { default: widget } = await import(pathToFileURL(process.argv[2]).href);
const el = new Node("div");
const stop = widget.render({ model, el });
const [picture, bar] = el.children[0].children;
const [play, slider, caption] = bar.children;
const before = { src: picture.src, max: slider.max, value: slider.value, caption: caption.textContent, play: play.textContent };

// Two moves before an answer become one message.
picture.fire("pointerdown", { clientX: 10, clientY: 10 });
picture.fire("pointermove", { clientX: 20, clientY: 10 });
picture.fire("pointermove", { clientX: 30, clientY: 15 });
picture.fire("pointermove", { clientX: 40, clientY: 20 });
picture.fire("pointerup");
picture.fire("pointermove", { clientX: 90, clientY: 90 });
answer();
answer();
picture.fire("pointerdown", { clientX: 0, clientY: 0 });
picture.fire("pointermove", { clientX: 40, clientY: 20, shiftKey: true });
picture.fire("pointerup");
answer();
picture.fire("wheel", { deltaY: 100 });
answer();
slider.value = "3";
slider.fire("input");
answer();
picture.fire("dblclick");
// Playing asks for the next picture after every answer, until it is paused.
play.fire("click");
answer();
play.fire("click");
answer();
answer();
stop();
console.log(JSON.stringify({ before, sent, left: Object.values(calls).flat().length }));
