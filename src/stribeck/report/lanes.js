// Lanes of a sweep: what is clicked, or chosen by its number, is drawn below.
for (const place of document.querySelectorAll(".picked")) {
  const found = JSON.parse(place.nextElementSibling.textContent), lanes = Object.keys(found.curves).map(Number);
  const field = place.querySelector("input"), [said, drawn] = [place.querySelector("span"), place.querySelector("div")];
  const marks = [...document.querySelectorAll("figure [id*='lane-']")].map((e) => [Number(e.id.split("lane-").pop()), e]);
  const maps = [...document.querySelectorAll("figure svg[data-axes]")].map((svg) => [svg, JSON.parse(svg.dataset.axes).filter((panel) => panel.cells)]).filter(([, panels]) => panels.length);
  field.max = Math.max(...lanes, ...found.cells);
  const cell = new Map(found.cells.map((lane, n) => [lane, n])), wide = maps.length ? maps[0][1][0].cells.x.length - 1 : 1;
  const away = (a, b) => { // of lanes: in cells where there is a map
    if (!cell.has(a) || !cell.has(b)) return Math.abs(a - b);
    const [p, q] = [cell.get(a), cell.get(b)];
    return Math.hypot((p % wide) - (q % wide), Math.floor(p / wide) - Math.floor(q / wide));
  };
  if (lanes.length < found.cells.length) maps.forEach(([svg, panels]) => lanes.forEach((lane) => mark(svg, panels, cell.get(lane), "kept")));
  const show = (wanted) => {
    const lane = lanes.reduce((a, b) => (away(b, wanted) < away(a, wanted) ? b : a));
    for (const [n, e] of marks) e.classList.toggle("chosen", n === lane);
    maps.forEach(([svg, panels]) => { svg.querySelectorAll(".cell").forEach((e) => e.remove()); mark(svg, panels, cell.get(lane), "cell"); });
    field.value = lane;
    said.textContent = `${found.about[lane]}${lane === wanted ? "" : ` (lane ${lane}, the one kept here that is next to ${wanted}${cell.has(lane) ? ": dots mark those kept" : ""})`}`;
    drawn.innerHTML = found.columns.map((name, k) => chart(name, found.t, found.curves[lane][k], k)).join("");
    drawn.querySelectorAll("svg[data-axes]").forEach((svg) => { svg.tabIndex = 0; read(svg); });
  };
  for (const [n, e] of marks) {
    e.classList.add("lane");
    e.addEventListener("click", () => show(n));
    e.appendChild(document.createElementNS("http://www.w3.org/2000/svg", "title")).textContent = `lane ${n}: ${found.about[n] ?? ""}`;
  }
  for (const [svg, panels] of maps) {
    svg.classList.add("lane");
    svg.addEventListener("click", (e) => {
      const p = new DOMPoint(e.clientX, e.clientY).matrixTransform(svg.getScreenCTM().inverse());
      const place = panels.map((panel) => cellAt(panel, [p.x, p.y])).find(Boolean);
      if (place) show(found.cells[place.n]);
    });
  }
  field.oninput = () => { if (field.value !== "") show(Number(field.value)); };
  show(lanes[0]);
}
function mark(svg, panels, n, kind) { // in each map: the outline of a chosen lane's cell, a dot in that of one kept
  if (n === undefined) return;
  const share = (scale, value) => { const [a, b] = scale.ends; return scale.kind === "log" ? Math.log(value / a) / Math.log(b / a) : (value - a) / (b - a); };
  for (const { box: [x, y, wide, high], cells, x: across, y: up } of panels) {
    const rows = cells.x.length - 1, [i, j] = [n % rows, Math.floor(n / rows)];
    const [left, right] = [share(across, cells.x[i]), share(across, cells.x[i + 1])], [low, top] = [share(up, cells.y[j]), share(up, cells.y[j + 1])];
    const box = { x: x + left * wide, y: y + (1 - top) * high, width: (right - left) * wide, height: (top - low) * high };
    const dot = { cx: box.x + box.width / 2, cy: box.y + box.height / 2, r: 1.1 };
    const shape = document.createElementNS("http://www.w3.org/2000/svg", kind === "cell" ? "rect" : "circle");
    for (const [key, value] of Object.entries({ class: kind, ...(kind === "cell" ? box : dot) })) shape.setAttribute(key, value);
    svg.append(shape);
  }
}
function chart(name, t, x, k) { // with what the page's script reads values by
  const known = x.filter((v) => v !== null), [low, high] = [Math.min(...known), Math.max(...known)], end = t[t.length - 1] || 1;
  name = name.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
  const at = (v) => 8 + 104 * (high > low ? (high - v) / (high - low) : 0.5);
  let pen = "M";
  const line = x.map((v, i) => { if (v === null) { pen = "M"; return ""; } const p = `${pen}${(70 + 620 * t[i] / end).toFixed(1)} ${at(v).toFixed(1)}`; pen = "L"; return p; }).join("");
  const text = known.length ? `<text x="64" y="14" text-anchor="end">${short(high)}</text><text x="64" y="114" text-anchor="end">${short(low)}</text>` : "";
  const middle = high > low ? [low, high] : [low - 1, low + 1], panel = { box: [70, 8, 620, 104], title: "", x: { label: "t (s)", ends: [0, end] }, y: { label: name, ends: middle }, lines: [["line", ""]] };
  const told = known.length ? `data-axes="${JSON.stringify([panel]).replaceAll("&", "&amp;").replaceAll('"', "&quot;")}"` : "";
  return `<svg viewBox="0 0 700 136" role="img" aria-label="${name} against time" data-name="chart-${k}" ${told}><rect x="70" y="4" width="620" height="112"/>${text}<text x="70" y="131">0</text>`
    + `<text x="690" y="131" text-anchor="end">${short(end)} s</text><text x="380" y="131" text-anchor="middle">${name}</text><g id="chart-${k}-line"><path d="${line}"/></g></svg>`;
}
