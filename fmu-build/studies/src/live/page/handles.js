// Handles: points of the drawing that the user can drag, because their coordinates are numbers of the text.

/** Largest number of digits of a number that a drag writes. */
const DIGITS = 6;
const turnedBy = ([x, y], angle) => [Math.cos(angle) * x - Math.sin(angle) * y, Math.sin(angle) * x + Math.cos(angle) * y];
const minus = (a, b) => [a[0] - b[0], a[1] - b[1]];
const isPair = (value) => Array.isArray(value) && value.length === 2 && value.every((number) => typeof number === "number");

/** Handles of a definition: of its scene, and of the poses at which its stops are reached. */
function collectHandles(root, scene, travel) {
  const metre = root.units?.length === "mm" ? 1e-3 : 1;
  const radian = root.units?.angle === "deg" ? Math.PI / 180 : 1;
  const all = [];
  const planes = new Map();
  for (const body of scene.bodies) {
    const own = root.bodies?.[body.name];
    if (!own || typeof own !== "object") continue;
    const at = new Map([...body.points.map((point) => [point.name, point]), ["center", body.center]]);
    const drawn = own.drawn ?? (body.name === "ground" ? { points: own.points } : undefined);
    const pairs = drawn ? Object.entries({ ...drawn.points, origin: drawn.origin, end: drawn.end, center: drawn.center }) : Object.entries({ ...own.points, center: own.center });
    const inner = own.drawn ? ["drawn"] : [];
    const isPlane = Boolean(drawn);
    const { frame } = body.points[0];
    for (const [name, raw] of pairs) {
      const point = at.get(name);
      if (!point || !isPair(raw)) continue;
      const place = ["origin", "end", "center"].includes(name) && !(own.points && name in own.points) ? [name] : ["points", name];
      all.push({ kind: "pair", name: `${body.name}.${name}`, path: ["bodies", body.name, ...inner, ...place], point, raw, unit: metre, isPlane, body: body.name });
    }
    if (isPlane && !planes.has(frame)) planes.set(frame, -(drawn.angle ?? 0) * radian);
    const end = at.get("end");
    if (typeof own.length === "number" && end && !own.drawn) all.push({ kind: "length", name: `${body.name}.end`, path: ["bodies", body.name, "length"], point: end, raw: own.length, unit: metre, body: body.name });
  }
  for (const handle of all) handle.turn = turnOf(handle, all, scene, planes);
  return [...join(all, root), ...stopHandles(root, scene, travel, metre, radian)].filter((handle) => handle.turn !== undefined);
}

/** Angle from the axes of a handle's numbers to those of its point's frame [rad], or undefined. */
function turnOf(handle, all, scene, planes) {
  const { frame } = handle.point;
  const origin = scene.bodies.find(({ name }) => name === handle.body).points[0];
  const known = handle.isPlane
    ? all.filter((other) => other.isPlane && other.point.frame === frame).map(({ raw, point }) => [raw, point.at])
    : all.filter((other) => other.body === handle.body && !other.isPlane).map(({ raw, point }) => [isPair(raw) ? raw : [raw, 0], point.at]);
  if (!handle.isPlane) known.push([[0, 0], origin.at]);
  let [far, turn] = [0, undefined];
  for (const [a, p] of known) {
    for (const [b, q] of known) {
      const [d, e] = [minus(b, a), minus(q, p)];
      if (Math.hypot(...d) > far) [far, turn] = [Math.hypot(...d), Math.atan2(e[1], e[0]) - Math.atan2(d[1], d[0])];
    }
  }
  return turn ?? (handle.isPlane ? planes.get(frame) : undefined);
}

