// Saving and copying: the drawing as SVG and PNG, the plots as PNG, the numbers as CSV.

/** Style properties that a drawing needs without a style sheet. */
const DRAWN = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-linecap", "stroke-linejoin", "opacity", "font-size", "font-weight", "paint-order", "text-anchor"];
/** Pixels of a PNG per pixel of the page. */
const FINE = 2;

/** A colour in a form that every program reads: browsers compute mixed colours as `color(srgb ...)`. */
function plainColour(value) {
  return value.replace(/color\(srgb ([\d.e-]+) ([\d.e-]+) ([\d.e-]+)(?: \/ ([\d.e-]+))?\)/g, (_, r, g, b, a) => {
    const [red, green, blue] = [r, g, b].map((part) => Math.round(255 * Number(part)));
    return a === undefined ? `rgb(${red}, ${green}, ${blue})` : `rgba(${red}, ${green}, ${blue}, ${a})`;
  });
}

/** The drawing as a separate document. */
function drawingAsSvg(svg) {
  const { width, height } = svg.getBoundingClientRect();
  const copy = svg.cloneNode(true);
  const [from, to] = [svg, copy].map((root) => [...root.querySelectorAll("*")]);
  from.forEach((shape, k) => {
    const style = getComputedStyle(shape);
    if (style.display === "none") return void (to[k].isHidden = true);
    for (const name of DRAWN) {
      const value = style.getPropertyValue(name);
      if (value && value !== "normal" && shape.tagName !== "g") to[k].setAttribute(name, plainColour(value));
    }
    if (shape.tagName === "g" && style.opacity !== "1") to[k].setAttribute("opacity", style.opacity);
    to[k].removeAttribute("style");
    to[k].removeAttribute("class");
  });
  for (const shape of to) if (shape.isHidden) shape.remove();
  const ground = element("rect", { width, height, fill: getComputedStyle(document.querySelector(".stage")).backgroundColor });
  copy.prepend(ground);
  for (const [name, value] of [["xmlns", SVG], ["width", width], ["height", height], ["font-family", "sans-serif"]]) copy.setAttribute(name, value);
  for (const name of ["id", "class", "role", "tabindex", "aria-labelledby", "style"]) copy.removeAttribute(name);
  return new XMLSerializer().serializeToString(copy);
}

/** A document as pixels. */
async function asCanvas(svg) {
  const [, width, height] = /width="([\d.]+)" height="([\d.]+)"/.exec(svg).map(Number);
  const image = new Image(width * FINE, height * FINE);
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(svg)}`;
  await image.decode();
  const canvas = document.createElement("canvas");
  Object.assign(canvas, { width: width * FINE, height: height * FINE });
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  return canvas;
}

/** All plots below one another as a document, each with the names of its lines. */
function plotsAsSvg({ plots, x: over, marks }) {
  const style = getComputedStyle(document.documentElement);
  const css = (name) => style.getPropertyValue(name).trim();
  const ratio = window.devicePixelRatio || 1;
  const width = Math.max(...plots.map(({ plot }) => plot.width));
  const root = element("svg", { xmlns: SVG, width, height: 0, "font-family": "sans-serif", "font-size": 11 });
  const ground = element("rect", { width, fill: css("--panel") }, root);
  let y = 8;
  for (const { plot, lines, unit } of plots) {
    const write = (words, at, attributes) => element("text", { x: fixed(at[0]), y: fixed(at[1]), fill: css("--muted"), ...attributes }, root, words);
    let at = 8;
    y += 14;
    write(unit, [at, y], { fill: css("--ink"), "font-weight": 600 });
    at += 7 * unit.length + 14;
    for (const { variable, colour } of lines) {
      const room = 6.6 * variable.name.length + 14;
      if (at + room > width) [at, y] = [8, y + 15];
      write(variable.name, [at, y], { fill: colour });
      at += room;
    }
    const [left, top, wide, high] = ["left", "top", "width", "height"].map((key) => plot.bbox[key] / ratio);
    const px = (value) => left + plot.valToPos(value, "x");
    const py = (value) => y + top + plot.valToPos(value, "y");
    plot.axes.forEach((axis, k) => axis._splits.forEach((split, i) => {
      const words = axis._values[i] ?? "";
      const ends = k ? [[left, py(split)], [left + wide, py(split)]] : [[px(split), y + top], [px(split), y + top + high]];
      element("path", { d: line(ends), stroke: css("--grid") }, root);
      write(words, k ? [left - 6, py(split) + 4] : [px(split), y + top + high + 15], { "text-anchor": k ? "end" : "middle" });
    }));
    for (const mark of marks) element("path", { d: line([[px(mark.x), y + top], [px(mark.x), y + top + high]]), stroke: css("--accent"), opacity: 0.5 }, root);
    // A separate element hides the parts outside of it.
    const inside = element("svg", { x: left, y: y + top, width: wide, height: high }, root);
    plot.series.slice(1).forEach(({ stroke, width: thick, dash }, k) => {
      const [xs, ys] = plot.data[k + 1];
      let path = "";
      xs.forEach((x, i) => (path += Number.isFinite(ys[i]) && ys[i] !== null ? `${path && ys[i - 1] !== null ? "L" : "M"}${fixed(plot.valToPos(x, "x"))} ${fixed(plot.valToPos(ys[i], "y"))}` : ""));
      element("path", { d: path, fill: "none", stroke: stroke(), "stroke-width": thick, ...(dash && { "stroke-dasharray": dash.join(" ") }) }, inside);
    });
    y += plot.height + 4;
  }
  element("text", { x: width - 24, y: y + 6, "text-anchor": "end", fill: css("--ink") }, root, `over ${over.name.toLowerCase()}${over.unit && ` [${over.unit}]`}`);
  for (const shape of [root, ground]) shape.setAttribute("height", y + 18);
  return new XMLSerializer().serializeToString(root);
}

/** Numbers as CSV: the variables of the run over time, or those of the travel over its positions. */
function asCsv(data, isTravel) {
  const quoted = (text) => `"${text.replaceAll('"', '""')}"`;
  const variables = isTravel ? data.travel.values : data.motion.variables.filter((v) => v.causality !== "parameter");
  const head = variables.map((v) => quoted(v.unit && v.unit !== "1" ? `${v.name} [${v.unit}]` : v.name));
  const count = isTravel ? data.travel.count : data.motion.count;
  const row = (k) => [...(isTravel ? [] : [k * data.motion.step]), ...variables.map((v) => v.samples[k])].map((x) => (Number.isFinite(x) ? String(Number(x.toPrecision(9))) : ""));
  const rows = Array.from({ length: count }, (_, k) => row(k).join(","));
  return [[...(isTravel ? [] : ['"time [s]"']), ...head].join(","), ...rows].join("\n") + "\n";
}

const asBlob = (canvas) => new Promise((done) => canvas.toBlob(done, "image/png"));

/** Offer a file for saving. */
function saveAs(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}
