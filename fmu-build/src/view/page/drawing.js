// The drawing: bodies, joints, ground, stops, paths, gaps, in any poses.

const COLOURS = ["#3f7fc1", "#d98324", "#3a9d6b", "#8c62c0", "#c9506f", "#2598a3", "#94812f", "#6d7f95"];

class Drawing {
  /** `sources`: poses for which the drawing must have room; `run`: those of the motion; `view`: zoom and shift [px]. */
  constructor(svg, data, sources, run, view = { zoom: 1, x: 0, y: 0 }) {
    Object.assign(this, { svg, data, scene: data.scene, sources, run, view, moving: [] });
    this.layers = {};
    svg.querySelectorAll(":scope > g").forEach((layer) => layer.remove());
    for (const name of ["ground", "ghosts", "paths", "compared", "bodies", "surfaces", "springs", "cylinders", "blocks", "joints", "masses", "locks", "arrows", "gaps", "names", "frame"]) {
      this.layers[name] = element("g", { class: `layer ${name}` }, svg);
    }
    this.labels = new Labels(this);
    this.arrows = new Arrows(this, data);
    this.connections = new Connections(this, data);
    // A travel far beyond the motion does not determine the scale of the drawing.
    const isLong = data.motion && data.travel?.goes_on.some(Boolean);
    this.rooms = { motion: isLong ? run : sources, travel: sources };
    this.boxes = { motion: this.extents(this.rooms.motion), travel: this.extents(sources) };
    [this.box, this.sources] = [this.boxes.motion, this.rooms.motion];
  }

  /** Make room for the motion, or for the whole travel. */
  makeRoom(mode) {
    const box = this.boxes[mode] ?? this.boxes.travel;
    if (box.every((value, k) => value === this.box[k])) return;
    [this.box, this.sources] = [box, this.rooms[mode] ?? this.rooms.travel];
    this.layout();
  }

  /** Smallest and largest coordinates of all moving parts [m]. */
  extents(sources) {
    const { bodies, joints, actuators, springs } = this.scene;
    const used = bodies.flatMap((body) => (body.points[0].frame === 0 ? [] : [...body.points, body.center]));
    const ends = [...actuators, ...springs].flatMap((connection) => connection.ends ?? []);
    const outlines = (this.scene.outlines ?? []).flatMap(({ frame, points }) => points.map((at) => ({ frame, at })));
    const points = [...used, ...ends, ...outlines, ...joints.flatMap((joint) => [joint.first, joint.second])];
    const box = [Infinity, Infinity, -Infinity, -Infinity];
    const drives = this.connections.strokes(sources);
    for (const poses of sources) {
      const strokes = drives.map(({ ends, most }) => along(...ends.map((end) => place(poses, end)), most));
      for (const [x, y] of [...points.map((point) => place(poses, point)), ...strokes]) {
        box[0] = Math.min(box[0], x);
        box[1] = Math.min(box[1], y);
        box[2] = Math.max(box[2], x);
        box[3] = Math.max(box[3], y);
      }
    }
    return box[0] > box[2] ? [0, 0, 1, 1] : box;
  }

  /** A point of the mechanism frame in pixels. */
  at([x, y]) {
    return [this.origin[0] + this.scale * x, this.origin[1] - this.scale * y];
  }

  /** Fit the drawing into its element and draw everything again. */
  layout({ width, height } = this.svg.getBoundingClientRect()) {
    if (width < 10 || height < 10) return;
    Object.assign(this, { width, height });
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    const [left, bottom, right, top] = this.box;
    const margin = Math.min(70, 0.11 * Math.min(width, height) + 12);
    const size = this.scene.size * 0.1;
    const [wide, high] = [Math.max(right - left, size), Math.max(top - bottom, size)];
    const { zoom, x, y } = this.view;
    this.scale = zoom * Math.min((width - 2 * margin) / wide, (height - 2 * margin) / high);
    this.origin = [width / 2 + x - (this.scale * (left + right)) / 2, height / 2 + y + (this.scale * (bottom + top)) / 2];
    this.half = Math.min(Math.max(0.022 * this.scene.size * this.scale, 3.5), 9 * Math.max(1, Math.sqrt(zoom)));
    for (const layer of Object.values(this.layers)) layer.replaceChildren();
    this.moving = [];
    this.labels.clear();
    this.drawGround();
    this.drawBodies();
    this.connections.layout();
    this.compared?.layout();
    this.drawJoints();
    this.drawStops();
    this.drawPaths();
    this.drawGaps();
    this.drawFrame();
    this.arrows.layout();
  }

