// Runs the compiled solver (WebAssembly) for one setting at a time; the newest setting wins.
"use strict";
const DONE = 0, MORE = 1, EVENTS_FULL = 2;
const FIRST_SLICE = 4000, SLICE = 20000; // attempted steps between two looks at what is asked for meanwhile
const REST = 8; // ms at least between two looks
const laws = new Map(); // name -> what is told of the law, and its WebAssembly.Instance
let layout, newest = 0;

class Memory { // what a run needs, laid out behind the module's own data
  constructor(instance, shape) {
    this.api = instance.exports;
    this.top = shape.end;
    new Int32Array(this.api.memory.buffer, this.api.shape.value, shape.numbers.length).set(shape.numbers); // runtime/any.c
  }
  room(bytes) {
    const at = Math.ceil(this.top / 16) * 16;
    this.top = at + bytes;
    const missing = this.top - this.api.memory.buffer.byteLength;
    if (missing > 0) this.api.memory.grow(Math.ceil(missing / 65536));
    return at;
  }
  doubles(values) {
    const at = this.room(8 * Math.max(values.length, 1));
    new Float64Array(this.api.memory.buffer, at, values.length).set(values);
    return at;
  }
  empty(count) { return this.room(8 * Math.max(count, 1)); }
  view(at, count) { return new Float64Array(this.api.memory.buffer, at, count); }
}

class Struct { // the C struct Run, by the layout that comes with the page
  constructor(memory) {
    this.memory = memory;
    this.at = memory.room(layout._size[0]);
    new Uint8Array(memory.api.memory.buffer, this.at, layout._size[0]).fill(0);
  }
  get data() { return new DataView(this.memory.api.memory.buffer); }
  set(name, value) {
    const [offset, kind] = layout[name], at = this.at + offset;
    if (kind === "pointer") this.data.setUint32(at, value, true);
    else if (kind === "double") this.data.setFloat64(at, value, true);
    else this.data.setBigInt64(at, BigInt(value), true);
  }
  get(name) {
    const [offset, kind] = layout[name], at = this.at + offset;
    return kind === "double" ? this.data.getFloat64(at, true) : Number(this.data.getBigInt64(at, true));
  }
}

function reason(status, t, most) {
  if (status === -1) return `at t = ${t.toPrecision(9)} s the step needed for solve.rtol fell below what floating point resolves`;
  if (status === -2) return `after t = ${t.toPrecision(9)} s the equations are no longer finite`;
  if (status === -4) return `at t = ${t.toPrecision(9)} s the steps needed for solve.rtol became so short that the end is 1e12 of them away`;
  return `gave up at t = ${t.toPrecision(9)} s after solve.max_steps = ${most} attempted steps`;
}

// The numbers that follow from the setting: tolerances, claims, the steady curve.
function about(memory, law, p, setting) {
  const { api } = memory, n = law.states.length;
  const setup = memory.empty(n + 2), claims = memory.empty(5), held = memory.empty(8);
  api.system_setup(p, setting.rtol, setup);
  api.system_claims(p, claims);
  api.system_relations(p, held);
  const values = Array.from(memory.view(setup, n + 2));
  law.states.forEach((name, i) => { if (name in setting.atol) values[i] = setting.atol[name] * values[n]; });
  return {
    atol: values.slice(0, n), share: values[n], longest: values[n + 1], claims: Array.from(memory.view(claims, 5)),
    holds: Array.from(memory.view(held, law.relations.length)),
  };
}

function steady(memory, p, speeds) {
  const F = memory.empty(speeds.length);
  speeds.forEach((v, i) => memory.api.system_steady(p, v, v > 0 ? 1 : -1, F + 8 * i));
  return memory.view(F, speeds.length).slice();
}

const rest = () => new Promise((go) => { // let a newer setting arrive
  const channel = new MessageChannel();
  channel.port1.onmessage = () => { channel.port1.close(); go(); };
  channel.port2.postMessage(0);
});

// What differs between a law on a body and a machine: where the arrays come from, and what is told of the law.
function ofLaw(memory, law, setting) {
  const p = memory.doubles(setting.p), { pieces } = setting, found = about(memory, law, p, setting);
  return {
    ...found, restart: pieces.restart, width: law.states.length,
    place: {
      parameters: p, atol: memory.doubles(found.atol), atol_now: memory.doubles(found.atol.map(() => 0)),
      fixed_atol: memory.doubles(found.atol.map((x, i) => (law.states[i] in setting.atol ? x : 0))), x: memory.doubles(setting.x), piece_start: memory.doubles(pieces.start),
      piece_rows: memory.doubles(pieces.rows), thresholds: memory.doubles([setting.level, 0]), held: memory.empty(1),
      memory: memory.empty(1), queue: memory.empty(1), noise: memory.empty(1), sampled: memory.empty(1), acted: memory.empty(1),
      rtol: found.share * setting.rtol, h_limit: found.longest, queue_room: 1,
    },
  };
}