/** Drawn points that a joint connects share one handle. A point joined to a fixed point has no handle. */
function join(all, root) {
  const byName = new Map(all.filter(({ isPlane }) => isPlane).map((handle) => [handle.name, handle]));
  const [groups, fixed] = [new Map([...byName.values()].map((handle) => [handle, new Set([handle])])), new Set()];
  for (const { type, first, second } of Object.values(root.joints ?? {})) {
    if (type !== "revolute") continue;
    const [a, b] = [byName.get(first), byName.get(second)];
    if (a && b) {
      const both = new Set([...groups.get(a), ...groups.get(b)]);
      for (const one of both) groups.set(one, both);
    } else if (a || b) fixed.add(a ?? b);
  }
  const first = new Set();
  return all.filter((handle) => {
    const group = groups.get(handle);
    if (!group) return true;
    if (first.has(group) || [...group].some((one) => fixed.has(one))) return false;
    first.add(group);
    handle.others = [...group].filter((one) => one !== handle);
    return true;
  });
}

/** Handles of stops, at the bodies in the position of the stop. */
function stopHandles(root, scene, travel, metre, radian) {
  return (travel?.stops ?? []).flatMap((met) => {
    const stop = scene.stops[met.stop];
    const own = root.stops?.[stop.name];
    const key = ["angle", "position", "length"].find((name) => typeof own?.[name] === "number");
    if (!key) return [];
    const base = { name: stop.name, path: ["stops", stop.name, key], raw: own[key], poses: met.poses, turn: 0 };
    const joint = scene.joints[stop.joint];
    if (key === "angle") {
      // Of two bodies the second one turns with the angle, unless it is the ground.
      const pair = stop.bodies;
      const frame = stop.frame ?? (pair ? pair[1].frame || pair[0].frame : joint?.second.frame);
      const about = joint?.second ?? { frame, at: [0, 0] };
      const points = scene.bodies.flatMap((body) => body.points).filter((point) => point.frame === frame);
      const far = points.reduce((best, point) => (Math.hypot(...minus(point.at, about.at)) > Math.hypot(...minus(best.at, about.at)) ? point : best), about);
      return far === about ? [] : [{ ...base, kind: "angle", point: far, about, unit: pair?.[1].frame === 0 ? -radian : radian }];
    }
    if (key === "length" && stop.ends) return [{ ...base, kind: "along", point: stop.ends[1], unit: metre, from: stop.ends[0] }];
    return joint?.axis ? [{ ...base, kind: "along", point: joint.second, unit: metre, joint }] : [];
  });
}

/** Numbers of a handle that was dragged from one point of the mechanism frame to another point [m]. */
function moved(handle, poses, from, to, perPixel) {
  const d = minus(to, from);
  const rounded = (value, step) => Number(Number(value.toFixed(Math.min(Math.max(Math.ceil(-Math.log10(step)), 0), 15))).toPrecision(DIGITS));
  if (handle.kind === "angle") {
    const center = place(poses, handle.about);
    const [a, b] = [minus(from, center), minus(to, center)];
    const angle = Math.atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    return [rounded(handle.raw + angle / handle.unit, perPixel / Math.hypot(...a) / Math.abs(handle.unit))];
  }
  const step = perPixel / handle.unit;
  if (handle.kind === "along") {
    const axis = handle.joint ? direct(poses, handle.joint.first.frame, handle.joint.axis) : minus(place(poses, handle.point), place(poses, handle.from));
    const size = Math.hypot(...axis) || 1;
    return [rounded(handle.raw + (d[0] * axis[0] + d[1] * axis[1]) / size / handle.unit, step)];
  }
  const [x, y] = turnedBy(d, -poses[handle.point.frame][0] - handle.turn);
  if (handle.kind === "length") return [rounded(Math.max(handle.raw + x / handle.unit, step), step)];
  return [rounded(handle.raw[0] + x / handle.unit, step), rounded(handle.raw[1] + y / handle.unit, step)];
}

