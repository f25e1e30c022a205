"use strict";
// The viewer of a report. All data stand in the page; lengths, times and values are in SI units and
// are shown with prefixes.

const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const { summary, frames: { quantities = [], frames = [], grid = null, notes = [] } } = data;

// Units ---------------------------------------------------------------------------------------------

const PREFIXES = [["G", 1e9], ["M", 1e6], ["k", 1e3], ["", 1], ["m", 1e-3], ["u", 1e-6], ["n", 1e-9]];
const PREFIXED = { "m": "kmun", "s": "mun", "Pa": "GMk", "J/kg": "Mk", "m/s": "k", "K": "k", "W": "GMk" };

/** The scale and the unit in which values up to `greatest` are short. */
function readable(unit, greatest) {
  const allowed = PREFIXED[unit];
  for (const [prefix, scale] of PREFIXES) {
    const known = prefix === "" || (allowed !== undefined && allowed.includes(prefix));
    if (known && greatest >= (prefix === "" || scale < 1 ? 1 : 10) * scale) return { scale, unit: prefix + unit };
  }
  return { scale: 1, unit };
}

const greatest = (values) => values.reduce((most, value) => (Math.abs(value) > most ? Math.abs(value) : most), 0);

/** A number with five digits. */
function short(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "-";
  const size = Math.abs(value);
  return size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(3) : String(+value.toPrecision(5));
}

function withUnit(value, unit) {
  const shown = readable(unit, Math.abs(value));
  return `${short(value / shown.scale)} ${shown.unit === "-" ? "" : shown.unit}`.trim();
}

const words = (name) => name.replaceAll("_", " ");

// Elements ------------------------------------------------------------------------------------------

function element(tag, text, parent) {
  const made = document.createElement(tag);
  if (text !== undefined) made.textContent = text;
  if (parent) parent.append(made);
  return made;
}

/** A table with a heading, unless it has no rows. */
function table(heading, head, rows) {
  if (rows.length === 0) return;
  const section = byId("tables");
  element("h2", heading, section);
  const wide = element("div", undefined, section);
  wide.className = "wide";
  const made = element("table", undefined, wide);
  const first = element("tr", undefined, element("thead", undefined, made));
  head.forEach((text) => element("th", text, first));
  const body = element("tbody", undefined, made);
  for (const row of rows) {
    const line = element("tr", undefined, body);
    row.forEach((cell) => element("td", typeof cell === "number" ? short(cell) : cell ?? "-", line));
  }
}

function options(select, names) {
  names.forEach((name, k) => { element("option", words(name), select).value = k; });
}

// Arrays --------------------------------------------------------------------------------------------

function bytes(text) {
  const binary = atob(text);
  return Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
}
const floats = (text) => Array.from(new Float32Array(bytes(text).buffer));

/** Values of quantity `q` in a plane, NaN where there is no particle. */
function planeValues(frame, q) {
  const [low, high] = frame.ranges[q];
  const step = (high - low) / 65534;
  return Array.from(new Uint16Array(bytes(frame.values[q]).buffer), (v) => (v === 65535 ? NaN : low + v * step));
}

/** Positions of a curve with jumps, whose two points at a jump are moved apart by a rounding error. */
function increasing(x) {
  const step = 1e-12 * (x[x.length - 1] - x[0]);
  let last = -Infinity;
  return x.map((at) => { last = Math.max(at, last + step); return last; });
}

// Colours -------------------------------------------------------------------------------------------

const SEQUENTIAL = ["#26185f", "#005fa8", "#008f8a", "#54b24f", "#e3c42b", "#fff3b0"];
const DIVERGING = ["#0b3c8c", "#4a86d8", "#a9c8ee", "#dddddd", "#f2b795", "#d9603b", "#8a1a12"];
const rgb = (hex) => [1, 3, 5].map((k) => parseInt(hex.slice(k, k + 2), 16));