  /** Move everything to these poses. `index` is the frame of the variables, if there is one. */
  show(poses, index) {
    this.poses = poses;
    if (this.scale === undefined) return;
    for (const move of this.moving) move(poses, index);
    this.arrows.show(poses, index);
    this.labels.show(poses);
  }

  /** A group that follows a point and a direction, an angle in the frame of a body [rad]. */
  follow(group, point, angle = 0, turns = true) {
    this.moving.push((poses) => {
      const [x, y] = this.at(place(poses, point));
      const turned = turns ? ` rotate(${fixed(((-poses[point.frame][0] - angle) * 180) / Math.PI)})` : "";
      group.setAttribute("transform", `translate(${fixed(x)} ${fixed(y)})${turned}`);
    });
    return group;
  }

  colour(frame) {
    return `--c:${COLOURS[(frame - 1) % COLOURS.length]}`;
  }

  /** Corners of a body in pixels of its frame. */
  outline(body) {
    const unique = new Map(body.points.map(({ at }) => [at.map((v) => v.toPrecision(9)).join(), at]));
    return hull([...unique.values()]).map(([x, y]) => [this.scale * x, -this.scale * y]);
  }

  isSlider(body) {
    const { frame } = body.points[0];
    return body.points.length === 1 && this.scene.joints.some((j) => j.axis && (j.second.frame === frame || j.first.frame === frame));
  }

  drawBodies() {
    for (const body of this.scene.bodies) {
      const { frame } = body.points[0];
      if (frame === 0) continue;
      const group = element("g", { class: "body", style: this.colour(frame), "data-body": body.name }, this.layers.bodies);
      element("title", {}, group, `${body.name}: ${shown(body.mass)} kg`);
      this.follow(group, { frame, at: [0, 0] });
      const corners = this.outline(body);
      // A line leads to a centre of mass outside of the points. The body covers the rest of the line.
      const [u, v] = corners.reduce(([x, y], p) => [x + p[0] / corners.length, y + p[1] / corners.length], [0, 0]);
      const [x, y] = body.center.at;
      if (body.mass > 0) element("path", { class: "arm", d: line([[u, v], [this.scale * x, -this.scale * y]]) }, group);
      const isDisc = corners.length === 1;
      if (isDisc && !this.isSlider(body)) {
        const [x, y] = corners[0];
        element("circle", { class: "shape disc", cx: x, cy: y, r: 1.9 * this.half }, group);
      } else if (!isDisc) {
        const path = line(corners) + (corners.length > 2 ? "Z" : "");
        element("path", { class: "edge", d: path, "stroke-width": fixed(2 * this.half + 2.4) }, group);
        element("path", { class: "shape", d: path, "stroke-width": fixed(2 * this.half) }, group);
      }
      this.nameBody(body, corners);
      if (body.mass > 0) {
        const mass = element("g", { class: "mass", style: this.colour(frame) }, this.layers.masses);
        element("circle", { r: 5.5 }, mass);
        element("path", { d: "M0 0V-5.5A5.5 5.5 0 0 1 5.5 0ZM0 0V5.5A5.5 5.5 0 0 1 -5.5 0Z" }, mass);
        this.follow(mass, body.center, 0, false);
      }
    }
    for (const { name, frame, points, is_closed } of this.scene.outlines ?? []) {
      const group = element("g", { class: "outline", style: frame === 0 ? "--c:var(--muted)" : this.colour(frame) }, this.layers.bodies);
      element("title", {}, group, name);
      const path = line(points.map(([x, y]) => [this.scale * x, -this.scale * y])) + (is_closed ? "Z" : "");
      element("path", { d: path }, group);
      this.follow(group, { frame, at: [0, 0] });
    }
    for (const surface of this.scene.surfaces.filter((s) => s.half)) {
      const group = element("g", { class: "surface" }, this.layers.surfaces);
      element("title", {}, group, surface.name);
      const [x, y] = surface.half.map((v) => v * this.scale);
      element("path", { d: line([[-x, y], [x, -y]]) }, group);
      this.follow(group, surface.middle);
    }
  }

