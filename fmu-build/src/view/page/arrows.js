// Arrows: forces on one scale, torques as arcs on another. All sizes are variables of the model.

/** Kinds of arrows: class, label, whether they are shown at first. */
const KINDS = [
  ["load", "Forces and drives", true],
  ["weight", "Weights", false],
  ["reaction", "Reactions", false],
];
/** Length of the longest arrow relative to the drawing. */
const LONGEST = 0.24;
/** Largest length of a peak in this length, and smallest distance of an arrow from the edge of the drawing [px]. */
const [MOST, EDGE] = [1.6, 8];

/** Path of an arrow from a point along a vector, with a head of this length [px]. */
function arrow([x, y], [dx, dy], head) {
  const length = Math.hypot(dx, dy);
  if (!(length > 0.5)) return "";
  const [ex, ey] = [dx / length, dy / length];
  const h = Math.min(head, 0.7 * length);
  const [tx, ty] = [x + dx, y + dy];
  const [bx, by] = [tx - h * ex, ty - h * ey];
  const w = 0.42 * h;
  return line([[x, y], [bx, by]]) + line([[bx - w * ey, by + w * ex], [tx, ty], [bx + w * ey, by - w * ex]]) + "Z";
}

/** Paths of shaft and head of an arc about the origin from the right, anticlockwise for a positive angle [px]. */
function arc(radius, angle) {
  if (!(Math.abs(angle) > 0.05)) return ["", ""];
  const [sign, size] = [Math.sign(angle), Math.min(Math.abs(angle), 5.6)];
  const end = [radius * Math.cos(size), -sign * radius * Math.sin(size)];
  const ahead = [-Math.sin(size), -sign * Math.cos(size)];
  const out = [Math.cos(size), -sign * Math.sin(size)];
  const tip = [end[0] + 7 * ahead[0], end[1] + 7 * ahead[1]];
  const wings = [-1, 1].map((s) => [end[0] + 3.4 * s * out[0], end[1] + 3.4 * s * out[1]]);
  const large = size > Math.PI ? 1 : 0;
  const shaft = `M${fixed(radius)} 0A${radius} ${radius} 0 ${large} ${sign > 0 ? 0 : 1} ${fixed(end[0])} ${fixed(end[1])}`;
  return [shaft, `${line([wings[0], tip, wings[1]])}Z`];
}

class Arrows {
  constructor(drawing, data) {
    Object.assign(this, { drawing, magnification: 1, visible: {} });
    this.forces = [];
    this.torques = [];
    this.samples = new Map((data.motion?.variables ?? []).map((variable) => [variable.name, variable.samples]));
    if (data.motion) this.collect(data.scene);
    this.kinds = KINDS.filter(([kind]) => [...this.forces, ...this.torques].some((a) => a.kind === kind));
    for (const [kind, , on] of this.kinds) this.visible[kind] = on;
    this.measure(data.motion?.count ?? 0);
  }

  /** Arrows of the mechanism. `vector` returns the force [N] in the mechanism frame for poses and a frame. */
  collect(scene) {
    const get = (name) => this.samples.get(name);
    const force = (kind, name, on, sizes, vector) => {
      if (sizes.every(Boolean)) this.forces.push({ kind, name, on, sizes, vector });
    };
    const torque = (kind, name, on, sizes) => sizes && this.torques.push({ kind, name, on, sizes });
    const plane = (kind, name, on, owner) => {
      const sizes = [get(`${owner}.force_x`), get(`${owner}.force_y`)];
      force(kind, name, on, sizes, (_, i) => sizes.map((s) => linear(s, i)));
    };
    for (const joint of scene.joints) {
      plane("reaction", joint.name, joint.second, joint.name);
      torque("reaction", joint.name, joint.second, get(`${joint.name}.torque`));
      torque("reaction", `${joint.name} friction`, joint.second, get(`${joint.name}.friction_torque`));
    }
    for (const point of scene.forces) plane("load", point.name, point, point.name);
    for (const point of scene.torques) torque("load", point.name, point, get(`${point.name}.torque`));
    const connections = [[scene.actuators, 1], [scene.springs, -1], [scene.stops.filter((s) => s.frame === null), 1]];
    for (const [list, sign] of connections) {
      for (const connection of list) this.between(scene, connection, sign, get, force, torque);
    }
    for (const stop of scene.stops.filter((s) => s.frame !== null)) {
      torque("load", stop.name, { frame: stop.frame, at: [0, 0] }, get(`${stop.name}.torque`));
    }
    const factor = get("load_factor");
    for (const { on, force: weight } of scene.weights) {
      force("weight", scene.frames[on.frame], on, [factor], (_, i) => weight.map((w) => w * linear(factor, i)));
    }
    for (const { name, middle } of scene.surfaces) {
      const drag = get(`${name}.drag`);
      force("load", name, middle, [drag], (_, i) => scene.flow.map((f) => f * linear(drag, i)));
    }
  }

