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
  if (!models.has(name)) models.set(name, Bokeh.documents.map((each) => each.get_model_by_name(name)).find((found) => found));
  return models.get(name);
};

async function panels() {
  for (const [id, item] of Object.entries(data.figures)) await Bokeh.embed.embed_item(item, id);
  quick();
  keyboard();
  const dark = matchMedia("(prefers-color-scheme: dark)");
  dark.addEventListener("change", colors);
  colors();
  if (matchMedia("(pointer: coarse)").matches) {
    for (const figure of figures()) figure.toolbar.active_drag = null; // a finger scrolls the page
  }
}
const figures = () => Object.keys(data.panels).map(model);

function colors() {
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

const pick = (result, column) => column === "speed" ? result.curve.v : column === "steady" ? result.curve.F : result.columns[column];
const scaled = new Map(); // chart -> what its axes are divided by

// A chart's sources for a result: what each depends on, and its rows divided by the units' factors.
function contents(name, result, ghost, [xf, yf]) {
  const panel = data.panels[name], found = {};
  const rows = (from) => {
    const all = { along: divide(pick(from, panel.x), xf) };
    for (const { column } of panel.y) all[column] = divide(pick(from, column) ?? new Float64Array(all.along.length).fill(NaN), yf);
    return panel.x === "speed" ? cut(all, all.along.length - 1) : all; // the last is the working point
  };
  const empty = () => ({ along: [], ...Object.fromEntries(panel.y.map((s) => [s.column, []])) });
  found[`${name}-now`] = { from: [result, xf, yf], rows: () => rows(result) };
  found[`${name}-ghost`] = ghost ? { from: [ghost, xf, yf], rows: () => rows(ghost) } : { from: [], rows: empty };
  for (const kind of panel.marks.length ? ["slip", "stick"] : []) {
    const marks = { x: [], y: [] };
    for (const column of panel.marks) {
      const element = column.includes(".") ? column.slice(0, column.lastIndexOf(".")) : "";
      for (const t of happened(result, element, kind)) { marks.x.push(t / xf); marks.y.push(at(result, column, t) / yf); }
    }
    found[`${name}-${kind}`] = { from: marks.x.length ? [result, xf, yf] : [], rows: () => marks };
  }
  if (name === "curve" && result.curve) {
    const { v, F } = result.curve, last = v.length - 1;
    found["curve-point"] = { from: [result, yf], rows: () => ({ x: [v[last]], y: [F[last] / yf] }) };
  }
  return found;
}
const cut = (found, n) => Object.fromEntries(Object.entries(found).map(([key, list]) => [key, list.slice(0, n)]));

function chart(name, result, ghost, room = 0.1) { // in BokehJS; the units are chosen by what is shown now
  const panel = data.panels[name], figure = model(name);
  const fitting = (columns, unit) => prefix(peak(...columns.map((column) => pick(result, column))), unit);
  const [xf, xu] = panel.log ? [1, panel.xUnit] : panel.x === "t" ? [1, "s"] : fitting([panel.x], panel.xUnit);
  const [yf, yu] = fitting(panel.y.map((s) => s.column), panel.yUnit);
  scaled.set(name, [xf, yf]);
  figure.y_range.range_padding = room;
  if (panel.x !== "t" && !panel.log) figure.x_range.range_padding = room;
  for (const [source, { from, rows }] of Object.entries(contents(name, result, ghost, [xf, yf]))) put(source, from, rows);
  figure.below[0].axis_label = `${panel.xLabel}${xu ? ` (${xu})` : ""}`;
  figure.left[0].axis_label = `${panel.yLabel}${yu ? ` (${yu})` : ""}`;
  const hover = model(`${name}-hover`);
  if (hover) hover.tooltips = [[panel.x === "t" ? "t" : panel.xName, `@along{0.0000} ${xu}`], ...panel.y.map((s) => [s.name, `@{${s.column}}{0.0000} ${yu}`])];
}

const divide = (list, factor) => factor === 1 ? list : Float64Array.from(list, (x) => x / factor);

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
