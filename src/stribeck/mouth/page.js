const copy = document.getElementById("copy");
if (copy) {
  copy.hidden = false;
  copy.onclick = async () => {
    try { await navigator.clipboard.writeText(copy.dataset.command); copy.textContent = "copied"; } catch { copy.textContent = copy.dataset.command; }
  };
}
// On a narrow screen the columns of a figure stand below each other, from the left one to the right one. Panels across several
// are squeezed, but not their letters. The legend shrinks.
const moved = new Map(); // by picture: its panels from above, each with its sideways factor, its way and where it ends
const NS = "http://www.w3.org/2000/svg";
function columnsOf(panels) { // panels whose plots overlap sideways, from the narrowest on; those across several are in none
  const columns = [];
  for (const panel of [...panels].sort((a, b) => a.plot[1] - a.plot[0] - (b.plot[1] - b.plot[0]))) {
    const [own, ...more] = columns.filter((column) => column.some(({ plot }) => plot[0] < panel.plot[1] && panel.plot[0] < plot[1]));
    if (own && !more.length) own.push(panel);
    else if (!own) columns.push([panel]);
  }
  return columns.sort((a, b) => a[0].plot[0] - b[0].plot[0]);
}
function unsqueeze(group, share, axis) { // letters, marks and legends, about where each is anchored; left of the axis at their distance to it
  const legends = [...group.querySelectorAll('g[id*="legend_"]')], free = (each) => !legends.some((legend) => legend.contains(each));
  const anchors = [...group.querySelectorAll("text[x], use[x]")].filter(free).map((each) => [each, Number(each.getAttribute("x"))]);
  const { x: first, width } = group.getBBox();
  for (const legend of legends) {
    const box = legend.getBBox(), right = box.x + box.width / 2 > first + width / 2;
    anchors.push([legend, box.x + (right ? box.width : 0)]);
  }
  for (const [each, x] of anchors) {
    const to = x < axis ? axis - (axis - x) / share : x;
    each.setAttribute("transform", `translate(${to} 0) scale(${1 / share} 1) translate(${-x} 0) ${each.getAttribute("transform") ?? ""}`);
  }
}
function fold(svg) {
  const [left, top, wide] = svg.getAttribute("viewBox").split(/[ ,]+/).map(Number), gap = 8;
  const frame = svg.getBoundingClientRect(), unit = wide / frame.width;
  const panels = [...svg.querySelectorAll('g[id*="-axes_"]')].map((group) => { // with its labels, and without what is clipped
    const parts = [group.querySelector("path"), ...group.querySelectorAll("text")].map((each) => each.getBoundingClientRect());
    const least = (side, edge, from) => from + (Math.min(...parts.map((each) => each[side])) - edge) * unit;
    const most = (side, edge, from) => from + (Math.max(...parts.map((each) => each[side])) - edge) * unit;
    return { group, plot: [parts[0].left, parts[0].right], axis: left + (parts[0].left - frame.left) * unit, from: least("left", frame.left, left), to: most("right", frame.left, left),
             above: least("top", frame.top, top), below: most("bottom", frame.top, top) };
  });
  const columns = columnsOf(panels).map((column) => column.sort((a, b) => a.above - b.above));
  if (columns.length < 2) return;
  const start = (some) => Math.min(...some.map(({ from }) => from)), end = (some) => Math.max(...some.map(({ to }) => to));
  // half the figure at least: letters of narrower columns would grow beyond those of the text
  const width = Math.max(wide / 2, ...columns.map((some) => end(some) - start(some) + gap)), head = Math.min(...columns.flat().map(({ above }) => above));
  const across = panels.filter((each) => !columns.flat().includes(each));
  const order = [...across.filter(({ above }) => above < head + gap), ...columns.flat(), ...across.filter(({ above }) => above >= head + gap)];
  let place = Math.min(...panels.map(({ above }) => above));
  moved.set(svg, order.map(({ group, axis, from, to, above, below }, k) => {
    const column = columns.find((some) => some.includes(order[k])), beside = axis - from; // what stands beside the axis keeps its width
    const share = column ? 1 : Math.min(1, (width - gap - beside) / (to - axis));
    const [dx, dy] = [left + gap / 2 + (column ? -start(column) : beside - share * axis), place - above];
    group.setAttribute("transform", `translate(${dx} ${dy}) scale(${share} 1)`);
    if (share < 1) unsqueeze(group, share, axis);
    place += below - above + gap;
    return { group, share, dx, dy, until: place };
  }));
  for (const legend of [...svg.querySelectorAll('g[id*="-legend_"]')].filter((each) => !each.closest('g[id*="-axes_"]'))) {
    const box = legend.getBBox(), share = Math.min(1, (width - gap) / box.width);
    legend.setAttribute("transform", `translate(${left + gap / 2 - share * box.x} ${(1 - share) * box.y}) scale(${share})`);
  }
  svg.setAttribute("viewBox", [left, top, width, place - top].join(" "));
  svg.style.minWidth = 0;
}
if (matchMedia("(max-width: 40rem)").matches) document.querySelectorAll("figure svg[viewBox]").forEach(fold);
// Pictures: + and - or Ctrl and the wheel zoom where the pointer is, dragging moves, Escape or a double click shows all.
for (const svg of document.querySelectorAll("figure svg[viewBox]")) {
  const whole = svg.getAttribute("viewBox").split(/[ ,]+/).map(Number);
  let box = [...whole], at = null;
  const show = () => { svg.setAttribute("viewBox", box.join(" ")); svg.classList.toggle("zoomed", box[2] < whole[2] * 0.999); };
  const all = () => { box = [...whole]; show(); };
  const zoom = (factor, x, y) => {
    const frame = svg.getBoundingClientRect(), wide = Math.min(whole[2], Math.max(whole[2] / 200, box[2] * factor)), share = wide / box[2];
    const [u, v] = x === undefined ? [0.5, 0.5] : [(x - frame.left) / frame.width, (y - frame.top) / frame.height];
    box = [box[0] + u * box[2] * (1 - share), box[1] + v * box[3] * (1 - share), wide, box[3] * share];
    if (wide >= whole[2]) box = [...whole];
    show();
  };
  svg.tabIndex = 0;
  svg.addEventListener("wheel", (e) => { if (e.ctrlKey || e.metaKey) { e.preventDefault(); zoom(e.deltaY > 0 ? 1.25 : 0.8, e.clientX, e.clientY); } }, { passive: false });
  svg.addEventListener("dblclick", (e) => (svg.classList.contains("zoomed") ? all() : zoom(0.33, e.clientX, e.clientY)));
  svg.addEventListener("pointerdown", (e) => { if (svg.classList.contains("zoomed")) { at = [e.clientX, e.clientY]; svg.setPointerCapture(e.pointerId); } });
  svg.addEventListener("pointermove", (e) => {
    if (!at) return;
    const frame = svg.getBoundingClientRect();
    box[0] -= (e.clientX - at[0]) / frame.width * box[2]; box[1] -= (e.clientY - at[1]) / frame.height * box[3];
    at = [e.clientX, e.clientY];
    show();
  });
  svg.addEventListener("pointerup", () => { at = null; });
  svg.addEventListener("keydown", (e) => { if (e.key === "+") zoom(0.8); else if (e.key === "-") zoom(1.25); else if (e.key === "Escape") all(); });
  window.addEventListener("beforeprint", all);
}
const within = (a) => { const row = a?.closest("ol"); if (row && row.scrollWidth > row.clientWidth) row.scrollLeft = a.offsetLeft - row.offsetLeft - 20; };
const links = new Map([...document.querySelectorAll("nav a")].map((a) => [a.hash.slice(1), a]));
const seen = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) if (isIntersecting) { for (const [id, a] of links) a.classList.toggle("here", id === target.id); within(links.get(target.id)); }
}, { rootMargin: "0px 0px -70% 0px" });
document.querySelectorAll("section").forEach((section) => seen.observe(section));

