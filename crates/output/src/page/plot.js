// Plots of lines and points as SVG, with the values of the point under the pointer or the focus.

const SVG = "http://www.w3.org/2000/svg";

function svg(name, attributes = {}, parent = null, text = null) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== null) element.textContent = text;
  if (parent) parent.appendChild(element);
  return element;
}

/** A box with the values at a place; it is hidden until `tell` shows it. */
function tipIn(host) {
  return Object.assign(element("div", host, null, "tip"), { hidden: true });
}

/** Shows a text in a tip; `corner` gives the upper left corner for its width and height. */
function tell(tip, text, corner) {
  Object.assign(tip, { hidden: false, textContent: text });
  const [left, top] = corner(tip.offsetWidth, tip.offsetHeight);
  Object.assign(tip.style, { left: `${left}px`, top: `${top}px` });
}

/**
 * A plot in `host`: `x` and `y` are { name, log }, a series is { name, colour, points: [[x, y, text]], line, marks, dash }.
 * Returns an object whose `mark(x)` draws a line at x, and whose `show(series)` shows other series.
 */
function plotted(host, { label, x, y, series, height = 300 }) {
  const box = element("div", host, null, "plot"),
    tip = tipIn(box),
    state = { at: null, series };
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
  const drawing = svg("svg", { viewBox: `0 0 ${width} ${height}`, height, role: "img", "aria-label": label }, box),
    [left, right, top, bottom] = [64, width - 14, 14, height - 46];
  const finite = state.series.flatMap(({ points }) => points).filter(([a, b]) => usable(a, x) && usable(b, y)),
    across = axis(finite, 0, x, left, right, Math.max(3, width / 110)),
    up = axis(finite, 1, y, bottom, top, 6);
  const rule = (x1, x2, y1, y2, look) => svg("line", { x1, x2, y1, y2, ...look }, drawing),
    words = (text, anchor, place) => svg("text", { ...place, "text-anchor": anchor }, drawing, text);
  for (const tick of across.ticks) {
    rule(across.at(tick), across.at(tick), top, bottom, { stroke: "var(--grid)" });
    words(across.text(tick), "middle", { x: across.at(tick), y: bottom + 16 });
  }
  for (const tick of up.ticks) {
    rule(left, right, up.at(tick), up.at(tick), { stroke: "var(--grid)" });
    words(up.text(tick), "end", { x: left - 6, y: up.at(tick) + 4 });
  }
  words(x.name, "middle", { x: (left + right) / 2, y: height - 10 });
  words(y.name, "middle", { transform: `translate(13 ${(top + bottom) / 2}) rotate(-90)` });
  const hide = () => {
    tip.hidden = true;
  };
  const show = ({ x, y, text }) =>
    tell(tip, text, (wide, high) => [clamped(x + 10, 0, width - wide - 4), Math.max(0, y - high - 8)]);
  const places = state.series.flatMap(one => drawSeries(drawing, one, { x, y, across, up, show, hide }));
  const line = rule(left, left, top, bottom, { stroke: "var(--closed)", "stroke-width": 1.5 });
  state.move = () => {
    const seen = state.at !== null && usable(state.at, x);
    if (seen) ["x1", "x2"].forEach(name => line.setAttribute(name, across.at(state.at)));
    line.setAttribute("visibility", seen ? "visible" : "hidden");
  };
  state.move();
  drawing.addEventListener("pointermove", ({ clientX, clientY }) => {
    const frame = drawing.getBoundingClientRect(),
      away = place => Math.hypot(frame.left + place.x - clientX, frame.top + place.y - clientY);
    const [near] = places.filter(place => away(place) < 24).sort((a, b) => away(a) - away(b));
    if (near) show(near);
    else hide();
  });
  drawing.addEventListener("pointerleave", hide);
}

