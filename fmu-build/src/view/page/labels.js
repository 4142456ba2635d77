// Labels of the drawing: each has several possible positions. If two labels collide, the less important one moves or
// hides.

/** Directions of a label from its point, the best first, with the anchor of its text. */
const SIDES = [[1, -1], [1, 1], [-1, -1], [-1, 1], [0, -1], [0, 1], [1, 0], [-1, 0]];
/** Distance from which on a line connects a label with its point [px]. */
const FAR = 30;
/** Height of a label [px]. */
const LINE = 15;

/** Widths of labels [px] by class and text: measuring a label again would need another layout of the page. */
const widths = new Map();

function widthOf(text) {
  const [words, kind] = [text.textContent, text.getAttribute("class")];
  const known = widths.get(kind + words);
  if (known) return known;
  const width = text.getComputedTextLength?.();
  if (width) widths.set(kind + words, width);
  return width || 7 * words.length;
}

class Labels {
  constructor(drawing) {
    Object.assign(this, { drawing, all: [], obstacles: [] });
  }

  clear() {
    this.all = [];
    this.obstacles = [];
  }

  /** A label. `anchor(poses)`: its point and its distance [px]. Labels with a smaller priority are placed first. */
  add(layer, className, words, priority, anchor, attributes = {}) {
    const text = element("text", { class: `name ${className}`, ...attributes }, layer, words);
    const leader = element("path", { class: "leader" }, layer);
    this.all.push({ text, leader, priority, anchor, layer, kept: 0 });
    this.isSorted = false;
    return text;
  }

  /** A point with a radius [px] that labels should not cover. */
  avoid(place, radius) {
    this.obstacles.push({ place, radius });
  }

  /** Place all labels without collisions. */
  show(poses) {
    if (!this.isSorted) {
      this.all.sort((a, b) => a.priority - b.priority);
      for (const label of this.all) label.width = widthOf(label.text);
      this.isSorted = true;
    }
    const { width, height } = this.drawing;
    const taken = [[-9e9, height - 34, 24 + (this.drawing.rulerWidth ?? 0), 9e9], [width - 60, -9e9, 9e9, 62], [-9e9, -9e9, 190, 46]];
    const points = this.obstacles.map(({ place, radius }) => [...place(poses), radius]);
    for (const label of this.all) {
      const on = label.layer.style.display !== "none" && this.put(label, label.anchor(poses), taken, points);
      switchTo(label.text, Boolean(on));
      switchTo(label.leader, Boolean(on?.isFar));
    }
  }

  /** Place a label at the best of its positions. Returns the position, if there is room. */
  put(label, [x, y, distance], taken, points) {
    let best;
    const last = 2 * SIDES.length;
    for (let k = 0; k < last; k++) {
      const [sx, sy] = SIDES[k % SIDES.length];
      const isFar = k >= SIDES.length;
      const reach = distance + (isFar ? FAR : 0);
      const slope = sx && sy ? 0.75 : 1;
      const [ax, ay] = [x + sx * reach * slope, y + sy * reach * slope];
      const left = sx > 0 ? ax : sx < 0 ? ax - label.width : ax - label.width / 2;
      const top = sy > 0 ? ay : sy < 0 ? ay - LINE : ay - LINE / 2;
      const box = [left, top, left + label.width, top + LINE];
      if (box[0] < 2 || box[2] > this.drawing.width - 2 || box[1] < 2 || box[3] > this.drawing.height - 2) continue;
      if (taken.some((other) => box[0] < other[2] + 3 && other[0] - 3 < box[2] && box[1] < other[3] && other[1] < box[3])) continue;
      const covered = points.filter(([px, py, r]) => px > box[0] - r && px < box[2] + r && py > box[1] - r && py < box[3] + r).length;
      // The previous position is kept as long as it is almost as good.
      const cost = covered * 3 + k * 0.25 + (isFar ? 2 : 0) - (k === label.kept ? 2 : 0);
      if (!best || cost < best.cost) best = { cost, k, box, isFar, from: [x, y], to: [ax, ay] };
    }
    if (!best) return undefined;
    label.kept = best.k;
    taken.push(best.box);
    moveTo(label.text, best.box[0], best.box[3] - 3.5);
    if (best.isFar) label.leader.setAttribute("d", line([best.from, best.to]));
    return best;
  }
}
