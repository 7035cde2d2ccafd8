// The widget of a notebook: shows pictures that Python renders, and sends what the mouse does. At most one message waits for an
// answer; moves of the mouse in the meantime are added up.

const SPEED = 0.008; // rad per pixel

function element(parent, name, properties) {
  const made = document.createElement(name);
  Object.assign(made, properties);
  parent.appendChild(made);
  return made;
}

function render({ model, el }) {
  const root = element(el, "div", { className: "rockfall-viewer" });
  root.style.width = `${model.get("width")}px`;
  const picture = element(root, "img", { draggable: false, alt: "the simulation" });
  const bar = element(root, "div", { className: "rockfall-bar" });
  const play = element(bar, "button", { type: "button" });
  const slider = element(bar, "input", { type: "range", min: 0, step: 1 });
  const caption = element(bar, "span", {});

  let waiting = false;
  let orbit = null;
  let pan = null;
  let zoom = 1;
  let state = null;

  // Sends what has come up since the last answer: the newest wish of each kind.
  function send() {
    if (waiting) return;
    let message = null;
    if (orbit) [message, orbit] = [{ kind: "orbit", ...orbit }, null];
    else if (pan) [message, pan] = [{ kind: "pan", ...pan }, null];
    else if (zoom !== 1) [message, zoom] = [{ kind: "zoom", factor: zoom }, 1];
    else if (state !== null) [message, state] = [{ kind: "show", state }, null];
    else if (model.get("playing")) message = { kind: "next" };
    if (message) {
      waiting = true;
      model.send(message);
    }
  }

  let url = null;
  function showFrame() {
    const old = url;
    url = URL.createObjectURL(new Blob([model.get("frame")], { type: "image/jpeg" }));
    picture.src = url;
    if (old) URL.revokeObjectURL(old);
  }
  function showState() {
    slider.max = model.get("last");
    if (state === null) slider.value = model.get("shown");
    caption.textContent = model.get("caption");
    play.textContent = model.get("playing") ? "Pause" : "Play";
  }

  play.addEventListener("click", () => {
    model.set("playing", !model.get("playing"));
    model.save_changes();
    send();
  });
  slider.addEventListener("input", () => {
    state = Number(slider.value);
    send();
  });
  let from = null;
  picture.addEventListener("pointerdown", (event) => {
    from = [event.clientX, event.clientY];
    picture.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  picture.addEventListener("pointermove", (event) => {
    if (!from) return;
    const [x, y] = [event.clientX - from[0], event.clientY - from[1]];
    from = [event.clientX, event.clientY];
    if (event.shiftKey) {
      const height = picture.clientHeight || 1;
      pan = { across: (pan?.across ?? 0) - x / height, up: (pan?.up ?? 0) + y / height };
    } else {
      orbit = { across: (orbit?.across ?? 0) - SPEED * x, up: (orbit?.up ?? 0) + SPEED * y };
    }
    send();
  });
  for (const name of ["pointerup", "pointercancel"]) {
    picture.addEventListener(name, () => {
      from = null;
    });
  }
  picture.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      zoom *= Math.exp(0.001 * event.deltaY);
      send();
    },
    { passive: false },
  );
  picture.addEventListener("dblclick", () => model.send({ kind: "frame all" }));

  function answered(message) {
    if (message?.kind === "done") {
      waiting = false;
      send();
    }
  }
  const changes = { "change:frame": showFrame };
  for (const name of ["shown", "last", "caption", "playing"]) changes[`change:${name}`] = showState;
  for (const [name, call] of Object.entries(changes)) model.on(name, call);
  model.on("msg:custom", answered);
  model.on("change:playing", send);
  showFrame();
  showState();

  return () => {
    for (const [name, call] of Object.entries(changes)) model.off(name, call);
    model.off("msg:custom", answered);
    model.off("change:playing", send);
    URL.revokeObjectURL(url);
  };
}

export default { render };