  /** Forces at both ends of a drive or a spring. Positive sizes times `sign` push the ends apart. */
  between(scene, connection, sign, get, force, torque) {
    const joint = scene.joints[connection.joint];
    const size = get(`${connection.name}.force`);
    if (connection.ends && size) {
      connection.ends.forEach((end, k) => {
        force("load", connection.name, end, [size], (poses, i) => {
          const [a, b] = connection.ends.map((p) => place(poses, p));
          const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
          const along = (sign * (k ? 1 : -1) * linear(size, i)) / length;
          return [(b[0] - a[0]) * along, (b[1] - a[1]) * along];
        });
      });
    } else if (joint?.axis && size) {
      force("load", connection.name, joint.second, [size], (poses, i) =>
        direct(poses, joint.first.frame, joint.axis).map((e) => sign * e * linear(size, i)));
    } else if (joint) {
      torque("load", connection.name, joint.second, get(`${connection.name}.torque`)?.map((size) => sign * size));
    } else if (connection.bodies) {
      const sizes = get(`${connection.name}.torque`);
      connection.bodies.forEach((on, k) => {
        if (on.frame !== 0) torque("load", connection.name, on, sizes?.map((size) => sign * (k ? 1 : -1) * size));
      });
    }
  }

  /** Reference sizes of the arrows: near the largest size, without short peaks. */
  measure(count) {
    const poses = this.drawing.data.motion?.frames;
    const all = { load: [], weight: [], reaction: [], torque: [] };
    const parts = Math.min(count, 60);
    for (let k = 0; k < parts; k++) {
      const i = parts > 1 ? Math.round((k * (count - 1)) / (parts - 1)) : 0;
      const frame = this.forces.length ? poses.frame(i) : [];
      for (const { kind, vector } of this.forces) all[kind].push(Math.hypot(...vector(frame, i)));
      for (const { sizes } of this.torques) all.torque.push(Math.abs(linear(sizes, i)));
    }
    const near = (sizes) => {
      const finite = sizes.filter((s) => Number.isFinite(s) && s > 0).sort((a, b) => a - b);
      return finite[Math.floor(0.96 * (finite.length - 1))] ?? 0;
    };
    this.largest = Math.max(near([...all.load, ...all.reaction]), near(all.weight)) || 1;
    this.largestTorque = near(all.torque) || 1;
  }

  layout() {
    const { layers, width, height } = this.drawing;
    this.perNewton = (LONGEST * Math.min(width, height) * this.magnification) / this.largest;
    for (const item of [...this.forces, ...this.torques]) {
      const group = element("g", { class: `arrow ${item.kind}`, "data-arrow": item.name }, layers.arrows);
      element("title", {}, group, item.name);
      item.group = group;
      item.path = element("path", {}, group);
      if (item.vector === undefined) item.shaft = element("path", { class: "shaft" }, group);
    }
    this.key = element("g", { class: "key", transform: `translate(${fixed(width - 18)} ${fixed(height - 18)})` }, layers.frame);
    const size = roundBelow((0.9 * LONGEST * Math.min(width, height)) / this.perNewton);
    const length = size * this.perNewton;
    element("path", { d: arrow([-length, 0], [length, 0], 9) }, this.key);
    element("text", { x: fixed(-length / 2), y: -7, "text-anchor": "middle" }, this.key, withPrefix(size, "N"));
  }

  /** The part of an arrow that has room. */
  room(from, vector) {
    const { width, height } = this.drawing;
    const length = Math.hypot(...vector);
    let part = (MOST * LONGEST * Math.min(width, height) * this.magnification) / length;
    const ends = [width, height].map((size, k) => (vector[k] > 0 ? size - EDGE - from[k] : from[k] - EDGE));
    // In a zoomed drawing an arrow from outside of the view stays outside.
    if (from.every((v, k) => v > 0 && v < [width, height][k])) {
      ends.forEach((end, k) => (part = Math.min(part, Math.max(end / Math.abs(vector[k]), 2 * EDGE / length))));
    }
    return Math.min(part, 1);
  }

  show(poses, index) {
    const isOn = (item) => index !== undefined && this.visible[item.kind];
    switchTo(this.key, index !== undefined && this.forces.some(isOn));
    for (const item of this.forces) {
      switchTo(item.group, isOn(item));
      if (!item.group.isShown) continue;
      const [x, y] = item.vector(poses, index);
      const from = this.drawing.at(place(poses, item.on));
      const isThere = Number.isFinite(x) && Number.isFinite(y);
      const vector = [x * this.perNewton, -y * this.perNewton];
      const part = isThere ? this.room(from, vector) : 0;
      item.group.classList.toggle("cut", part < 1);
      item.path.setAttribute("d", isThere ? arrow(from, vector.map((v) => part * v), 10) : "");
    }
    for (const item of this.torques) {
      switchTo(item.group, isOn(item));
      if (!item.group.isShown) continue;
      const [x, y] = this.drawing.at(place(poses, item.on));
      const angle = (4.6 * this.magnification * linear(item.sizes, index)) / this.largestTorque;
      const paths = arc(this.drawing.half + 13, angle);
      [item.shaft, item.path].forEach((path, k) => path.setAttribute("d", paths[k]));
      item.group.setAttribute("transform", `translate(${fixed(x)} ${fixed(y)})`);
    }
  }
}
