// Zoom and pan of the drawing: wheel, pinch, drag, keys, buttons.

const MOST_ZOOM = 200;

class Zoom {
  /** `view` contains zoom and shift [px] relative to the fitted drawing. `changed` draws again. */
  constructor(svg, view, changed) {
    Object.assign(this, { svg, view, changed, pointers: new Map() });
    svg.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    svg.addEventListener("pointerdown", (event) => this.down(event));
    svg.addEventListener("pointermove", (event) => this.move(event));
    for (const name of ["pointerup", "pointercancel"]) svg.addEventListener(name, (event) => this.pointers.delete(event.pointerId));
    svg.addEventListener("dblclick", () => this.reset());
  }

  /** Change the zoom by a factor, and keep a point of the element fixed: by default the middle. */
  by(factor, x, y) {
    const { width, height } = this.svg.getBoundingClientRect();
    const before = this.view.zoom;
    const zoom = Math.min(Math.max(before * factor, 0.2), MOST_ZOOM);
    const [dx, dy] = [(x ?? width / 2) - width / 2, (y ?? height / 2) - height / 2];
    const ratio = zoom / before;
    Object.assign(this.view, { zoom, x: dx - (dx - this.view.x) * ratio, y: dy - (dy - this.view.y) * ratio });
    this.update();
  }

  pan(dx, dy) {
    this.view.x += dx;
    this.view.y += dy;
    this.update();
  }

  reset() {
    Object.assign(this.view, { zoom: 1, x: 0, y: 0 });
    this.update();
  }

  /** Draw once per frame. A finger scrolls the page only while the drawing fits. */
  update() {
    this.svg.classList.toggle("zoomed", this.view.zoom > 1 || this.view.x !== 0 || this.view.y !== 0);
    if (this.isWaiting) return;
    this.isWaiting = true;
    requestAnimationFrame(() => {
      this.isWaiting = false;
      this.changed();
    });
  }

  local({ clientX, clientY }) {
    const { left, top } = this.svg.getBoundingClientRect();
    return [clientX - left, clientY - top];
  }

  wheel(event) {
    event.preventDefault();
    const lines = event.deltaMode === 1 ? 16 : event.deltaMode === 2 ? 400 : 1;
    this.by(Math.exp(-Math.min(Math.max(event.deltaY * lines, -300), 300) * 0.0018), ...this.local(event));
  }

  down(event) {
    if (event.button !== 0) return;
    this.pointers.set(event.pointerId, this.local(event));
    if (event.pointerType !== "touch" || this.view.zoom > 1) this.svg.setPointerCapture(event.pointerId);
  }

  move(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = this.local(event);
    const others = [...this.pointers].filter(([id]) => id !== event.pointerId);
    this.pointers.set(event.pointerId, now);
    if (!others.length) {
      if (event.pointerType !== "touch" || this.svg.classList.contains("zoomed")) this.pan(now[0] - before[0], now[1] - before[1]);
      return;
    }
    const [, other] = others[0];
    const apart = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]) || 1;
    const middle = (point) => [(point[0] + other[0]) / 2, (point[1] + other[1]) / 2];
    const [from, to] = [middle(before), middle(now)];
    this.view.x += to[0] - from[0];
    this.view.y += to[1] - from[1];
    this.by(apart(now) / apart(before), ...to);
  }

  /** Handle a key. Returns whether the key has a function. */
  key(key) {
    const pan = { w: [0, 40], a: [40, 0], s: [0, -40], d: [-40, 0] }[key];
    if (pan) this.pan(...pan);
    else if (key === "+" || key === "=") this.by(1.25);
    else if (key === "-") this.by(0.8);
    else if (key === "0") this.reset();
    else return false;
    return true;
  }
}
