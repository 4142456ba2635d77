// The page: reads its data, builds the drawing, the plots and the table, and shows all of them at one time.

const byId = (id) => document.getElementById(id);
/** Time between two updates of the numbers while the motion plays [ms]. */
const NUMBERS = 90;

/** State of the page. Plots and table are built after the first frame is drawn. */
const page = { mode: "still", numbersAt: 0, layers: new Map(), magnification: 1, view: { zoom: 1, x: 0, y: 0 } };

/** Poses for which the drawing must have room: some from each source. */
function sampled(source) {
  const parts = Math.min(source.count, 72);
  return Array.from({ length: parts }, (_, k) => source.frames.frame(parts > 1 ? (k * (source.count - 1)) / (parts - 1) : 0));
}

/** Read the series of the data. */
function readAll({ motion, travel }) {
  for (const source of [motion, travel].filter(Boolean)) {
    source.frames = new Poses(source.poses, source.count);
    for (const variable of source.variables ?? source.values) readLater(variable, source.count);
  }
}

/** Whether the motion goes towards the low end of the travel. The slider then has the opposite direction. */
function runsBackward({ motion, travel }) {
  if (!travel || travel.is_closed) return false;
  if (travel.start > 0.9 || travel.start < 0.1 || !motion) return travel.start > 0.5;
  const [first, last] = [0, motion.count - 1].map((k) => motion.frames.frame(k));
  const [low, high] = [0, travel.count - 1].map((k) => travel.frames.frame(k));
  let along = 0;
  first.forEach((pose, body) => pose.forEach((x, k) => (along += (last[body][k] - x) * (high[body][k] - low[body][k]))));
  return along < 0;
}

/** Show these data instead of the previous ones. */
function show(data) {
  // At this point no new layout of the page is needed.
  const room = byId("drawing").getBoundingClientRect();
  readAll(data);
  if (data.compare) readAll(data.compare);
  page.isBackward = runsBackward(data);
  const before = page.clock;
  page.clock?.play(false);
  page.data = data;
  page.still = data.still?.poses;
  page.mode = data.motion && page.mode !== "travel" ? "motion" : data.travel ? "travel" : "still";
  const run = data.motion ? sampled(data.motion) : [];
  const sources = [...run, ...(data.travel ? sampled(data.travel) : []), ...(page.still ? [page.still] : [])];
  page.drawing = data.scene && new Drawing(byId("drawing"), data, sources, run, page.view);
  if (page.drawing && data.compare?.scene) page.drawing.compared = new Compared(page.drawing, data.compare);
  page.clock = data.motion && new Clock(data.motion.count, data.motion.step, draw);
  if (before && page.clock) {
    page.clock.index = Math.min(before.time / page.clock.step, page.clock.last);
    Object.assign(page.clock, { speed: before.speed, repeats: before.repeats });
  }
  page.scratch = (data.motion ?? data.travel)?.frames.bodies.map(() => [0, 0, 0]);
  byId("side").hidden = !data.motion;
  document.body.classList.toggle("alone", !data.motion);
  document.querySelector(".stage").hidden = !page.drawing;
  describe();
  listFindings();
  fillControls();
  byId("compared").textContent = data.compare ? `solid: ${data.label} · dashed: ${data.compare.label}` : "";
  fillResults(byId("results"), data, (index, part) => (index === undefined ? travelTo(part) : seek(index)));
  if (page.drawing) {
    fillLayers();
    page.drawing.layout(room);
  }
  if (page.plots) fillSide();
  draw();
}

/** Draw the present time or position. */
function draw() {
  if (page.mode === "motion") drawMotion();
  else if (page.mode === "travel") drawTravel();
  else page.drawing?.show(page.still);
}