function ofMachine(memory, law, setting) {
  const { arrays, rooms } = setting, { rtol, least_rate, ...lists } = arrays;
  const place = Object.fromEntries(Object.entries(lists).map(([name, list]) => [name, memory.doubles(list)]));
  const zeros = () => memory.doubles(new Float64Array(rooms.held)); // integers 0 have the same bits
  const holds = memory.empty(law.relations.length);
  memory.api.system_relations(place.parameters, holds);
  return {
    restart: setting.restart, width: law.states.length + rooms.held + rooms.shown, claims: [], holds: Array.from(memory.view(holds, law.relations.length)),
    place: {
      ...place, sampled: zeros(), acted: zeros(), rtol: rtol[0], h_limit: 1 / least_rate[0],
      queue_room: rooms.queue_room, noise_room: rooms.noise_room,
    },
  };
}

// Every column of the output, row by row, from the states.
function table(memory, law, setting, found, start, states, rows) {
  const { piece_start, piece_rows, parameters: p } = found.place, { width } = found, piece = 8 * law.shape.numbers[1];
  const columns = law.columns.length, values = memory.empty(rows * columns), { api } = memory;
  for (let i = 0, n = 0; i < rows; i++) {
    const t = i * setting.step;
    while (n + 1 < start.length && start[n + 1] <= t * (1 + 1e-12)) n++; // waveforms/pieces.py
    api.system_columns(p, piece_rows + n * piece, t, states + 8 * i * width, values + 8 * i * columns);
  }
  return memory.view(values, rows * columns);
}

async function solve(instance, law, setting, tell, current) {
  const memory = new Memory(instance, law.shape), { api } = memory, started = performance.now(), { rows } = setting;
  const found = (setting.arrays ? ofMachine : ofLaw)(memory, law, setting), p = found.place.parameters;
  const wrong = law.relations.filter((_, i) => found.holds[i] !== 1);
  if (wrong.length) return { wrong, claims: found.claims };
  const run = new Struct(memory), eventRoom = Math.max(setting.eventRoom, Number(api.stribeck_event_room()));
  const out = memory.empty(rows * found.width), times = memory.empty(eventRoom), what = memory.empty(eventRoom);
  const pieces = found.restart.length, restart = memory.room(pieces + 1);
  new Int8Array(api.memory.buffer, restart, pieces).set(found.restart);
  const place = {
    ...found.place, out, event_time: times, piece_restart: restart, event_what: what, step: setting.step, h: Infinity,
    h_smallest: Infinity, pieces, rows, event_room: eventRoom, t_end: setting.end, restart: 1,
  };
  for (const [name, value] of Object.entries(place)) run.set(name, value);
  const events = [];
  let status = MORE, left = setting.maxSteps, slice = FIRST_SLICE, looked = performance.now(), said = started;
  while ((status === MORE || status === EVENTS_FULL) && left > 0) {
    const attempts = Math.min(slice, left);
    slice = SLICE;
    run.set("attempts_left", attempts);
    status = api.stribeck_advance(run.at);
    left -= attempts - Math.max(run.get("attempts_left"), 0);
    const count = run.get("events"), kinds = new Int32Array(api.memory.buffer, what, count);
    memory.view(times, count).forEach((t, i) => events.push([t, kinds[i]]));
    run.set("events", 0);
    const now = performance.now();
    if (now - looked > REST) {
      if (now - said > 60) { tell(run.get("t") / setting.end); said = now; }
      await rest();
      looked = performance.now();
      if (!current()) return null;
    }
  }
  const done = run.get("row"), columns = law.columns.length, found_columns = {};
  const starts = Array.from(memory.view(found.place.piece_start, pieces));
  const cells = table(memory, law, setting, found, starts, out, done);
  law.columns.forEach((column, j) => {
    const own = new Float64Array(done);
    for (let i = 0; i < done; i++) own[i] = cells[i * columns + j];
    found_columns[column.name] = own;
  });
  const result = {
    columns: found_columns, rows: done, events, claims: found.claims,
    reason: status === DONE ? null : reason(status, run.get("t"), setting.maxSteps),
    stats: { accepted: run.get("accepted"), rejected: run.get("rejected"), milliseconds: performance.now() - started },
  };
  if (setting.arrays) return result;
  let mean = 0; // speed over the second half: the working point
  for (let i = done >> 1; i < done; i++) mean += Math.abs(found_columns.v[i]) / (done - (done >> 1));
  const speeds = [...setting.speeds, mean];
  return { ...result, mean, curve: { v: speeds, F: steady(memory, p, speeds) } };
}

onmessage = async ({ data: { id, layout: fields, law, module, setting } }) => {
  if (fields) { layout = fields; return; }
  if (module) {
    laws.set(law.name, { law, made: WebAssembly.instantiate(module, {}) });
    return;
  }
  newest = id;
  try {
    const { law: own, made } = laws.get(law), { instance } = await made;
    if (newest !== id) return;
    const result = await solve(instance, own, setting, (share) => postMessage({ id, share }), () => newest === id);
    if (result) postMessage({ id, result }, Object.values(result.columns ?? {}).map((column) => column.buffer)); // moved, not copied
  } catch (error) {
    postMessage({ id, error: String(error) });
  }
};
