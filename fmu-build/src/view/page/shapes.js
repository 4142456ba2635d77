// Shapes of the drawing: elements, paths, hulls. One unit of the SVG is one pixel.

const SVG = "http://www.w3.org/2000/svg";

/** A new element of the drawing. */
function element(name, attributes, parent, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  parent?.append(made);
  return made;
}

const fixed = (x) => x.toFixed(2);

/** Move a text. A transform needs no new layout of its letters. */
function moveTo(text, x, y) {
  text.setAttribute("transform", `translate(${fixed(x)} ${fixed(y)})`);
}

/** Show or hide an element, if this is a change. */
function switchTo(shape, on) {
  if (shape.isShown === on) return;
  shape.isShown = on;
  shape.style.display = on ? "" : "none";
}

const line = (points) => "M" + points.map(([x, y]) => `${fixed(x)} ${fixed(y)}`).join("L");

/** Corners of the convex hull, anticlockwise. */
function hull(points) {
  const sorted = [...points].sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const turn = (o, a, b) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
  const half = (list) => {
    const out = [];
    for (const p of list) {
      while (out.length > 1 && turn(out.at(-2), out.at(-1), p) <= 0) out.pop();
      out.push(p);
    }
    return out.slice(0, -1);
  };
  return sorted.length < 3 ? sorted : [...half(sorted), ...half(sorted.reverse())];
}

/** The point at a distance from one point towards another. */
function along([x1, y1], [x2, y2], distance) {
  const part = distance / (Math.hypot(x2 - x1, y2 - y1) || 1);
  return [x1 + part * (x2 - x1), y1 + part * (y2 - y1)];
}
