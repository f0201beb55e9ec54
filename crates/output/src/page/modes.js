// Natural vibrations: a table of modes, and the body that vibrates in one of them.

/** Seconds of a period on the screen. */
const PERIOD = 2;

/** The share of the largest scale of displacements at which the view opens. */
const SHOWN = 0.4;

function modesSection(page, data, shape) {
  const { modes: states, units } = data,
    found = data.report?.modes;
  if (!found) return;
  const own = section(page, "Natural vibrations", "modes"),
    { modes, closed, undecided, unproven, is_complete, rigid_motions, mass } = found;
  const bracket = `${undecided.length} of them may be open: each frequency lies between both columns`,
    verdict = unproven ? `as in the answer, without a proof: ${unproven}` : undecided.length ? bracket : "proven";
  list(own, [
    ["closed rows", data.rows?.count > 0 && `${closed.length} of ${data.rows.count}${ofPart(data)}, ${verdict}`],
    ["missed", is_complete ? "no frequency below the last one: the negative pivots of K - w M count as many" : "not excluded"],
    ["without energy", rigid_motions.length > 0 && rigid_motions.join("; ")],
    ["mass", shown(mass)],
  ]);
  const axes = ["x", "y", "z"].slice(0, shape.dimension),
    limit = one => (one ? `${shown(one.amplitude, 3)} (row ${one.row})` : "-"),
    has = key => modes.some(mode => (mode[key] ?? null) !== null);
  table(
    own,
    [
      ["mode#", mode => String(modes.indexOf(mode) + 1)],
      ["frequency [1/time]#", mode => shown(mode.frequency, 7)],
      ...(has("frequency_open") ? [["undecided open [1/time]#", mode => shown(mode.frequency_open, 7)]] : []),
      ["residual#", mode => shown(mode.residual, 2)],
      ...axes.map((axis, k) => [`${axis} mass %#`, mode => ((100 * mode.effective_mass[k]) / mass).toFixed(2)]),
      ...(has("opens") ? [[`opens at [${units.length}]#`, mode => limit(mode.opens)]] : []),
      ...(has("closes") ? [[`closes at [${units.length}]#`, mode => limit(mode.closes)]] : []),
    ],
    modes,
  );
  if (!states?.length) return;
  const none = { closed: new Uint8Array(data.rows?.count ?? 0), rows: [], pressure: [] },
    contact = data.contact ? { ...data.contact, rows: Array.from(data.contact.closed.keys()) } : none;
  const frame = (mode, share) => ({ ...contact, states: [...states[mode].ends, share] });
  const frames = states.flatMap((_, mode) => [frame(mode, 0), frame(mode, 1)]),
    range = { min: 1, max: states.length, step: 1, value: 1 },
    label = "The body that vibrates in the mode of the slider",
    settings = { name: "mode", range, facts: "mode-facts", label, frames };
  const { line, output, facts, panel } = slidingPanel(own, data, shape, settings, value => go(value - 1));
  let [now, began] = [0, null];
  const show = share => panel.show(frame(now, share));
  const go = mode => {
    now = mode;
    output.textContent = `${mode + 1} of ${modes.length}, frequency ${shown(modes[mode].frequency, 7)}`;
    facts.textContent = `The equilibrium with the mode on it; its largest displacement is ${inUnit(states[mode].amplitude, units.length)}.`;
    if (began === null) show(1);
  };
  const step = time => {
    if (began === null) return;
    show(0.5 + 0.5 * Math.cos((2 * Math.PI * (time - began)) / (1000 * PERIOD)));
    requestAnimationFrame(step);
  };
  const button = pressed(line, "play", () => {
    began = began === null ? performance.now() : null;
    button.textContent = began === null ? "play" : "stop";
    if (began === null) show(1);
    else requestAnimationFrame(step);
  });
  go(0);
  // A vibration is mostly too small to be seen as it is.
  panel.scale.value = SHOWN * Number(panel.scale.max);
  panel.scale.dispatchEvent(new Event("input"));
  window.signorini.modes = panel;
}