function drawMotion() {
  const { clock, data } = page;
  const { index } = clock;
  page.drawing.makeRoom("motion");
  page.drawing.show(data.motion.frames.at(index, page.scratch), index);
  page.drawing.compared?.show("motion", clock.time);
  const now = performance.now();
  const withNumbers = !clock.isPlaying || now - page.numbersAt > NUMBERS;
  page.plots?.show(index, withNumbers);
  byId("time").value = index;
  if (!withNumbers) return;
  page.numbersAt = now;
  page.table?.show(index, false, !clock.isPlaying);
  byId("time-text").textContent = `${clock.time.toFixed(decimals(clock.step))} s`;
  byId("time").setAttribute("aria-valuetext", `${clock.time.toFixed(decimals(clock.step))} s`);
  byId("play").classList.toggle("playing", clock.isPlaying);
  byId("play").setAttribute("aria-pressed", String(clock.isPlaying));
  byId("play").setAttribute("aria-label", clock.isPlaying ? "Pause" : "Play");
  byId("travel-text").textContent = "";
}

function drawTravel() {
  const { data } = page;
  const part = partOf(byId("travel").value);
  const position = part * (data.travel.count - 1);
  page.drawing.makeRoom("travel");
  page.drawing.show(data.travel.frames.at(position, page.scratch));
  page.drawing.compared?.show("travel", part);
  page.plots?.show(position);
  page.table?.show(position, true);
  const first = leading(data.travel) ?? data.travel.values[0];
  const [unit, factor] = first.display ?? [first.unit, 1];
  const value = linear(first.samples, position) * factor;
  const text = unit === "deg" ? `${onAxis(Number(value.toFixed(1)))}°` : `${shown(value, 4)} ${unit}`;
  byId("travel-text").textContent = text;
  byId("travel").setAttribute("aria-valuetext", `${first.name} ${text}`);
}

/** Number of digits after the point with which two frames have different times. */
function decimals(step) {
  return Math.min(Math.max(Math.ceil(-Math.log10(step)), 0), 9);
}

/** The part of the travel at a position of the slider, and vice versa. */
function partOf(place) {
  return page.isBackward ? 1 - Number(place) : Number(place);
}

function enter(mode) {
  if (page.mode !== mode) {
    page.mode = mode;
    if (mode === "travel") page.clock?.play(false);
    byId("time-row").classList.toggle("off", mode === "travel");
    byId("travel-row").classList.toggle("off", mode === "motion");
    page.plots?.enter(mode);
  }
}

function seek(index) {
  enter("motion");
  page.clock.play(false);
  page.clock.seek(index);
}

/** Move to a part of the travel, from 0 at its low end to 1. */
function travelTo(part) {
  byId("travel").value = partOf(part);
  enter("travel");
  draw();
}

/** Move to a sample of the run, or of the travel. */
function goTo(index, mode) {
  if (mode === "travel") travelTo((page.mode === "travel" ? index : page.data.travel.start * (page.data.travel.count - 1)) / (page.data.travel.count - 1));
  else seek(page.mode === "motion" ? index : page.clock.index);
}

function play(on) {
  const { clock } = page;
  enter("motion");
  clock.play(on);
  announce(on ? "Playing" : `Paused at ${clock.time.toFixed(decimals(clock.step))} s`);
}

function announce(text) {
  byId("announced").textContent = text;
}

/** Connect the controls with their functions. */
function setUpControls() {
  byId("time").addEventListener("input", (event) => seek(Number(event.target.value)));
  byId("play").addEventListener("click", () => play(!page.clock.isPlaying));
  for (const speed of SPEEDS) byId("speed").add(new Option(`${speed < 1 ? `1/${Math.round(1 / speed)}` : speed} × real time`, speed));
  byId("speed").addEventListener("change", (event) => (page.clock.speed = Number(event.target.value)));
  byId("loop").addEventListener("click", (event) => {
    page.clock.repeats = !page.clock.repeats;
    event.currentTarget.setAttribute("aria-pressed", String(page.clock.repeats));
  });
  byId("travel").addEventListener("input", (event) => travelTo(partOf(event.target.value)));
  setUpTools();
  document.addEventListener("keydown", onKey);
}

