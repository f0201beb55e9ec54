// Plots of lines and points as SVG, with the values of the point under the pointer or the focus.

const SVG = "http://www.w3.org/2000/svg";

function svg(name, attributes = {}, parent = null, text = null) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== null) element.textContent = text;
  if (parent) parent.appendChild(element);
  return element;
}

/**
 * A plot in `host`: `x` and `y` are { name, log }, a series is { name, colour, points: [[x, y, text]], line, marks, dash }.
 * Returns an object whose `mark(x)` draws a line at x.
 */
function plotted(host, { label, x, y, series, height = 300 }) {
  const box = host.appendChild(document.createElement("div"));
  box.className = "plot";
  const tip = box.appendChild(document.createElement("div"));
  tip.className = "tip";
  tip.hidden = true;
  const state = { at: null, series };
  const draw = () => {
    const width = box.clientWidth || 600;
    box.querySelector("svg")?.remove();
    drawnPlot(box, tip, { width, height: width < 480 ? 260 : height, label, x, y, state });
  };
  new ResizeObserver(draw).observe(box);
  return {
    mark: at => {
      state.at = at;
      state.move?.();
    },
    show: next => {
      state.series = next;
      draw();
    },
  };
}

function drawnPlot(box, tip, { width, height, label, x, y, state }) {
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": label }, box);
  const inner = { left: 64, right: width - 14, top: 14, bottom: height - 46 };
  const finite = state.series.flatMap(({ points }) => points).filter(([a, b]) => usable(a, x) && usable(b, y));
  const across = axis(
    finite.map(point => point[0]),
    x,
    inner.left,
    inner.right,
    Math.max(3, width / 110),
  );
  const up = axis(
    finite.map(point => point[1]),
    y,
    inner.bottom,
    inner.top,
    6,
  );
  for (const tick of across.ticks) {
    svg(
      "line",
      { x1: across.at(tick), x2: across.at(tick), y1: inner.top, y2: inner.bottom, stroke: "var(--grid)" },
      drawing,
    );
    svg("text", { x: across.at(tick), y: inner.bottom + 16, "text-anchor": "middle" }, drawing, across.text(tick));
  }
  for (const tick of up.ticks) {
    svg("line", { x1: inner.left, x2: inner.right, y1: up.at(tick), y2: up.at(tick), stroke: "var(--grid)" }, drawing);
    svg("text", { x: inner.left - 6, y: up.at(tick) + 4, "text-anchor": "end" }, drawing, up.text(tick));
  }
  svg("text", { x: (inner.left + inner.right) / 2, y: height - 10, "text-anchor": "middle" }, drawing, x.name);
  svg(
    "text",
    { transform: `translate(13 ${(inner.top + inner.bottom) / 2}) rotate(-90)`, "text-anchor": "middle" },
    drawing,
    y.name,
  );
  const places = [];
  for (const one of state.series) drawSeries(drawing, one, { x, y, across, up, places, width, tip });
  const line = svg(
    "line",
    { y1: inner.top, y2: inner.bottom, stroke: "var(--closed)", "stroke-width": 1.5, visibility: "hidden" },
    drawing,
  );
  state.move = () => {
    const seen = state.at !== null && usable(state.at, x);
    if (seen) ["x1", "x2"].forEach(name => line.setAttribute(name, across.at(state.at)));
    line.setAttribute("visibility", seen ? "visible" : "hidden");
  };
  state.move();
  drawing.addEventListener("pointermove", event => {
    const frame = drawing.getBoundingClientRect(),
      px = event.clientX - frame.left,
      py = event.clientY - frame.top;
    const near = places.reduce(
      (best, place) => {
        const away = Math.hypot(place.x - px, place.y - py);
        return away < best.away ? { ...place, away } : best;
      },
      { away: 24 },
    );
    tellAt(tip, near, width);
  });
  drawing.addEventListener("pointerleave", () => {
    tip.hidden = true;
  });
}