  nameBody(body, corners) {
    const { frame } = body.points[0];
    const middle = corners.reduce(([x, y], p) => [x + p[0] / corners.length, y + p[1] / corners.length], [0, 0]);
    const point = { frame, at: [middle[0] / this.scale, -middle[1] / this.scale] };
    const distance = corners.length === 1 ? 2 * this.half + 6 : this.half + 4;
    this.labels.add(this.layers.names, "of-body", body.name, 1, (poses) => [...this.at(place(poses, point)), distance], { style: this.colour(frame) });
  }

  drawGround() {
    const pivots = this.scene.joints.filter((j) => !j.axis).flatMap((j) => [j.first, j.second].filter((p) => p.frame === 0));
    const ends = [...this.scene.actuators, ...this.scene.springs].flatMap((c) => (c.ends ?? []).filter((p) => p.frame === 0));
    const seen = new Set();
    for (const { at } of [...pivots, ...ends]) {
      if (seen.has(String(at))) continue;
      seen.add(String(at));
      const [x, y] = this.at(at);
      const group = element("g", { class: "support", transform: `translate(${fixed(x)} ${fixed(y)})` }, this.layers.ground);
      element("path", { class: "bracket", d: "M0 0-11 18H11Z" }, group);
      this.hatch(group, [-18, 18], [18, 18]);
    }
    for (const joint of this.scene.joints.filter((j) => j.axis)) this.drawRail(joint);
  }

  /** A line with hatching on its right-hand side, seen from the first end to the second with y downward. */
  hatch(group, [x1, y1], [x2, y2], side = 1) {
    element("path", { class: "surface-line", d: line([[x1, y1], [x2, y2]]) }, group);
    const length = Math.hypot(x2 - x1, y2 - y1);
    const [ex, ey] = [(x2 - x1) / length, (y2 - y1) / length];
    const count = Math.max(Math.round(length / 6), 1);
    let path = "";
    for (let k = 0; k <= count; k++) {
      const s = (length * k) / count;
      const [x, y] = [x1 + ex * s, y1 + ey * s];
      path += line([[x, y], [x - 5 * ex - side * 7 * ey, y - 5 * ey + side * 7 * ex]]);
    }
    element("path", { class: "hatch", d: path }, group);
  }

  /** The axis of a prismatic joint over the range of the joint, hatched on the ground. */
  drawRail(joint) {
    let [least, most] = [Infinity, -Infinity];
    for (const poses of this.sources) {
      const s = this.position(poses, joint);
      [least, most] = [Math.min(least, s), Math.max(most, s)];
    }
    const on = joint.first.frame;
    const group = element("g", { class: on === 0 ? "rail" : "rail moving" }, on === 0 ? this.layers.ground : this.layers.bodies);
    const angle = Math.atan2(joint.axis[1], joint.axis[0]);
    this.follow(group, joint.first, angle);
    const [from, to] = [least * this.scale - 26, most * this.scale + 26];
    if (on === 0) {
      this.hatch(group, [from, 11], [to, 11]);
      element("path", { class: "axis", d: line([[from, 0], [to, 0]]) }, group);
    } else {
      element("path", { class: "slot", d: line([[from + 14, 0], [to - 14, 0]]) }, group);
    }
  }

