// A rig over time: drift per camera against the first recording, verdicts, poses.
const VERDICT_CLASS = { moved: "bad", suspect: "suspect", "cannot tell": "suspect" };
const shiftOf = (report, camera) => (report ? report.cameras.find((shift) => shift.camera === camera) : undefined);
const dateOf = (day) => new Date(1000 * day.date_s).toISOString().slice(0, 16).replace("T", " ") + " UTC";
const dayText = (data, day) => (data.is_dated ? `${day.name}, ${dateOf(day)}` : day.name);
const norm = (list) => (list.every((v) => v === null) ? null : Math.hypot(...list.map((v) => v ?? 0)));

// Where a recording stands from left to right, 0 to 1: by date, or evenly.
function placesOf(data) {
  const days = data.recordings, first = days[0].date_s, last = days[days.length - 1].date_s;
  return days.map((day, i) => (data.is_dated && last > first ? (day.date_s - first) / (last - first) : i / (days.length - 1)));
}

// The first and the last name, and those between that have room beside the one before.
function fittingNames(names, places, left, right) {
  const letter = 6, between = 10, last = names.length - 1, widthOf = (i) => letter * names[i].length;
  const fitting = [{ name: names[0], x: left, anchor: "start" }];
  let end = left + widthOf(0);
  for (let i = 1; i < last; ++i) {
    const x = left + 12 + places[i] * (right - left - 24), half = widthOf(i) / 2;
    if (x - half < end + between || x + half > right - widthOf(last) - between) continue;
    fitting.push({ name: names[i], x, anchor: "middle" });
    end = x + half;
  }
  return [...fitting, { name: names[last], x: right, anchor: "end" }];
}