/** Draws a series, and returns the places of its points. */
function drawSeries(drawing, one, { x, y, across, up, show, hide }) {
  const points = one.points.map(([a, b, text]) =>
    usable(a, x) && usable(b, y)
      ? { x: across.at(a), y: up.at(b), text: text ?? `${one.name}\n${shown(a)}, ${shown(b)}` }
      : null,
  );
  const steps = points.map((to, i) => to && `${points[i - 1] ? "L" : "M"}${to.x.toFixed(1)} ${to.y.toFixed(1)}`);
  if (one.line !== false) svg("path", { d: steps.join(""), fill: "none", ...strokeOf(one, 2) }, drawing);
  const places = points.filter(Boolean);
  for (const point of one.marks ? places : []) {
    const keys = one.focus ? { tabindex: 0, role: "img", "aria-label": point.text } : {},
      circle = svg("circle", { cx: point.x, cy: point.y, r: one.size ?? 4, ...dotOf(one, 1.5), ...keys }, drawing);
    circle.addEventListener("focus", () => show(point));
    circle.addEventListener("blur", hide);
  }
  return places;
}

/** The look of the line of a series, and of its points. */
function strokeOf({ colour, dash }, width) {
  return { stroke: colour, "stroke-width": width, "stroke-dasharray": dash ?? "none" };
}

function dotOf({ colour, hollow }, width) {
  return { fill: hollow ? "var(--paper)" : colour, stroke: colour, "stroke-width": width };
}

function usable(value, { log }) {
  return Number.isFinite(value) && (!log || value > 0);
}

/** Positions of one component of points on the screen, and the values with labels. */
function axis(points, component, { log }, from, to, most) {
  const of = log ? Math.log10 : value => value,
    [least, greatest] = rangeOf(points.map(point => of(point[component])));
  // Values that differ by rounding alone count as one value.
  const differs = greatest - least > 1e-9 * Math.max(Math.abs(least), Math.abs(greatest)),
    room = end => (differs ? 0.03 * (greatest - least) : log ? 0.5 : 0.5 * (Math.abs(end) || 1)),
    [low, high] = [least - room(least), greatest + room(greatest)];
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
  const entries = series.map(one => [
    one.name,
    ...(one.line === false ? [] : [["line", { x1: 1, x2: 19, y1: 10, y2: 10, ...strokeOf(one, 2.5) }]]),
    ...(one.marks ? [["circle", { cx: 10, cy: 10, r: 5, ...dotOf(one, 2) }]] : []),
  ]);
  legendOf(host, entries);
}

/** If a series has more points than this, its marks would hide its line. */
const MOST_MARKS = 60;

/**
 * The series of a plot of the data, as `plotted` takes them. Beside points that no line joins, only these have marks. `words` gives the
 * text of a point, for its name and values; a point with a text takes the focus. The series called `goal` is a dashed line.
 */
function seriesOf(series, colours, words) {
  const known = point => point?.every(Number.isFinite);
  const all = series.map(({ name, points: flat }, index) => {
    const points = Array.from({ length: flat.length / 2 }, (_, i) => [flat[2 * i], flat[2 * i + 1]]),
      line = points.length === 1 || points.some((point, i) => known(point) && known(points[i - 1]));
    if (name === "goal") return { name, points, line, colour: "var(--soft)", dash: "6 5" };
    const told = words ? points.map(point => [...point, words(name, point)]) : points;
    return { name, points: told, line, colour: colours.lines[index % colours.lines.length], focus: Boolean(words) };
  });
  const joined = all.every(({ line }) => line),
    marked = one => one.name !== "goal" && (!one.line || (joined && one.points.length <= MOST_MARKS));
  return all.map(one => ({ ...one, marks: marked(one) }));
}

/** Draws a plot of the data, with a key if it has several series and needs one; returns the plot. */
function dataPlot(host, { x, y, log, series }, colours, { label, key = true, words, height = 250 } = {}) {
  const all = seriesOf(series, colours, words),
    axes = [x, y].map((quantity, k) => ({ name: titled(quantity), log: log[k] })),
    plot = plotted(host, { label: label ?? `${y.name} over ${x.name}`, x: axes[0], y: axes[1], series: all, height });
  if (key && all.length > 1) keyOf(host, all);
  return plot;
}

/** Draws all plots of the data, neighbours with the same names over one key; returns a function that marks a position in each. */
function dataPlots(host, { plots, colours }) {
  const names = plot => plot?.series.map(({ name }) => name).join();
  const made = plots.map((plot, i) => dataPlot(host, plot, colours, { key: names(plots[i + 1]) !== names(plot) }));
  return at => made.forEach(plot => plot.mark(at));
}
