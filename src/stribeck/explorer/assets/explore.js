// The page: fields and sliders -> a setting for the worker -> panels. What a law is comes from the page's data.
"use strict";
const data = JSON.parse(document.getElementById("data").textContent);
const $ = (id) => document.getElementById(id);
const make = (tag, attributes = {}, ...inside) => {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) name in node ? (node[name] = value) : node.setAttribute(name, value);
  node.append(...inside);
  return node;
};
const state = { law: data.law, values: {}, ghost: null, latest: null, id: 0 };
window.stribeck = { state, result: null, set, idle: true };

// ---- numbers ------------------------------------------------------------------------------------------------------

const law = () => data.laws[state.law];
const numbers = () => [...law().numbers, ...data.numbers];
const value = (path) => state.values[path] ?? numbers().find((n) => n.path === path)?.value;
const show = (x, digits = 4) => {
  if (!Number.isFinite(x)) return "–";
  const text = String(Number(x.toPrecision(digits)));
  return text.replace("-", "−");
};

const brief = (x) => String(Number(x.toPrecision(7))); // in a field; the exact number stays behind it

function wrong(number, x) {
  const unit = number.unit ? ` ${number.unit}` : "";
  if (!Number.isFinite(x)) return `${number.path}: must be a finite number`;
  if (number.above !== null && !(x > number.above)) return `${number.path}: ${x}: must be > ${number.above}${unit}`;
  if (number.at_least !== null && !(x >= number.at_least)) return `${number.path}: ${x}: must be >= ${number.at_least}${unit}`;
  if (number.closed && !(x >= number.low && x <= number.high)) return `${number.path}: ${x}: must be from ${show(number.low)} to ${show(number.high)}${unit} in this page`;
  return null;
}

const STEPS = 1000;
const toSlider = (n, x) => Math.round(STEPS * Math.min(1, Math.max(0, n.log
  ? Math.log(Math.max(x, n.low) / n.low) / Math.log(n.high / n.low) : (x - n.low) / (n.high - n.low))));
function fromSlider(n, at) {
  const share = at / STEPS;
  const x = n.log ? n.low * Math.pow(n.high / n.low, share) : n.low + share * (n.high - n.low);
  return n.whole ? Math.round(x) : Number(x.toPrecision(4));
}

const GROUPS = { "law": "Law", "law.parameters": "Machine parameters", "plant": "Body", "plant.initial": "Start", "drive": "Drive",
  "drive.signal": "Drive signal", "solve": "Solver", "solve.atol": "Absolute tolerances", "output": "Output" };
const closed = (group) => /(^plant|\.)\.?initial$|^solve|^output$/.test(group);

function controls() {
  const box = $("numbers"), open = new Map([...box.querySelectorAll("details")].map((d) => [d.dataset.group, d.open]));
  box.replaceChildren();
  const groups = new Map();
  for (const number of numbers()) {
    if (!groups.has(number.group)) groups.set(number.group, []);
    groups.get(number.group).push(number);
  }
  for (const [group, own] of groups) {
    const details = make("details", { open: open.get(group) ?? !closed(group) },
      make("summary", {}, GROUPS[group] ?? group, group in GROUPS ? make("code", {}, `[${group}]`) : ""));
    details.dataset.group = group;
    for (const number of own) details.append(row(number));
    box.append(details);
  }
}

function row(number) {
  const id = `n-${number.path}`, x = value(number.path);
  const field = make("input", { id, type: "number", step: "any", value: brief(x), autocomplete: "off" });
  const slider = make("input", { type: "range", min: "0", max: String(STEPS), step: "1", value: String(toSlider(number, x)) });
  slider.setAttribute("aria-label", `${number.name}, ${number.meaning}`);
  slider.setAttribute("aria-valuetext", `${x} ${number.unit}`);
  slider.dataset.path = field.dataset.path = number.path;
  slider.oninput = () => set(number.path, fromSlider(number, Number(slider.value)), slider);
  field.oninput = () => { if (field.value !== "") set(number.path, Number(field.value), field); };
  slider.ondblclick = () => set(number.path, number.value);
  return make("div", { className: "number", title: `${number.path}: ${number.meaning}` },
    make("label", { htmlFor: id }, number.name), field, make("span", { className: "unit" }, number.unit),
    make("span", { className: "meaning" }, number.meaning), make("span", { className: "slide" }, slider));
}

