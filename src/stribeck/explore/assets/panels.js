// The charts (BokehJS): what a result puts into their sources, units for people, the ghost, light and dark.
"use strict";
const PREFIXES = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"], [1e-12, "p"]];

function prefix(size, unit) { // the factor to divide by, and the unit's text
  if (!/^(m|m\/s|s|N|N m|J|W|Pa|V|A|rad|rad\/s)$/.test(unit) || !(size > 0)) return [1, unit];
  if (unit.startsWith("rad") || unit === "s") {
    const found = PREFIXES.find(([factor]) => size >= factor && factor <= 1) ?? [1, ""];
    return [found[0], found[1] + unit];
  }
  const [factor, sign] = PREFIXES.find(([f]) => size >= 0.9 * f) ?? [1e-12, "p"];
  return [factor, sign + unit];
}
function human(x, unit) {
  const [factor, text] = prefix(Math.abs(x), unit);
  return `${show(x / factor, 3)} ${text}`;
}
const peak = (...lists) => {
  let most = 0;
  for (const list of lists) for (const x of list ?? []) if (Math.abs(x) > most) most = Math.abs(x);
  return most;
};

const models = new Map();
const model = (name) => {
  if (!models.has(name)) {
    for (const each of Bokeh.documents) {
      const found = each.get_model_by_name(name);
      if (found) models.set(name, found);
    }
  }
  return models.get(name);
};

async function panels() {
  for (const [id, item] of Object.entries(data.figures)) await Bokeh.embed.embed_item(item, id);
  quick();
  const dark = matchMedia("(prefers-color-scheme: dark)");
  dark.addEventListener("change", colours);
  colours();
  if (matchMedia("(pointer: coarse)").matches) {
    for (const figure of figures()) figure.toolbar.active_drag = null; // a finger scrolls the page
  }
}
const figures = () => Object.keys(data.panels).map(model);

function colours() {
  const style = getComputedStyle(document.documentElement), ink = style.getPropertyValue("--ink").trim();
  const soft = style.getPropertyValue("--soft").trim(), line = style.getPropertyValue("--line").trim();
  const paper = style.getPropertyValue("--paper").trim();
  for (const figure of figures()) {
    figure.setv({ background_fill_color: paper, border_fill_color: paper, outline_line_color: line });
    for (const axis of [...figure.below, ...figure.left]) {
      if (!("axis_label" in axis)) continue;
      axis.setv({ axis_label_text_color: ink, major_label_text_color: soft, axis_line_color: line, major_tick_line_color: line, minor_tick_line_color: null });
    }
    for (const each of [...figure.center, ...figure.above]) {
      if ("grid_line_color" in each) each.grid_line_color = line;
      if ("label_text_color" in each) each.setv({ label_text_color: ink, background_fill_color: paper });
    }
  }
}

const shown = new Map(); // what each source was last filled from
function put(source, from, rows) { // new data only where they are others: each asks for a redraw
  const last = shown.get(source), same = last?.length === from.length && from.every((each, i) => Object.is(each, last[i]));
  if (same || !model(source)) return;
  shown.set(source, from);
  model(source).data = rows();
}

// The columns of one panel, divided by the unit's factor; the unit is chosen by what is shown now. A coarse panel leaves
// out what is nearer than half a pixel to the row before; told is whether it left out anything.
function fill(name, result, ghost, coarse) {
  const panel = data.panels[name], figure = model(name), { x } = panel, curve = x === "speed";
  const pick = (from, column) => column === "speed" ? from.curve.v : column === "steady" ? from.curve.F : from.columns[column];
  const scale = (columns, unit) => prefix(peak(...columns.map((c) => pick(result, c))), unit);
  const [xf, xu] = panel.log ? [1, panel.xUnit] : panel.x === "t" ? [1, "s"] : scale([x], panel.xUnit);
  const [yf, yu] = scale(panel.y.map((s) => s.column), panel.yUnit);
  let left = false;
  const rows = (from) => {
    const found = { along: divide(pick(from, x), xf) };
    for (const series of panel.y) found[series.column] = divide(pick(from, series.column) ?? new Float64Array(found.along.length).fill(NaN), yf);
    if (curve) return cut(found, found.along.length - 1); // the last is the working point
    const kept = coarse ? thin(found, figure) : found;
    left ||= kept !== found;
    return kept;
  };
  put(`${name}-now`, [result, xf, yf, coarse], () => rows(result));
  put(`${name}-ghost`, ghost ? [ghost, xf, yf, coarse] : [], () => ghost ? rows(ghost) : { along: [], ...Object.fromEntries(panel.y.map((s) => [s.column, []])) });
  measuredPoints(name, xf, yf);
  figure.below[0].axis_label = `${panel.xLabel}${xu ? ` (${xu})` : ""}`;
  figure.left[0].axis_label = `${panel.yLabel}${yu ? ` (${yu})` : ""}`;
  const hover = model(`${name}-hover`);
  if (hover) hover.tooltips = [[panel.x === "t" ? "t" : panel.xName, `@along{0.0000} ${xu}`], ...panel.y.map((s) => [s.name, `@{${s.column}}{0.0000} ${yu}`])];
  return [yf, left];
}
const cut = (found, n) => Object.fromEntries(Object.entries(found).map(([key, list]) => [key, list.slice(0, n)]));

