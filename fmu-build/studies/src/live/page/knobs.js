// Sliders of inputs and parameters. Their values are not written into the text.

/** Number of sliders of each kind that are shown at first. */
const FIRST = 5;
/** Range of a quantity whose value is 0, by its unit. */
const RANGES = { N: 1e4, "N.m": 1e3, rad: Math.PI, m: 0.1, "m/s": 1, "rad/s": 1, 1: 1 };

class Knobs {
  /** `turned` is called after each change. */
  constructor(parent, turned) {
    Object.assign(this, { parent, turned, values: new Map(), rows: new Map(), all: [] });
    this.list = parent.querySelector(".rows");
    this.choice = byId("live-knob-choice");
    this.choice.addEventListener("change", () => {
      const knob = this.all.find(({ name }) => name === this.choice.value);
      const name = this.choice.value;
      byId("live-knobs-problem").textContent = knob || !name ? "" : `${name}: no input and no parameter has this name`;
      if (!knob) return;
      this.choice.value = "";
      this.add(knob).querySelector("input").focus();
    });
    byId("live-knobs-reset").addEventListener("click", () => {
      this.values.clear();
      this.rows.forEach((row) => row.reset());
      this.turned();
    });
  }

  /** The present variables of the model. Sliders of other variables are removed. */
  update(all) {
    if (!all.length) return;
    const isNew = JSON.stringify(all) !== this.known;
    if (!isNew) return;
    this.known = JSON.stringify(all);
    this.all = all;
    const names = new Set(all.map(({ name }) => name));
    for (const name of this.rows.keys()) if (!names.has(name)) this.remove(name);
    for (const knob of all) this.rows.get(knob.name)?.update(knob);
    if (!this.isFilled) {
      const numbers = all.filter(({ start }) => typeof start === "number");
      const named = numbers.filter(({ name, is_input }) => !is_input && !name.includes("."));
      [...all.filter((knob) => knob.is_input).slice(0, FIRST), ...named.slice(0, FIRST)].forEach((knob) => this.add(knob));
      this.isFilled = true;
    }
    byId("live-knob-names").replaceChildren(...all.map(({ name }) => Object.assign(document.createElement("option"), { value: name })));
    this.parent.hidden = false;
  }

  remove(name) {
    this.rows.get(name)?.remove();
    this.rows.delete(name);
    this.values.delete(name);
  }

  set(name, value, start) {
    if (value === start) this.values.delete(name);
    else this.values.set(name, value);
    byId("live-knobs-reset").disabled = !this.values.size;
    this.turned();
  }

  add(knob) {
    const there = this.rows.get(knob.name);
    if (there) return there;
    const row = this.list.appendChild(document.createElement("div"));
    row.className = "knob";
    row.dataset.knob = knob.name;
    this.rows.set(knob.name, row);
    const label = row.appendChild(document.createElement("label"));
    const name = label.appendChild(document.createElement("span"));
    name.textContent = knob.name;
    if (typeof knob.start === "boolean") this.fillSwitch(row, label, knob);
    else this.fillSlider(row, label, knob);
    return row;
  }

  fillSwitch(row, label, first) {
    const box = label.appendChild(document.createElement("input"));
    box.type = "checkbox";
    let knob = first;
    box.addEventListener("change", () => this.set(knob.name, box.checked, knob.start));
    row.reset = () => (box.checked = knob.start);
    row.update = (now) => {
      knob = now;
      row.title = knob.description;
      if (!this.values.has(knob.name)) row.reset();
    };
    row.update(first);
  }

  fillSlider(row, label, first) {
    const slider = label.appendChild(document.createElement("input"));
    slider.type = "range";
    const number = row.appendChild(document.createElement("input"));
    Object.assign(number, { type: "number", step: "any" });
    number.setAttribute("aria-label", `Value of ${first.name}`);
    const unit = row.appendChild(document.createElement("small"));
    let [knob, factor] = [first, 1];
    const show = (value) => {
      slider.value = value * factor;
      number.value = Number((value * factor).toPrecision(6));
      slider.setAttribute("aria-valuetext", `${number.value} ${unit.textContent}`);
    };
    const turn = (input) => {
      const value = Number(input.value) / factor;
      if (input.value === "" || !Number.isFinite(value)) return;
      if (input === number) widen(value);
      show(value);
      this.set(knob.name, value, knob.start);
    };
    const widen = (value) => {
      slider.min = Math.min(Number(slider.min), value * factor);
      slider.max = Math.max(Number(slider.max), value * factor);
    };
    slider.addEventListener("input", () => turn(slider));
    number.addEventListener("change", () => turn(number));
    row.reset = () => show(knob.start);
    row.update = (now) => {
      knob = now;
      row.title = knob.description;
      factor = knob.display?.[1] ?? 1;
      unit.textContent = (knob.display?.[0] ?? knob.unit ?? "").replace(/^1$/, "");
      const room = Math.abs(knob.start) || (RANGES[knob.unit] ?? 1);
      const [low, high] = knob.bounds;
      const [least, most] = [Math.max(knob.start - room, low ?? -Infinity), Math.min(knob.start + room, high ?? Infinity)];
      const step = 10 ** Math.floor(Math.log10(((most - least) * factor) / 400));
      Object.assign(slider, { min: least * factor, max: most * factor, step: step > 0 ? step : "any" });
      const value = this.values.get(knob.name) ?? knob.start;
      widen(value);
      show(value);
    };
    row.update(first);
  }
}
