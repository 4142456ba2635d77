// Drives and springs: cylinders with their strokes, coils, motors.

class Connections {
  constructor(drawing, data) {
    Object.assign(this, { drawing, data, scene: data.scene });
  }

  /** Ends of a drive or a spring: its two points, or the points of its prismatic joint. */
  ends(connection) {
    const joint = this.scene.joints[connection.joint];
    return connection.ends ?? (joint?.axis ? [joint.first, joint.second] : undefined);
  }

  /** Drives that are drawn as cylinders, with their smallest and largest lengths [m]. */
  strokes(sources) {
    // Without stops the travel may contain impossible lengths of a cylinder. Then the lengths of the motion count.
    const isBounded = this.data.travel?.stops.length || !this.drawing.run.length;
    return this.scene.actuators.flatMap((drive) => {
      const ends = this.ends(drive);
      if (!ends) return [];
      const lengths = (isBounded ? sources : this.drawing.run).map((poses) => {
        const [a, b] = ends.map((end) => place(poses, end));
        return Math.hypot(b[0] - a[0], b[1] - a[1]);
      });
      return [{ drive, ends, least: Math.min(...lengths), most: Math.max(...lengths) }];
    });
  }

  layout() {
    const { half, scale } = this.drawing;
    Object.assign(this, { half, scale });
    for (const spring of this.scene.springs) {
      const ends = this.ends(spring);
      if (ends) this.drawSpring(spring, ends);
      else this.drawRings(spring, "spiral");
    }
    const strokes = this.strokes(this.drawing.sources);
    strokes.forEach((stroke) => this.drawCylinder(stroke));
    for (const drive of this.scene.actuators) {
      if (strokes.every((stroke) => stroke.drive !== drive)) this.drawRings(drive, "motor");
    }
  }

  drawSpring(spring, ends) {
    const group = element("g", { class: "spring" }, this.drawing.layers.springs);
    element("title", {}, group, spring.name);
    const [a, b] = ends.map((end) => this.drawing.at(place(this.drawing.run[0] ?? this.drawing.sources[0], end)));
    const coils = Math.min(Math.max(Math.round(Math.hypot(b[0] - a[0], b[1] - a[1]) / 8), 8), 32);
    let path = "M0 0L.14 0";
    for (let k = 0; k < coils; k++) path += `L${(0.14 + (0.72 * (k + 0.5)) / coils).toFixed(4)} ${k % 2 ? 1 : -1}`;
    element("path", { d: `${path}L.86 0L1 0`, "vector-effect": "non-scaling-stroke" }, group);
    this.drawing.moving.push((poses) => {
      const [[x1, y1], [x2, y2]] = ends.map((end) => this.drawing.at(place(poses, end)));
      const [dx, dy] = [x2 - x1, y2 - y1];
      const w = 6 / (Math.hypot(dx, dy) || 1);
      group.setAttribute("transform", `matrix(${[dx, dy, -dy * w, dx * w, x1, y1].map((v) => v.toFixed(3)).join(" ")})`);
    });
  }

  /** A cylinder whose rod is as long as the smallest length allows. The stroke is marked next to it. */
  drawCylinder({ drive, ends, ...lengths }) {
    const [least, most] = [lengths.least * this.scale, lengths.most * this.scale];
    const group = element("g", { class: "cylinder", "data-drive": drive.name }, this.drawing.layers.cylinders);
    element("title", {}, group, drive.name);
    const h = Math.min(Math.max(this.half * 0.95, 4.5), 8);
    const barrel = Math.max(0.86 * least, 4);
    const stroke = element("g", { class: "stroke" }, group);
    const rail = 2 * h + 5;
    element("path", { d: line([[least, rail], [most, rail]]) + line([[least, rail - 4], [least, rail + 4]]) + line([[most, rail - 4], [most, rail + 4]]) }, stroke);
    const now = element("circle", { r: 2.6, cy: rail }, stroke);
    if (most - least < 1) stroke.remove();
    const rod = element("path", { class: "rod" }, group);
    const tube = element("rect", { class: "barrel", x: 0, y: -h, height: 2 * h, rx: 2.5 }, group);
    const piston = element("rect", { class: "piston", y: -h + 1.2, width: 4, height: 2 * h - 2.4 }, group);
    element("circle", { class: "eye", r: 3.6 }, group);
    const eye = element("circle", { class: "eye", r: 3.6 }, group);
    const middle = (poses) => {
      const [[x1, y1], [x2, y2]] = ends.map((end) => this.drawing.at(place(poses, end)));
      return [(x1 + x2) / 2, (y1 + y2) / 2];
    };
    this.drawing.labels.add(this.drawing.layers.names, "small", drive.name, 2, (poses) => [...middle(poses), h + 6]);
    this.drawing.moving.push((poses) => {
      const [[x1, y1], [x2, y2]] = ends.map((end) => this.drawing.at(place(poses, end)));
      const length = Math.hypot(x2 - x1, y2 - y1);
      const angle = (Math.atan2(y2 - y1, x2 - x1) * 180) / Math.PI;
      group.setAttribute("transform", `translate(${fixed(x1)} ${fixed(y1)}) rotate(${fixed(angle)})`);
      const inside = Math.min(barrel, 0.92 * length);
      const head = Math.min(Math.max(length - 0.9 * least, 2), Math.max(inside - 4, 2));
      tube.setAttribute("width", fixed(inside));
      rod.setAttribute("d", line([[head, 0], [length, 0]]));
      piston.setAttribute("x", fixed(head - 2));
      eye.setAttribute("cx", fixed(length));
      now.setAttribute("cx", fixed(length));
      switchTo(now, length >= least - 1 && length <= most + 1);
    });
  }

  /** A drive or a spring in a revolute joint, or at each of two bodies that turn. */
  drawRings({ bodies, joint, name }, kind) {
    const at = bodies?.filter((on) => on.frame !== 0) ?? [this.scene.joints[joint].second];
    for (const on of at) this.drawRing(on, kind, name);
    const middle = (poses) => this.drawing.at(place(poses, at[at.length - 1]));
    this.drawing.labels.add(this.drawing.layers.names, "small", name, 2, (poses) => [...middle(poses), this.half + 9]);
  }

  drawRing(on, kind, name) {
    const group = element("g", { class: `ring ${kind}` }, this.drawing.layers.cylinders);
    element("title", {}, group, name);
    const r = this.half + 7;
    const path = kind === "motor" ? `M${r} 0A${r} ${r} 0 1 1 0 ${-r}` : "M3 0A4 4 0 1 1-5 0 6 6 0 1 1 7 0 8 8 0 1 1-9 0 10 10 0 0 1 11 0";
    element("path", { d: path }, group);
    this.drawing.follow(group, on);
  }
}