const FEW = 8000; // rows that are drawn as soon as they are thinned
function thin(found, figure) { // rows that lie half a pixel or more from the one kept before, in any line
  const lists = Object.values(found), n = found.along.length, kept = new Uint32Array(n);
  if (n < FEW) return found;
  const least = lists.map((list, i) => {
    const range = i ? figure.y_range : figure.x_range, size = (i ? figure.inner_height : figure.inner_width) || 500;
    let low = Infinity, high = -Infinity;
    for (const each of list) { if (each < low) low = each; if (each > high) high = each; }
    return 0.5 * Math.min(high - low, Math.abs(range.end - range.start)) / size;
  });
  const apart = (a, b, length) => !(Math.abs(a - b) <= length) && (a === a || b === b);
  let count = 0;
  for (let i = 0, last = -1; i < n; i++) {
    if (last < 0 || i === n - 1 || lists.some((list, j) => apart(list[i], list[last], least[j]))) kept[count++] = last = i;
  }
  if (count === n) return found;
  const picked = kept.subarray(0, count);
  return Object.fromEntries(Object.entries(found).map(([key, list]) => [key, Float64Array.from(picked, (i) => list[i])]));
}

function measuredPoints(name, xf, yf) { // what was measured, in the chart's present units
  const { columns } = data.measured ?? { columns: {} }, panel = data.panels[name], across = columns[panel.x];
  for (const { column } of panel.y) {
    put(`${name}-measured-${column}`, [xf, yf], () => {
      const { t, x } = columns[column], along = panel.x === "t" ? t : x.map((_, i) => across.x[i]);
      return { x: divide(along, xf), y: divide(x, yf) };
    });
  }
}

// How far the simulated columns are from the measured ones: rms, and as a share of the measured changes.
function missed(result) {
  const told = [];
  for (const [name, { t, x }] of Object.entries(data.measured.columns)) {
    if (data.measured.given.includes(name)) continue;
    const end = (result.rows - 1) * value("output.step"), unit = law().columns.find((c) => c.name === name).unit;
    const inside = t.map((_, i) => i).filter((i) => t[i] >= 0 && t[i] <= end * (1 + 1e-9));
    const mean = inside.reduce((sum, i) => sum + x[i], 0) / inside.length;
    const square = (each) => Math.sqrt(inside.reduce((sum, i) => sum + each(i) ** 2, 0) / inside.length);
    const left = square((i) => at(result, name, t[i]) - x[i]), size = square((i) => x[i] - mean);
    told.push(`${name} ${human(left, unit)} (${show(100 * left / size, 2)} %)`);
  }
  return `Misses the measured ${told.join(", ")} rms.`;
}
const divide = (list, factor) => factor === 1 ? list : Float64Array.from(list, (x) => x / factor);

// Panels in sight are drawn at once, coarsely; when the hand rests, with every row, and the others one by one.
const REST = 60; // ms
const waiting = { panels: [], timer: 0 };

function draw(result) {
  const ghost = state.ghost, names = Object.keys(data.panels);
  if (data.panels.energy) {
    energy(result);
    if (ghost && ghost.columns && model("energy-ghost")) energy(ghost, true);
  }
  const seen = Object.fromEntries(["trajectories", ...names].map((id) => [id, inSight(document.getElementById(id))]));
  const now = names.filter((name) => seen[document.getElementById(name) ? name : "trajectories"]);
  const coarse = now.filter((name) => one(name, result, ghost, true));
  clearTimeout(waiting.timer);
  waiting.panels = [...coarse, ...names.filter((name) => !now.includes(name))];
  const next = () => {
    if (waiting.panels.length) one(waiting.panels.shift(), result, ghost, false);
    if (waiting.panels.length) waiting.timer = setTimeout(next);
    else window.stribeck.idle = !flying.pending && !flying.id;
  };
  window.stribeck.idle = false;
  waiting.timer = setTimeout(next, waiting.panels.length ? REST : 0);
}
function inSight(element) {
  if (!element) return false;
  const { top, bottom } = element.getBoundingClientRect();
  return bottom > 0 && top < innerHeight;
}
function one(name, result, ghost, coarse) {
  const [factor, left] = fill(name, result, ghost, coarse), { marks } = data.panels[name];
  for (const kind of marks.length ? ["slip", "stick"] : []) {
    const found = { x: [], y: [] };
    for (const column of marks) {
      const element = column.includes(".") ? column.slice(0, column.lastIndexOf(".")) : "";
      for (const t of happened(result, element, kind)) { found.x.push(t); found.y.push(at(result, column, t) / factor); }
    }
    put(`${name}-${kind}`, found.x.length ? [result, factor] : [], () => found);
  }
  if (name !== "curve" || !result.curve) return left;
  const { v, F } = result.curve, last = v.length - 1;
  put("curve-point", [result, factor], () => ({ x: [v[last]], y: [F[last] / factor] }));
  return left;
}

function happened(result, element, kind) { // when: data.watched names what the solver's numbers mean
  return result.events.filter(([, what]) => {
    const [name, kinds] = data.watched[what >> 2];
    return name === element && kinds[what & 3] === kind;
  }).map(([t]) => t);
}

function at(result, column, t) { // between two rows
  const list = result.columns[column], step = value("output.step"), i = Math.min(Math.floor(t / step), list.length - 2);
  if (i < 0) return list[0];
  return list[i] + (t / step - i) * (list[i + 1] - list[i]);
}

function energy(result) {
  const { columns } = result;
  if (columns.E_dissipated) return;
  const stored = columns.E_stored ?? new Float64Array(columns.t.length);
  columns.E_dissipated = columns.E_in.map((x, i) => x - (stored[i] - stored[0]));
}

function keep() { // the present setting stays behind as the ghost
  state.ghost = state.latest;
  $("keep").textContent = "move the ghost here";
  if (state.latest) draw(state.latest);
}