/** Range and colours of values: zero in the middle if both signs matter. */
function colours(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value < low) low = value;
    if (value > high) high = value;
  }
  if (!(low <= high)) [low, high] = [0, 1];
  const most = Math.max(-low, high);
  const diverging = low < 0 && high > 0 && Math.min(-low, high) > 0.05 * most;
  if (diverging) [low, high] = [-most, most];
  if (low === high) high = low + (Math.abs(low) || 1);
  const stops = (diverging ? DIVERGING : SEQUENTIAL).map(rgb);
  const at = (value) => {
    const place = Math.min(1, Math.max(0, (value - low) / (high - low))) * (stops.length - 1);
    const k = Math.min(stops.length - 2, Math.floor(place));
    return stops[k].map((c, d) => c + (stops[k + 1][d] - c) * (place - k));
  };
  return { low, high, at };
}

/** A bar of colours with three labels. */
function colourBar(parent, scale, unit) {
  const shown = readable(unit, Math.max(Math.abs(scale.low), Math.abs(scale.high)));
  const label = (value) => short(value / shown.scale);
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [180, 12];
  const pen = canvas.getContext("2d");
  for (let k = 0; k < 180; k++) {
    pen.fillStyle = `rgb(${scale.at(scale.low + (scale.high - scale.low) * k / 179).map(Math.round)})`;
    pen.fillRect(k, 0, 1, 12);
  }
  const middle = 0.5 * (scale.low + scale.high);
  element("span", label(scale.low), parent);
  parent.append(canvas);
  element("span", `${label(scale.high)} ${shown.unit} (middle: ${label(middle)})`, parent);
}

function swatch(parent, color, text) {
  const item = element("span", undefined, parent);
  element("i", undefined, item).style.background = color;
  item.append(text);
}

// Plots ---------------------------------------------------------------------------------------------

const WIDTH = () => Math.max(320, Math.min(1020, document.body.clientWidth - 20));

/** The axes of a plot: labels for x and y with units. */
function axes(labels) {
  return labels.map(([label, unit], d) => ({
    label: unit === "-" || unit === "" ? label : `${label} [${unit}]`,
    values: (plot, splits) => splits.map(short),
    space: d === 0 ? 70 : 40,
    size: d === 0 ? 34 : 66,
    labelSize: 22,
  }));
}

/** Room for the axes and the edge of a plot [pixels]. */
const ROOM = [66 + 22 + 12, 34 + 22 + 20];

/** A plot of curves over one axis, with dashed lines at the positions `marks`. `series`: {label, x, y,
 * color, line}. */