  /** Position of a prismatic joint [m]. */
  position(poses, joint) {
    const [a, b] = [place(poses, joint.first), place(poses, joint.second)];
    const [x, y] = direct(poses, joint.first.frame, joint.axis);
    return (b[0] - a[0]) * x + (b[1] - a[1]) * y;
  }

  drawJoints() {
    for (const joint of this.scene.joints) {
      const group = element("g", { class: "joint", "data-joint": joint.name }, this.layers.joints);
      element("title", {}, group, joint.name);
      if (joint.axis) {
        const block = element("g", { class: "block", style: this.colour(joint.second.frame || joint.first.frame) }, this.layers.blocks);
        element("rect", { x: -17, y: -10.5, width: 34, height: 21, rx: 3.5 }, block);
        const angle = Math.atan2(joint.axis[1], joint.axis[0]);
        this.moving.push((poses) => {
          const [x, y] = this.at(place(poses, joint.second));
          const turned = ((-poses[joint.first.frame][0] - angle) * 180) / Math.PI;
          block.setAttribute("transform", `translate(${fixed(x)} ${fixed(y)}) rotate(${fixed(turned)})`);
        });
        element("circle", { r: 2.2, class: "dot" }, group);
        this.follow(group, joint.second, 0, false);
      } else {
        element("circle", { r: fixed(Math.max(this.half * 0.62, 3.4)), class: "pin" }, group);
        this.follow(group, joint.first, 0, false);
      }
      const at = (poses) => this.at(place(poses, joint.second));
      this.labels.add(this.layers.names, "small", joint.name, 4, (poses) => [...at(poses), 7 + this.half * 0.5]);
      this.labels.avoid(at, joint.axis ? 12 : 6);
    }
  }

  /** The bodies at each reached stop as dashed outlines, and a padlock at the place of a lock. */
  drawStops() {
    for (const met of this.data.travel?.stops ?? []) {
      const stop = this.scene.stops[met.stop];
      const ends = stop.bodies ?? stop.ends?.filter((on) => on.frame).slice(-1);
      const frames = ends?.map((on) => on.frame) ?? [stop.frame ?? this.scene.joints[stop.joint]?.second.frame];
      const group = element("g", { class: stop.rigid ? "ghost" : "ghost bumper", "data-stop": stop.name }, this.layers.ghosts);
      let [far, label] = [-1, [0, 0]];
      for (const body of this.scene.bodies.filter((b) => b.points[0].frame && frames.includes(b.points[0].frame))) {
        const corners = body.points.map((point) => this.at(place(met.poses, point)));
        const outer = hull(corners);
        if (outer.length === 1) element("circle", { cx: outer[0][0], cy: outer[0][1], r: 1.9 * this.half }, group);
        if (outer.length > 1) element("path", { d: line(outer) + (outer.length > 2 ? "Z" : "") }, group);
        for (const [x, y] of corners) {
          const [x0, y0] = this.at(place(met.poses, { frame: body.points[0].frame, at: [0, 0] }));
          const distance = Math.hypot(x - x0, y - y0);
          if (distance > far) [far, label] = [distance, [x, y]];
        }
      }
      const text = this.labels.add(this.layers.ghosts, "small stop", stop.name, 0, () => [...label, 14]);
      const flag = this.data.motion?.variables.find((v) => v.name === stop.flag);
      const lock = this.scene.locks.find((l) => l.stop === met.stop);
      const padlock = lock && this.drawPadlock(lock, met);
      const engaged = lock && this.data.motion?.variables.find((v) => v.name === `${lock.name}.engage`);
      this.moving.push((_, index) => {
        const isThere = index !== undefined && flag && linear(flag.samples, Math.round(index)) > 0.5;
        text.classList.toggle("reached", Boolean(isThere));
        const isEngaged = index !== undefined && engaged && linear(engaged.samples, Math.round(index)) > 0.5;
        padlock?.classList.toggle("engaged", Boolean(isEngaged));
        // An engaged lock with a release force need not hold.
        padlock?.classList.toggle("holds", Boolean(isEngaged && isThere));
      });
    }
  }

