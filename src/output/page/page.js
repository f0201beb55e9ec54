// Puts the page together.

/** Which frames set the colours of a series: more would take time and show nothing. */
const MOST_FRAMES = 24;

function evenly(list, most) {
  if (list.length <= most) return list;
  return Array.from({ length: most }, (_, i) => list[Math.floor((i * (list.length - 1)) / (most - 1))]);
}

/** The closed rows of an answer, of all rows a flag each. */
function flags(rows, count) {
  const closed = new Uint8Array(count);
  rows.forEach(row => {
    closed[row] = 1;
  });
  return closed;
}

/** The two states around a place, and the share of the upper one. */
function around(states, at) {
  const sign = states.at(-1).at >= states[0].at ? 1 : -1;
  let upper = states.findIndex(state => sign * (state.at - at) >= 0);
  if (upper < 0) upper = states.length - 1;
  const lower = Math.max(0, upper - 1),
    wide = states[upper].at - states[lower].at;
  return [states[lower], states[upper], wide === 0 ? 0 : Math.min(Math.max((at - states[lower].at) / wide, 0), 1)];
}

/** The one answer of a solve. */
function answerFrame(data) {
  const { contact, states } = data,
    rows = Array.from(contact.closed.keys());
  return {
    states: [states[0], states[0], 0],
    closed: contact.closed,
    proven: contact.proven,
    remaining: contact.remaining,
    rows,
    pressure: contact.pressure,
  };
}

/** The part of a list of closed rows that belongs to one answer. */
function closedAt({ starts, rows, values }, index) {
  return {
    rows: Array.from(rows.subarray(starts[index], starts[index + 1])),
    values: values.map(all => all.subarray(starts[index], starts[index + 1])),
  };
}

/** The exact answer at a gap: between two corners everything is linear. */
function exactFrame(data, gap) {
  const { corners, closed } = data.sweep,
    pieces = corners.length / 2,
    sign = corners.at(-1).gap >= corners[0].gap ? 1 : -1;
  let piece = 0;
  while (piece + 1 < pieces && sign * (gap - corners[2 * piece + 1].gap) > 0) piece++;
  const [from, to] = [corners[2 * piece], corners[2 * piece + 1]],
    wide = to.gap - from.gap;
  const share = wide === 0 ? 0 : Math.min(Math.max((gap - from.gap) / wide, 0), 1);
  const between = (a, b) => (share === 0 ? a : share === 1 ? b : a * (1 - share) + b * share);
  const {
      rows,
      values: [first, last],
    } = closedAt(closed, piece),
    pressure = Array.from(first, (value, i) => between(value, last[i]));
  return {
    states: around(data.states, gap),
    closed: flags(rows, data.rows.count),
    rows,
    pressure,
    at: gap,
    facts: {
      force: between(from.force, to.force),
      width: from.width,
      area: from.area,
      pressure_max: pressure.reduce((most, value) => Math.max(most, value), 0),
      count: rows.length,
    },
  };
}

/** The answer at a gap or force that was solved. */
function pointFrame(data, index) {
  const { points, closed } = data.sweep,
    point = points[index],
    {
      rows,
      values: [pressure],
    } = closedAt(closed, index);
  return {
    states: around(data.states, index),
    closed: flags(rows, data.rows.count),
    rows,
    pressure,
    at: point.force ?? point.gap,
    facts: point.contact,
    travel: point.travel,
  };
}

function motionFrame(data, index) {
  const {
      rows,
      values: [pressure],
    } = closedAt(data.motion.closed, index),
    state = data.states[index];
  return {
    states: [state, state, 0],
    closed: flags(rows, data.rows.count),
    rows,
    pressure,
    time: data.motion.times[state.at],
  };
}

/** A labelled range with what it says of its place. */
function slider(host, label, { min, max, step, value }, moved) {
  const line = element("div", host, null, "slider"),
    name = element("label", line, label);
  const range = Object.assign(element("input", line), { type: "range", min, max, step, value });
  range.id = `slider-${label.replace(/\W+/g, "-")}`;
  name.htmlFor = range.id;
  const told = element("output", line);
  told.setAttribute("for", range.id);
  range.addEventListener("input", () => moved(Number(range.value)));
  return { line, range, told };
}