function curvePlot(place, readout, series, xName, yName, marks = []) {
  const xs = readable(xName.unit, greatest(series.flatMap((s) => s.x)));
  const ys = readable(yName.unit, greatest(series.flatMap((s) => s.y.filter(Number.isFinite))));
  const scaled = (values, scale) => values.map((value) => (Number.isFinite(value) ? value / scale : null));
  const joined = uPlot.join(series.map((s) => [scaled(s.x, xs.scale), scaled(s.y, ys.scale)]));
  const look = (s) => ({
    label: s.label,
    stroke: s.color,
    fill: s.line ? undefined : s.color,
    width: s.line ? 1.6 : 0,
    paths: s.line ? undefined : () => null,
    spanGaps: true,
    points: { show: !s.line, size: s.size ?? 4, width: 0, fill: s.color },
  });
  const show = (plot) => {
    const { left, idx } = plot.cursor;
    if (idx === null || idx === undefined || left < 0) { readout.textContent = "\u00a0"; return; }
    // the nearest value of each series, for positions differ between them
    const x = plot.data[0];
    const reach = 0.01 * (plot.scales.x.max - plot.scales.x.min);
    const near = (values) => {
      for (let away = 0; away < x.length; away++) {
        const sides = [idx - away, idx + away].filter((at) => Math.abs(x[at] - x[idx]) <= reach);
        if (sides.length === 0) return null;
        const at = sides.find((k) => values[k] !== null && values[k] !== undefined);
        if (at !== undefined) return values[at];
      }
      return null;
    };
    const known = (values, k) => values[k] !== null && values[k] !== undefined;
    const between = (values) => {
      let [low, high] = [idx, idx];
      while (low >= 0 && !known(values, low)) low--;
      while (high < x.length && !known(values, high)) high++;
      if (low < 0 || high >= x.length) return null;
      const share = high > low ? (x[idx] - x[low]) / (x[high] - x[low]) : 0;
      return values[low] + share * (values[high] - values[low]);
    };
    const parts = series.map((s, k) => [s.label, (s.line ? between : near)(plot.data[k + 1])]).filter(([, value]) => value !== null)
      .map(([label, value]) => `${label} ${short(value)}`);
    readout.textContent = `${xName.name} ${short(plot.data[0][idx])} ${xs.unit}: ${parts.join(", ")} ${ys.unit}`;
  };
  const dashed = (plot) => {
    const { ctx: pen, bbox } = plot;
    pen.save();
    pen.strokeStyle = "#555";
    pen.setLineDash([5, 4]);
    for (const at of marks) {
      const left = plot.valToPos(at / xs.scale, "x", true);
      if (left < bbox.left || left > bbox.left + bbox.width) continue;
      pen.beginPath();
      pen.moveTo(left, bbox.top);
      pen.lineTo(left, bbox.top + bbox.height);
      pen.stroke();
    }
    pen.restore();
  };
  place.replaceChildren();
  return new uPlot({
    width: WIDTH(),
    height: 400,
    scales: { x: { time: false } },
    axes: axes([[xName.name, xs.unit], [yName.name, ys.unit]]),
    series: [{}, ...series.map(look)],
    cursor: { drag: { x: true, y: true, uni: 12 }, points: { show: false } },
    hooks: { draw: [dashed], setCursor: [show] },
  }, joined, place);
}

/** A picture of cells that zooms. `cells`: {lower, cell, count, values, body, failed}. */
function mapPlot(place, readout, cells, scale, names) {
  const { lower, cell, count, values } = cells;
  const upper = [0, 1].map((d) => lower[d] + cell[d] * count[d]);
  const unit = names.map((name, d) => readable(name.unit, Math.max(Math.abs(lower[d]), Math.abs(upper[d]))));
  const image = document.createElement("canvas");
  [image.width, image.height] = count;
  const pixels = image.getContext("2d").createImageData(...count);
  values.forEach((value, k) => {
    if (Number.isNaN(value)) return;
    const row = count[1] - 1 - Math.floor(k / count[0]);
    pixels.data.set([...scale.at(value), 255], 4 * (row * count[0] + k % count[0]));
  });
  image.getContext("2d").putImageData(pixels, 0, 0);
  const [x0, x1, y0, y1] = [lower[0], upper[0], lower[1], upper[1]];
  const inUnits = (value, d) => value / unit[d].scale;
  const draw = (plot) => {
    const { ctx: pen, bbox } = plot;
    const px = (x) => plot.valToPos(inUnits(x, 0), "x", true);
    const py = (y) => plot.valToPos(inUnits(y, 1), "y", true);
    pen.save();
    pen.beginPath();
    pen.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    pen.clip();
    pen.imageSmoothingEnabled = false;
    pen.drawImage(image, px(x0), py(y1), px(x1) - px(x0), py(y0) - py(y1));
    if (cells.body) drawMarks(pen, cells, px, py);
    pen.restore();
  };
  const show = (plot) => {
    const { left, top } = plot.cursor;
    if (left === undefined || left < 0) { readout.textContent = "\u00a0"; return; }
    const at = [plot.posToVal(left, "x") * unit[0].scale, plot.posToVal(top, "y") * unit[1].scale];
    const place = at.map((value, d) => Math.floor((value - lower[d]) / cell[d]));
    const inside = place.every((k, d) => k >= 0 && k < count[d]);
    const k = place[1] * count[0] + place[0];
    const texts = at.map((value, d) => `${names[d].name} ${short(value / unit[d].scale)} ${unit[d].unit}`);
    const known = inside && !Number.isNaN(values[k]);
    const body = known && cells.body ? data.bodies[cells.body[k]] : undefined;
    const value = known ? `${names[2].name} ${withUnit(values[k], names[2].unit)}` : "no particle";
    readout.textContent = [...texts, value, ...(body ? [`${body.name}, ${body.material}`] : [])].join(", ");
  };
  let [width, height] = [WIDTH() - ROOM[0], 420];
  if (names[2].equal) {
    const ratio = (upper[1] - lower[1]) / (upper[0] - lower[0]);
    height = Math.max(120, Math.min(640, ratio * width));
    width = Math.min(width, Math.max(200, height / ratio));
  }
  place.replaceChildren();
  const range = (from, to, d) => (plot, low, high) => (low === null || low === high ? [inUnits(from, d), inUnits(to, d)] : [low, high]);
  return new uPlot({
    width: width + ROOM[0],
    height: height + ROOM[1],
    scales: { x: { time: false, range: range(x0, x1, 0) }, y: { range: range(y0, y1, 1) } },
    axes: axes([0, 1].map((d) => [names[d].name, unit[d].unit])),
    series: [{}, { paths: () => null, points: { show: false } }],
    cursor: { drag: { x: true, y: true, uni: 12 }, points: { show: false } },
    hooks: { draw: [draw], setCursor: [show] },
  }, [[inUnits(x0, 0), inUnits(x1, 0)], [inUnits(y0, 1), inUnits(y1, 1)]], place);
}