function refresh(path, from) { // the controls of one number
  const number = numbers().find((n) => n.path === path), x = value(path);
  for (const input of document.querySelectorAll(`#numbers input[data-path="${CSS.escape(path)}"]`)) {
    if (input.type === "range") { if (input !== from) input.value = String(toSlider(number, x)); input.setAttribute("aria-valuetext", `${x} ${number.unit}`); }
    else if (input !== from) input.value = brief(x);
    input.classList.toggle("changed", x !== number.value);
  }
}

function set(path, x, from = null) {
  const number = numbers().find((n) => n.path === path), text = wrong(number, x);
  if (text) { complain(text); return; }
  state.values[path] = x;
  refresh(path, from);
  simulate();
}

// ---- the setting that the worker solves ---------------------------------------------------------------------------

const JUMP = 1, CORNER = 2, SMOOTH = 0;

function polyline(t, value) { // straight lines between points, constant outside, from t = 0 on
  const start = [Math.min(0, t[0])], level = [value[0]], slope = [0];
  for (let i = 0; i + 1 < t.length; i++) {
    if (t[i + 1] - t[i] > 0) {
      start.push(t[i]); level.push(value[i]); slope.push((value[i + 1] - value[i]) / (t[i + 1] - t[i]));
    }
  }
  start.push(t[t.length - 1]); level.push(value[value.length - 1]); slope.push(0);
  let first = 0;
  while (first + 1 < start.length && start[first + 1] <= 0) first++;
  const rows = [], restart = [];
  for (let i = first; i < start.length; i++) {
    rows.push(start[i], level[i], slope[i]);
    if (i === first) { restart.push(JUMP); continue; }
    const before = level[i - 1] + slope[i - 1] * (start[i] - start[i - 1]);
    const jump = Math.abs(level[i] - before) > 1e-12 * Math.max(Math.abs(before), Math.abs(level[i]));
    restart.push(jump ? JUMP : slope[i] !== slope[i - 1] ? CORNER : SMOOTH);
  }
  return { start: start.slice(first), rows, restart };
}

function pieces() {
  const signal = data.signal, at = (name) => value(`drive.signal.${name}`);
  if (signal.smooth) return { start: [0], rows: [0, 0, 0], restart: [JUMP] };
  if (signal.kind === "ramp") return { start: [0], rows: [0, 0, at("rate")], restart: [JUMP] };
  if (signal.kind === "step") return polyline([at("time"), at("time")], [0, at("value")]);
  const t = signal.t.map((x, i) => at(`t[${i}]`) ?? x), scale = (at("scale") ?? 1) / signal.scale;
  const down = t.findIndex((x, i) => i && x < t[i - 1]);
  if (down > 0) throw new Error(`drive.signal.t[${down}]: ${t[down]}: times must not decrease (the one before is ${t[down - 1]})`);
  return polyline(t, signal.value.map((x, i) => at(`value[${i}]`) ?? x * scale));
}

