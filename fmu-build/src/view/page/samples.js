// Samples: series of numbers in the page, and interpolation between them.

/** Values of a series. NaN stands for a missing value. */
function readSeries(series, count) {
  const out = new Float64Array(count);
  if (series === null || typeof series === "number") return out.fill(series ?? NaN);
  if (series.v) return out.map((_, k) => series.v[k] ?? NaN);
  let last = 0;
  let before = 0;
  series.d.forEach((d, k) => {
    if (d === null) return void (out[k] = NaN);
    const whole = d + 2 * last - before;
    [before, last] = [last, whole];
    out[k] = whole * series.s;
  });
  return out;
}

/** Decode the samples of a variable when they are first read. */
function readLater(variable, count) {
  const set = (value) => Object.defineProperty(variable, "samples", { value });
  Object.defineProperty(variable, "samples", { configurable: true, get: () => set(readSeries(variable.values, count)).samples });
}

/** Value between samples by a cubic with the slopes of the neighbours: for poses, which are smooth. */
function cubic(samples, index) {
  const last = samples.length - 1;
  const i = Math.min(Math.max(Math.floor(index), 0), Math.max(last - 1, 0));
  const u = Math.min(Math.max(index - i, 0), 1);
  const b = samples[i];
  const c = samples[Math.min(i + 1, last)];
  if (u === 0) return b;
  if (u === 1) return c;
  const a = i > 0 ? samples[i - 1] : 2 * b - c;
  const d = i + 2 <= last ? samples[i + 2] : 2 * c - b;
  const [p, q] = [0.5 * (c - a), 0.5 * (d - b)];
  return b + u * (p + u * (3 * (c - b) - 2 * p - q + u * (2 * (b - c) + p + q)));
}

/** Value between samples by linear interpolation: for variables, which may jump. */
function linear(samples, index) {
  const i = Math.min(Math.max(Math.floor(index), 0), samples.length - 1);
  const u = index - i;
  return u > 0 && i + 1 < samples.length ? samples[i] + u * (samples[i + 1] - samples[i]) : samples[i];
}

/** Poses of all bodies in frames, and between frames. */
class Poses {
  constructor(list, count) {
    this.count = count;
    this.bodies = list.map((pose) => pose.map((series) => readSeries(series, count)));
  }

  /** Angle, x and y of each body, into `out`. */
  at(index, out) {
    this.bodies.forEach((pose, body) => {
      for (let k = 0; k < 3; k++) out[body][k] = cubic(pose[k], index);
    });
    return out;
  }

  frame(index) {
    return this.at(index, this.bodies.map(() => [0, 0, 0]));
  }
}

/** A point of a body in the mechanism frame [m]. */
function place(poses, { frame, at: [x, y] }) {
  const [angle, x0, y0] = poses[frame];
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  return [x0 + c * x - s * y, y0 + s * x + c * y];
}

/** A direction of a body's frame in the mechanism frame. */
function direct(poses, frame, [x, y]) {
  const [c, s] = [Math.cos(poses[frame][0]), Math.sin(poses[frame][0])];
  return [c * x - s * y, s * x + c * y];
}

/** Narrow spaces between groups of three digits of a number with five digits or more before its point. */
function grouped(text) {
  const [, sign, whole, rest] = /^([^\d]*)(\d*)(.*)$/.exec(text);
  return sign + (whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, "\u202f") : whole) + rest;
}

/** A readable number with this number of digits. */
function shown(value, digits = 5) {
  if (!Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  if (size === 0) return "0";
  let text = size >= 1e-3 && size < 1e7 ? value.toPrecision(digits) : value.toExponential(digits - 1);
  if (text.includes("e") && size >= 1 && size < 1e7) text = String(Number(text));
  return grouped(text.replace("-", "−").replace("e-", "e−").replace("e+", "e"));
}

/** A message whose numbers have at most six digits, unless two of them would become equal. */
function brief(text) {
  const pattern = /\d+(\.\d+)?(e[-+]?\d+)?/g;
  const rounded = (number) => (number.replace(/\D/g, "").length > 6 && number.includes(".") ? String(Number(Number(number).toPrecision(6))) : number);
  const numbers = [...new Set(text.match(pattern))];
  return new Set(numbers.map(rounded)).size < numbers.length ? text : text.replace(pattern, rounded);
}

/** A number on an axis whose largest number has this size. */
function onAxis(value, size = Math.abs(value)) {
  const [factor, prefix] = size >= 1e12 || (size > 0 && size < 1e-4) ? [undefined] : size >= 1e9 ? [1e-9, " G"] : size >= 1e6 ? [1e-6, " M"] : [1, ""];
  const text = factor ? String(Number((value * factor).toPrecision(6))) : value.toExponential(3).replace(/\.?0+e/, "e").replace("e+", "e");
  return grouped(text.replaceAll("-", "−")) + (value === 0 ? "" : prefix ?? "");
}

/** A length in the unit of the file. */
function length(value, { length: [unit, factor] }, digits = 4) {
  return `${shown(value * factor, digits)} ${unit}`;
}

/** The largest number of 1, 2 or 5 times a power of ten that is not larger. */
function roundBelow(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return ([5, 2].find((step) => step * power <= value) ?? 1) * power;
}

/** A number with this unit and a suitable prefix. */
function withPrefix(value, unit) {
  const size = Math.abs(value);
  const [factor, prefix] = size >= 1e6 ? [1e-6, "M"] : size >= 1e3 ? [1e-3, "k"] : size >= 1 || size === 0 ? [1, ""] : [1e3, "m"];
  return `${Number((value * factor).toPrecision(4))} ${prefix}${unit}`.replace("-", "−");
}