/** Lines between bodies, and crosses on failed cells. */
function drawMarks(pen, { lower, cell, count, body, failed }, px, py) {
  const x = (i) => px(lower[0] + i * cell[0]);
  const y = (j) => py(lower[1] + j * cell[1]);
  pen.strokeStyle = "#000";
  pen.lineWidth = 1.2;
  pen.beginPath();
  for (let j = 0; j < count[1]; j++) {
    for (let i = 0; i < count[0]; i++) {
      const own = body[j * count[0] + i];
      if (own === 255) continue;
      const right = i + 1 < count[0] ? body[j * count[0] + i + 1] : own;
      const above = j + 1 < count[1] ? body[(j + 1) * count[0] + i] : own;
      if (right !== own && right !== 255) { pen.moveTo(x(i + 1), y(j)); pen.lineTo(x(i + 1), y(j + 1)); }
      if (above !== own && above !== 255) { pen.moveTo(x(i), y(j + 1)); pen.lineTo(x(i + 1), y(j + 1)); }
    }
  }
  pen.stroke();
  if (!failed) return;
  pen.strokeStyle = "#e0007a";
  pen.beginPath();
  // one cross per eight pixels at most
  const step = [0, 1].map((d) => Math.max(1, Math.round(8 / Math.abs(d === 0 ? x(1) - x(0) : y(1) - y(0)))));
  for (let j = 0; j < count[1]; j += step[1]) {
    for (let i = 0; i < count[0]; i += step[0]) {
      if (!failed[j * count[0] + i]) continue;
      const [cx, cy] = [x(i + 0.5), y(j + 0.5)];
      pen.moveTo(cx - 3, cy - 3); pen.lineTo(cx + 3, cy + 3);
      pen.moveTo(cx - 3, cy + 3); pen.lineTo(cx + 3, cy - 3);
    }
  }
  pen.stroke();
}

// Frames --------------------------------------------------------------------------------------------

/** The materials of the scene, each once. */
const materials = [...new Map(data.bodies.map((body) => [body.material, body.color]))];

