// Frames: the states shown at the positions of a slider.

/** Number of frames that set the colours of a series: more would take time without a visible effect. */
const MOST_FRAMES = 24;

function evenly(list, most) {
  if (list.length <= most) return list;
  return Array.from({ length: most }, (_, i) => list[Math.floor((i * (list.length - 1)) / (most - 1))]);
}

/** The closed rows of an answer: a flag for each row. */
function flags(rows, count) {
  const closed = new Uint8Array(count);
  rows.forEach(row => {
    closed[row] = 1;
  });
  return closed;
}

/** The two states around a position, and the share of the upper one. */
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

/** The exact answer at a gap: it is linear between two corners. */
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
