// The answer along lines: a plot for each line, of the quantity that the reader chooses.

/** Columns of place, before those that are plotted. */
function placesOf({ ends: [from] }) {
  return 1 + from.length;
}

function alongSection(page, data) {
  const { along, units, colours } = data;
  if (!along) return;
  const own = section(page, `Along lines${ofPart(data)}`, "along");
  for (const line of along) {
    const { ends, columns, bodies } = line,
      words = `from ${vectorShown(ends[0], units.length)} to ${vectorShown(ends[1], units.length)}`;
    element("h3", own, words);
    if (!bodies.length) {
      remark(own, "The line meets no body.");
      continue;
    }
    const seriesOf = column =>
      bodies.map(({ name, points }, index) => ({
        name: name || (bodies.length > 1 ? "first body" : columns[column].name),
        colour: colours.lines[index % colours.lines.length],
        points: Array.from({ length: points.length / columns.length }, (_, i) => {
          const at = i * columns.length;
          return [points[at], points[at + column]];
        }),
      }));
    const isKnown = column => seriesOf(column).some(({ points }) => points.some(([, value]) => Number.isFinite(value)));
    const choice = element("select", element("label", own, "quantity ")),
      host = element("div", own, null, "plotted");
    columns.forEach(({ name }, column) => {
      if (column >= placesOf(line) && isKnown(column))
        Object.assign(element("option", choice, name), { value: column, selected: name === "von_mises" });
    });
    const show = () => {
      const column = Number(choice.value),
        titled = ({ name, unit }) => `${name}${unit && ` [${unit}]`}`,
        series = seriesOf(column);
      host.replaceChildren();
      plotted(host, {
        label: `${columns[column].name} ${words}`,
        x: { name: titled(columns[0]) },
        y: { name: titled(columns[column]) },
        series,
        height: 260,
      });
      if (bodies.length > 1) keyOf(host, series);
    };
    choice.addEventListener("change", show);
    show();
  }
}