function showLine(frame, q) {
  const { name, unit } = quantities[q];
  const [x, values, body] = [floats(frame.x), floats(frame.values[q]), bytes(frame.body)];
  const failed = frame.failed ? bytes(frame.failed) : null;
  const series = materials.map(([material, color]) => {
    const rows = x.map((_, k) => k).filter((k) => data.bodies[body[k]]?.material === material);
    return { label: material, x: rows.map((k) => x[k]), y: rows.map((k) => values[k]), color };
  });
  const exact = data.exact.find((curve) => Math.abs(curve.time - frame.time) <= 1e-9 * Math.abs(frame.time));
  if (exact && exact.values[name]) {
    series.push({ label: "exact", x: increasing(exact.x), y: exact.values[name], color: "#d81040", line: true });
  }
  if (failed) {
    const rows = x.map((_, k) => k).filter((k) => failed[k]);
    series.push({ label: "failed", x: rows.map((k) => x[k]), y: rows.map((k) => values[k]), color: "#e0007a", size: 7 });
  }
  const named = [{ name: "position", unit: "m" }, { name: words(name), unit }];
  const between = x.map((at, k) => (k > 0 && body[k] !== body[k - 1] ? 0.5 * (at + x[k - 1]) : NaN)).filter(Number.isFinite);
  curvePlot(byId("frame-plot"), byId("frame-values"), series.filter((s) => s.x.length > 0), ...named, between);
  const legend = byId("frame-legend");
  series.filter((s) => s.x.length > 0).forEach((s) => swatch(legend, s.color, s.label));
  if (between.length > 0) legend.append("dashed: interfaces");
}

/** The bodies of a plane in the colours of their materials. */
function showMaterials(frame) {
  const body = bytes(frame.body);
  const values = Array.from(body, (k) => (k === 255 ? NaN : k));
  const colors = data.bodies.map(({ color }) => rgb(color));
  const cells = { ...grid, values, body, failed: frame.failed ? bytes(frame.failed) : null };
  const names = [{ name: "x", unit: "m" }, { name: "y", unit: "m" }, { name: "body number", unit: "", equal: true }];
  mapPlot(byId("frame-plot"), byId("frame-values"), cells, { at: (k) => colors[k] ?? [0, 0, 0] }, names);
  materials.forEach(([material, color]) => swatch(byId("frame-legend"), color, material));
  if (frame.failed) byId("frame-legend").append("crosses: failed");
}

function showPlane(frame, q) {
  if (q === quantities.length) { showMaterials(frame); return; }
  const { name, unit } = quantities[q];
  const values = planeValues(frame, q);
  const scale = colours(values);
  const cells = { ...grid, values, body: bytes(frame.body), failed: frame.failed ? bytes(frame.failed) : null };
  const names = [{ name: "x", unit: "m" }, { name: "y", unit: "m" }, { name: words(name), unit, equal: true }];
  mapPlot(byId("frame-plot"), byId("frame-values"), cells, scale, names);
  const legend = byId("frame-legend");
  colourBar(legend, scale, unit);
  legend.append("black lines: interfaces");
  if (frame.failed) legend.append("crosses: failed");
}

function showFrame() {
  const [q, frame] = [Number(byId("quantity").value), frames[Number(byId("time").value)]];
  byId("frame-legend").replaceChildren();
  byId("time-text").textContent = `${withUnit(frame.time, "s")}, frame ${Number(byId("time").value) + 1} of ${frames.length}`;
  if (grid) showPlane(frame, q); else showLine(frame, q);
}

/** A quantity of all frames over position and time. */
function showPositionTime() {
  const q = Number(byId("quantity").value);
  const xs = frames.map((frame) => floats(frame.x));
  const low = Math.min(...xs.map((x) => x[0]));
  const high = Math.max(...xs.map((x) => x[x.length - 1]));
  const columns = Math.min(400, xs[0].length);
  const cell = [(high - low) / columns, (frames[frames.length - 1].time - frames[0].time) / (frames.length - 1)];
  const values = new Array(columns * frames.length).fill(NaN);
  frames.forEach((frame, row) => {
    const [sums, counts] = [new Float64Array(columns), new Float64Array(columns)];
    floats(frame.values[q]).forEach((value, k) => {
      const column = Math.min(columns - 1, Math.floor((xs[row][k] - low) / cell[0]));
      if (Number.isFinite(value)) { sums[column] += value; counts[column] += 1; }
    });
    for (let k = 0; k < columns; k++) if (counts[k] > 0) values[row * columns + k] = sums[k] / counts[k];
  });
  const scale = colours(values);
  const { name, unit } = quantities[q];
  const names = [{ name: "position", unit: "m" }, { name: "time", unit: "s" }, { name: words(name), unit }];
  const cells = { lower: [low, frames[0].time - 0.5 * cell[1]], cell, count: [columns, frames.length], values };
  mapPlot(byId("x-t-plot"), byId("x-t-values"), cells, scale, names);
  byId("x-t-legend").replaceChildren();
  colourBar(byId("x-t-legend"), scale, unit);
}

