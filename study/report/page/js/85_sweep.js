// A sweep: success first, then errors and NEES over what was varied, methods side by side, a map of two fields, and a table.
function sweepTable(view, cells) {
  const { reference, methods } = view.data, unit = view.unit() ? ` [${view.unit()}]` : "", against = methods.indexOf(reference);
  const figures = ["median", "mean", "95 %", "largest"].map((name) => ({ text: name, raw: name + unit })), number = (v) => ({ text: figure(v), raw: v ?? "" });
  const head = [view.xTitle(), "method", { text: "answered", raw: ["answered", "tasks"] }, ...figures, ...(against < 0 || methods.length < 2 ? [] : [`median / ${reference}\u2019s`])], rows = [];
  cells.forEach((row, level) => view.data.methods.forEach((name, m) => {
    const { values, answered, tasks } = row[m], median = sortedQuantile(values, 0.5), other = against < 0 ? null : sortedQuantile(row[against].values, 0.5);
    rows.push(Object.assign([named(view.levels()[level], m === 0), { node: withSwatch(m, name), plain: name }, { text: tasks ? `${answered} of ${tasks}` : "\u2013", raw: [answered, tasks] },
      ...[median, mean(values), sortedQuantile(values, 0.95), values.length ? values[values.length - 1] : null, median !== null && other > 0 ? median / other : null].slice(0, head.length - 3).map(number)], { first: m === 0 && level > 0 }));
  }));
  return [head, rows];
}

function sweepHead(data, view) {
  const all = view.gather(() => 0, 1)[0], order = data.methods.map((_, m) => m).sort((a, b) => all[b].answered - all[a].answered || (sortedQuantile(all[a].values, 0.5) ?? Infinity) - (sortedQuantile(all[b].values, 0.5) ?? Infinity));
  const share = (m) => (all[m].tasks === 0 ? `${data.methods[m]} has no result yet` : all[m].answered === 0 ? `${data.methods[m]} gives nothing for ${view.subjects[0][1]}` : `${data.methods[m]} answers ${Math.round((100 * all[m].answered) / all[m].tasks)} % of the tasks` + (all[m].values.length ? ` with a median position error of ${figure(sortedQuantile(all[m].values, 0.5))} cm` : ""));
  const rigs = data.rows.subject.filter((s) => data.subjects[s].startsWith("rig:")).length, wanted = data.tasks.length * data.methods.length;
  replace(document.getElementById("head"), h("div", { class: "top" }, h("h1", {}, data.title), h("span", { class: "brand" }, `Rigproof ${data.version} \u00b7 sweep`)),
    h("div", { class: "verdict " + (rigs < wanted ? "suspect" : "plain"), role: "status" }, h("div", { class: "word" }, `${plural(data.tasks.length, "task")}, ${plural(data.methods.length, "method")}`),
      h("p", { class: "sentence" }, rigs < wanted ? `${rigs} of ${wanted} answers are there.` : "All answers are there."), h("ul", {}, order.map((m) => h("li", {}, share(m) + "."))), mixedDrivers(data)));
}

function mixedDrivers({ gl_renderers: drivers }) {
  if (drivers.length < 2) return null;
  return h("p", { class: "sentence" }, `Pictures are of ${drivers.length} GL drivers, and differ from one to the other: ${drivers.map((one) => `${plural(one.answers, "answer")} by ${one.name}`).join(", ")} (times.csv says which).`);
}

// Of all charts: it stays in sight on a large screen.
function sweepControls(view, draw) {
  const { data } = view, set = (key, map = (v) => v) => (value) => { view[key] = map(value); draw(); };
  const filters = view.choices.map((axis) => choice(data.axes[axis].title, ["all", ...data.axes[axis].levels], (v) => { view.fixed[axis] = v === 0 ? null : v - 1; draw(); }));
  const shows = data.methods.map((name) => checkbox(name, true, (on) => { view.legend.selected[name] = on; draw(); }));
  const logAxis = checkbox("log axis", view.logX, set("logX")), noLog = h("span", { class: "soft" });
  const node = h("div", { class: "card controls", id: "controls" }, h("div", { class: "bar" },
    choice("show", KINDS, set("kind"), view.kind), choice("of", QUANTITIES, set("q"), view.q),
    view.subjects.length > 1 ? choice("", view.subjects.map(([, name]) => name), set("subject")) : null,
    view.choices.length > 1 ? choice("over", view.choices.map((i) => data.axes[i].title), set("x", (i) => view.choices[i]), view.choices.indexOf(view.x)) : null,
    checkbox("log errors", view.log, set("log")), logAxis, noLog),
  shows.length > 1 ? h("div", { class: "bar", style: { marginTop: "8px" } }, h("span", { class: "soft" }, "methods"), shows) : null,
  filters.length > 1 ? h("div", { class: "bar", style: { marginTop: "8px" } }, h("span", { class: "soft" }, "only"), filters) : null);
  // What the field over which all is drawn allows.
  const follow = () => {
    const reason = view.whyNotLog();
    logAxis.hidden = !view.isOrdered() || Boolean(reason);
    noLog.textContent = reason ? `no log axis: ${reason}` : "";
    shows.forEach((label, m) => { label.querySelector("input").checked = view.isShown(m); });
    filters.forEach((filter, i) => { filter.hidden = view.choices[i] === view.x; });
  };
  return { node, follow };
}

