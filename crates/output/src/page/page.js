// Puts the page together.

function answerSection(page, data, shape, summary) {
  const own = section(page, "The answer", "answer");
  contactList(own, summary, data);
  const panel = new Panel(own, data, shape, {
    label: "The displaced body, coloured by a field",
    frames: [answerFrame(data)],
    resultants: summary.resultants,
  });
  panel.show(answerFrame(data));
  profileSection(page, data, shape)(answerFrame(data));
  window.signorini.answer = panel;
}

const EXACTNESS =
  "Shapes and colours are drawn from numbers of 16 bits. Pressures, gaps and forces of rows are in double precision, as in report.json.";

async function assemble() {
  const began = performance.now(),
    page = document.getElementById("page"),
    data = await unpackedData();
  const summary = data.report?.methods?.[0] ?? data.report?.answer ?? (data.report?.modes ? null : data.report),
    notes = data.body ? [EXACTNESS] : [];
  // Black is invisible on a dark page.
  data.colours.lines = data.colours.lines.map(colour => (colour === "#000000" ? "var(--ink)" : colour));
  window.signorini = { data };
  document.getElementById("loading").remove();
  const still = document.getElementById("still");
  still.remove();
  headline(page, data, summary);
  if (data.body) {
    const shape = { ...shapeOf(data.body), eye: data.question.eye };
    if (data.sweep) sweepSection(page, data, shape, notes);
    else if (data.motion) motionSection(page, data, shape, notes);
    else if (data.states) answerSection(page, data, shape, summary);
    sensitivitySection(page, data);
    modesSection(page, data, shape);
    if (data.report?.levels) levelsSection(page, data, still);
    questionSection(page, data, shape, summary);
    certificateSection(page, data);
    comparisonSection(page, data);
    resultantSection(page, summary, data);
    segmentSection(page, summary, data);
    searchSection(page, data, shape);
    alongSection(page, data);
  } else if (data.report?.points) tradeoffSection(page, data, still);
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

// Paper is light, even if the screen is dark.
function onPaper(prints) {
  document.documentElement.toggleAttribute("data-print", prints);
  View.all.forEach(view => view.drawNow());
}
window.addEventListener("beforeprint", () => onPaper(true));
window.addEventListener("afterprint", () => onPaper(false));
matchMedia("print").addEventListener("change", event => onPaper(event.matches));
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => View.all.forEach(view => view.redraw()));

assemble().catch(failed);
