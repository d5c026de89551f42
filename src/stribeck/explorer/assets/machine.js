// The page of a machine: what its numbers do to the solver's arrays was measured when the page was made.
"use strict";
function machineSetting() {
  const step = value("output.step"), tEnd = value("solve.t_end"), rows = Math.floor(tEnd / step + 1e-9) + 1;
  const widest = law().columns.length, most = Math.floor(4e6 / widest);
  if (rows > most) throw new Error(`output.step: ${step}: must be at least ${show(tEnd / (most - 1))} s here: the page keeps up to ${most} rows`);
  const arrays = Object.fromEntries(Object.entries(data.machine.arrays).map(([name, list]) => [name, Float64Array.from(list)]));
  for (const number of numbers()) {
    const change = value(number.path) - number.value;
    for (const [name, i, rate] of number.effects) arrays[name][i] += rate * change;
  }
  return { arrays, restart: data.machine.restart, rooms: data.machine.rooms, step, rows, end: Math.max(tEnd, (rows - 1) * step),
    maxSteps: value("solve.max_steps"), eventRoom: data.eventRoom };
}

function machineSummary(result) {
  const told = [];
  data.watched.forEach(([name, kinds]) => {
    const counts = [...new Set(kinds)].map((kind) => [kind.replaceAll("_", " "), happened(result, name, kind).length]).filter(([, n]) => n);
    if (counts.length) told.push(`${name ? `${name}: ` : ""}${counts.map(([kind, n]) => `${kind} ${n === 1 ? "once" : `${n} times`}`).join(", ")}`);
  });
  return told.length ? `${told.join("; ")}.` : "Nothing passes its threshold.";
}

function machineForm() { // no choice of a law; the numbers that stay, by name
  $("choice").hidden = $("guarantees").hidden = true;
  const { fixed } = data.machine;
  $("fixed").hidden = !fixed.length;
  $("fixed").append(make("p", { className: "soft" }, "These parameters change the equations or a signal's table and have no slider: 'stribeck explore --set PATH=VALUE' makes a page with another value."),
    ...fixed.map(({ path, value: x }) => make("div", { className: "kept" }, make("code", {}, path), ` ${show(x, 6)}`)));
}
