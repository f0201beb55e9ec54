// Answers in a series: sweeps, motions, the search for the contact set.

/** A labelled range with a text about its position. */
function slider(host, label, { min, max, step, value }, moved) {
  const line = element("div", host, null, "slider"),
    name = element("label", line, label);
  const range = Object.assign(element("input", line), { type: "range", min, max, step, value });
  range.id = `slider-${label.replace(/\W+/g, "-")}`;
  name.htmlFor = range.id;
  const output = element("output", line);
  output.setAttribute("for", range.id);
  range.addEventListener("input", () => moved(Number(range.value)));
  return { line, range, output };
}

/** Pressure along each obstacle of a plane body; returns a function that shows another frame. */
function profileSection(page, data, shape) {
  if (!data.rows?.count || shape.dimension !== 2) return () => {};
  const own = section(page, `Contact pressure along the boundary${ofPart(data)}`, "pressure"),
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

/** A sweep: at every gap if the path is exact, else at the solved points. */
function sweepSection(page, data, shape, notes) {
  const { sweep, units } = data,
    { points, events, corners } = sweep,
    exact = corners.length > 0,
    several = obstacleCount(points[0].contact) > 1,
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
  const facts = element("p", own);
  facts.id = "facts";
  const panel = new Panel(own, data, shape, {
    label: "The displaced body at the gap of the slider",
    frames: evenly(frames, MOST_FRAMES),
  });
  const profile = profileSection(page, data, shape),
    marks = sweepPlots(page, data);
  const unit = ofForces ? units.force : units.length;
  let now = null;
  const go = at => {
    now = at;
    const frame = exact ? exactFrame(data, at) : pointFrame(data, at),
      { force, width, area, pressure_max, count } = frame.facts;
    control.output.textContent = inUnit(frame.at, unit, 9);
    if (exact) control.field.value = String(at);
    const extent =
      width !== undefined && width !== null
        ? `cells of closed nodes ${inUnit(width, units.length)} wide`
        : `cells of closed nodes ${inUnit(area, `${units.length}²`)}`;
    const ofAll = several ? "" : `, force ${inUnit(force, units.force, 10)}`;
    facts.textContent = `${counted(count, "closed row")}${ofPart(data)}${ofAll}, peak pressure ${inUnit(pressure_max, units.pressure, 10)}${several ? "" : `, ${extent}`}${frame.travel !== undefined ? `, travel ${inUnit(frame.travel, units.length)}` : ""}`;
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
      `Between its events the answer is linear in the gap: closed rows, forces and pressures are exact at every position of the slider. A row${ofPart(data)} touches or releases ${counted(events.length, "time")}.`,
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

/** Force, extent and peak pressure over the gap or force; returns a function that marks a position. */
function sweepPlots(page, data) {
  const { sweep, units, colours } = data,
    { points, corners } = sweep,
    ofForces = sweep.swept === "force";
  const own = section(page, ofForces ? "Over the force" : "Over the gap", "curves"),
    x = { name: ofForces ? `force [${units.force}]` : `gap [${units.length}]` };
  const hasWidth = points[0].contact.width !== undefined,
    several = obstacleCount(points[0].contact) > 1,
    at = point => point.force ?? point.gap;
  const ofEach = of =>
    points[0].contact.obstacles.map((one, index) => ({
      name: one.of,
      colour: colours.lines[index % colours.lines.length],
      marks: true,
      points: points.map(point => [at(point), of(point.contact.obstacles[index]) ?? 0]),
    }));
  const exact = { name: "exact path", colour: colours.lines[0] },
    solved = { name: `${sweep.swept}s that were solved`, colour: colours.lines[1], marks: true, line: !corners.length };
  const ofAll = (ofPoint, ofCorner) => [
    ...(corners.length ? [{ ...exact, points: corners.map(corner => [corner.gap, ofCorner(corner)]) }] : []),
    { ...solved, points: points.map(point => [at(point), ofPoint(point)]) },
  ];
  const travel = ofForces ? [[`travel [${units.length}]`, ofAll(point => point.travel, () => NaN)]] : [];
  const curves = several
    ? [
        ...travel,
        [`force [${units.force}]`, ofEach(one => one.force)],
        hasWidth
          ? [`estimated width [${units.length}]`, ofEach(one => one.estimate?.width)]
          : [`estimated area [${units.length}²]`, ofEach(one => one.estimate?.area)],
        [`peak pressure [${units.pressure}]`, ofEach(one => one.pressure_max)],
      ]
    : [
        ...(ofForces
          ? travel
          : [[`contact force [${units.force}]`, ofAll(point => point.contact.force, corner => corner.force)]]),
        hasWidth
          ? [
              `width of the cells of closed nodes [${units.length}]`,
              ofAll(point => point.contact.width, corner => corner.width),
            ]
          : [
              `area of the cells of closed nodes [${units.length}²]`,
              ofAll(point => point.contact.area, corner => corner.area),
            ],
        [`peak pressure [${units.pressure}]`, ofAll(point => point.contact.pressure_max, corner => corner.pressure_max)],
      ];
  const made = curves.map(([name, series]) =>
    plotted(own, { label: `${name} over the ${sweep.swept}`, x, y: { name }, height: 230, series }),
  );
  keyOf(own, several ? curves.at(-1)[1] : corners.length ? [exact, solved] : [solved]);
  return at => made.forEach(plot => plot.mark(at));
}

function sweepTable(page, data) {
  const own = section(page, "Solved and certified", "points"),
    { sweep, units, question } = data,
    part = ofPart(data),
    several = obstacleCount(sweep.points[0].contact) > 1,
    swept = sweep.swept === "force" ? `${several ? "swept " : ""}force [${units.force}]#` : `gap [${units.length}]#`,
    at = point => shown(point.force ?? point.gap, 9),
    points = evenly(sweep.points, 60);
  const columns = [
    [swept, at],
    ["status", point => STATUS[point.status]],
    [`closed${part}#`, point => String(point.contact.count)],
    ...(several
      ? []
      : [
          [`force [${units.force}]#`, point => shown(point.contact.force, 10)],
          [`peak pressure [${units.pressure}]#`, point => shown(point.contact.pressure_max, 7)],
        ]),
    [`energy error${part} ≤#`, point => shown(point.bound, 2)],
  ];
  table(
    own,
    columns.map(column => column[0]),
    points.map(point => columns.map(column => column[1](point))),
  );
  if (several)
    obstacleTable(
      own,
      points.flatMap(point => point.contact.obstacles.map(one => [at(point), one])),
      units,
      swept,
    );
  if (question.parts > 1)
    element(
      "p",
      own,
      "Closed rows, energy errors and pictures are of the meshed part; forces, widths, areas and pressures are of the whole body.",
      "soft",
    );
  if (!sweep.events.length) return;
  const more = element("details", own),
    shownEvents = sweep.events.slice(0, 200);
  element(
    "summary",
    more,
    `${counted(sweep.events.length, "event")}${part}${shownEvents.length < sweep.events.length ? ", the first 200 shown" : ""}`,
  );
  table(
    more,
    [`gap [${units.length}]#`, `node${part}#`, "what"],
    shownEvents.map(event => [shown(event.gap, 12), String(event.node), event.touches ? "touches" : "releases"]),
  );
}

function motionSection(page, data, shape, notes) {
  const { motion, units, report, colours, states } = data,
    own = section(page, "The motion", "answer");
  const frames = states.map((_, index) => motionFrame(data, index));
  const { contact } = report,
    several = contact.obstacles.length > 1,
    mean = `the mean over ${shown(contact.force_window.time)}`;
  list(own, [
    ["scheme", `${report.scheme}, ${counted(report.steps, "step")} of ${shown(report.step)}`],
    [
      "contact",
      contact.first === null
        ? "none"
        : `from ${shown(contact.first)} to ${shown(contact.last)}, for ${shown(contact.duration)} in all`,
    ],
    ["impulse", several ? null : shown(contact.impulse)],
    [
      "largest force",
      several
        ? null
        : `${inUnit(contact.force_max, units.force)} in one step, ${inUnit(contact.force_mean_max, units.force)} on ${mean}`,
    ],
    ["energy", `change ${shown(report.energy.change, 3)}, largest gain ${shown(report.energy.gain, 3)}`],
  ]);
  if (several)
    table(
      own,
      [
        "obstacle",
        "from#",
        "to#",
        "impulse#",
        `largest force in one step [${units.force}]#`,
        `largest, ${mean} [${units.force}]#`,
      ],
      contact.obstacles.map(one => [
        one.of,
        ...[one.first, one.last].map(time => (time === null ? "-" : shown(time))),
        ...[one.impulse, one.force_max, one.force_mean_max].map(value => shown(value)),
      ]),
    );
  const control = slider(own, "time", { min: 0, max: states.length - 1, step: 1, value: motion.opens }, value => go(value));
  const facts = element("p", own);
  facts.id = "facts";
  const panel = new Panel(own, data, shape, {
    label: "The body at the time of the slider",
    frames: evenly(frames, MOST_FRAMES),
  });
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
    y: { name: `contact force${several ? " of all obstacles" : ""} [${units.force}]` },
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
    control.output.textContent = `t = ${shown(frame.time, 6)}`;
    facts.textContent = `${counted(frame.rows.length, "closed row")}, force ${inUnit(at(1), units.force)}${several ? " of all obstacles" : ""}; energies: kinetic ${shown(at(4))}, strain ${shown(at(5))}, potential ${shown(at(6))}, total ${shown(at(7), 9)} ${work}`;
    panel.show(frame);
    force.mark(frame.time);
    energy.mark(frame.time);
  };
  if (states.length < motion.times.length)
    notes.push(`Of ${motion.times.length} frames ${states.length} are kept in this page.`);
  go(motion.opens);
}

function searchSection(page, data, shape) {
  const { search } = data;
  if (!search || search.steps.length < 2) return;
  const own = section(page, `The search for the contact set${ofPart(data)}`, "search"),
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
  const facts = element("p", own);
  facts.id = "search-facts";
  const panel = new Panel(own, data, shape, {
    label: "The closed rows of a step of the search",
    frames: evenly(frames, MOST_FRAMES),
  });
  const go = value => {
    const step = search.steps[value - 1],
      before = search.steps[value - 2];
    let [closes, opens] = [0, 0];
    if (before)
      step.set.forEach((flag, row) => {
        closes += flag > before.set[row] ? 1 : 0;
        opens += flag < before.set[row] ? 1 : 0;
      });
    control.output.textContent = `${step.number} of ${search.count}`;
    facts.textContent = `${counted(step.closed, "closed row")}${before ? `: ${closes} more close, ${opens} open` : ""}${step.penalty ? `; penalty ${shown(step.penalty, 2)} times the local stiffness` : ""}${step.state ? "" : "; the body is that of the answer"}`;
    panel.show(frames[value - 1]);
  };
  go(search.steps.length);
}