/** Frames that make a picture over position and time. */
const FEWEST_ROWS = 8;

function startFrames() {
  if (frames.length === 0 || quantities.length === 0) return;
  byId("frames").hidden = false;
  options(byId("quantity"), [...quantities.map((quantity) => quantity.name), ...(grid ? ["materials"] : [])]);
  const slider = byId("time");
  slider.max = frames.length - 1;
  slider.value = frames.length - 1;
  slider.addEventListener("input", showFrame);
  const over = grid === null && frames.length >= FEWEST_ROWS;
  byId("x-t").hidden = !over;
  byId("quantity").addEventListener("change", () => { showFrame(); if (over) showPositionTime(); });
  let playing = null;
  const stop = () => { clearInterval(playing); playing = null; byId("play").textContent = "Play"; };
  byId("play").addEventListener("click", () => {
    if (playing !== null) { stop(); return; }
    if (Number(slider.value) === frames.length - 1) slider.value = 0;
    byId("play").textContent = "Stop";
    playing = setInterval(() => {
      if (Number(slider.value) >= frames.length - 1) { stop(); return; }
      slider.value = Number(slider.value) + 1;
      showFrame();
    }, 150);
  });
  notes.forEach((note) => element("li", note, byId("frame-notes")));
  showFrame();
  if (over) showPositionTime();
}

// Histories -----------------------------------------------------------------------------------------

/** SI unit of a column of the histories, from its name. */
function historyUnit(name) {
  const units = { dt: "s", pressure: "Pa", velocity: "m/s", position: "m", displacement: "m", time: "s", temperature: "K" };
  return Object.entries(units).find(([end]) => name === end || name.endsWith(`_${end}`) || name.endsWith(`${end}_x`))?.[1] ?? "";
}

function startHistories() {
  const names = Object.keys(data.histories).filter((name) => name !== "time");
  if (names.length === 0 || data.histories.time === undefined) return;
  byId("histories").hidden = false;
  options(byId("history"), names);
  // a pressure or velocity that is not zero first
  const telling = (name) => /pressure|velocity/.test(name) && data.histories[name].some((value) => Math.abs(value ?? 0) > 0);
  byId("history").value = Math.max(0, names.findIndex(telling));
  const show = () => {
    const name = names[Number(byId("history").value)];
    const [x, y] = [data.histories.time, data.histories[name].map((value) => value ?? NaN)];
    const series = [{ label: words(name), x, y, color: "#1f6fb4", line: true }];
    curvePlot(byId("history-plot"), byId("history-values"), series, { name: "time", unit: "s" }, { name: words(name), unit: historyUnit(name) });
  };
  byId("history").addEventListener("change", show);
  show();
}

// Texts and tables ----------------------------------------------------------------------------------