function setting() {
  if (data.machine) return machineSetting();
  const own = law(), path = new Map(numbers().filter((n) => n.target).map((n) => [n.target, n.path]));
  const step = value("output.step"), tEnd = value("solve.t_end"), rows = Math.floor(tEnd / step + 1e-9) + 1;
  if (rows > 200001) throw new Error(`output.step: ${step}: must be at least ${show(tEnd / 200000)} s here: the page keeps up to 200001 rows`);
  const found = own.parameters.map((target) => value(path.get(target)));
  const speed = value("law.parameters.v_s") ?? own.speed, speeds = [];
  for (let i = 0; i <= 160; i++) speeds.push(speed * Math.pow(10, -3 + i / 32));
  return {
    p: found, x: own.states.map((name) => value(`plant.initial.${name}`) ?? 0), level: value("law.parameters.v_s") ?? 0,
    pieces: pieces(), rtol: value("solve.rtol"), step, rows, end: Math.max(tEnd, (rows - 1) * step),
    maxSteps: value("solve.max_steps"), eventRoom: data.eventRoom, speeds,
    atol: Object.fromEntries(data.numbers.filter((n) => n.group === "solve.atol").map((n) => [n.name, value(n.path)])),
  };
}

let worker;
const flying = { id: 0, since: 0, pending: false, timer: 0, link: 0 };
const PATIENCE = 150; // ms after which a newer setting ends the run of an older one

function simulate() {
  flying.pending = true;
  window.stribeck.idle = false;
  pump();
}

function pump() { // one run at a time: curves follow a slider that moves faster than runs end
  if (!worker || !flying.pending) return;
  const waited = performance.now() - flying.since;
  clearTimeout(flying.timer);
  if (flying.id && waited < PATIENCE) { flying.timer = setTimeout(pump, PATIENCE - waited); return; }
  flying.pending = false;
  let wanted;
  try { wanted = setting(); } catch (error) { complain(error.message); flying.id = 0; window.stribeck.idle = true; return; }
  const id = ++state.id, own = law();
  Object.assign(flying, { id, since: performance.now() });
  (own.sent ??= send(own)).then(() => worker.postMessage({ id, law: own.name, setting: wanted }));
  setTimeout(() => { if (flying.id === id) progress(0); }, 100);
  clearTimeout(flying.link);
  flying.link = setTimeout(link, REST); // the browser takes milliseconds for it
}

async function send({ wasm, sent, ...plain }) { // a law goes to the worker once
  worker.postMessage({ law: plain, module: await bytes(wasm) });
}

function arrived({ data: { id, result, share, error } }) {
  if (id !== flying.id) return;
  if (share !== undefined) { progress(share); return; }
  flying.id = 0;
  window.stribeck.idle = !flying.pending;
  answer(result, error); // not idle before all panels are drawn
  pump();
}

function answer(result, error) {
  progress(null);
  if (error) { complain(error); return; }
  if (result.wrong) {
    complain(result.wrong.map((r) => `${r.key}: ${value(r.path)}: must be ${r.allowed}`).join("; "));
    claims(result.claims);
    return;
  }
  complain(result.reason ? `The run failed: ${result.reason}. The curves end there.` : "");
  complete(result);
  state.latest = result;
  unread();
  window.stribeck.result = result;
  draw(result);
  claims(result.claims);
  equation();
  $("status").textContent = `${summary(result)} ${result.stats.accepted} steps in ${show(result.stats.milliseconds, 2)} ms.`;
  window.stribeck.wait = performance.now() - flying.since;
}

// What the panels need beside the columns: times, energies, the mean speed.
function complete(result) {
  const { columns, rows } = result, step = value("output.step");
  columns.t = Float64Array.from({ length: rows }, (_, i) => i * step);
  if (data.machine) return;
  if (!columns.E_in) {
    const u = columns.u ?? columns.F, { y } = columns, E = new Float64Array(rows);
    for (let i = 1; i < rows; i++) E[i] = E[i - 1] + 0.5 * (u[i] + u[i - 1]) * (y[i] - y[i - 1]);
    columns.E_in = E;
  }
}

