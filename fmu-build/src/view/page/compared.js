// The run to compare: its bodies as dashed outlines over the drawing.

class Compared {
  constructor(drawing, other) {
    Object.assign(this, { drawing, other, moving: [] });
    this.source = { motion: other.motion, travel: other.travel };
    this.scratch = (other.motion ?? other.travel)?.frames.bodies.map(() => [0, 0, 0]);
  }

  layout() {
    const { drawing, other } = this;
    const { scale } = drawing;
    this.moving = [];
    for (const body of other.scene.bodies) {
      const { frame } = body.points[0];
      if (frame === 0) continue;
      const group = element("g", { class: "ghost other", "data-compared": body.name }, drawing.layers.compared);
      element("title", {}, group, `${body.name}: ${other.label}`);
      const corners = hull(body.points.map(({ at: [x, y] }) => [scale * x, -scale * y]));
      if (corners.length === 1) element("circle", { cx: fixed(corners[0][0]), cy: fixed(corners[0][1]), r: 1.9 * drawing.half }, group);
      else element("path", { d: line(corners) + (corners.length > 2 ? "Z" : "") }, group);
      this.moving.push([group, { frame, at: [0, 0] }]);
    }
  }

  /** Show the run at a time [s], or at a part of its travel from 0 to 1. */
  show(mode, at) {
    const source = this.source[mode];
    switchTo(this.drawing.layers.compared, Boolean(source));
    if (!source) return;
    const index = mode === "motion" ? at / source.step : at * (source.count - 1);
    const poses = source.frames.at(Math.min(index, source.count - 1), this.scratch);
    for (const [group, point] of this.moving) {
      const [x, y] = this.drawing.at(place(poses, point));
      group.setAttribute("transform", `translate(${fixed(x)} ${fixed(y)}) rotate(${fixed((-poses[point.frame][0] * 180) / Math.PI)})`);
    }
  }
}