function questionSection(page, data, shape, summary) {
  const own = section(page, "The question", "question"),
    { question, units } = data,
    box = element("div", own, null, "view");
  const loads = summary?.resultants?.find(resultant => resultant.of === "loads");
  const view = new View(box, shape, {
    table: data.colours.field.map(channels),
    label: "The body with its supports, loads and obstacles before anything has moved",
    paint: (view, brush) => {
      if (shape.flat)
        question.obstacles.forEach(obstacle => obstacle.outline && paintOutline(view, brush, obstacle, 0, false));
      paintSupports(view, brush, question, shape.dimension);
      paintLoads(view, brush, question.loads, loads, shape.dimension);
      paintGap(view, brush, data.rows, units.length, shape.dimension);
      paintScale(view, brush, units.length);
    },
  });
  addPatches(view, data);
  if (shape.flat) {
    const [low, high] = [[...shape.low], [...shape.high]];
    for (const { approach } of question.obstacles)
      for (let k = 0; k < 2; k++) (approach[k] < 0 ? low : high)[k] += 0.1 * shape.size * approach[k];
    view.window = [low, high];
  }
  const legend = element("div", own, null, "legend");
  const entry = (text, name, attributes) => {
    const span = element("span", legend);
    svg(name, attributes, svg("svg", { viewBox: "0 0 20 20" }, span));
    span.append(text);
  };
  if (question.fixed.length)
    entry("held in all directions", "rect", { x: 4, y: 4, width: 12, height: 12, fill: "var(--held)" });
  if (question.guided.vertices.length)
    entry("held across the plate", "rect", { x: 1, y: 8, width: 18, height: 4, fill: "var(--held)" });
  if (question.loads.vertices.length || question.loads.inside)
    entry("load", "path", {
      d: "M1 10H12M12 4 19 10 12 16Z",
      stroke: "var(--load)",
      "stroke-width": 2,
      fill: "var(--load)",
    });
  if (question.obstacles.some(obstacle => !obstacle.is_body))
    entry("obstacle", "rect", { x: 2, y: 4, width: 16, height: 12, fill: "var(--solid)" });
  list(own, [
    question.force === undefined
      ? [
          "gap",
          `${inUnit(question.gap, units.length)}: the shift of every obstacle along its approach direction, negative towards the body`,
        ]
      : ["pressing force", inUnit(question.force, units.force)],
    ...question.obstacles.map(({ boundary, approach, is_body }, index) => [
      `obstacles[${index}]`,
      `${is_body ? "another body" : "rigid"}, faces the boundary ${boundary} in the direction ${vectorShown(approach.slice(0, shape.dimension), "")}`,
    ]),
    ["loads", loads ? `${vectorShown(loads.force, units.force)} in all` : null],
    ["supports", supportWords(question)],
  ]);
  return view;
}

function supportWords({ fixed, guided }) {
  const parts = [];
  if (fixed.length) parts.push(`${counted(fixed.length, "node")} held in all directions`);
  if (guided.vertices.length) parts.push(`${counted(guided.vertices.length, "direction")} of nodes held`);
  return parts.length ? parts.join(", ") : "none";
}

/** Pressure along each obstacle of a plane body; returns what shows another frame. */
function profileSection(page, data, shape) {
  if (!data.rows?.count || shape.dimension !== 2) return () => {};
  const own = section(page, "Contact pressure along the boundary", "pressure"),
    { rows, units } = data;
  const plots = data.question.obstacles.map(({ approach }, obstacle) => {
    const axis = approach[0] !== 0 ? 1 : 0;
    const order = Array.from(rows.vertices.keys()).filter(row => rows.obstacles[row] === obstacle);
    order.sort((a, b) => shape.places[3 * rows.vertices[a] + axis] - shape.places[3 * rows.vertices[b] + axis]);
    if (!order.length) return () => {};
    const place = row => shape.places[3 * rows.vertices[row] + axis];
    const several = data.pressures?.map((pressure, method) => ({
      name: data.report.methods[method].method,
      colour: data.colours.lines[method],
      dash: ["none", "7 4", "2 4"][method],
      points: order.map(row => [place(row), pressure[row]]),
    }));
    const series = frame => {
      if (several) return several;
      const by = new Map(frame.rows.map((row, i) => [row, frame.pressure[i]]));
      return [
        {
          name: "pressure",
          colour: "var(--accent)",
          marks: true,
          size: 3,
          points: order.map(row => [place(row), by.get(row) ?? 0]),
        },
      ];
    };
    const name = data.question.obstacles.length > 1 ? `, obstacles[${obstacle}]` : "";
    const made = plotted(own, {
      label: `Contact pressure along the boundary${name}`,
      x: { name: `${["x", "y"][axis]} [${units.length}]` },
      y: { name: `pressure${name} [${units.pressure}]` },
      series: several ?? [],
      height: 260,
    });
    if (several) keyOf(own, several);
    return frame => made.show(series(frame));
  });
  return frame => plots.forEach(show => show(frame));
}

