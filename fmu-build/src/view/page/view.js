// The page: reads its data, builds the drawing, the plots and the table, and keeps them at one time.

const byId = (id) => document.getElementById(id);
const data = JSON.parse(byId("data").textContent);
/** Time between two updates of the numbers while the motion plays [ms]. */
const NUMBERS = 90;

for (const source of [data.motion, data.travel].filter(Boolean)) {
  source.frames = new Poses(source.poses, source.count);
  for (const variable of source.variables ?? source.values) variable.samples = readSeries(variable.values, source.count);
}

/** Poses that the drawing must have room for: some of each source. */
function sampled(source) {
  const parts = Math.min(source.count, 72);
  return Array.from({ length: parts }, (_, k) => source.frames.frame(parts > 1 ? (k * (source.count - 1)) / (parts - 1) : 0));
}

const view = { mode: data.motion ? "motion" : data.travel ? "travel" : "still", told: 0 };
const still = data.still?.poses;
const run = data.motion ? sampled(data.motion) : [];
const drawing = data.scene && new Drawing(byId("drawing"), data, [...run, ...(data.travel ? sampled(data.travel) : []), ...(still ? [still] : [])], run);
const clock = data.motion && new Clock(data.motion.count, data.motion.step, () => show());
/** Made after the first frame is drawn. */
let [plots, table] = [undefined, undefined];
const scratch = (data.motion ?? data.travel)?.frames.bodies.map(() => [0, 0, 0]);

/** Draw what the page stands at. */
function show() {
  if (view.mode === "motion") showMotion();
  else if (view.mode === "travel") showTravel();
  else drawing?.show(still);
}

function showMotion() {
  const { index } = clock;
  drawing.show(data.motion.frames.at(index, scratch), index);
  const now = performance.now();
  const withNumbers = !clock.isPlaying || now - view.told > NUMBERS;
  plots?.show(index, withNumbers);
  byId("time").value = index;
  if (!withNumbers) return;
  view.told = now;
  table?.show(index, false, !clock.isPlaying);
  byId("time-text").textContent = `${clock.time.toFixed(decimals(clock.step))} s`;
  byId("time").setAttribute("aria-valuetext", `${clock.time.toFixed(decimals(clock.step))} s`);
  byId("play").classList.toggle("playing", clock.isPlaying);
  byId("play").setAttribute("aria-pressed", String(clock.isPlaying));
  byId("play").setAttribute("aria-label", clock.isPlaying ? "Pause" : "Play");
  byId("travel-text").textContent = "";
}

function showTravel() {
  const position = Number(byId("travel").value) * (data.travel.count - 1);
  drawing.show(data.travel.frames.at(position, scratch));
  table?.show(position, true);
  const [first] = data.travel.values;
  const value = linear(first.samples, position);
  const text = first.is_angle ? `${((value * 180) / Math.PI).toFixed(1)}°` : `${shown(value, 4)} m`;
  byId("travel-text").textContent = text;
  byId("travel").setAttribute("aria-valuetext", `${first.name} ${text}`);
}

/** Digits after the point that tell two frames apart. */
function decimals(step) {
  return Math.min(Math.max(Math.ceil(-Math.log10(step)), 0), 9);
}

function enter(mode) {
  if (view.mode !== mode) {
    view.mode = mode;
    if (mode === "travel") clock?.play(false);
    byId("time-row").classList.toggle("off", mode === "travel");
    byId("travel-row").classList.toggle("off", mode === "motion");
    byId("plots-panel").classList.toggle("off", mode === "travel");
  }
}

function seek(index) {
  enter("motion");
  clock.play(false);
  clock.seek(index);
}

function travelTo(position) {
  byId("travel").value = position;
  enter("travel");
  show();
}

function play(on) {
  enter("motion");
  clock.play(on);
  announce(on ? "Playing" : `Paused at ${clock.time.toFixed(decimals(clock.step))} s`);
}

function announce(text) {
  byId("announced").textContent = text;
}