/** Set the controls according to the data. */
function fillControls() {
  const { data, clock } = page;
  byId("controls").hidden = !data.motion && !data.travel;
  byId("time-row").hidden = !data.motion;
  byId("travel-row").hidden = !data.travel;
  if (clock) {
    byId("time").max = clock.last;
    byId("speed").value = clock.speed;
  }
  if (!data.travel) return;
  if (page.mode !== "travel") byId("travel").value = partOf(data.travel.start);
  fillEnds();
  const [low, high] = data.travel.goes_on;
  const stops = [...new Set([...data.travel.stops.map((met) => data.scene.stops[met.stop].name), ...data.travel.ends.filter(Boolean)])];
  const ends = data.travel.is_closed && !stops.length ? "over one full cycle of the motion" : stops.length ? `between the ends of travel, with the stops ${stops.join(", ")}` : "from one end of the travel to the other end";
  const beyond = low || high ? "; the motion of the mechanism continues beyond this range" : "";
  byId("hint").textContent = `The slider Travel sets the position of the mechanism, independent of time, ${ends}${beyond}. Press Space to play the motion, and the arrow keys to move by one frame. To zoom the drawing, use the mouse wheel or two fingers. To move the drawing, drag it.`;
}

function onKey(event) {
  const { clock, data } = page;
  const { target, key } = event;
  if (event.ctrlKey || event.metaKey || event.altKey || target.matches("input[type=search], select, textarea, [contenteditable]")) return;
  const steps = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10 }[key];
  const onTravel = target.id === "travel";
  if (key === " " && data.motion && !target.matches("button, input[type=checkbox]")) play(!clock.isPlaying);
  else if (steps && onTravel) travelTo(partOf(Math.min(Math.max(Number(target.value) + (steps * (event.shiftKey ? 10 : 1)) / (data.travel.count - 1), 0), 1)));
  else if (steps && data.motion) seek(Math.round(clock.index) + steps * (event.shiftKey ? 10 : 1));
  else if (key === "Home" || key === "End") onTravel ? travelTo(partOf(key === "End" ? 1 : 0)) : data.motion && seek(key === "End" ? clock.last : 0);
  else if (key === "f" && page.drawing) fullScreen();
  else if (!page.drawing || !page.zoom.key(key)) return;
  event.preventDefault();
}

/** Names of the stops at the ends of the travel, and marks between the ends. */
function fillEnds() {
  const { travel, scene } = page.data;
  const at = (part) => travel.stops.filter((met) => Math.abs(met.at - part) < 1e-6).map((met) => scene.stops[met.stop].name);
  const words = [0, 1].map((part) => [...new Set([...at(part), travel.ends[part]])].filter(Boolean).join(", "));
  [byId("travel-low").textContent, byId("travel-high").textContent] = page.isBackward ? [words[1], words[0]] : words;
  const track = byId("travel-low").parentElement;
  track.querySelectorAll("i").forEach((mark) => mark.remove());
  const marks = [...travel.stops.map((met) => ({ at: met.at, name: scene.stops[met.stop].name, kind: "stop" })), ...travel.dead_centres.map((mark) => ({ ...mark, name: `dead centre of ${mark.name}`, kind: "toggle" })), ...travel.equilibria.map((mark) => ({ ...mark, name: `${mark.name} equilibrium`, kind: "balance" }))];
  for (const { at: part, name, kind } of marks) {
    const mark = track.appendChild(document.createElement("i"));
    mark.className = kind;
    mark.title = name;
    mark.style.left = `${(100 * partOf(part)).toFixed(2)}%`;
  }
}

