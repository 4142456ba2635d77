// Plots over time, over a variable, or over the travel: one plot per unit, with a cursor at the present position.

const LINES = ["#2f7dd1", "#e0812b", "#2ca06b", "#9a62d0", "#d64f74", "#1d9aa8", "#a58a1f", "#7688a0"];
const HEIGHT = 168;
const MOST_LINES = 12;
/** The time as the horizontal axis. */
const TIME = { name: "Time", unit: "s", factor: 1 };
/** The part of the travel as the horizontal axis, if no coordinate is better. */
const PART = "Part of the travel";
/** A peak is cut if it is larger than nearly all values by this factor. */
const PEAK = 8;

class Plots {
  /** `goTo` moves to a sample of the run, or of the travel. */
  constructor(parent, picker, goTo) {
    Object.assign(this, { parent, picker, goTo, plots: [], colours: new Map(), chosen: {}, over: {}, mode: "motion" });
    new ResizeObserver(() => this.resize()).observe(parent);
    picker.addEventListener("change", () => {
      const [mode, ...name] = picker.value.split(":");
      this.over[mode] = name.join(":");
      this.goTo(this.index, mode);
      this.build();
    });
  }

  /** Plot these data: the variables that were plotted before, or those that the data name. */
  load(data) {
    this.data = data;
    this.sources = { motion: Plots.source(data.motion), travel: Plots.source(data.travel) };
    this.others = { motion: Plots.source(data.compare?.motion), travel: Plots.source(data.compare?.travel) };
    const first = { motion: data.motion?.plotted ?? [], travel: data.travel ? Plots.ofTravel(data.travel) : [] };
    for (const mode of ["motion", "travel"]) {
      const known = this.sources[mode]?.byName;
      this.chosen[mode] = (this.chosen[mode] ?? first[mode]).filter((name) => known?.has(name));
      if (this.over[mode] && this.over[mode] !== PART && !known?.has(this.over[mode])) this.over[mode] = undefined;
    }
    this.over.motion ??= "";
    this.over.travel ??= data.travel ? leading(data.travel)?.name ?? PART : PART;
    this.fillPicker();
    this.build(true);
  }

  static source(source) {
    if (!source) return undefined;
    const variables = source.variables ?? source.values;
    return { count: source.count, step: source.step, variables, byName: new Map(variables.map((v) => [v.name, v])) };
  }

  /** Variables that are plotted over the travel at first. */
  static ofTravel(travel) {
    const names = travel.values.map(({ name }) => name);
    const masses = names.filter((name) => /\.reduced_(mass|inertia)$/.test(name)).slice(0, 2);
    const ratios = names.filter((name) => name.includes(".advantage_on_")).slice(0, 1);
    const chosen = [...travel.plotted, ...masses, ...ratios];
    const some = (pattern) => names.filter((name) => pattern.test(name)).slice(0, 4);
    return chosen.length ? chosen : [...some(/\.(angle|position|length)$/), ...some(/\.force$/)];
  }

  fillPicker() {
    const { motion, travel } = this.sources;
    const option = (words, mode, name) => Object.assign(new Option(words, `${mode}:${name}`));
    const group = (words, options) => {
      const made = document.createElement("optgroup");
      made.label = words;
      made.append(...options);
      return made;
    };
    const isPlace = (v) => /\.(angle|position|length|x|y)$/.test(v.name) && v.causality !== "parameter";
    const outputs = motion?.variables.filter((v) => v.causality === "output" && !v.is_boolean) ?? [];
    const groups = [];
    if (motion) {
      groups.push(group("Run", [option("Time", "motion", ""), ...[...outputs.filter(isPlace), ...outputs.filter((v) => !isPlace(v))].map((v) => option(v.name, "motion", v.name))]));
    }
    if (travel) groups.push(group("Travel, without time", [...travel.variables.filter(isPlace).map((v) => option(`${v.name} (travel)`, "travel", v.name)), option(PART, "travel", PART)]));
    const words = groups.map(({ textContent }) => textContent).join();
    if (words !== this.words) this.picker.replaceChildren(...groups);
    this.words = words;
  }

  /** Plot the run or the travel. */
  enter(mode) {
    if (mode === this.mode || !this.sources[mode]) return;
    this.mode = mode;
    this.build();
  }

  has(name) {
    return this.chosen[this.mode].includes(name);
  }

  toggle(name, on) {
    this.chosen[this.mode] = this.chosen[this.mode].filter((other) => other !== name);
    if (on) this.chosen[this.mode].push(name);
    this.build();
  }

  colour(name) {
    return this.colours.get(name);
  }

  /** The unit in which a variable is plotted: its display unit, if it has one. */
  static unit(variable) {
    return variable.is_boolean ? "true or false" : (variable.display?.[0] ?? variable.unit);
  }