function setUpControls() {
  byId("controls").hidden = !data.motion && !data.travel;
  byId("time-row").hidden = !data.motion;
  byId("travel-row").hidden = !data.travel;
  if (data.motion) setUpTime();
  if (data.travel) setUpTravel();
  document.addEventListener("keydown", onKey);
}

function setUpTime() {
  byId("time").max = clock.last;
  byId("time").addEventListener("input", (event) => seek(Number(event.target.value)));
  byId("play").addEventListener("click", () => play(!clock.isPlaying));
  for (const speed of SPEEDS) {
    const words = speed < 1 ? `1/${Math.round(1 / speed)}` : String(speed);
    byId("speed").add(new Option(`${words} × real time`, speed, false, speed === clock.speed));
  }
  byId("speed").addEventListener("change", (event) => (clock.speed = Number(event.target.value)));
  byId("loop").addEventListener("click", (event) => {
    clock.repeats = !clock.repeats;
    event.currentTarget.setAttribute("aria-pressed", String(clock.repeats));
  });
}

function setUpTravel() {
  byId("travel").value = data.travel.start;
  byId("travel").addEventListener("input", (event) => travelTo(Number(event.target.value)));
  const [low, high] = data.travel.goes_on;
  const stops = [...new Set(data.travel.stops.map((met) => data.scene.stops[met.stop].name))];
  const ends = data.travel.is_closed && !stops.length ? "over one full cycle of the motion" : stops.length ? `between the ends of travel, with the stops ${stops.join(", ")}` : "from one end of the travel to the other end";
  const beyond = low || high ? "; the motion of the mechanism continues beyond this range" : "";
  byId("hint").textContent = `The slider Travel sets the position of the mechanism, independent of time, ${ends}${beyond}. Press Space to play the motion, and the arrow keys to move by one frame.`;
}

function onKey(event) {
  const { target, key } = event;
  if (event.ctrlKey || event.metaKey || event.altKey || target.matches("input[type=search], select")) return;
  const steps = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10 }[key];
  const onTravel = target.id === "travel";
  if (key === " " && data.motion && !target.matches("button, input[type=checkbox]")) play(!clock.isPlaying);
  else if (steps && onTravel) travelTo(Math.min(Math.max(Number(target.value) + (steps * (event.shiftKey ? 10 : 1)) / (data.travel.count - 1), 0), 1));
  else if (steps && data.motion) seek(Math.round(clock.index) + steps * (event.shiftKey ? 10 : 1));
  else if (key === "Home" || key === "End") onTravel ? travelTo(key === "End" ? 1 : 0) : data.motion && seek(key === "End" ? clock.last : 0);
  else return;
  event.preventDefault();
}

/** Switches for what the drawing shows. */
function setUpLayers() {
  const { arrows, layers, scene } = drawing;
  const add = (words, on, change, kind = "") => {
    const button = byId("layers").appendChild(document.createElement("button"));
    Object.assign(button, { type: "button", textContent: words });
    button.className = kind;
    const set = (value) => {
      button.setAttribute("aria-pressed", String(value));
      change(value);
    };
    button.addEventListener("click", () => {
      set(button.getAttribute("aria-pressed") !== "true");
      show();
    });
    set(on);
  };
  const layer = (name) => (on) => (layers[name].style.display = on ? "" : "none");
  for (const [kind, words, on] of arrows.kinds) add(words, on, (value) => (arrows.visible[kind] = value), `arrows ${kind}`);
  if (scene.bodies.some((body) => body.mass > 0)) add("Centres of mass", true, layer("masses"));
  if (scene.markers.length && (data.motion || data.travel)) add("Paths", true, layer("paths"));
  if (scene.surfaces.some((surface) => surface.half)) add("Surfaces", false, layer("surfaces"));
  if (data.travel?.stops.length) add("Stops", true, (on) => ["ghosts", "locks"].forEach((name) => layer(name)(on)));
  add("Names", !matchMedia("(max-width: 520px)").matches, layer("names"));
  if (arrows.kinds.length) setUpArrowSize();
}

