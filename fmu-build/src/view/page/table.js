// The table of values: at the present time, or at the present position of the travel.

const CAUSALITIES = [["output", "Outputs"], ["input", "Inputs"], ["parameter", "Parameters"]];

class Table {
  constructor(plots) {
    Object.assign(this, { plots, kind: "output", rows: [] });
    this.table = document.getElementById("values");
    this.title = document.getElementById("values-title");
    this.filter = document.getElementById("filter");
    this.kinds = document.getElementById("kinds");
    this.filter.addEventListener("input", () => this.build());
    // While the motion plays, only visible rows are updated.
    this.sight = new IntersectionObserver((entries) => entries.forEach(({ target, isIntersecting }) => (target.isInSight = isIntersecting)));
  }

  load(data) {
    this.data = data;
    this.isTravel = Boolean(this.isTravel && data.travel);
    // Rows of unchanged variables are kept: a new layout takes longer than a run.
    if (this.key() === this.built) {
      const byName = new Map(this.list().map((variable) => [variable.name, variable]));
      for (const row of this.rows) row.variable = byName.get(row.variable.name);
      this.paint();
      return void (this.index !== undefined && this.show(this.index));
    }
    this.kinds.replaceChildren();
    for (const [kind, words] of CAUSALITIES) {
      if (!data.motion?.variables.some((v) => v.causality === kind)) continue;
      const button = this.kinds.appendChild(document.createElement("button"));
      Object.assign(button, { type: "button", textContent: words });
      button.dataset.kind = kind;
      button.addEventListener("click", () => this.switchTo(kind));
    }
    this.build();
  }

  /** Data on which the rows depend. */
  key() {
    const kinds = new Set(this.data.motion?.variables.map((v) => v.causality));
    const variables = this.list().map(({ name, unit, display, description }) => [name, unit, display, description]);
    return JSON.stringify([this.isTravel, this.kind, this.filter.value, [...kinds], variables]);
  }

  switchTo(kind) {
    this.kind = kind;
    this.build();
  }

  /** Variables of the motion, or quantities that depend on the position only. */
  list() {
    if (this.isTravel) return this.data.travel.values;
    return this.data.motion?.variables.filter((v) => v.causality === this.kind) ?? [];
  }

  build() {
    for (const button of this.kinds.children) button.setAttribute("aria-pressed", String(button.dataset.kind === this.kind));
    this.kinds.hidden = this.isTravel;
    this.built = this.key();
    this.title.textContent = this.isTravel ? "Values along the travel" : "Values";
    this.table.querySelectorAll("tbody").forEach((body) => body.remove());
    this.sight.disconnect();
    this.rows = [];
    const wanted = this.filter.value.trim().toLowerCase();
    let [owner, body] = [undefined, undefined];
    for (const variable of this.list()) {
      if (!variable.name.toLowerCase().includes(wanted)) continue;
      const [first, ...rest] = variable.name.split(".");
      if (first !== owner) {
        owner = first;
        body = this.table.appendChild(document.createElement("tbody"));
        body.className = rest.length ? "" : "single";
        if (rest.length) {
          const head = body.insertRow().appendChild(document.createElement("th"));
          Object.assign(head, { colSpan: 4, scope: "rowgroup", textContent: owner });
        }
      }
      this.rows.push(this.row(body, variable, rest.join(".") || first));
    }
    if (!this.rows.length) {
      const cell = this.table.createTBody().insertRow().insertCell();
      Object.assign(cell, { colSpan: 4, className: "hint", textContent: "No variable matches the filter." });
    }
    if (this.index !== undefined) this.show(this.index);
  }

  row(body, variable, words) {
    const row = body.insertRow();
    row.dataset.variable = variable.name;
    row.title = variable.description ?? "";
    const tick = row.insertCell();
    if (this.isTravel || this.kind !== "parameter") {
      const box = tick.appendChild(document.createElement("input"));
      Object.assign(box, { type: "checkbox", checked: this.plots.has(variable.name) });
      box.setAttribute("aria-label", `Plot ${variable.name}`);
      box.addEventListener("change", () => {
        this.plots.toggle(variable.name, box.checked);
        this.paint();
      });
    }
    row.insertCell().textContent = words;
    const cells = [row.insertCell(), row.insertCell()];
    for (const cell of cells) cell.className = "number";
    const { unit, display } = variable;
    const numbers = cells.map((cell, k) => {
      const number = cell.appendChild(document.createElement("span"));
      const name = k ? (display?.[0] ?? "") : unit === "1" ? "" : (unit ?? "");
      if (name) cell.appendChild(document.createElement("small")).textContent = name;
      return number;
    });
    this.sight.observe(row);
    return { row, variable, display, numbers };
  }

  /** Colours of the plotted lines next to their variables. */
  paint() {
    for (const { row, variable } of this.rows) {
      const colour = this.plots?.colour(variable.name);
      row.classList.toggle("plotted", Boolean(colour));
      if (colour) row.style.setProperty("--c", colour);
    }
  }

  /** Values at a frame of the motion, or at a position of the travel: of all rows, or of the visible ones. */
  show(index, isTravel = this.isTravel, all = true) {
    this.index = index;
    if (isTravel !== this.isTravel) {
      this.isTravel = isTravel;
      return this.build();
    }
    for (const { row, variable, display, numbers } of this.rows) {
      if (!all && !row.isInSight) continue;
      if (variable.is_boolean) {
        numbers[0].textContent = variable.samples[Math.floor(index)] > 0.5 ? "true" : "false";
        continue;
      }
      const value = linear(variable.samples, index);
      numbers[0].textContent = shown(value);
      if (display) numbers[1].textContent = shown(value * display[1]);
    }
    if (!this.isPainted) this.paint();
    this.isPainted = true;
  }
}