/** Zoom, full screen, saving. */
function setUpTools() {
  page.zoom = new Zoom(byId("drawing"), page.view, () => {
    page.drawing?.layout();
    draw();
  });
  byId("zoom-in").addEventListener("click", () => page.zoom.by(1.4));
  byId("zoom-out").addEventListener("click", () => page.zoom.by(1 / 1.4));
  byId("zoom-reset").addEventListener("click", () => page.zoom.reset());
  byId("full").addEventListener("click", fullScreen);
  byId("full").hidden = !document.fullscreenEnabled;
  document.addEventListener("pointerdown", ({ target }) => byId("save").contains(target) || (byId("save").open = false));
  byId("save").addEventListener("keydown", ({ key }) => key === "Escape" && (byId("save").open = false));
  byId("save").addEventListener("click", ({ target }) => {
    const kind = target.dataset.save;
    if (!kind) return;
    byId("save").open = false;
    save(kind).catch((error) => announce(`Not saved: ${error.message}`));
  });
}

function fullScreen() {
  if (document.fullscreenElement) document.exitFullscreen();
  else document.querySelector(".stage").requestFullscreen();
}

async function save(kind) {
  const name = (page.data.name || "Mechanism").replace(/[^\w-]/g, "_");
  const isPlot = kind.startsWith("plots");
  const svg = () => (isPlot ? plotsAsSvg(page.plots) : drawingAsSvg(byId("drawing")));
  const file = isPlot ? `${name}_plots` : name;
  if (kind.endsWith("svg")) saveAs(`${file}.svg`, new Blob([svg()], { type: "image/svg+xml" }));
  else if (kind === "csv") saveAs(`${name}.csv`, new Blob([asCsv(page.data, page.mode === "travel")], { type: "text/csv" }));
  else if (kind.endsWith("png")) saveAs(`${file}.png`, await asBlob(await asCanvas(svg())));
  else await navigator.clipboard.write([new ClipboardItem({ "image/png": asBlob(await asCanvas(svg())) })]);
  announce(kind === "copy" ? "The drawing is copied" : "Saved");
}

/** Switches for the parts of the drawing. */
function fillLayers() {
  const { data, drawing } = page;
  const { arrows, layers, scene } = drawing;
  byId("layers").replaceChildren();
  const add = (words, on, change, kind = "") => {
    const button = byId("layers").appendChild(document.createElement("button"));
    Object.assign(button, { type: "button", textContent: words });
    button.className = kind;
    const set = (value) => {
      button.setAttribute("aria-pressed", String(value));
      change(value);
    };
    button.addEventListener("click", () => {
      page.layers.set(words, button.getAttribute("aria-pressed") !== "true");
      set(page.layers.get(words));
      draw();
    });
    set(page.layers.get(words) ?? on);
  };
  const layer = (name) => (on) => (layers[name].style.display = on ? "" : "none");
  for (const [kind, words, on] of arrows.kinds) add(words, on, (value) => (arrows.visible[kind] = value), `arrows ${kind}`);
  if (scene.bodies.some((body) => body.mass > 0)) add("Centres of mass", true, layer("masses"));
  if (scene.markers.length && (data.motion || data.travel)) add("Paths", true, layer("paths"));
  if (scene.surfaces.some((surface) => surface.half)) add("Surfaces", false, layer("surfaces"));
  if (data.travel?.stops.length) add("Stops", true, (on) => ["ghosts", "locks"].forEach((name) => layer(name)(on)));
  add("Names", !matchMedia("(max-width: 520px)").matches, layer("names"));
  if (arrows.kinds.length) addArrowSize();
}

function addArrowSize() {
  const label = byId("layers").appendChild(document.createElement("label"));
  label.className = "size";
  label.append("Arrow size");
  const input = label.appendChild(document.createElement("input"));
  Object.assign(input, { type: "range", min: -1, max: 1, step: 0.05, value: Math.log10(page.magnification) });
  page.drawing.arrows.magnification = page.magnification;
  input.setAttribute("aria-label", "Size of the arrows");
  input.addEventListener("input", () => {
    page.drawing.arrows.magnification = page.magnification = 10 ** Number(input.value);
    page.drawing.layout();
    draw();
  });
}