function failuresSection(data) {
  if (!data.failures.length) return null;
  const head = ["method", "tasks", "status", "for example", "code"], rows = data.failures.map((f) => [f.method, String(f.tasks), f.status.replaceAll("_", " "), textCell(f.reason), { node: h("code", {}, f.code), plain: f.code }]);
  return section("failures", "What was not answered, and why", null, h("div", { class: "card" }, h("div", { class: "bar" }, copyButtons(() => [head, rows])), table(head, rows, { text: [0, 2, 3, 4], caption: "Failures" })));
}

// A title that says what is drawn, and a chart, which may be wider than the screen.
function sweepCard(view, draws, { height, title, option, width = () => widthFor(view), follow = () => {} }, ...above) {
  const node = h("div", { class: "chart" }), heading = h("h3", {});
  const setUp = () => {
    heading.textContent = title();
    node.style.minWidth = width();
    node.style.height = `${height + (view.isOrdered() ? 0 : 40)}px`;
    follow();
  };
  whenShown(setUp);
  const draw = chart(node, option, null, view.legend);
  draws.push(() => { setUp(); draw(); });
  return h("div", { class: "card" }, h("div", { class: "bar" }, heading, above), scrolling("chart", node));
}

function neesSection(view, draws, now) {
  if (!view.data.rows.nees.some((value) => value !== null)) return null;
  const words = h("ul", { class: "small" });
  return section("nees", "Are stated sigmas honest?", "NEES of all cameras of a task together for each degree of freedom, as the mean over tasks: 1 if sigmas are honest, above if they are too small. In the grey band lie 95 % of such means (chi-square, tasks taken as independent): 1 in 20 points is outside by chance. Rings are outside.",
    sweepCard(view, draws, { height: 320, title: () => `NEES for each degree of freedom${view.xTitle() ? " over " + view.xTitle() : ""}`, option: () => neesOption(view, now()),
      follow: () => replace(words, ...neesWords(view, now()).map((line) => h("li", {}, line))) }), words);
}

function showSweep(written) {
  const data = { ...written, rows: Object.fromEntries(Object.entries(written.rows).map(([name, column]) => [name, asList(column)])) };
  const view = new SweepView(data), draws = [], tableCard = h("div", { class: "card" });
  let cells = view.gather();
  const now = () => cells, over = () => (view.xTitle() ? " over " + view.xTitle() : ""), titled = () => view.title() + over();
  const drawTable = () => {
    const [head, rows] = sweepTable(view, cells);
    replace(tableCard, h("div", { class: "bar" }, h("h3", {}, titled()), copyButtons(() => [head, rows])), table(head, rows, { text: [0, 1], caption: "Figures" }));
  };
  const draw = () => { cells = view.gather(); controls.follow(); for (const each of draws) each(); drawTable(); };
  const controls = sweepControls(view, draw), band = choice("band", BANDS.map(([name]) => name), (value) => { view.band = value; draw(); });
  const boxWords = h("span", { class: "soft" }, "box: middle half; whiskers: 5 and 95 %");
  view.legend.onchange = draw;
  sweepHead(data, view);
  const parts = [
    section("success", "Answered", "Share of the tasks with a result in which a method gives the quantity for every camera (or pair).",
      sweepCard(view, draws, { height: 300, title: () => "Share of the tasks answered" + over(), option: () => successOption(view, cells) })),
    section("errors", "Errors", "Median and quantiles over tasks and cameras.",
      sweepCard(view, draws, { height: 400, title: titled, option: () => errorOption(view, cells), follow: () => { band.hidden = !view.isOrdered(); boxWords.hidden = view.isOrdered(); } }, band, boxWords)),
    neesSection(view, draws, now),
    section("boxes", "Methods side by side", "Quantiles 5, 25, 50, 75 and 95 % over everything that is chosen.",
      sweepCard(view, draws, { height: 340, title: () => view.title(), option: () => boxOption(view), width: () => "" })),
    sweepMap(view, draws), section("figures", "Figures", null, tableCard), failuresSection(data),
  ].filter(Boolean);
  whenShown(drawTable);
  document.getElementById("head").append(drawNavigation(parts));
  controls.follow();
  replace(document.getElementById("main"), controls.node, ...parts);
  attached = true;
  redrawAll();
}