class Handles {
  /** `begin`, `change` and `end` a drag, with the paths of the numbers and the numbers. */
  constructor(on) {
    Object.assign(this, { on, list: [] });
    const { extents, layout } = Drawing.prototype;
    const own = this;
    // The drawing keeps its scale during a drag.
    Drawing.prototype.extents = function (...sources) {
      return own.drag?.box ?? extents.apply(this, sources);
    };
    Drawing.prototype.layout = function (...room) {
      layout.apply(this, room);
      if (this.scale !== undefined) own.layout(this);
    };
    addEventListener("pointermove", (event) => this.move(event));
    addEventListener("pointerup", (event) => this.finish(event, true));
    addEventListener("pointercancel", (event) => this.finish(event, false));
    // Before the listener of the text, which stops the propagation of its keys.
    addEventListener("keydown", (event) => event.key === "Escape" && this.drag && this.finish(this.drag, false), true);
  }

  /** The handles for the next data. None if the text gives no motion. */
  set(root, { scene, travel, wrong }) {
    const own = wrong?.scene ?? scene;
    this.list = root && own ? collectHandles(root, own, wrong ? undefined : travel) : [];
    // At the points of the text, not of the last motion.
    if (wrong) this.list.forEach((handle) => (handle.poses = wrong.poses));
  }

  layout(drawing) {
    if (drawing.data.wrong) drawWrong(drawing, drawing.data.wrong);
    this.layer?.remove();
    this.layer = element("g", { class: "layer handles" }, drawing.svg);
    for (const handle of this.list) {
      const group = element("g", { class: `handle ${handle.path[0] === "stops" ? "stop" : "point"}`, "data-handle": handle.path.join(".") }, this.layer);
      element("circle", { class: "reach", r: 13 }, group);
      element("circle", { class: "ring", r: 7 }, group);
      element("title", {}, group, `Drag: ${handle.path.join(".")} (with Shift: another number at this place)`);
      const put = (poses) => moveTo(group, ...drawing.at(place(poses, handle.point)));
      if (handle.poses) put(handle.poses);
      else drawing.moving.push(put);
      group.addEventListener("pointerdown", (event) => this.start(event, event.shiftKey ? this.below(handle, drawing) : handle, drawing));
    }
  }

  /** The next handle at the same point. */
  below(handle, drawing) {
    const at = (one) => place(one.poses ?? drawing.poses, one.point);
    const here = this.list.filter((one) => Math.hypot(...minus(at(one), at(handle))) * drawing.scale < 3);
    return here[(here.indexOf(handle) + 1) % here.length];
  }

  /** Position of a pointer in the mechanism frame [m]. */
  place({ clientX, clientY }) {
    const { drawing } = mechanism;
    const { x, y } = new DOMPoint(clientX, clientY).matrixTransform(drawing.svg.getScreenCTM().inverse());
    return [(x - drawing.origin[0]) / drawing.scale, (drawing.origin[1] - y) / drawing.scale];
  }

  start(event, handle, drawing) {
    if (event.button || this.drag) return;
    event.preventDefault();
    event.stopPropagation();
    mechanism.clock?.play(false);
    const poses = (handle.poses ?? drawing.poses).map((pose) => [...pose]);
    this.drag = { pointerId: event.pointerId, handle, poses, box: drawing.box, from: this.place(event) };
    document.documentElement.setPointerCapture(event.pointerId);
    document.documentElement.classList.add("drags");
    this.on.begin(handle);
  }

  move(event) {
    if (event.pointerId !== this.drag?.pointerId) return;
    const { handle, poses, from } = this.drag;
    const numbers = moved(handle, poses, from, this.place(event), 1 / mechanism.drawing.scale);
    if (String(numbers) === String(this.drag.numbers)) return;
    this.drag.numbers = numbers;
    this.on.change(handle, numbers);
  }

  finish({ pointerId }, isKept) {
    if (pointerId !== this.drag?.pointerId) return;
    const { handle, numbers } = this.drag;
    this.drag = undefined;
    document.documentElement.classList.remove("drags");
    this.on.end(handle, isKept ? numbers : undefined);
  }
}