function setUpArrowSize() {
  const label = byId("layers").appendChild(document.createElement("label"));
  label.className = "size";
  label.append("Arrow size");
  const input = label.appendChild(document.createElement("input"));
  Object.assign(input, { type: "range", min: -1, max: 1, step: 0.05, value: 0 });
  input.setAttribute("aria-label", "Size of the arrows");
  input.addEventListener("input", () => {
    drawing.arrows.magnification = 10 ** Number(input.value);
    drawing.layout();
    show();
  });
}

function setUpTheme() {
  const root = document.documentElement;
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const repaint = () => plots?.redraw();
  byId("theme").addEventListener("click", () => {
    const isDark = root.dataset.theme ? root.dataset.theme === "dark" : dark.matches;
    root.dataset.theme = isDark ? "light" : "dark";
    repaint();
  });
  dark.addEventListener("change", repaint);
}

function setUpFindings() {
  const list = byId("findings").querySelector("ul");
  for (const { is_error, path, line: number, message, remedy } of data.findings) {
    const item = list.appendChild(document.createElement("li"));
    item.className = is_error ? "error" : "warning";
    const where = item.appendChild(document.createElement("b"));
    where.textContent = [is_error ? "Error" : "Warning", number ? `line ${number}` : "", path].filter(Boolean).join(" · ");
    const words = item.appendChild(document.createElement("bdi"));
    words.textContent = remedy ? `${message}; ${remedy}` : message;
  }
  byId("findings").hidden = !data.findings.length;
}

function describe() {
  const { scene, motion, still: stands } = data;
  const count = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;
  const parts = scene ? `${count(scene.bodies.length - 1, "body").replace("bodys", "bodies")}, ${count(scene.joints.length, "joint")}, ${count(scene.actuators.length, "drive")}.` : "Nothing can be drawn.";
  const gaps = (stands?.gaps ?? []).map((gap) => `${gap.joint} is open by ${shown(gap.gap, 4)} m`).join(", ");
  if (gaps) byId("error").appendChild(document.createElement("p")).textContent = `In the position in the key guess, ${gaps}.`;
  const length = motion ? ` Motion over ${shown((motion.count - 1) * motion.step, 4)} s.` : "";
  byId("drawing-description").textContent = parts + length + (gaps ? ` In the position in the key guess, ${gaps}.` : "");
  const left = motion?.left_out ? ` ${motion.left_out} variables are not on this page.` : "";
  const frames = motion ? `${motion.count} computed frames, interpolated in between. ` : "";
  byId("about").textContent = `${frames}${parts}${left} Angles are positive anticlockwise. Values are in SI units. Built by linkage-fmu.`;
  if (stands && byId("error-title")) {
    byId("error-title").textContent = stands.is_assembled ? "The loops of this mechanism close, but the motion cannot be computed" : "The loops of this mechanism do not close; the drawing shows the positions of the guess";
  } else if (motion && byId("error-title")) {
    byId("error-title").textContent = "The motion ends early";
  }
}

byId("side").hidden = !data.motion;
document.body.classList.toggle("alone", !data.motion);
describe();
setUpFindings();
setUpTheme();
setUpControls();
if (drawing) {
  new ResizeObserver(() => {
    drawing.layout();
    show();
  }).observe(byId("drawing"));
  setUpLayers();
} else {
  document.querySelector(".stage").hidden = true;
}
if (data.motion) {
  const finish = () => {
    const library = document.createElement("script");
    library.textContent = byId("plot-library").textContent;
    document.head.append(library);
    plots = new Plots(byId("plots"), data.motion, (index) => seek(index));
    table = new Table(data, plots);
    document.body.dataset.ready = "";
    show();
  };
  // In the second frame the first one is on the screen; only then the library of the plots is compiled.
  requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(finish)));
} else {
  document.body.dataset.ready = "";
}
window.mechanism = { data, clock, drawing, seek, travelTo, play };