function summary(result) {
  if (data.machine) return machineSummary(result);
  const slips = result.events.filter(([, what]) => !(what & 1)).map(([t]) => t);
  const { y } = result.columns;
  if (slips.length > 3) {
    const periods = slips.slice(1).map((t, i) => t - slips[i]).slice(-Math.min(20, slips.length - 1));
    const mean = periods.reduce((a, b) => a + b) / periods.length;
    return `Sticks and slips ${slips.length} times, mean period ${human(mean, "s")}.`;
  }
  if (slips.length) return `Slips ${slips.length === 1 ? "once, at" : `${slips.length} times, first at`} t = ${human(slips[0], "s")}.`;
  let far = 0;
  for (const each of y) far = Math.max(far, Math.abs(each));
  return `Does not pass v_s; moves up to ${human(far, law().columns[0].unit)}.`;
}

// ---- claims, equation, links --------------------------------------------------------------------------------------

const WORDS = { unique: "unique", bounded: "bounded", smooth: "smooth", passive: "passive", drift_free: "drift-free" };

function claims(values) {
  const box = $("claims");
  box.replaceChildren(...data.claims.map((name, i) => {
    const holds = values[i], text = law().conditions[name];
    const kind = Number.isNaN(holds) ? "none" : holds ? "yes" : text ? "no" : "not";
    const told = { none: "does not apply", yes: "yes", no: "not shown", not: "no" }[kind];
    const item = make("li", { className: kind }, make("b", {}, WORDS[name]), make("span", { className: "verdict" }, told));
    if (text) item.append(make("span", { className: "condition" }, ` where ${text}`));
    item.dataset.claim = name;
    item.dataset.holds = kind;
    return item;
  }));
}

function equation() {
  const own = law(), names = [...own.numbers].sort((a, b) => b.symbol.length - a.symbol.length);
  $("equations").replaceChildren(...own.equations.map((text) => {
    let numbers = [[text, false]];
    for (const n of names) {
      numbers = numbers.flatMap(([part, done]) => done ? [[part, true]]
        : part.split(new RegExp(`(?<![\\p{L}\\p{N}_])${n.symbol.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")}(?![\\p{L}\\p{N}_₀-₉])`, "u"))
          .flatMap((piece, i) => i ? [[show(value(n.path)), true], [piece, false]] : [[piece, false]]));
    }
    return make("div", { className: "equation" }, make("p", {}, text),
      make("p", { className: "numbered" }, ...numbers.map(([part, done]) => done ? make("b", {}, part) : part)));
  }));
}

function complain(text) { $("problem").textContent = text; $("problem").hidden = !text; }
function progress(share) {
  $("progress").hidden = share === null;
  if (share !== null) $("progress").value = share;
}