  /** A padlock next to the position where a lock holds. */
  drawPadlock(lock, met) {
    const [x, y] = this.at(place(met.poses, lock));
    const at = `translate(${fixed(x - 2.2 * this.half - 6)} ${fixed(y - 2.2 * this.half - 4)})`;
    const group = element("g", { class: "padlock", transform: at }, this.layers.locks);
    element("title", {}, group, lock.name);
    element("rect", { x: -6, y: -2, width: 12, height: 9, rx: 1.8 }, group);
    element("path", { d: "M-3.600-2V-5A3.600 3.600 0 0 1 3.600-5V-2" }, group);
    return group;
  }

  drawPaths() {
    const sources = [["travel", this.data.travel], ["motion", this.data.motion]];
    this.scene.markers.forEach((marker, k) => {
      for (const [kind, source] of sources) {
        if (!source) continue;
        const points = [];
        for (let i = 0; i < source.count; i++) points.push(this.at(place(source.frames.frame(i), marker)));
        element("path", { class: `path ${kind}`, d: line(points) }, this.layers.paths);
      }
      const group = element("g", { class: "marker", "data-marker": marker.name }, this.layers.paths);
      element("title", {}, group, marker.name);
      element("path", { d: "M0-5 5 0 0 5-5 0Z" }, group);
      this.follow(group, marker, 0, false);
    });
  }

  /** Open joints, with the length of the gap. */
  drawGaps() {
    for (const gap of this.data.still?.gaps ?? []) {
      const [a, b] = [this.at(gap.first), this.at(gap.second)];
      const group = element("g", { class: "gap", "data-gap": gap.joint }, this.layers.gaps);
      element("path", { d: line([a, b]) }, group);
      for (const [x, y] of [a, b]) element("circle", { cx: fixed(x), cy: fixed(y), r: 7 }, group);
      const words = `${gap.joint}: ends ${length(gap.gap, this.data)} apart`;
      const text = element("text", { "text-anchor": "middle", y: fixed(Math.max(a[1], b[1]) + 28) }, group, words);
      const room = 4 * words.length + 10;
      text.setAttribute("x", fixed(Math.min(Math.max((a[0] + b[0]) / 2, room), Math.max(this.width - room, room))));
    }
  }

  /** Scale of lengths, direction of gravity. */
  drawFrame() {
    const size = roundBelow((0.24 * this.width) / this.scale);
    const group = element("g", { class: "ruler", transform: `translate(18 ${fixed(this.height - 18)})` }, this.layers.frame);
    this.rulerWidth = size * this.scale;
    element("path", { d: `M0-5V0H${fixed(size * this.scale)}V-5` }, group);
    const [unit, factor] = this.data.length;
    const words = unit === "m" ? withPrefix(size, unit) : `${grouped(String(Number((size * factor).toPrecision(4))))} ${unit}`;
    element("text", { x: fixed(Math.max((size * this.scale) / 2, 3.2 * words.length)), y: -5, "text-anchor": "middle" }, group, words);
    const [weight] = this.scene.weights;
    if (!weight) return;
    const force = Math.hypot(...weight.force);
    if (!(force > 0)) return;
    const [x, y] = weight.force.map((v) => (26 * v) / force);
    const compass = element("g", { class: "gravity", transform: `translate(${fixed(this.width - 34)} ${fixed(38)})` }, this.layers.frame);
    element("title", {}, compass, "Direction of gravity");
    element("path", { class: "shaft", d: arrow([-x / 2, y / 2], [x, -y], 6) }, compass);
    element("text", { x: fixed((-14 * y) / 26), y: fixed((-14 * x) / 26 + 4), "text-anchor": "middle" }, compass, "g");
  }
}
