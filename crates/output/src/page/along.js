// The answer along lines: a plot for each line, of the quantity that the reader chooses.

function alongSection(page, data) {
  const { along, units, colours } = data;
  if (!along) return;
  const own = section(page, `Along lines${ofPart(data)}`, "along");
  for (const { ends, plots } of along) {
    const words = `from ${vectorShown(ends[0], units.length)} to ${vectorShown(ends[1], units.length)}`;
    element("h3", own, words);
    if (!plots.length) {
      remark(own, "The line meets no body.");
      continue;
    }
    const choice = element("select", element("label", own, "quantity ")),
      host = element("div", own, null, "plotted");
    plots.forEach(({ y: { name } }, value) =>
      Object.assign(element("option", choice, name), { value, selected: name === "von_mises" }),
    );
    const show = () => {
      host.replaceChildren();
      dataPlot(host, plots[choice.value], colours, { label: `${plots[choice.value].y.name} ${words}` });
    };
    choice.addEventListener("change", show);
    show();
  }
}
