// What was found, left out, and estimated besides; how the data came about.
const SEVERITY = { cause: "bad", contradiction: "bad", refusal: "bad", suspect: "suspect" };

function findingsSection(result) {
  const all = [...result.reasons, ...result.notes];
  const list = all.map((finding) => h("li", {}, h("span", { class: "badge " + (SEVERITY[finding.severity] || "") }, finding.severity.replace("_", " ")),
    h("div", {}, h("div", {}, prose(finding.sentence)), finding.remedy && finding.severity !== "note" ? h("div", { class: "soft small" }, prose(finding.remedy)) : null, h("code", { class: "soft" }, finding.code))));
  return section("findings", "Findings", all.length ? "What speaks against the answer, and what is worth knowing; the codes are in docs/reference/findings.md." : null,
    h("div", { class: "card" }, all.length ? h("ul", { class: "findings" }, list) : "Nothing speaks against the answer."));
}

function stopList(stops) {
  const known = [...new Set(stops.filter((stop) => stop >= 0))].sort((a, b) => a - b), runs = [];
  for (const stop of known) {
    const last = runs[runs.length - 1];
    if (last && last[1] === stop - 1) last[1] = stop;
    else runs.push([stop, stop]);
  }
  return runs.map(([a, b]) => (a === b ? `${a}` : b === a + 1 ? `${a}, ${b}` : `${a}\u2013${b}`)).join(", ");
}

function leftOutSection(data, result) {
  const head = ["camera", "used", "left out", "why", "at stops"], rows = [];
  for (const use of result.use) {
    const name = nameCell(data, use.camera);
    if (!use.left_out.length) rows.push([name, String(use.used), "0", "", ""]);
    use.left_out.forEach((group, i) => rows.push(Object.assign([named(name, i === 0), i === 0 ? String(use.used) : "", String(group.stops.length), textCell((group.depth ? "depth: " : "") + group.reason), stopList(group.stops)], { first: i === 0 && rows.length > 0 })));
  }
  if (!rows.length) return null;
  return section("left-out", "What was left out", null, h("div", { class: "card" }, h("div", { class: "bar" }, copyButtons(() => [head, rows])), table(head, rows, { text: [0, 3, 4], caption: "Left out" })));
}

function titleOf(name) {
  const at = name.lastIndexOf("_");
  return at < 0 ? name : `${name.slice(0, at).replaceAll("_", " ")} [${name.slice(at + 1)}]`;
}

function alsoSection(data, result) {
  if (!result.also_estimated.length) return null;
  const head = ["of", "quantity", withSigmaHead("estimate"), { text: "stated before", raw: "sigma stated before" }, { text: "off by", raw: "off by [sigma]" }];
  const rows = result.also_estimated.map((q, i) => {
    const first = i === 0 || result.also_estimated[i - 1].camera !== q.camera, decimals = decimalsFor(q.sigma), z = q.prior_sigma > 0 ? q.value / q.prior_sigma : null;
    const name = q.camera ? nameCell(data, q.camera) : "rig and board";
    return Object.assign([named(name, first), titleOf(q.name), withSigma(q.value, q.sigma, decimals), q.prior_sigma > 0 ? { text: `\u00b1${figure(q.prior_sigma)}`, raw: q.prior_sigma } : "\u2013",
      z === null ? "\u2013" : { text: `${signed(z, 1)} sigma`, raw: z, over: Math.abs(z) > 4 }], { first: first && i > 0 });
  });
  return section("also", "Also estimated", "What calibrations and rulers leave: estimated together with the poses, as corrections of what was stated. \u201cOff by\u201d is in standard deviations of what was stated.",
    h("div", { class: "card" }, h("div", { class: "bar" }, copyButtons(() => [head, rows])), h("details", { open: rows.length <= 16 }, h("summary", {}, plural(rows.length, "quantity").replace("quantitys", "quantities")), table(head, rows, { text: [0, 1], caption: "Also estimated" }))));
}

function methodsSection(data, onmethod) {
  if (data.results.length < 2) return null;
  const number = (value, digits) => ({ text: figure(value, digits), raw: value ?? "" });
  const two = (result, key) => { const [place, angle] = worstOf(result.poses, key); return [number(place), number(angle)]; };
  const head = ["method", "verdict", ...(data.has_truth ? ["error [cm]", "error [deg]"] : []), "sigma [cm]", "sigma [deg]", "NEES"];
  const rows = data.results.map((result, i) => [{ node: h("button", { type: "button", onclick: () => onmethod(i) }, result.method), plain: result.method }, result.verdict.word,
    ...(data.has_truth ? two(result, "error") : []), ...two(result, "sigma"), number(result.nees ? result.nees.value : null, 3)]);
  return section("methods", "Methods", "The same data by every method; the largest of all cameras and axes.", h("div", { class: "card" }, h("div", { class: "bar" }, copyButtons(() => [head, rows])), table(head, rows, { text: [0, 1], caption: "Methods" })));
}

function originSection(data) {
  return section("origin", "Configuration and versions", null,
    h("div", { class: "card" }, h("dl", {}, data.facts.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]))),
    data.texts.map(({ name, text }) => h("details", { class: "card" }, h("summary", {}, name), h("pre", {}, text))));
}