// Values: the pointer, or the arrows left and right, read the curves of the panel where they are, off the drawing itself.
const tip = document.body.appendChild(Object.assign(document.createElement("div"), { className: "tip", hidden: true }));
tip.setAttribute("role", "status");
const short = (v) => { const n = Number(v.toPrecision(4)), size = Math.abs(n); return (n && (size < 1e-3 || size >= 1e6) ? n.toExponential() : String(n)).replaceAll("-", "\u2212"); };
const POWERS = { p: -12, n: -9, "\u00b5": -6, m: -3, "": 0, k: 3, M: 6, G: 9 };
function united(value, unit) { // in the prefix that keeps the number short; no kilometers, kiloseconds
  const [, prefix, base, rest] = /^([pn\u00b5mkMG]?)(m|s|N|J|V|Pa|rad|W|A|Hz)((?:[ /].*)?)$/.exec(unit) ?? [];
  if (!base || !value) return `${short(value)}${unit ? ` ${unit}` : ""}`;
  const si = value * 10 ** POWERS[prefix], known = Object.entries(POWERS).filter(([, power]) => power <= 0 || !["m", "s", "rad", "V"].includes(base)).reverse();
  const [best, power] = known.find(([, p]) => Math.abs(si) >= 0.5 * 10 ** p) ?? known.at(-1);
  return `${short(si / 10 ** power)} ${best}${base}${rest}`;
}
function valued(scale, share) {
  const [a, b] = scale.ends;
  if (scale.kind === "log") return a * (b / a) ** share;
  if (scale.kind === "asinh") { const [p, q] = [Math.asinh(a / scale.width), Math.asinh(b / scale.width)]; return scale.width * Math.sinh(p + (q - p) * share); }
  return a + (b - a) * share;
}
function drawn(scale, value) { // no finer than a drawing shows
  if (!scale.ends) return value;
  if (scale.kind) return Number(value.toPrecision(3));
  const grain = 10 ** Math.floor(Math.log10(Math.abs(scale.ends[1] - scale.ends[0]) / 2000));
  return Math.round(value / grain) * grain;
}
function said(scale, value, label = scale.label) {
  const [, name, unit] = /^(.*?)(?: \(([^()]*)\))?(?:, .*)?$/.exec(label) ?? ["", label, ""];
  const word = scale?.words?.reduce((p, q) => (Math.abs(q[0] - value) < Math.abs(p[0] - value) ? q : p))[1];
  return `${name ? `${name} = ` : ""}${word ?? united(drawn(scale, value), unit ?? "")}`;
}
function points(element) { // of a line, null where it is interrupted; of single marks, each between interruptions
  const line = [...element.querySelectorAll("path")].find((path) => !path.closest("defs"));
  if (!line) return [...element.querySelectorAll("use")].flatMap((use) => [[Number(use.getAttribute("x")), Number(use.getAttribute("y"))], null]);
  return [...(line.getAttribute("d") ?? "").matchAll(/([ML])\s*([-\d.e]+)[ ,]+([-\d.e]+)/g)].flatMap(([, kind, x, y]) => (kind === "M" ? [null, [Number(x), Number(y)]] : [[Number(x), Number(y)]]));
}
function read(svg) {
  const panels = JSON.parse(svg.dataset.axes), known = new Map(), name = svg.dataset.name ?? svg.getAttribute("aria-label");
  for (const panel of panels) { // panels that share an axis have its name once
    panel.x.label ||= panels.find((p) => p.x.label && p.box[0] === panel.box[0] && String(p.x.ends) === String(panel.x.ends))?.x.label ?? "";
    panel.y.label ||= panels.find((p) => p.y.label && p.box[1] === panel.box[1] && String(p.y.ends) === String(panel.y.ends))?.y.label ?? panel.title;
  }
  let at = null, home = svg; // a place in the drawing as it was drawn, and the group that holds it
  const mark = document.createElementNS(NS, "circle");
  mark.setAttribute("class", "reading");
  const curves = (panel) => {
    if (!known.has(panel)) {
      known.set(panel, panel.lines.flatMap(([id, label]) => {
        const element = document.getElementById(`${name}-${id}`), all = element ? points(element) : [];
        const real = all.filter(Boolean), rising = real.length > 2 && real.length === all.length - 1 && real.every((p, i) => !i || p[0] >= real[i - 1][0]);
        const color = element && getComputedStyle(element.querySelector("path:not(defs path), use") ?? element);
        return label || (real.length > 2 && panel.lines.every((each) => !each[1])) ? [{ label, all, rising, color: color && (color.stroke === "none" ? color.fill : color.stroke) }] : [];
      }));
    }
    return known.get(panel);
  };
  const inside = ([x, y, wide, high], p) => p[0] >= x - 1 && p[0] <= x + wide + 1 && p[1] >= y - 1 && p[1] <= y + high + 1;
  const value = (panel, which, p) => { const [x, y, wide, high] = panel.box; return valued(panel[which], which === "x" ? (p[0] - x) / wide : 1 - (p[1] - y) / high); };
  const nearest = (curve, box, [x, y]) => {
    let best = null;
    const take = (p) => { const far = Math.hypot(p[0] - x, p[1] - y); if (inside(box, p) && (!best || far < best.far)) best = { p, far, curve }; };
    curve.all.forEach((q, i) => {
      if (!q) return;
      const p = curve.all[i - 1];
      if (!p) return take(q);
      const [dx, dy] = [q[0] - p[0], q[1] - p[1]], long = dx * dx + dy * dy, s = long ? Math.min(1, Math.max(0, ((x - p[0]) * dx + (y - p[1]) * dy) / long)) : 0;
      take([p[0] + s * dx, p[1] + s * dy]);
    });
    return best;
  };
  const crossing = (curve, box, x, y) => {
    const found = curve.all.findIndex((p, i) => p && i && curve.all[i - 1] && curve.all[i - 1][0] <= x && p[0] >= x);
    if (found < 0) return null;
    const [p, q] = [curve.all[found - 1], curve.all[found]], s = q[0] > p[0] ? (x - p[0]) / (q[0] - p[0]) : 0, here = [x, p[1] + s * (q[1] - p[1])];
    return inside(box, here) ? { p: here, far: Math.abs(here[1] - y), curve } : null;
  };
  const lines = (panel, p) => {
    const own = curves(panel).flatMap((curve) => (curve.rising ? crossing(curve, panel.box, ...p) : nearest(curve, panel.box, p)) ?? []).sort((a, b) => a.far - b.far);
    if (!own.length) return { words: [[said(panel.x, value(panel, "x", p))], [said(panel.y, value(panel, "y", p))]] };
    const rows = own[0].curve.rising ? own.filter((each) => each.curve.rising).slice(0, 8) : own.slice(0, 1), many = curves(panel).length > 1;
    const words = rows.map((each) => [many && each.curve.label ? `${each.curve.label}: ${said(panel.y, value(panel, "y", each.p)).split(" = ").pop()}` : said(panel.y, value(panel, "y", each.p)), many ? each.curve.color : ""]);
    return { words: [[said(panel.x, value(panel, "x", own[0].p))], ...words], mark: own[0] };
  };
  const show = (x, y) => {
    const panel = panels.find((each) => inside(each.box, at)), place = panel?.cells && cellAt(panel, at);
    if (!panel) return hide();
    const found = place ? { words: [[said({}, place.x, panel.x.label)], [said({}, place.y, panel.y.label)], [place.value === null ? "nothing to show" : said({}, place.value, panel.title)]] } : lines(panel, at);
    mark.remove();
    if (found.mark) {
      mark.setAttribute("cx", found.mark.p[0]); mark.setAttribute("cy", found.mark.p[1]); mark.setAttribute("r", 3);
      mark.style.stroke = found.mark.curve.color;
      home.append(mark);
    }
    tip.replaceChildren(...found.words.map(([text, color]) => {
      const row = Object.assign(document.createElement("div"), { textContent: text });
      if (color) row.style.borderLeft = `3px solid ${color}`;
      return row;
    }));
    tip.hidden = false;
    tip.style.left = `${Math.max(4, Math.min(x + 14, innerWidth - tip.offsetWidth - 8))}px`;
    tip.style.top = `${y + tip.offsetHeight + 24 > innerHeight ? y - tip.offsetHeight - 10 : y + 14}px`;
  };
  const hide = () => { tip.hidden = true; mark.remove(); };
  const over = (e) => {
    const p = new DOMPoint(e.clientX, e.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const { group, share, dx, dy } = moved.get(svg)?.find(({ until }) => p.y < until) ?? { group: svg, share: 1, dx: 0, dy: 0 };
    home = group;
    at = [(p.x - dx) / share, p.y - dy];
    show(e.clientX, e.clientY);
  };
  svg.addEventListener("pointermove", over);
  svg.addEventListener("pointerdown", over);
  svg.addEventListener("pointerleave", (e) => { if (e.pointerType !== "touch") hide(); });
  svg.addEventListener("blur", hide);
  svg.addEventListener("keydown", (e) => {
    if (e.key === "Escape") return hide();
    const way = { ArrowLeft: -1, ArrowRight: 1 }[e.key];
    if (!way) return;
    e.preventDefault();
    let k = at ? panels.findIndex((each) => inside(each.box, at)) : -1;
    if (k < 0) { k = 0; at = [panels[0].box[0], panels[0].box[1] + panels[0].box[3] / 2]; }
    at[0] += way * panels[k].box[2] / 50;
    if (!inside(panels[k].box, at)) {
      const [x, y, wide, high] = panels[(k + way + panels.length) % panels.length].box;
      at = [way > 0 ? x : x + wide, y + high / 2];
    }
    const p = new DOMPoint(...at).matrixTransform(svg.getScreenCTM());
    show(p.x, p.y);
  });
  window.addEventListener("beforeprint", hide);
}
function cellAt({ box: [x, y, wide, high], cells, ...panel }, p) { // of a map: where, which in its order, and its value
  const find = (edges, value) => edges.findIndex((edge, i) => i && (value - edges[i - 1]) * (value - edge) <= 0) - 1;
  const middle = (scale, [a, b]) => (scale.kind === "log" ? Math.sqrt(a * b) : (a + b) / 2);
  const [i, j] = [find(cells.x, valued(panel.x, (p[0] - x) / wide)), find(cells.y, valued(panel.y, 1 - (p[1] - y) / high))];
  if (i < 0 || j < 0) return null;
  const n = j * (cells.x.length - 1) + i;
  return { n, x: middle(panel.x, cells.x.slice(i, i + 2)), y: middle(panel.y, cells.y.slice(j, j + 2)), value: cells.values[n] };
}
document.querySelectorAll("figure svg[data-axes]").forEach(read);
