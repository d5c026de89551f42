// While a slider moves, curves are drawn on a plain canvas over each chart's frame, on the axes that the chart has; the
// charts themselves (axes, tools, hover) follow when the hand rests. The same sources, glyphs and colors serve both.
"use strict";
const REST = 60; // ms without a new run after which the charts are drawn
const PAINTED = 50; // ms after which BokehJS has painted what it was given
const ROOM = 0.6; // the share of a range that is left free about curves that still move
const boards = new Map(); // chart -> its canvas
const waiting = { panels: [], timer: 0 };

const views = new Map();
const shape = (name) => { // where the frame of a chart lies, or nothing before it is laid out
  if (!views.has(name)) views.set(name, Bokeh.index.find_one(model(name)));
  const view = views.get(name), box = view?.frame?.bbox;
  return box?.width > 0 && box.height > 0 ? { box, at: view.el.getBoundingClientRect() } : null;
};
const seen = ({ at }) => at.bottom > 0 && at.top < innerHeight;

function draw(result) { // at once what is in sight; then, unless a newer run comes, every chart as a whole
  const names = Object.keys(data.panels), ghost = state.ghost;
  if (data.panels.energy) for (const each of [result, ghost]) if (each?.columns) energy(each);
  const now = names.filter((name) => scaled.has(name) && live(name, result, ghost));
  const worst = now.map((name) => [misfit(name, result), name]).sort(([a], [b]) => b - a)[0];
  clearTimeout(waiting.timer);
  if (worst?.[0] > 0) requestAnimationFrame(() => setTimeout(() => follow(worst[1], result, ghost))); // after this frame
  waiting.panels = [...now, ...names.filter((name) => !now.includes(name))];
  window.stribeck.idle = false;
  waiting.timer = setTimeout(() => rested(result, ghost), now.length ? REST : 0);
}

function follow(name, result, ghost) { // axes that the curves have left; one chart a run keeps the hand's pace
  if (state.latest !== result || window.stribeck.idle) return;
  chart(name, result, ghost, ROOM);
  requestAnimationFrame(() => { if (boards.get(name).result === result && !boards.get(name).hidden) live(name, result, ghost); });
}

function rested(result, ghost) {
  const name = waiting.panels.shift(), board = boards.get(name);
  if (name) chart(name, result, ghost);
  if (board) setTimeout(() => requestAnimationFrame(() => { if (board.result === result) board.hidden = true; }), PAINTED);
  if (waiting.panels.length) waiting.timer = setTimeout(() => rested(result, ghost));
  else window.stribeck.idle = !flying.pending && !flying.id;
}

function board(name, box, at) {
  if (!boards.has(name)) {
    const canvas = make("canvas", { className: "live" });
    (document.getElementById(name) ?? document.getElementById("trajectories")).append(canvas);
    boards.set(name, canvas);
  }
  const canvas = boards.get(name), zoom = devicePixelRatio || 1, home = canvas.parentElement.getBoundingClientRect();
  const size = [Math.round(box.width * zoom), Math.round(box.height * zoom)];
  if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
  Object.assign(canvas.style, { left: `${at.left - home.left + box.left}px`, top: `${at.top - home.top + box.top}px`, width: `${box.width}px`, height: `${box.height}px` });
  canvas.hidden = false;
  const pen = canvas.getContext("2d");
  pen.setTransform(zoom, 0, 0, zoom, 0, 0);
  return pen;
}

const scale = (range, log, from, to) => { // data -> pixels
  const f = log ? Math.log : (x) => x, start = f(range.start), rate = (to - from) / (f(range.end) - start);
  return log ? (x) => from + rate * (Math.log(x) - start) : (x) => from + rate * (x - start);
};
const plain = (x) => x?.value ?? x; // a color or a size, as BokehJS keeps it