function startTexts() {
  const { scene } = summary;
  byId("title").textContent = summary.title;
  byId("description").textContent = scene.description ?? "";
  const method = summary.method_choice ? `, method ${typeof summary.method_choice === "string" ? summary.method_choice : summary.method_choice.preset ?? "chosen"}` : "";
  const transfer = scene.method?.transfer;
  const scheme = [scene.method?.shape, typeof transfer === "string" ? transfer : JSON.stringify(transfer)].filter(Boolean).join(", ");
  const build = [`flyer-mpm ${summary.version}`, summary.commit ? `commit ${summary.commit}` : "commit not recorded"];
  const machine = summary.machine ? [`on ${summary.machine}`] : [];
  const layout = `ranks ${summary.ranks}, threads ${summary.threads}, patches [${summary.patches.join(", ")}]`;
  const cost = `${summary.particles} particles, ${summary.steps} steps, ${short(summary.wall_seconds)} s`;
  byId("provenance").textContent = [...build, ...machine, `${scheme}${method}`, layout, cost, `scene ${(summary.origin?.file ?? "unknown").split("/").pop()}`].join("; ");
  summary.warnings.forEach((text) => element("li", `Warning: ${text}`, byId("warnings")));
  byId("scene").textContent = JSON.stringify(scene, null, 2);
}

function percent(value) {
  return typeof value === "number" ? `${short(100 * value)} %` : "-";
}

function startTables() {
  table("Measured quantities", ["quantity", "time", "computed", "exact", "difference"], (summary.measured ?? []).map((m) => {
    const exact = m.exact === undefined ? "-" : withUnit(m.exact, m.unit);
    return [m.name, withUnit(m.time, "s"), withUnit(m.value, m.unit), exact, m.exact ? percent(m.value / m.exact - 1) : "-"];
  }));
  const errors = summary.profiles.filter((profile) => profile.errors);
  const keys = [...new Set(errors.flatMap((profile) => Object.keys(profile.errors)))]
    .filter((key) => errors.some((profile) => typeof profile.errors[key] === "number"));
  table("Errors of the profiles", ["error", ...errors.map((profile) => withUnit(profile.time, "s"))],
    keys.map((key) => [words(key), ...errors.map((profile) => profile.errors[key] ?? "-")].map((v) => (typeof v === "object" ? "-" : v))));
  table("Gauges", ["gauge", "quantity", "value", "time"], (summary.gauges ?? []).map((g) =>
    [g.gauge, g.quantity, g.value === null || g.value === undefined ? "-" : withUnit(g.value, g.unit), g.time === null || g.time === undefined ? "-" : withUnit(g.time, "s")]));
  const { energy, momentum } = summary;
  const { lower, geometry } = summary.scene.domain;
  const per = lower.length === 1 ? "/m2" : geometry === "axisymmetric" ? "/rad" : "/m";
  table("Conservation", ["", "start", "end", "boundaries", "relative error"], [
    [`energy [J${per}]`, energy.total_start, energy.total_end, energy.boundary_work, energy.drift],
    ...momentum.start.map((start, k) => [
      `momentum${lower.length === 1 ? "" : ` along ${"xy"[k]}`} [kg m/s${per}]`,
      short(start), short(momentum.end[k]), short(momentum.boundary_impulse[k]), k === 0 ? momentum.drift : "",
    ]),
  ]);
  table("Effects", ["effect", "active", "bytes per particle", "bytes per ghost", "share of step"], summary.effects.map((e) =>
    [e.effect, e.active ? "yes" : "no", e.bytes_per_particle, e.bytes_per_ghost, e.active ? percent(e.step_share) : "-"]));
  table("Ranks", ["rank", "patches", "particles", "particle-steps", "CPU", "bytes sent", "messages"], (summary.decomposition?.ranks ?? []).slice(0, 64).map((r) =>
    [String(r.rank), r.patches, r.particles, r.particle_steps, withUnit(r.cpu_seconds, "s"), r.bytes, r.messages]));
  table("Time by activity, all ranks", ["activity", "seconds"], Object.entries(summary.phase_seconds));
}

function startPictures() {
  if (data.pictures.length === 0) return;
  byId("pictures").hidden = false;
  for (const [name, source] of data.pictures) {
    const image = element("img", undefined, byId("pictures"));
    image.src = source;
    image.alt = image.title = words(name);
    image.addEventListener("click", () => image.classList.toggle("full"));
  }
}

startTexts();
startTables();
startFrames();
startHistories();
startPictures();