function link() {
  const changed = numbers().filter((n) => state.values[n.path] !== undefined && value(n.path) !== n.value);
  const words = changed.map((n) => `${encodeURIComponent(n.path)}=${value(n.path)}`);
  if (state.law !== data.law) words.unshift(`law=${encodeURIComponent(state.law)}`);
  history.replaceState(null, "", `${location.pathname}${location.search}${words.length ? `#${words.join("&")}` : ""}`);
}

function readLink() {
  const words = new URLSearchParams(location.hash.slice(1));
  if (words.get("law") in data.laws) state.law = words.get("law");
  for (const [path, text] of words) {
    const number = numbers().find((n) => n.path === path);
    if (number && text !== "" && !wrong(number, Number(text))) state.values[path] = Number(text);
  }
}

function toml() {
  const tables = structuredClone(data.scenario);
  if (!data.machine) tables.law = structuredClone(law().table);
  const signal = tables.drive?.signal;
  if (signal?.kind === "points" && !signal.t) Object.assign(signal, { t: data.signal.t, value: data.signal.value.map((x) => x / data.signal.scale) });
  for (const number of numbers()) {
    const words = number.path.split(".");
    let table = tables;
    for (const word of words.slice(0, -1)) table = table[word] ??= {};
    const [, name, index] = /^(.*?)(?:\[(\d+)\])?$/.exec(words[words.length - 1]);
    const x = value(number.path), given = state.values[number.path] !== undefined && x !== number.value;
    if (index !== undefined) table[name][Number(index)] = x;
    else if (given || name in table) table[name] = number.whole ? BigInt(x) : x;
  }
  const lines = [], word = (x) => typeof x === "string" ? JSON.stringify(x) : typeof x === "bigint" ? String(x)
    : typeof x === "number" ? (Number.isInteger(x) && Math.abs(x) < 1e15 ? `${x}.0` : String(x))
    : Array.isArray(x) ? `[${x.map(word).join(", ")}]`
    : typeof x === "object" ? `{ ${Object.entries(x).map(([key, each]) => `${bare(key)} = ${word(each)}`).join(", ")} }` : String(x);
  const bare = (key) => /^[\w-]+$/.test(key) ? key : JSON.stringify(key);
  const table = (own, path) => {
    const plain = Object.entries(own).filter(([, x]) => typeof x !== "object" || Array.isArray(x));
    if (path && plain.length) lines.push("", `[${path}]`);
    for (const [key, x] of plain) lines.push(`${bare(key)} = ${["schema", "seed", "max_steps"].includes(key) ? String(x) : word(x)}`);
    for (const [key, x] of Object.entries(own)) {
      if (typeof x === "object" && !Array.isArray(x)) table(x, path ? `${path}.${bare(key)}` : bare(key));
    }
  };
  table(tables, "");
  return `${lines.join("\n").trim()}\n`;
}

async function copy(text, button) {
  window.stribeck.copied = text;
  let done = false;
  try { await navigator.clipboard.writeText(text); done = true; } catch {
    const area = make("textarea", { value: text });
    document.body.append(area); area.select();
    done = document.execCommand("copy");
    area.remove();
  }
  const before = button.dataset.text ??= button.textContent;
  button.textContent = done ? "copied" : "cannot copy here";
  setTimeout(() => { button.textContent = before; }, 1500);
}

// ---- begin --------------------------------------------------------------------------------------------------------

async function bytes(text) { // base64 of gzip
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

function choose(name) {
  state.law = name;
  $("law").value = name;
  $("about").textContent = law().about;
  controls();
  simulate();
}

function reset() {
  state.values = {};
  choose(data.law);
}

function pullsAndGivesWay() { // a body that is pulled by a spring, and friction that falls with speed
  return data.scenario.drive?.kind === "spring" && numbers().some((n) => n.path === "law.parameters.F_s");
}

async function begin() {
  for (const [name, own] of Object.entries(data.laws)) $("law").append(make("option", { value: name, title: own.about }, name));
  $("law").onchange = () => choose($("law").value);
  $("reset").onclick = reset;
  $("keep").onclick = () => { keep(); };
  $("toml").onclick = () => copy(toml(), $("toml"));
  $("link").onclick = () => { link(); copy(location.href, $("link")); };
  $("command").onclick = () => copy(data.command, $("command"));
  window.onhashchange = () => { state.values = {}; state.law = data.law; readLink(); choose(state.law); };
  if (data.machine) machineForm();
  if (pullsAndGivesWay()) $("measured").textContent += " Try F_s: well above F_c the body sticks and slips, at F_c it follows smoothly.";
  readLink();
  const library = make("script", {}, new TextDecoder().decode(await bytes($("charts").textContent)));
  document.head.append(library);
  await panels();
  worker = new Worker(URL.createObjectURL(new Blob([$("solver").textContent], { type: "text/javascript" })));
  worker.onmessage = arrived;
  worker.onerror = (event) => complain(`The solver cannot run here: ${event.message}`);
  worker.postMessage({ layout: data.layout });
  choose(state.law);
  const [first] = Object.keys(state.values), field = first && document.getElementById(`n-${first}`)?.closest(".number");
  if (field) $("controls").scrollTop += field.getBoundingClientRect().top - $("controls").getBoundingClientRect().top - 40; // what a link set is in sight
}
begin().catch((error) => complain(`This browser cannot show the page: ${error.message ?? error}`));