function live(name, result, ghost) { // told: whether the chart is in sight, and drawn
  const found = shape(name);
  if (!found || !seen(found)) return false;
  const { box, at } = found, figure = model(name), pen = board(name, box, at), style = getComputedStyle(document.body);
  const { width, height } = box, axes = [scale(figure.x_range, data.panels[name].log, 0, width), scale(figure.y_range, false, height, 0)];
  pen.fillStyle = style.backgroundColor;
  pen.fillRect(0, 0, width, height);
  grid(pen, figure, axes, width, height, style.getPropertyValue("--line"));
  const fresh = contents(name, result, ghost, scaled.get(name)), made = new Map();
  for (const { visible, data_source, glyph } of figure.renderers) {
    if (!visible) continue;
    if (!made.has(data_source)) made.set(data_source, fresh[data_source.name]?.rows() ?? data_source.data);
    const rows = made.get(data_source), lists = [rows[glyph.x.field], rows[glyph.y.field]];
    if (glyph.type === "Line") line(pen, lists, axes, glyph); else dots(pen, lists, axes, glyph);
  }
  boards.get(name).result = result;
  return true;
}

function grid(pen, figure, [across, up], width, height, color) {
  pen.strokeStyle = color;
  pen.lineWidth = 1;
  pen.beginPath();
  const ticks = (axis, range) => axis.ticker.get_ticks(range.start, range.end, range, NaN).major;
  for (const x of ticks(figure.below[0], figure.x_range)) { const at = Math.round(across(x)) + 0.5; pen.moveTo(at, 0); pen.lineTo(at, height); }
  for (const y of ticks(figure.left[0], figure.y_range)) { const at = Math.round(up(y)) + 0.5; pen.moveTo(0, at); pen.lineTo(width, at); }
  pen.stroke();
}

function line(pen, [xs, ys], [across, up], glyph) { // without what is nearer than a pixel to the point before
  pen.globalAlpha = plain(glyph.line_alpha);
  pen.strokeStyle = plain(glyph.line_color);
  pen.lineWidth = plain(glyph.line_width);
  pen.beginPath();
  const last = xs.length - 1;
  let begun = false, x0 = 0, y0 = 0;
  for (let i = 0; i <= last; i++) {
    const x = across(xs[i]), y = up(ys[i]);
    if (!(x === x && y === y)) { begun = false; continue; }
    if (!begun) pen.moveTo(x, y);
    else if (i === last || Math.abs(x - x0) >= 1 || Math.abs(y - y0) >= 1) pen.lineTo(x, y);
    else continue;
    begun = true; x0 = x; y0 = y;
  }
  pen.stroke();
  pen.globalAlpha = 1;
}

function dots(pen, [xs, ys], [across, up], glyph) {
  const r = plain(glyph.size) / 2, corner = plain(glyph.marker) === "triangle";
  pen.fillStyle = plain(glyph.fill_color);
  pen.beginPath();
  for (let i = 0; i < xs.length; i++) {
    const x = across(xs[i]), y = up(ys[i]);
    if (corner) { pen.moveTo(x, y - 1.15 * r); pen.lineTo(x + r, y + 0.58 * r); pen.lineTo(x - r, y + 0.58 * r); pen.closePath(); }
    else { pen.moveTo(x + r, y); pen.arc(x, y, r, 0, 7); }
  }
  pen.fill();
}

function misfit(name, result) { // how far the curves leave the frame, or leave it empty, as shares of it; zoomed charts stay
  const [xf, yf] = scaled.get(name), { x_range, y_range } = model(name), panel = data.panels[name];
  const off = (range, columns, factor) => {
    if (range.have_updated_interactively) return 0;
    const [low, high] = extent(columns.map((column) => pick(result, column))), size = range.end - range.start;
    if (!(high >= low)) return 0;
    return Math.max((high / factor - range.end) / size, (range.start - low / factor) / size, 0.4 - (high - low) / factor / size);
  };
  return Math.max(panel.log ? 0 : off(x_range, [panel.x], xf), off(y_range, panel.y.map((s) => s.column), yf));
}
function extent(lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) for (const each of list ?? []) { if (each < low) low = each; if (each > high) high = each; }
  return [low, high];
}