/** A sweep: at every gap where the path is exact, at the points that were solved elsewhere. */
function sweepSection(page, data, shape, notes) {
  const { sweep, units } = data,
    { points, events, corners } = sweep,
    exact = corners.length > 0,
    ofForces = sweep.swept === "force";
  const own = section(page, exact ? "The answer at every gap" : `The answers at the ${sweep.swept}s`, "answer");
  const frames = exact
    ? data.states.map(state => exactFrame(data, state.at))
    : points.map((_, index) => pointFrame(data, index));
  const ends = exact ? [corners[0].gap, corners.at(-1).gap] : [0, points.length - 1];
  const control = slider(
    own,
    exact ? "gap" : sweep.swept,
    exact ? { min: 0, max: 1, step: "any", value: 0 } : { min: 0, max: ends[1], step: 1, value: 0 },
    value => go(exact ? ends[0] * (1 - value) + ends[1] * value : value),
  );
  control.range.setAttribute("aria-label", exact ? "gap, exact at every position" : sweep.swept);
  const panel = new Panel(own, data, shape, {
    label: "The displaced body at the gap of the slider",
    frames: evenly(frames, MOST_FRAMES),
  });
  const facts = element("p", own);
  facts.id = "facts";
  const profile = profileSection(page, data, shape),
    marks = sweepPlots(page, data);
  const unit = ofForces ? units.force : units.length;
  let now = null;
  const go = at => {
    now = at;
    const frame = exact ? exactFrame(data, at) : pointFrame(data, at),
      { force, width, area, pressure_max, count } = frame.facts;
    control.told.textContent = inUnit(frame.at, unit, 9);
    if (exact) control.field.value = String(at);
    const extent =
      width !== undefined && width !== null
        ? `width ${inUnit(width, units.length)}`
        : `area ${inUnit(area, `${units.length}²`)}`;
    facts.textContent = `${counted(count, "closed row")}, force ${inUnit(force, units.force, 10)}, peak pressure ${inUnit(pressure_max, units.pressure, 10)}, ${extent}${frame.travel !== undefined ? `, travel ${inUnit(frame.travel, units.length)}` : ""}`;
    panel.show(frame);
    profile(frame);
    marks(frame.at);
  };
  if (exact) {
    const part = gap => (ends[1] === ends[0] ? 0 : (gap - ends[0]) / (ends[1] - ends[0]));
    control.field = Object.assign(element("input", control.line), { type: "number", step: "any" });
    control.field.setAttribute("aria-label", "gap as a number");
    const inside = gap => Math.min(Math.max(gap, Math.min(...ends)), Math.max(...ends));
    const to = gap => {
      control.range.value = part(gap);
      go(gap);
    };
    control.field.addEventListener(
      "change",
      () => Number.isFinite(control.field.valueAsNumber) && to(inside(control.field.valueAsNumber)),
    );
    const stops = [ends[0], ...events.map(event => event.gap), ends[1]].sort((a, b) => part(a) - part(b));
    for (const [text, next] of [
      ["previous event", () => stops.filter(gap => part(gap) < part(now) - 1e-12).at(-1)],
      ["next event", () => stops.find(gap => part(gap) > part(now) + 1e-12)],
    ]) {
      const button = element("button", control.line, text);
      button.type = "button";
      button.addEventListener("click", () => {
        const gap = next();
        if (gap !== undefined) to(gap);
      });
    }
    element(
      "p",
      own,
      `Between its events the answer is linear in the gap: closed rows, forces and pressures are exact at every position of the slider. A row touches or releases ${counted(events.length, "time")}.`,
      "soft",
    );
  } else
    element(
      "p",
      own,
      `The exact path between these answers is not known: the slider stops at the ${points.length} that were solved.`,
      "soft",
    );
  if (data.states.length < sweep.state_count)
    notes.push(
      `Of ${sweep.state_count} shapes ${data.states.length} are kept in this page; shapes and stresses are interpolated between them. Contact data, forces and pressures stay exact.`,
    );
  go(ends[0]);
  sweepTable(page, data);
}

