// A chart by keyboard: in focus, the arrow keys go along its curves and tell the values there.
"use strict";
const COARSE = 200; // steps from one end to the other; with Shift row by row
const reading = { name: null, row: 0 };

const chartAt = (event) => Object.keys(data.panels).find((name) => event.composedPath().includes(Bokeh.index.find_one(model(name))?.el));
const rowsOf = (panel) => pick(state.latest, panel.x).length - (panel.x === "speed" ? 1 : 0); // the last is the working point

function told(panel) {
  const part = (name, column, unit) => { const x = pick(state.latest, column)[reading.row]; return `${name} ${x ? human(x, unit) : `0 ${unit}`}`; };
  const along = panel.x === "t" ? part("t", "t", "s") : part(panel.xName, panel.x, panel.xUnit);
  return `${along}: ${panel.y.map((s) => part(s.name, s.column, panel.yUnit)).join(", ")}`;
}

function point(name, panel) { // cross hairs
  const at = (column, factor) => pick(state.latest, column)[reading.row] / factor, [xf, yf] = scaled.get(name);
  model(`${name}-height`).setv({ location: at(panel.x, xf), visible: true });
  model(`${name}-width`).setv({ location: at(panel.y[0].column, yf), visible: true });
}

function unread() {
  if (!reading.name) return;
  for (const side of ["height", "width"]) model(`${reading.name}-${side}`).visible = false;
  reading.name = null;
  $("reading").hidden = true;
}

function readBy(event) {
  const name = chartAt(event), panel = data.panels[name];
  if (!panel || !state.latest || event.ctrlKey || event.altKey || event.metaKey) return;
  if (!event.composedPath()[0].classList.contains("bk-events")) return; // a tool's button
  const rows = rowsOf(panel), step = event.shiftKey ? 1 : Math.max(1, Math.round(rows / COARSE));
  const to = { ArrowRight: reading.row + step, ArrowLeft: reading.row - step, Home: 0, End: rows - 1 }[event.key];
  if (event.key === "Escape") unread();
  if (to === undefined) return;
  event.preventDefault();
  const row = reading.name === name ? to : event.key === "End" ? rows - 1 : 0; // in another chart from the left
  if (reading.name !== name) unread();
  Object.assign(reading, { name, row: Math.min(Math.max(row, 0), rows - 1) });
  point(name, panel);
  $("reading").textContent = told(panel);
  $("reading").hidden = false;
}

function keyboard() {
  document.addEventListener("keydown", readBy);
  document.addEventListener("focusin", (event) => {
    const name = chartAt(event), layer = event.composedPath()[0];
    if (reading.name && name !== reading.name) unread();
    if (!name || !layer.classList.contains("bk-events")) return;
    layer.setAttribute("role", "img");
    layer.setAttribute("aria-label", `${data.panels[name].yLabel} against ${data.panels[name].xLabel}; the arrow keys tell values`);
  });
}
