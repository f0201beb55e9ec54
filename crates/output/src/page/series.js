// Answers in a series: sweeps, motions, the search for the contact set.

/** A labelled range with a text about its position. */
function slider(host, label, settings, moved) {
  const line = element("div", host, null, "slider"),
    name = element("label", line, label),
    range = input(line, "range", settings),
    output = element("output", line);
  range.id = name.htmlFor = `slider-${label.replace(/\W+/g, "-")}`;
  output.setAttribute("for", range.id);
  range.addEventListener("input", () => moved(Number(range.value)));
  return { line, range, output };
}

/** A slider with the facts of its position, and a view of the body there. */
function slidingPanel(own, data, shape, { name, range, facts, label, frames }, moved) {
  const control = slider(own, name, range, moved);
  const words = Object.assign(element("p", own), { id: facts });
  return { ...control, facts: words, panel: new Panel(own, data, shape, { label, frames }) };
}

/** Pressure over the arc length along each obstacle of a plane body; returns a function that shows another frame. */
function profileSection(page, data, shape) {
  if (!data.rows?.count || shape.dimension !== 2) return () => {};
  const own = section(page, `Contact pressure along the boundary${ofPart(data)}`, "pressure"),
    { rows, units } = data;
  const plots = data.question.obstacles.map((_, obstacle) => {
    // Rows of the side that faces away have no arc length.
    const faces = row => rows.obstacles[row] === obstacle && Number.isFinite(rows.along[row]);
    const order = Array.from(rows.vertices.keys()).filter(faces),
      place = row => rows.along[row];
    order.sort((a, b) => place(a) - place(b));
    if (!order.length) return () => {};
    const several = data.pressures?.map((pressure, method) => ({
      name: data.report.methods[method].method,
      colour: data.colours.lines[method],
      dash: ["none", "7 4", "2 4"][method],
      points: order.map(row => [place(row), pressure[row]]),
    }));
    const series = frame => {
      if (several) return several;
      const by = new Map(frame.rows.map((row, i) => [row, frame.pressure[i]])),
        points = order.map(row => [place(row), by.get(row) ?? 0]);
      return [{ name: "pressure", colour: "var(--accent)", marks: true, size: 3, points }];
    };
    const name = data.question.obstacles.length > 1 ? `, obstacles[${obstacle}]` : "";
    const made = plotted(own, {
      label: `Contact pressure along the boundary${name}`,
      x: { name: `arc length s [${units.length}]` },
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
  const ends = exact ? [corners[0].gap, corners.at(-1).gap] : [0, points.length - 1],
    range = exact ? { min: 0, max: 1, step: "any", value: 0 } : { min: 0, max: ends[1], step: 1, value: 0 },
    label = "The displaced body at the gap of the slider",
    settings = { name: exact ? "gap" : sweep.swept, range, facts: "facts", label, frames },
    control = slidingPanel(own, data, shape, settings, value => go(exact ? between(...ends, value) : value));
  control.range.setAttribute("aria-label", exact ? "gap, exact at every position" : sweep.swept);
  const profile = profileSection(page, data, shape),
    marks = dataPlots(section(page, ofForces ? "Over the force" : "Over the gap", "curves"), data);
  const unit = ofForces ? units.force : units.length,
    field = exact && input(control.line, "number", { step: "any" }, "gap as a number");
  let now = null;
  const go = at => {
    now = at;
    const frame = exact ? exactFrame(data, at) : pointFrame(data, at),
      { force, width, area, pressure_max, count } = frame.facts;
    control.output.textContent = inUnit(frame.at, unit, 9);
    if (exact) field.value = String(at);
    const extent = (width ?? null) !== null ? `${inUnit(width, units.length)} wide` : inUnit(area, `${units.length}²`),
      travel = frame.travel !== undefined && `travel ${inUnit(frame.travel, units.length)}`;
    const words = [
      `${counted(count, "closed row")}${ofPart(data)}`,
      !several && `force ${inUnit(force, units.force, 10)}`,
      `peak pressure ${inUnit(pressure_max, units.pressure, 10)}`,
      !several && `cells of closed nodes ${extent}`,
      travel,
    ];
    control.facts.textContent = words.filter(Boolean).join(", ");
    control.panel.show(frame);
    profile(frame);
    marks(frame.at);
  };
  if (exact) {
    const part = gap => shareOf(gap, ...ends);
    const to = gap => {
      control.range.value = part(gap);
      go(gap);
    };
    field.addEventListener("change", () => {
      if (Number.isFinite(field.valueAsNumber)) to(clamped(field.valueAsNumber, Math.min(...ends), Math.max(...ends)));
    });
    const stops = [...ends, ...events.map(event => event.gap)].sort((a, b) => part(a) - part(b)),
      visit = gap => gap !== undefined && to(gap);
    pressed(control.line, "previous event", () => visit(stops.filter(gap => part(gap) < part(now) - 1e-12).at(-1)));
    pressed(control.line, "next event", () => visit(stops.find(gap => part(gap) > part(now) + 1e-12)));
  }
  remark(
    own,
    exact
      ? `Between its events the answer is linear in the gap: closed rows, forces and pressures are exact at every position of the slider. A row${ofPart(data)} touches or releases ${counted(events.length, "time")}.`
      : `The exact path between these answers is not known: the slider stops at the ${points.length} that were solved.`,
  );
  if (data.states.length < sweep.state_count)
    notes.push(
      `Of ${sweep.state_count} shapes ${data.states.length} are kept in this page; shapes and stresses are interpolated between them. Contact data, forces and pressures stay exact.`,
    );
  go(ends[0]);
  sweepTable(page, data);
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
  table(own, columns, points);
  if (several)
    obstacleTable(
      own,
      points.flatMap(point => point.contact.obstacles.map(one => [at(point), one])),
      units,
      swept,
    );
  if (question.parts > 1)
    remark(
      own,
      "Closed rows, energy errors and pictures are of the meshed part; forces, widths, areas and pressures are of the whole body.",
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
    [
      [`gap [${units.length}]#`, event => shown(event.gap, 12)],
      [`node${part}#`, event => event.node],
      ["what", event => (event.touches ? "touches" : "releases")],
    ],
    shownEvents,
  );
}

/// The peak of the contact force with its estimated error, if there is one.
function peakForce({ peak_force: peak, estimated_error: error }, units) {
  const off = peak.error === null ? "" : ` ± ${shown(peak.error, 2)}`,
    unresolved = error && !error.resolved ? "; not resolved: its estimated error is more than a tenth of it" : "";
  return `${inUnit(peak.value, units.force)}${off}, over ${shown(peak.window)}${unresolved}`;
}

function motionSection(page, data, shape, notes) {
  const { motion, units, report, states } = data,
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
    ["peak force", contact.first !== null && peakForce(contact, units)],
    ["impulse", !several && shown(contact.impulse)],
    [
      "largest force",
      !several &&
        `${inUnit(contact.force_max, units.force)} in one step, ${inUnit(contact.force_mean_max, units.force)} on ${mean}`,
    ],
    ["energy", `change ${shown(report.energy.change, 3)}, largest gain ${shown(report.energy.gain, 3)}`],
    [
      "energy taken",
      `${shown(report.energy.damped, 3)} ${workUnit(units)} by damping, ${shown(report.energy.taken_by_scheme, 3)} ${workUnit(units)} by the scheme`,
    ],
  ]);
  if (several)
    table(
      own,
      [
        ["obstacle", one => one.of],
        ["from#", one => shown(one.first)],
        ["to#", one => shown(one.last)],
        [`peak [${units.force}]#`, one => shown(one.peak_force.value)],
        ["impulse#", one => shown(one.impulse)],
        [`largest force in one step [${units.force}]#`, one => shown(one.force_max)],
        [`largest, ${mean} [${units.force}]#`, one => shown(one.force_mean_max)],
      ],
      contact.obstacles,
    );
  const range = { min: 0, max: states.length - 1, step: 1, value: motion.opens },
    label = "The body at the time of the slider",
    settings = { name: "time", range, facts: "facts", label, frames };
  const { output, facts, panel } = slidingPanel(own, data, shape, settings, value => go(value));
  const columns = 9,
    count = motion.history.length / columns,
    ofAll = several ? " of all obstacles" : "",
    marks = dataPlots(section(page, "Force and energies", "curves"), data);
  const go = index => {
    const frame = frames[index];
    let line = 0;
    while (line + 1 < count && motion.history[columns * (line + 1)] <= frame.time * (1 + 1e-12)) line++;
    const at = k => motion.history[columns * line + k];
    output.textContent = `t = ${shown(frame.time, 6)}`;
    facts.textContent = `${counted(frame.rows.length, "closed row")}, force ${inUnit(at(1), units.force)}${ofAll}; energies: kinetic ${shown(at(4))}, strain ${shown(at(5))}, potential ${shown(at(6))}, total ${shown(at(7), 9)} ${workUnit(units)}`;
    panel.show(frame);
    marks(frame.time);
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
    frames = search.steps.map(step => ({
      states: alone(step.state ?? data.states[0]),
      closed: step.set,
      rows,
      pressure: none,
    }));
  const range = { min: 1, max: search.steps.length, step: 1, value: search.steps.length },
    label = "The closed rows of a step of the search",
    settings = { name: "step", range, facts: "search-facts", label, frames };
  const { output, facts, panel } = slidingPanel(own, data, shape, settings, value => go(value));
  const go = value => {
    const step = search.steps[value - 1],
      before = search.steps[value - 2],
      changed = (from, to) => to.filter((flag, row) => flag > from[row]).length;
    const changes = before && `: ${changed(before.set, step.set)} more close, ${changed(step.set, before.set)} open`,
      penalty = step.penalty ? `; penalty ${shown(step.penalty, 2)} times the local stiffness` : "";
    output.textContent = `${step.number} of ${search.count}`;
    facts.textContent = `${counted(step.closed, "closed row")}${changes ?? ""}${penalty}${step.state ? "" : "; the body is that of the answer"}`;
    panel.show(frames[value - 1]);
  };
  go(search.steps.length);
}
