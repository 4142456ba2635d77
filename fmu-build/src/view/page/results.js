// Key results of a run: strokes, times, largest forces with their positions, work and energy.

/** Rows of results: identity, label, value, unit, and position of a largest value as text and as a sample. */
function results(data) {
  const { motion, travel, scene } = data;
  if (!motion || !scene) return [];
  const byName = new Map(motion.variables.map((v) => [v.name, v]));
  const rows = [];
  const lead = travel && leading(travel);
  const at = (index) => {
    const time = `${shown(index * motion.step, 4)} s`;
    const variable = lead && byName.get(lead.name);
    if (!variable) return `at ${time}`;
    const unit = variable.display?.[0] ?? variable.unit;
    return `at ${time}, ${lead.name} ${shown(linear(variable.samples, index) * (variable.display?.[1] ?? 1), 4)} ${unit}`;
  };
  const add = (words, value, variable, index) => {
    const unit = variable.display?.[0] ?? variable.unit;
    rows.push({ words, value: value * (variable.display?.[1] ?? 1), unit, where: index === undefined ? "" : at(index), index });
  };
  const largest = (samples) => samples.reduce((best, x, k) => (Math.abs(x) > Math.abs(samples[best]) ? k : best), 0);
  const first = (owner, quantities) => quantities.map((quantity) => byName.get(`${owner}.${quantity}`)).find(Boolean);
  for (const { name } of scene.actuators) {
    const place = travel?.values.find((v) => v.causality === "position" && v.name.startsWith(`${name}.`));
    const isLong = travel?.goes_on.some(Boolean);
    if (place && !isLong && !travel.is_closed) {
      add(`Stroke of ${name}`, Math.max(...place.samples) - Math.min(...place.samples), place);
    }
  }
  for (const stop of scene.stops) {
    const index = reachedAt(motion, stop);
    if (index > 0) rows.push({ words: `Time to the stop ${stop.name}`, value: index * motion.step, unit: "s", where: "", index });
  }
  for (const [list, words] of [[scene.actuators, "Largest force of"], [scene.stops, "Largest force of stop"]]) {
    for (const { name } of list) {
      const force = first(name, ["acting_force", "force", "acting_torque", "torque"]);
      if (!force) continue;
      const k = largest(force.samples);
      if (force.samples[k] !== 0) add(`${words} ${name}`.replace("force", force.unit === "N.m" ? "torque" : "force"), force.samples[k], force, k);
    }
  }
  const reactions = scene.joints.map(({ name }) => byName.get(`${name}.force`)).filter(Boolean);
  const worst = reactions.map((v) => [v, largest(v.samples)]).sort(([a, i], [b, j]) => Math.abs(b.samples[j]) - Math.abs(a.samples[i]))[0];
  if (worst) add(`Largest reaction, in ${worst[0].name.split(".")[0]}`, worst[0].samples[worst[1]], worst[0], worst[1]);
  for (const { name } of scene.actuators) {
    const [force, place] = [first(name, ["acting_force", "force", "acting_torque", "torque"]), first(name, ["length", "position", "angle"])];
    if (!force || !place) continue;
    let work = 0;
    for (let k = 1; k < motion.count; k++) work += 0.5 * (force.samples[k] + force.samples[k - 1]) * (place.samples[k] - place.samples[k - 1]);
    if (Number.isFinite(work)) rows.push({ words: `Work of ${name}`, value: work, unit: "J", where: "over the run" });
  }
  const kinetic = byName.get("energy.kinetic");
  if (kinetic) {
    const k = largest(kinetic.samples);
    add("Largest kinetic energy", kinetic.samples[k], kinetic, k);
  }
  for (const v of travel?.values ?? []) {
    if (!/\.holding_(force|torque)$/.test(v.name)) continue;
    const words = `Largest ${v.name.endsWith("force") ? "holding force" : "holding torque"} of ${v.name.split(".")[0]}`;
    if (travel.dead_centres.some((mark) => mark.name.split(", ").includes(v.name.split(".")[0]))) {
      rows.push({ words, value: Infinity, unit: "", where: "unbounded at the dead centre of the drive" });
      continue;
    }
    const finite = v.samples.map((x) => (Number.isFinite(x) ? x : 0));
    const k = largest(finite);
    const place = lead ? `${lead.name} ${shown(lead.samples[k] * (lead.display?.[1] ?? 1), 4)} ${lead.display?.[0] ?? lead.unit}` : "";
    rows.push({ words, value: finite[k], unit: v.unit, where: place && `travel, at ${place}`, part: k / Math.max(travel.count - 1, 1) });
  }
  return rows;
}

/** Fill the table of key results. A click moves to the position of a value. */
function fillResults(panel, data, goTo) {
  const rows = results(data);
  const others = data.compare ? new Map(results(data.compare).map((row) => [row.words, row])) : undefined;
  panel.hidden = !rows.length;
  const table = panel.querySelector("table");
  table.replaceChildren();
  if (others) {
    const head = table.createTHead().insertRow();
    for (const words of ["", data.label, data.compare.label, ""]) head.appendChild(document.createElement("th")).textContent = words;
  }
  const body = table.createTBody();
  for (const { words, value, unit, where, index, part } of rows) {
    const row = body.insertRow();
    const name = row.appendChild(document.createElement("th"));
    Object.assign(name, { scope: "row", textContent: words });
    const number = (x) => {
      const cell = row.insertCell();
      cell.className = "number";
      cell.append(x === undefined ? "–" : shown(x, 4));
      if (x !== undefined) cell.appendChild(document.createElement("small")).textContent = unit;
    };
    number(value);
    if (others) number(others.get(words)?.value);
    const cell = row.insertCell();
    if (index === undefined && part === undefined) cell.textContent = where;
    else {
      const button = cell.appendChild(document.createElement("button"));
      Object.assign(button, { type: "button", className: "link", textContent: where || "show" });
      button.addEventListener("click", () => goTo(index, part));
    }
  }
}