function setUpTheme() {
  const root = document.documentElement;
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const repaint = () => page.plots?.redraw();
  byId("theme").addEventListener("click", () => {
    const isDark = root.dataset.theme ? root.dataset.theme === "dark" : dark.matches;
    root.dataset.theme = isDark ? "light" : "dark";
    repaint();
  });
  dark.addEventListener("change", repaint);
}

function listFindings() {
  const { data } = page;
  const list = byId("findings").querySelector("ul");
  list.replaceChildren();
  for (const { is_error, path, line: number, message, remedy } of data.findings) {
    const item = list.appendChild(document.createElement("li"));
    item.className = is_error ? "error" : "warning";
    const where = item.appendChild(document.createElement("b"));
    where.textContent = [is_error ? "Error" : "Warning", number ? `line ${number}` : "", path].filter(Boolean).join(" · ");
    const words = item.appendChild(document.createElement("bdi"));
    words.textContent = brief(remedy ? `${message}; ${remedy}` : message);
  }
  byId("findings").hidden = !data.findings.length;
}

/** Name, description and error: part of the page at first, written again for other data. */
function setTexts() {
  const { name, description, error } = page.data;
  document.title = name || "Mechanism";
  document.querySelector("h1 bdi").textContent = document.title;
  byId("lead").textContent = description;
  byId("error").hidden = !error;
  byId("error-text").replaceChildren(brief(error ?? ""));
  byId("error-title").textContent = "The motion could not be computed";
}

function describe() {
  const { scene, motion, still: stands } = page.data;
  setTexts();
  const count = (n, word) => `${n} ${word}${n === 1 ? "" : "s"}`;
  const parts = scene ? `${count(scene.bodies.length - 1, "body").replace("bodys", "bodies")}, ${count(scene.joints.length, "joint")}, ${count(scene.actuators.length, "drive")}.` : "Nothing can be drawn.";
  const gaps = (stands?.gaps ?? []).map((gap) => `the two points of ${gap.joint} are ${length(gap.gap, page.data)} apart`).join(", ");
  if (gaps) byId("error-text").append(document.createElement("br"), `In the position in the key guess, ${gaps}.`);
  const duration = motion ? ` Motion over ${shown((motion.count - 1) * motion.step, 4)} s.` : "";
  byId("drawing-description").textContent = parts + duration + (gaps ? ` In the position in the key guess, ${gaps}.` : "");
  const left = motion?.left_out ? ` ${motion.left_out} variables are not on this page.` : "";
  const frames = motion ? `${motion.count} computed frames, with interpolation between frames. ` : "";
  byId("about").textContent = `${frames}${parts}${left} Angles are positive anticlockwise. Values are in SI units and in display units. Built by linkage-fmu.`;
  if (stands) {
    byId("error-title").textContent = stands.is_assembled ? "The loops of this mechanism close, but the motion cannot be computed" : "The loops of this mechanism do not close; the drawing shows the positions of the guess";
  } else if (motion) {
    byId("error-title").textContent = "The motion ends before the stop time";
  }
}

/** Plots and table of the data. The library is loaded the first time. */
function fillSide() {
  const { motion } = page.data;
  if (!motion) return;
  if (!page.plots) {
    const library = document.createElement("script");
    library.textContent = byId("plot-library").textContent;
    document.head.append(library);
    page.plots = new Plots(byId("plots"), byId("over"), goTo);
    page.table = new Table(page.plots);
  }
  page.plots.load(page.data);
  page.table.load(page.data);
}

setUpTheme();
setUpControls();
new ResizeObserver(() => {
  page.drawing?.layout();
  draw();
}).observe(byId("drawing"));
show(JSON.parse(byId("data").textContent));
// In the second frame the first frame is on the screen. Only then the library of the plots is compiled.
const afterTwoFrames = (next) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(next)));
afterTwoFrames(() => {
  fillSide();
  document.body.dataset.ready = "";
  draw();
});
window.mechanism = {
  show, seek, travelTo, play, page,
  get data() { return page.data; },
  get clock() { return page.clock; },
  get drawing() { return page.drawing; },
};