function drawSeries(drawing, one, { x, y, across, up, places, width, tip }) {
  const points = one.points.map(([a, b, text]) =>
    usable(a, x) && usable(b, y)
      ? { x: across.at(a), y: up.at(b), text: text ?? `${one.name}\n${shown(a)}, ${shown(b)}` }
      : null,
  );
  if (one.line !== false) {
    let path = "",
      pen = "M";
    for (const point of points) {
      if (point) path += `${pen}${point.x.toFixed(1)} ${point.y.toFixed(1)}`;
      pen = point ? "L" : "M";
    }
    svg(
      "path",
      { d: path, fill: "none", stroke: one.colour, "stroke-width": 2, "stroke-dasharray": one.dash ?? "none" },
      drawing,
    );
  }
  for (const point of points.filter(Boolean)) {
    places.push(point);
    if (!one.marks) continue;
    const circle = svg(
      "circle",
      {
        cx: point.x,
        cy: point.y,
        r: one.size ?? 4,
        fill: one.hollow ? "var(--paper)" : one.colour,
        stroke: one.colour,
        "stroke-width": 1.5,
      },
      drawing,
    );
    if (one.focus) {
      circle.setAttribute("tabindex", "0");
      circle.setAttribute("role", "img");
      circle.setAttribute("aria-label", point.text);
      circle.addEventListener("focus", () => tellAt(tip, { ...point, away: 0 }, width));
      circle.addEventListener("blur", () => {
        tip.hidden = true;
      });
    }
  }
}

function tellAt(tip, near, width) {
  tip.hidden = near.text === undefined;
  if (tip.hidden) return;
  tip.textContent = near.text;
  tip.style.left = `${Math.max(0, Math.min(near.x + 10, width - tip.offsetWidth - 4))}px`;
  tip.style.top = `${Math.max(0, near.y - tip.offsetHeight - 8)}px`;
}

function usable(value, { log }) {
  return Number.isFinite(value) && (!log || value > 0);
}

/** Positions of values on the screen, and the values with labels. */
function axis(values, { log }, from, to, most) {
  const of = log ? Math.log10 : value => value;
  let low = values.length ? Math.min(...values.map(of)) : 0,
    high = values.length ? Math.max(...values.map(of)) : 1;
  // Values that differ by rounding alone count as one value.
  if (!(high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high))))
    [low, high] = log
      ? [low - 0.5, high + 0.5]
      : [low - 0.5 * (Math.abs(low) || 1), high + 0.5 * (Math.abs(high) || 1)];
  else [low, high] = [low - 0.03 * (high - low), high + 0.03 * (high - low)];
  const at = value => from + ((of(value) - low) / (high - low)) * (to - from);
  if (!log) return { at, ticks: ticks(low, high, most), text: value => shown(value, 4) };
  const every = Math.max(1, Math.ceil((high - low) / most)),
    powers = [];
  for (let power = Math.ceil(low); power <= high; power++) if (power % every === 0) powers.push(10 ** power);
  if (powers.length < 2)
    return { at, ticks: ticks(10 ** low, 10 ** high, most).filter(value => value > 0), text: value => shown(value, 3) };
  return { at, ticks: powers, text: value => `1e${Math.round(Math.log10(value))}` };
}

/** The names of the series under a plot. */
function keyOf(host, series) {
  const key = host.appendChild(document.createElement("div"));
  key.className = "legend";
  for (const { name, colour, line, marks, dash, hollow } of series) {
    const entry = key.appendChild(document.createElement("span")),
      mark = svg("svg", { viewBox: "0 0 20 20" }, entry);
    if (line !== false)
      svg(
        "line",
        { x1: 1, x2: 19, y1: 10, y2: 10, stroke: colour, "stroke-width": 2.5, "stroke-dasharray": dash ?? "none" },
        mark,
      );
    if (marks)
      svg(
        "circle",
        { cx: 10, cy: 10, r: 5, fill: hollow ? "var(--paper)" : colour, stroke: colour, "stroke-width": 2 },
        mark,
      );
    entry.append(name);
  }
}