// One axis: shift of each camera with its sigma, 1 thick and 2 thin.
function driftPanel(data, axis, shown) {
  const width = 340, height = 170, left = 52, right = 14, top = 26, bottom = 22, places = placesOf(data);
  const points = data.cameras.flatMap((camera, c) => (shown === null || shown === c ? data.recordings.map((day, d) => {
    const shift = d === 0 ? { shift: AXES.map(() => 0), sigma: AXES.map(() => 0), verdict: "first" } : shiftOf(day.since_first, camera.name);
    return shift && shift.shift[axis] !== null ? { c, d, value: inUnit(shift.shift[axis], axis), sigma: inUnit(shift.sigma[axis], axis) ?? 0, verdict: shift.verdict } : null;
  }) : [])).filter(Boolean);
  if (points.length <= data.cameras.length && !points.some((p) => p.d > 0)) return null;
  const extent = 1.08 * Math.max(...points.map((p) => Math.abs(p.value) + 2 * p.sigma)) || 1e-3;
  const x = (p) => left + 12 + places[p.d] * (width - left - right - 24) + 5 * (p.c - (data.cameras.length - 1) / 2);
  const y = (value) => top + ((1 - Math.max(-1, Math.min(1, value / extent))) / 2) * (height - top - bottom);
  const tick = roundStep(extent * 0.999), nodes = [];
  for (const value of [-tick, 0, tick]) {
    nodes.push(s("line", { x1: left, x2: width - right, y1: y(value), y2: y(value), stroke: value === 0 ? color("soft") : color("line") }));
    nodes.push(s("text", { x: left - 7, y: y(value) + 4, "text-anchor": "end" }, value === 0 ? "0" : minus(String(+value.toPrecision(2)))));
  }
  const names = data.recordings.map((day) => (data.is_dated ? dateOf(day).slice(0, 10) : shortened(day.name, 18)));
  for (const { name, x, anchor } of fittingNames(names, places, left, width - right)) nodes.push(s("text", { x, y: height - 4, "text-anchor": anchor }, name));
  data.cameras.forEach((_, c) => {
    const own = points.filter((p) => p.c === c), stroke = cameraColor(c);
    nodes.push(s("polyline", { points: own.map((p) => `${x(p)},${y(p.value)}`).join(" "), fill: "none", stroke, "stroke-width": 1.4, opacity: 0.55 }));
    for (const p of own) {
      const bar = (half, thick) => s("line", { x1: x(p), x2: x(p), y1: y(p.value - half), y2: y(p.value + half), stroke, "stroke-width": thick, "stroke-linecap": "round" });
      const moved = VERDICT_CLASS[p.verdict] === "bad";
      nodes.push(s("g", {}, s("title", {}, `${data.cameras[c].name}, ${data.recordings[p.d].name}: ${signed(p.value, decimalsFor(p.sigma))} \u00b1 ${figure(p.sigma)} ${unitOf(axis)}, ${p.verdict}`),
        p.sigma > 0 ? [bar(2 * p.sigma, 1.2), bar(p.sigma, 3)] : [],
        moved ? s("circle", { cx: x(p), cy: y(p.value), r: 7, fill: "none", stroke: color("bad"), "stroke-width": 2 }) : null,
        s("circle", { cx: x(p), cy: y(p.value), r: 3.6, fill: p.verdict === "suspect" ? color("card") : stroke, stroke, "stroke-width": 1.5 })));
    }
  });
  const title = `${AXES[axis]} [${unitOf(axis)}]`;
  return s("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title + " of each camera over the recordings" }, s("text", { class: "title", x: left, y: 14 }, title), nodes);
}

function driftSection(data) {
  const holder = h("div", {}), names = ["all cameras", ...data.cameras.map((camera) => camera.name)];
  let shown = null;
  const draw = () => replace(holder, h("div", { class: "forest" }, AXES.map((_, axis) => driftPanel(data, axis, shown))),
    h("div", { class: "legend" }, data.cameras.map((camera, c) => h("span", {}, swatch(c), camera.name)), h("span", {}, "bars: 1 and 2 sigma; ring: moved; hollow: suspect")));
  whenShown(draw);
  return section("drift", "Drift", "The pose of each camera now less that of the first recording, along and about the robot's axes, were it the only one that moved.",
    h("div", { class: "card" }, data.cameras.length > 1 ? h("div", { class: "bar" }, choice("show", names, (i) => { shown = i === 0 ? null : i - 1; draw(); })) : null, holder));
}

function verdictCell(shift) {
  if (!shift) return { text: "\u2013", raw: [] };
  const place = norm(shift.shift.slice(0, 3)), angle = norm(shift.shift.slice(3));
  const size = place === null && angle === null ? "" : ` ${place === null ? "\u2013" : figure(100 * place)} cm, ${angle === null ? "\u2013" : figure((180 / Math.PI) * angle)}\u00b0`;
  return { node: h("span", {}, h("span", { class: "badge " + (VERDICT_CLASS[shift.verdict] || "") }, shift.verdict), size), plain: shift.verdict + size, raw: [shift.verdict, inUnit(place, 0), inUnit(angle, 3)] };
}

function verdictsSection(data) {
  const sizes = (text) => [text + " [cm]", text + " [deg]"], shift = (text) => ({ text, raw: [text, ...sizes(text)] });
  const head = ["recording", "camera", shift("since the first"), shift("since the one before"), { text: "would show since the first", raw: sizes("would show since the first") }], rows = [];
  data.recordings.slice(1).forEach((day) => data.cameras.forEach((camera, c) => {
    const first = shiftOf(day.since_first, camera.name), shows = first && first.detectable_m !== null && first.detectable_rad !== null;
    rows.push(Object.assign([named(dayText(data, day), c === 0), nameCell(data, camera.name), verdictCell(first), verdictCell(shiftOf(day.since_last, camera.name)),
      shows ? { text: `${figure(100 * first.detectable_m)} cm, ${figure((180 / Math.PI) * first.detectable_rad)}\u00b0`, raw: [100 * first.detectable_m, (180 / Math.PI) * first.detectable_rad] } : "\u2013"], { first: c === 0 && rows.length > 0 }));
  }));
  return section("verdicts", "Verdicts", "Whether a camera has moved, as rigproof moved judges it at one false alarm in a thousand; the last column is the smallest shift that is found with 90 % probability.",
    h("div", { class: "card" }, h("div", { class: "bar" }, copyButtons(() => [head, rows])), table(head, rows, { text: [0, 1, 2, 3], caption: "Verdicts" })));
}

function historyPosesSection(data) {
  const head = ["camera", "recording", "stops", ...poseHead()], rows = [];
  data.cameras.forEach((camera, c) => data.recordings.forEach((day, d) => {
    const pose = day.poses.find((p) => p.child === camera.name);
    const cells = AXES.map((_, axis) => (pose && pose.observable[axis] && pose.values[axis] !== null ? withSigma(inUnit(pose.values[axis], axis), inUnit(pose.value_sigmas ? pose.value_sigmas[axis] : null, axis), decimalsFor(inUnit(pose.value_sigmas ? pose.value_sigmas[axis] : null, axis))) : "\u2013"));
    rows.push(Object.assign([named(nameCell(data, camera.name), d === 0), dayText(data, day), String(day.stops), ...cells], { first: d === 0 && c > 0 }));
  }));
  return section("poses", "Poses", `In ${data.robot_frame}, with the sigmas that each result states.`,
    h("div", { class: "card" }, h("div", { class: "bar" }, copyButtons(() => [head, rows])), table(head, rows, { text: [0, 1], caption: "Poses" })));
}

function historyFindings(data) {
  const list = data.recordings.flatMap((day) => day.findings.map((finding) => h("li", {}, h("span", { class: "badge " + (SEVERITY[finding.severity] || "") }, finding.severity.replace("_", " ")),
    h("div", {}, h("div", {}, dayText(data, day) + ": ", prose(finding.sentence)), h("code", { class: "soft" }, finding.code)))));
  return list.length ? section("findings", "Findings", "What the comparisons and the results say besides.", h("div", { class: "card" }, h("ul", { class: "findings" }, list))) : null;
}

function showHistory(data) {
  const { level, word, why } = data.verdict;
  replace(document.getElementById("head"), h("div", { class: "top" }, h("h1", {}, data.title), h("span", { class: "brand" }, `Rigproof ${data.version} \u00b7 ${plural(data.recordings.length, "recording")} \u00b7 method ${data.method}`)),
    h("div", { class: "verdict " + level, role: "status" }, h("div", { class: "word" }, word), h("p", { class: "sentence" }, prose(data.verdict.sentence)),
      why.length ? h("ul", {}, why.map((line) => h("li", {}, prose(line)))) : null));
  const parts = [driftSection(data), verdictsSection(data), historyPosesSection(data), historyFindings(data)].filter(Boolean);
  document.getElementById("head").append(drawNavigation(parts));
  replace(document.getElementById("main"), ...parts);
  attached = true;
  redrawAll();
}