  /** The horizontal axis: its label, its unit, and its samples of a run or a travel. */
  axis(source = this.sources[this.mode]) {
    const name = this.over[this.mode];
    const variable = source.byName.get(name);
    if (variable) {
      const factor = variable.display?.[1] ?? 1;
      const unit = Plots.unit(variable);
      return { name, unit: unit === "1" ? "" : unit, samples: Array.from(variable.samples, (v) => v * factor) };
    }
    if (this.mode === "travel") return { name: PART, unit: "", samples: Array.from({ length: source.count }, (_, k) => k / Math.max(source.count - 1, 1)) };
    return { ...TIME, samples: Array.from({ length: source.count }, (_, k) => k * source.step) };
  }

  /** Create the plots, or give existing plots new data. */
  build(isOtherRun = false) {
    const source = this.sources[this.mode];
    const groups = new Map();
    if (source) {
      this.picker.value = `${this.mode}:${this.over[this.mode]}`;
      this.x = this.axis();
      this.otherX = this.others[this.mode] && this.axis(this.others[this.mode]);
      this.marks = this.marksOf();
    }
    for (const name of source ? this.chosen[this.mode] : []) {
      const variable = source.byName.get(name);
      const unit = Plots.unit(variable);
      const group = groups.get(unit) ?? groups.set(unit, []).get(unit);
      if (group.length < MOST_LINES) group.push(variable);
    }
    const kinds = JSON.stringify([this.mode, this.over, [...groups].map(([unit, all]) => [unit, all.map(({ name }) => name)])]);
    if (isOtherRun && kinds === this.kinds && !this.otherX && !this.hadOther) {
      [...groups.values()].forEach((variables, k) => this.plots[k].update(variables));
      return void (this.index !== undefined && this.show(this.index));
    }
    [this.kinds, this.hadOther] = [kinds, Boolean(this.otherX)];
    this.plots.forEach(({ plot }) => plot.destroy());
    this.parent.replaceChildren();
    this.colours.clear();
    this.plots = [...groups].map(([unit, variables]) => this.plot(unit, variables));
    if (source && !this.plots.length) {
      const hint = document.createElement("p");
      hint.className = "hint";
      hint.textContent = "Tick variables in the table to plot them.";
      this.parent.append(hint);
    }
    // The library computes the layout of its plots in a microtask.
    queueMicrotask(() => this.index !== undefined && this.show(this.index));
  }

  /** Marked positions: x, and label. */
  marksOf() {
    const { travel, motion, scene } = this.data;
    const at = (index) => linear(this.x.samples, index);
    if (this.mode === "travel") {
      const place = ({ at: part }) => at(part * (travel.count - 1));
      const stops = travel.stops.map((met) => ({ x: place(met), words: scene.stops[met.stop].name, kind: "stop" }));
      const toggles = travel.dead_centres.map((mark) => ({ x: place(mark), words: "dead centre", kind: "toggle" }));
      const equilibria = travel.equilibria.map((mark) => ({ x: place(mark), words: mark.name, kind: "balance" }));
      return [...stops, ...equilibria, ...toggles];
    }
    return scene.stops.flatMap((stop) => {
      const index = reachedAt(motion, stop);
      return index > 0 ? [{ x: at(index), words: stop.name, kind: "stop" }] : [];
    });
  }