/** Force, extent and peak pressure over the gap or force; returns what marks a place. */
function sweepPlots(page, data) {
  const { sweep, units, colours } = data,
    { points, corners } = sweep,
    ofForces = sweep.swept === "force";
  const own = section(page, ofForces ? "Over the force" : "Over the gap", "curves"),
    x = { name: ofForces ? `force [${units.force}]` : `gap [${units.length}]` };
  const hasWidth = points[0].contact.width !== undefined;
  const curves = [
    ofForces
      ? [`travel [${units.length}]`, point => point.travel, () => NaN]
      : [`contact force [${units.force}]`, point => point.contact.force, corner => corner.force],
    hasWidth
      ? [`contact width [${units.length}]`, point => point.contact.width, corner => corner.width]
      : [`contact area [${units.length}²]`, point => point.contact.area, corner => corner.area],
    [`peak pressure [${units.pressure}]`, point => point.contact.pressure_max, corner => corner.pressure_max],
  ];
  const exact = { name: "exact path", colour: colours.lines[0] },
    solved = { name: `${sweep.swept}s that were solved`, colour: colours.lines[1], marks: true, line: !corners.length };
  const made = curves.map(([name, ofPoint, ofCorner]) =>
    plotted(own, {
      label: `${name} over the ${sweep.swept}`,
      x,
      y: { name },
      height: 230,
      series: [
        ...(corners.length ? [{ ...exact, points: corners.map(corner => [corner.gap, ofCorner(corner)]) }] : []),
        { ...solved, points: points.map(point => [point.force ?? point.gap, ofPoint(point)]) },
      ],
    }),
  );
  keyOf(own, corners.length ? [exact, solved] : [solved]);
  return at => made.forEach(plot => plot.mark(at));
}

function sweepTable(page, { sweep, units }) {
  const own = section(page, "Solved and certified", "points"),
    ofForces = sweep.swept === "force";
  table(
    own,
    [
      ofForces ? `force [${units.force}]#` : `gap [${units.length}]#`,
      "status",
      "closed#",
      `force [${units.force}]#`,
      `peak pressure [${units.pressure}]#`,
      "energy error ≤#",
    ],
    evenly(sweep.points, 60).map(point => [
      shown(point.force ?? point.gap, 9),
      STATUS[point.status],
      shown(point.contact.count),
      shown(point.contact.force, 10),
      shown(point.contact.pressure_max, 7),
      shown(point.bound, 2),
    ]),
  );
  if (!sweep.events.length) return;
  const more = element("details", own),
    shownEvents = sweep.events.slice(0, 200);
  element(
    "summary",
    more,
    `${counted(sweep.events.length, "event")}${shownEvents.length < sweep.events.length ? ", the first 200 of them" : ""}`,
  );
  table(
    more,
    [`gap [${units.length}]#`, "node#", "what"],
    shownEvents.map(event => [shown(event.gap, 12), shown(event.node), event.touches ? "touches" : "releases"]),
  );
}

