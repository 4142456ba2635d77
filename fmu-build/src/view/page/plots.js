// Plots over time, one for each unit, with a cursor at the present time.

const LINES = ["#2f7dd1", "#e0812b", "#2ca06b", "#9a62d0", "#d64f74", "#1d9aa8", "#a58a1f", "#7688a0"];
const HEIGHT = 168;
const MOST_LINES = 12;

class Plots {
  /** `seek` moves the time to a frame. */
  constructor(parent, seek) {
    Object.assign(this, { parent, seek, plots: [], colours: new Map() });
    new ResizeObserver(() => this.resize()).observe(parent);
  }

  /** Plot a motion: the variables that were plotted before, or those that it names. */
  load(motion) {
    this.motion = motion;
    this.times = Array.from({ length: motion.count }, (_, k) => k * motion.step);
    this.byName = new Map(motion.variables.map((variable) => [variable.name, variable]));
    this.chosen = (this.chosen ?? motion.plotted).filter((name) => this.byName.has(name));
    this.build();
  }

  has(name) {
    return this.chosen.includes(name);
  }

  toggle(name, on) {
    this.chosen = this.chosen.filter((other) => other !== name);
    if (on) this.chosen.push(name);
    this.build();
  }

  colour(name) {
    return this.colours.get(name);
  }

  /** The unit in which a variable is plotted: its display unit, if it has one. */
  static unit(variable) {
    return variable.is_boolean ? "true or false" : (variable.display?.[0] ?? variable.unit);
  }

  build() {
    this.plots.forEach(({ plot }) => plot.destroy());
    this.parent.replaceChildren();
    this.colours.clear();
    const groups = new Map();
    for (const name of this.chosen) {
      const variable = this.byName.get(name);
      const unit = Plots.unit(variable);
      const group = groups.get(unit) ?? groups.set(unit, []).get(unit);
      if (group.length < MOST_LINES) group.push(variable);
    }
    this.plots = [...groups].map(([unit, variables]) => this.plot(unit, variables));
    if (!this.plots.length) {
      const hint = document.createElement("p");
      hint.className = "hint";
      hint.textContent = "Tick variables in the table to plot them.";
      this.parent.append(hint);
    }
    if (this.index !== undefined) this.show(this.index);
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
    const shownLines = variables.map((variable, k) => {
      const colour = LINES[k % LINES.length];
      this.colours.set(variable.name, colour);
      const item = legend.appendChild(document.createElement("span"));
      item.className = "key";
      item.style.setProperty("--c", colour);
      item.append(variable.name + " ");
      const value = item.appendChild(document.createElement("b"));
      value.dataset.value = variable.name;
      const factor = variable.display?.[1] ?? 1;
      return { variable, colour, factor, value, samples: Array.from(variable.samples, (v) => (Number.isFinite(v) ? v * factor : null)) };
    });
    const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
    const axis = { stroke: () => css("--muted"), font: "11px system-ui, sans-serif", grid: { stroke: () => css("--grid"), width: 1 }, ticks: { show: false } };
    const series = shownLines.map(({ variable, colour }) => ({
      label: variable.name, stroke: colour, width: 1.6, pxAlign: 0, points: { show: false },
      paths: variable.is_boolean ? uPlot.paths.stepped({ align: 1 }) : undefined,
    }));
    const plot = new uPlot({
      width: Math.max(this.parent.clientWidth, 200), height: HEIGHT, legend: { show: false }, padding: [8, 24, 0, 0],
      cursor: { drag: { setScale: false }, points: { show: false }, x: false, y: false },
      scales: { x: { time: false }, y: { range: (_, low, high) => Plots.range(low, high) } },
      axes: [
        { ...axis, size: 26, gap: 4, values: (_, ticks) => ticks.map((t, k) => (k === ticks.length - 1 ? `${t} s` : String(t))) },
        { ...axis, size: 58, gap: 6, values: (_, ticks) => ticks.map((v) => String(Number(v.toPrecision(6))).replace("-", "−")) },
      ],
      series: [{}, ...series],
    }, [this.times, ...shownLines.map((l) => l.samples)], box);
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
      this.seek(plot.posToVal(event.clientX - left, "x") / this.motion.step);
    };
    plot.over.addEventListener("pointerdown", drag);
    plot.over.addEventListener("pointermove", drag);
    figure.setAttribute("role", "img");
    figure.setAttribute("aria-label", `${variables.map((v) => v.name).join(", ")} over time, in ${unit}`);
    return { plot, now, lines: shownLines };
  }

  /** Range of an axis: a little more than the values, and never so narrow that rounding fills it. */
  static range(low, high) {
    if (low === null || high === null) return [0, 1];
    const least = 1e-9 * Math.max(Math.abs(low), Math.abs(high));
    if (high - low <= least) {
      const room = Math.abs(low) * 0.1 || 1;
      return [low - room, high + room];
    }
    const room = 0.06 * (high - low);
    return [low - room, high + room];
  }

  /** Move the cursors to a frame; the numbers in the legends too, if asked for. */
  show(index, withNumbers = true) {
    this.index = index;
    for (const { plot, now, lines } of this.plots) {
      const x = plot.valToPos(index * this.motion.step, "x");
      now.style.transform = `translateX(${x.toFixed(2)}px)`;
      for (const { samples, variable, dot, value, factor } of lines) {
        const y = variable.is_boolean ? samples[Math.floor(index)] : linear(variable.samples, index) * factor;
        const isThere = Number.isFinite(y);
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