  plot(unit, variables) {
    const figure = document.createElement("figure");
    figure.className = "plot";
    figure.dataset.unit = unit;
    const legend = figure.appendChild(document.createElement("figcaption"));
    const head = legend.appendChild(document.createElement("span"));
    head.className = "unit";
    head.textContent = unit === "1" ? "" : unit;
    const box = figure.appendChild(document.createElement("div"));
    this.parent.append(figure);
    const numbers = (variable) => {
      const factor = variable.display?.[1] ?? 1;
      return Array.from(variable.samples, (v) => (Number.isFinite(v) ? v * factor : null));
    };
    const shownLines = variables.map((variable, k) => {
      const colour = LINES[k % LINES.length];
      this.colours.set(variable.name, colour);
      const item = legend.appendChild(document.createElement("span"));
      item.className = "key";
      item.dataset.name = variable.name;
      item.style.setProperty("--c", colour);
      item.append(variable.name + " ");
      const value = item.appendChild(document.createElement("b"));
      value.dataset.value = variable.name;
      return { variable, colour, factor: variable.display?.[1] ?? 1, value, samples: numbers(variable) };
    });
    const others = shownLines.flatMap(({ variable, colour }) => {
      const other = this.others[this.mode]?.byName.get(variable.name);
      return other ? [{ variable: other, colour, samples: numbers(other) }] : [];
    });
    const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const axis = { stroke: () => css("--muted"), font: "11px system-ui, sans-serif", grid: { stroke: () => css("--grid"), width: 1 }, ticks: { show: false } };
    const series = ({ variable, colour }, isOther) => ({
      label: variable.name, stroke: colour, width: isOther ? 1.2 : 1.6, dash: isOther ? [5, 4] : undefined,
      facets: [{ scale: "x", auto: true }, { scale: "y", auto: true }], paths: drawLine(variable.is_boolean),
    });
    let [x, y] = [];
    const columns = () => {
      x = Plots.ends([...this.x.samples, ...(others.length ? this.otherX.samples : [])]);
      y = Plots.range([...shownLines, ...others].flatMap(({ samples }) => samples.filter((v) => v !== null)), this.mode === "travel");
      return [null, ...shownLines.map((l) => [this.x.samples, l.samples]), ...others.map((l) => [this.otherX.samples, l.samples])];
    };
    const plot = new uPlot({
      mode: 2, width: Math.max(this.parent.clientWidth, 200), height: HEIGHT, legend: { show: false }, padding: [8, 24, 0, 0],
      cursor: { show: false },
      scales: { x: { time: false, range: () => x }, y: { range: () => y } },
      axes: [
        { ...axis, scale: "x", size: 26, gap: 4, values: (_, ticks) => ticks.map((t, k) => (k === ticks.length - 1 && this.x.unit ? `${onAxis(t)} ${this.x.unit}` : onAxis(t))) },
        { ...axis, scale: "y", size: 58, gap: 6, values: (_, ticks) => ticks.map((t) => onAxis(t, Math.max(...ticks.map(Math.abs)))) },
      ],
      series: [{}, ...shownLines.map((l) => series(l, false)), ...others.map((l) => series(l, true))],
      hooks: { drawAxes: [(u) => drawMarks(u, this.marks, css)] },
    }, columns(), box);
    plot.over.setAttribute("aria-hidden", "true");
    const now = plot.over.appendChild(document.createElement("div"));
    now.className = "now";
    for (const shownLine of shownLines) {
      shownLine.dot = plot.over.appendChild(document.createElement("div"));
      shownLine.dot.className = "dot";
      shownLine.dot.dataset.dot = shownLine.variable.name;
      shownLine.dot.style.setProperty("--c", shownLine.colour);
    }
    const drag = (event) => {
      if (event.type === "pointermove" && !event.buttons) return;
      const { left } = plot.over.getBoundingClientRect();
      this.goTo(this.nearest(plot.posToVal(event.clientX - left, "x"), x[1] - x[0]), this.mode);
    };
    plot.over.addEventListener("pointerdown", drag);
    plot.over.addEventListener("pointermove", drag);
    figure.setAttribute("role", "img");
    figure.setAttribute("aria-label", `${variables.map((v) => v.name).join(", ")} over ${this.x.name.toLowerCase()}, in ${unit}`);
    const update = (now) => {
      shownLines.forEach((line, k) => Object.assign(line, { variable: now[k], samples: numbers(now[k]) }));
      plot.setData(columns());
    };
    return { plot, now, lines: shownLines, unit: head.textContent, update };
  }

  /** The sample at which x has a value. Of several samples the one next to the present sample. */
  nearest(value, range) {
    const { samples } = this.x;
    const last = samples.length - 1;
    if (this.over[this.mode] === "" || this.over[this.mode] === PART) return (value / (samples[last] || 1)) * last;
    let [best, least] = [0, Infinity];
    samples.forEach((x, k) => {
      const cost = Math.abs(x - value) + (0.03 * range * Math.abs(k - (this.index ?? 0))) / (last || 1);
      if (cost < least) [best, least] = [k, cost];
    });
    return best;
  }

  /** Smallest and largest value, with a distance larger than rounding. */
  static ends(values) {
    let [low, high] = [Infinity, -Infinity];
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
    if (!Number.isFinite(low)) return [0, 1];
    const room = 0.1 * Math.max(Math.abs(low), Math.abs(high)) || 1;
    return high - low > 1e-8 * room ? [low, high] : [low - room, high + room];
  }

  /** Range of an axis: slightly more than the values without high peaks, and never so narrow that rounding fills it. */
  static range(values, cuts) {
    if (!values.length) return [0, 1];
    let [low, high] = Plots.ends(values);
    const sizes = values.map(Math.abs).sort((a, b) => a - b);
    const most = sizes[Math.floor(0.9 * (sizes.length - 1))];
    if (cuts && sizes.at(-1) > PEAK * most && most > 0) [low, high] = [Math.max(low, -2 * most), Math.min(high, 2 * most)];
    const room = 0.06 * (high - low);
    return [low - room, high + room];
  }

