// Frames: the states shown at the positions of a slider.

/** Number of frames that set the colours of a series: more would take time without a visible effect. */
const MOST_FRAMES = 24;

function evenly(list, most) {
  if (list.length <= most) return list;
  return Array.from({ length: most }, (_, i) => list[Math.floor((i * (list.length - 1)) / (most - 1))]);
}

/** The value at a share of the way from one to another. */
function between(from, to, share) {
  return from * (1 - share) + to * share;
}

/** The share of the way from one to another at which a value lies. */
function shareOf(value, from, to) {
  return from === to ? 0 : clamped((value - from) / (to - from), 0, 1);
}

/** The two states around a position, and the share of the upper one. */
function around(states, at) {
  const sign = states.at(-1).at >= states[0].at ? 1 : -1,
    found = states.findIndex(state => sign * (state.at - at) >= 0);
  const upper = found < 0 ? states.length - 1 : found,
    ends = [states[Math.max(0, upper - 1)], states[upper]];
  return [...ends, shareOf(at, ends[0].at, ends[1].at)];
}

/** One state as it is, without another. */
function alone(state) {
  return [state, state, 0];
}

/** The one answer of a solve. */
function answerFrame({ contact, states }) {
  return { ...contact, states: alone(states[0]), rows: Array.from(contact.closed.keys()) };
}

/** The part of a list of closed rows that belongs to one answer, with a flag for each row of the scene. */
function closedAt(data, { starts, rows, values }, index) {
  const own = all => all.subarray(starts[index], starts[index + 1]),
    closed = new Uint8Array(data.rows.count);
  for (const row of own(rows)) closed[row] = 1;
  return { closed, rows: Array.from(own(rows)), pressure: own(values[0]), values: values.map(own) };
}

/** The exact answer at a gap: it is linear between two corners. */
function exactFrame(data, gap) {
  const { corners, closed } = data.sweep,
    sign = corners.at(-1).gap >= corners[0].gap ? 1 : -1;
  let piece = 0;
  while (2 * piece + 2 < corners.length && sign * (gap - corners[2 * piece + 1].gap) > 0) piece++;
  const [from, to] = [corners[2 * piece], corners[2 * piece + 1]],
    share = shareOf(gap, from.gap, to.gap);
  const { values, ...contact } = closedAt(data, closed, piece),
    pressure = Array.from(values[0], (value, i) => between(value, values[1][i], share));
  return {
    ...contact,
    states: around(data.states, gap),
    pressure,
    at: gap,
    facts: {
      force: between(from.force, to.force, share),
      width: from.width,
      area: from.area,
      pressure_max: pressure.reduce((most, value) => Math.max(most, value), 0),
      count: pressure.length,
    },
  };
}

/** The answer at a gap or force that was solved. */
function pointFrame(data, index) {
  const { points, closed } = data.sweep,
    { force, gap, contact, travel } = points[index];
  return {
    ...closedAt(data, closed, index),
    states: around(data.states, index),
    at: force ?? gap,
    facts: contact,
    travel,
  };
}

function motionFrame(data, index) {
  const state = data.states[index];
  return {
    ...closedAt(data, data.motion.closed, index),
    states: alone(state),
    time: data.motion.times[state.at],
  };
}