function motionSection(page, data, shape, notes) {
  const { motion, units, report, colours, states } = data,
    own = section(page, "The motion", "answer");
  const frames = states.map((_, index) => motionFrame(data, index));
  const control = slider(own, "time", { min: 0, max: states.length - 1, step: 1, value: 0 }, value => go(value));
  const panel = new Panel(own, data, shape, {
    label: "The body at the time of the slider",
    frames: evenly(frames, MOST_FRAMES),
  });
  const facts = element("p", own);
  facts.id = "facts";
  const columns = 8,
    count = motion.history.length / columns,
    column = k =>
      Array.from({ length: count }, (_, i) => [motion.history[columns * i], motion.history[columns * i + k]]);
  const work = `${units.force} ${units.length}`.trim(),
    energies = ["kinetic", "strain", "potential", "total"].map((name, k) => ({
      name,
      colour: colours.lines[k],
      points: column(4 + k),
    }));
  const curves = section(page, "Force and energies", "curves");
  const force = plotted(curves, {
    label: "Contact force over time",
    x: { name: "time" },
    y: { name: `contact force [${units.force}]` },
    series: [{ name: "contact force", colour: colours.lines[0], points: column(1) }],
    height: 230,
  });
  const energy = plotted(curves, {
    label: "Energies over time",
    x: { name: "time" },
    y: { name: `energy [${work}]` },
    series: energies,
    height: 260,
  });
  keyOf(curves, energies);
  const go = index => {
    const frame = frames[index];
    let line = 0;
    while (line + 1 < count && motion.history[columns * (line + 1)] <= frame.time * (1 + 1e-12)) line++;
    const at = k => motion.history[columns * line + k];
    control.told.textContent = `t = ${shown(frame.time, 6)}`;
    facts.textContent = `${counted(frame.rows.length, "closed row")}, force ${inUnit(at(1), units.force)}; energies: kinetic ${shown(at(4))}, strain ${shown(at(5))}, potential ${shown(at(6))}, total ${shown(at(7), 9)} ${work}`;
    panel.show(frame);
    force.mark(frame.time);
    energy.mark(frame.time);
  };
  if (states.length < motion.times.length)
    notes.push(`Of ${motion.times.length} frames ${states.length} are kept in this page.`);
  go(0);
  const { contact } = report;
  list(own, [
    ["scheme", `${report.scheme}, ${counted(report.steps, "step")} of ${shown(report.step)}`],
    [
      "contact",
      contact.first === null
        ? "none"
        : `from ${shown(contact.first)} to ${shown(contact.last)}, for ${shown(contact.duration)} in all`,
    ],
    ["impulse", shown(contact.impulse)],
    [
      "largest force",
      `${inUnit(contact.force_max, units.force)} in one step, ${inUnit(contact.force_mean_max, units.force)} on the mean over ${shown(contact.force_window.time)}`,
    ],
    ["energy", `change ${shown(report.energy.change, 3)}, largest gain ${shown(report.energy.gain, 3)}`],
  ]);
}

function searchSection(page, data, shape) {
  const { search } = data;
  if (!search || search.steps.length < 2) return;
  const own = section(page, "The search for the contact set", "search"),
    rows = Array.from({ length: data.rows.count }, (_, row) => row);
  const none = new Float64Array(rows.length),
    answer = data.states[0];
  const frames = search.steps.map(step => ({
    states: [step.state ?? answer, step.state ?? answer, 0],
    closed: step.set,
    rows,
    pressure: none,
  }));
  const control = slider(
    own,
    "step",
    { min: 1, max: search.steps.length, step: 1, value: search.steps.length },
    value => go(value),
  );
  const panel = new Panel(own, data, shape, {
    label: "The closed rows of a step of the search",
    frames: evenly(frames, MOST_FRAMES),
  });
  const facts = element("p", own);
  facts.id = "search-facts";
  const go = value => {
    const step = search.steps[value - 1],
      before = search.steps[value - 2];
    let [closes, opens] = [0, 0];
    if (before)
      step.set.forEach((flag, row) => {
        closes += flag > before.set[row] ? 1 : 0;
        opens += flag < before.set[row] ? 1 : 0;
      });
    control.told.textContent = `${step.number} of ${search.count}`;
    facts.textContent = `${counted(step.closed, "closed row")}${before ? `: ${closes} more close, ${opens} open` : ""}${step.penalty ? `; penalty ${shown(step.penalty, 2)} times the local stiffness` : ""}${step.state ? "" : "; the body is that of the answer"}`;
    panel.show(frames[value - 1]);
  };
  go(search.steps.length);
}