  /** Move the cursors to a sample. On request also update the numbers in the legends. */
  show(index, withNumbers = true) {
    this.index = index;
    if (!this.x) return;
    const present = linear(this.x.samples, index);
    for (const { plot, now, lines } of this.plots) {
      const x = plot.valToPos(present, "x");
      now.style.transform = `translateX(${x.toFixed(2)}px)`;
      for (const { samples, variable, dot, value, factor } of lines) {
        const y = variable.is_boolean ? samples[Math.floor(index)] : linear(variable.samples, index) * factor;
        const isThere = Number.isFinite(y) && y !== null;
        switchTo(dot, isThere);
        if (isThere) dot.style.transform = `translate(${x.toFixed(2)}px, ${plot.valToPos(y, "y").toFixed(2)}px)`;
        if (withNumbers) value.textContent = variable.is_boolean ? (y > 0.5 ? "true" : "false") : shown(y);
      }
    }
  }

  resize() {
    const width = this.parent.clientWidth;
    if (width < 50) return;
    for (const { plot } of this.plots) if (plot.width !== width) plot.setSize({ width, height: HEIGHT });
    if (this.index !== undefined) this.show(this.index);
  }

  redraw() {
    for (const { plot } of this.plots) plot.redraw(false, true);
  }
}

/** The horizontal axis for a travel: the first coordinate or drive that only rises or only falls. */
function leading(travel) {
  const isSteady = ({ samples }) => {
    const steps = Array.from(samples).slice(1).map((x, k) => x - samples[k]);
    return steps.length && (steps.every((d) => d > 0) || steps.every((d) => d < 0));
  };
  return travel.values.filter((v) => v.causality === "position").find(isSteady);
}

/** The sample of a run at which a stop is reached first. -1: not reached. 0: the run starts there. */
function reachedAt(motion, stop) {
  const flag = motion.variables.find((v) => v.name === stop.flag);
  if (!flag) return -1;
  const first = flag.samples.findIndex((v) => v > 0.5);
  const time = motion.variables.find((v) => v.name === `${stop.name}.impact_time`)?.samples;
  const exact = first > 0 && time ? time[first] / motion.step : first;
  return exact > first - 1 && exact <= first ? exact : first;
}

/** Draws a line through points in any order of x. A Boolean is drawn in steps. */
function drawLine(isStepped) {
  return (u, k) => {
    const [xs, ys] = u.data[k];
    const stroke = new Path2D();
    let last;
    xs.forEach((x, i) => {
      if (ys[i] === null || ys[i] === undefined || !Number.isFinite(x)) return void (last = undefined);
      const [px, py] = [u.valToPos(x, "x", true), u.valToPos(ys[i], "y", true)];
      if (last === undefined) stroke.moveTo(px, py);
      else if (isStepped) stroke.lineTo(px, last);
      stroke.lineTo(px, py);
      last = py;
    });
    return { stroke, fill: null, clip: null, band: null, gaps: null, flags: 0 };
  };
}

/** Vertical lines at marked positions, with their labels where there is room. */
function drawMarks(u, marks, css) {
  const { ctx, bbox } = u;
  const ratio = window.devicePixelRatio || 1;
  const ends = [];
  ctx.save();
  ctx.font = `${10 * ratio}px system-ui, sans-serif`;
  ctx.lineWidth = ratio;
  Object.assign(ctx, { textAlign: "left", textBaseline: "alphabetic" });
  for (const { x, words, kind } of marks) {
    const px = u.valToPos(x, "x", true);
    if (!Number.isFinite(px) || px < bbox.left - 1 || px > bbox.left + bbox.width + 1) continue;
    ctx.strokeStyle = css(kind === "stop" ? "--accent" : kind === "toggle" ? "--alert" : "--weight");
    ctx.setLineDash(kind === "stop" ? [] : [3 * ratio, 3 * ratio]);
    ctx.globalAlpha = 0.6;
    ctx.beginPath();
    ctx.moveTo(px, bbox.top);
    ctx.lineTo(px, bbox.top + bbox.height);
    ctx.stroke();
    const width = ctx.measureText(words).width;
    const left = px + 3 * ratio + width > bbox.left + bbox.width ? px - 3 * ratio - width : px + 3 * ratio;
    const row = [0, 1].find((r) => !ends.some(([r2, a, b]) => r2 === r && left < b + 4 * ratio && a < left + width + 4 * ratio));
    if (row === undefined) continue;
    ends.push([row, left, left + width]);
    ctx.globalAlpha = 1;
    ctx.fillStyle = css("--muted");
    ctx.fillText(words, left, bbox.top + (10 + 12 * row) * ratio);
  }
  ctx.restore();
}