function tradeoffSection(page, data) {
  const { report, colours } = data,
    own = section(page, "Work and precision", "tradeoff"),
    ofMotion = report.points.some(point => "scheme" in point);
  const error = point => Math.max(ofMotion ? point.displacement_error : point.energy_error, 1e-16);
  const panels = ofMotion
    ? [[`${counted(report.dofs, "dof")}`, report.points]]
    : report.meshes.map((mesh, index) => [
        `${counted(mesh.dofs, "dof")}, ${counted(mesh.contact_rows, "contact row")}`,
        report.points.filter(point => point.mesh === index),
      ]);
  for (const [title, points] of panels) {
    element("h3", own, title);
    const names = [...new Set(points.map(nameOf))];
    const series = names.map((name, k) => ({
      name,
      colour: colours.lines[k % colours.lines.length],
      marks: true,
      focus: true,
      hollow: name.includes("mixed"),
      points: points
        .filter(point => nameOf(point) === name)
        .map(point => [point.seconds, error(point), wordsOf(point)]),
    }));
    const front = points
      .filter(point => point.best)
      .sort((a, b) => a.seconds - b.seconds)
      .map(point => [point.seconds, error(point), wordsOf(point)]);
    const best = { name: "Pareto front", colour: "var(--soft)", dash: "6 5", points: front };
    plotted(own, {
      label: `Error over time, ${title}`,
      x: { name: "time [s]", log: true },
      y: { name: ofMotion ? "displacement error, relative" : "energy error, relative", log: true },
      series: [best, ...series],
      height: 360,
    });
    keyOf(own, [...series, best]);
    const more = element("details", own);
    element("summary", more, `${counted(points.length, "measured point")} as a table`);
    table(
      more,
      ["method", "seconds#", "error#", "best"],
      points.map(point => [
        nameOf(point),
        shown(point.seconds, 4),
        shown(error(point), 3),
        point.best ? "on the front" : "",
      ]),
    );
  }
}

function nameOf(point) {
  return point.scheme ?? `${point.method}, ${point.condensed ? "contact" : "all"} dofs${point.mixed ? ", mixed" : ""}`;
}

function wordsOf(point) {
  if (point.scheme)
    return `${point.scheme}, step ${shown(point.step, 4)}\n${shown(point.seconds, 4)} s, displacement error ${shown(point.displacement_error, 3)}\nenergy change ${shown(point.energy_change, 2)}`;
  return [
    `${nameOf(point)}${point.knob === null ? "" : `, setting ${shown(point.knob, 2)}`}`,
    `${shown(point.seconds, 4)} s`,
    `energy error ${shown(point.energy_error, 3)}, bound ${shown(point.energy_error_bound, 3)}`,
    `force error ${shown(point.force_error, 3)}`,
    counted(point.rows_wrong, "misclassified row"),
  ].join("\n");
}

function answerSection(page, data, shape, summary) {
  const own = section(page, "The answer", "answer");
  const panel = new Panel(own, data, shape, {
    label: "The displaced body, coloured by a field",
    frames: [answerFrame(data)],
    resultants: summary.resultants,
  });
  panel.show(answerFrame(data));
  contactList(own, summary, data);
  profileSection(page, data, shape)(answerFrame(data));
  window.signorini.answer = panel;
}

const EXACTNESS =
  "Shapes and colours are drawn from numbers of 16 bits. Pressures, gaps and forces of rows are in double precision, as in report.json.";

async function assemble() {
  const began = performance.now(),
    page = document.getElementById("page"),
    data = await unpackedData();
  const summary = data.report?.methods ? data.report.methods[0] : data.report,
    notes = data.body ? [EXACTNESS] : [];
  window.signorini = { data };
  document.getElementById("loading").remove();
  document.getElementById("still")?.remove();
  headline(page, data, summary);
  if (data.body) {
    const shape = shapeOf(data.body);
    questionSection(page, data, shape, summary);
    if (data.sweep) sweepSection(page, data, shape, notes);
    else if (data.motion) motionSection(page, data, shape, notes);
    else answerSection(page, data, shape, summary);
    certificateSection(page, data);
    comparisonSection(page, data);
    resultantSection(page, summary, data);
    segmentSection(page, summary, data);
    searchSection(page, data, shape);
  } else if (data.report?.points) tradeoffSection(page, data);
  else {
    contactList(section(page, "The answer", "answer"), summary, data);
    certificateSection(page, data);
  }
  aboutSection(page, data, notes);
  await new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)));
  document.documentElement.dataset.ready = Math.round(performance.now() - began);
}

function failed(error) {
  const loading = document.getElementById("loading") ?? element("p", document.getElementById("page"));
  loading.textContent = `This browser cannot draw the page: ${error.message}. It needs one from 2023 or later; the numbers are also in report.json.`;
  throw error;
}

// Paper is light, whatever the screen.
window.addEventListener("beforeprint", () => {
  document.documentElement.dataset.print = "";
  View.all.forEach(view => view.drawNow());
});
window.addEventListener("afterprint", () => {
  delete document.documentElement.dataset.print;
  View.all.forEach(view => view.redraw());
});
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => View.all.forEach(view => view.redraw()));

assemble().catch(failed);
