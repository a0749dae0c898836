// The verdict first: the word, the sentence, why; then a few figures.
function worstOf(poses, key) {
  let place = null, angle = null;
  for (const pose of poses) {
    (pose[key] || []).forEach((value, axis) => {
      if (value === null || !pose.observable[axis]) return;
      const size = Math.abs(inUnit(value, axis));
      if (axis < 3) place = Math.max(place ?? 0, size);
      else angle = Math.max(angle ?? 0, size);
    });
  }
  return [place, angle];
}

function tiles(data, result) {
  const tile = (value, what) => h("div", { class: "tile" }, h("b", {}, value), h("span", {}, what));
  const used = result.use.reduce((sum, use) => sum + use.used, 0);
  const out = result.use.reduce((sum, use) => sum + use.left_out.reduce((n, group) => n + (group.depth ? 0 : group.stops.length), 0), 0);
  const list = [tile(`${data.cameras.length} \u00d7 ${data.drive.driven.length}`, "cameras \u00d7 stops")];
  if (result.use.length) list.push(tile(`${used}`, "images used" + (out > 0 ? `, ${out} left out` : "")));
  const answered = result.status === "solved" ? "" : ", of what is answered";
  const [sigmaPlace, sigmaAngle] = worstOf(result.poses, "sigma");
  if (sigmaPlace !== null) list.push(tile(`${figure(sigmaPlace)} cm`, "largest sigma of a position" + answered));
  if (sigmaAngle !== null) list.push(tile(`${figure(sigmaAngle)}\u00b0`, "largest sigma of an angle" + answered));
  const [errorPlace, errorAngle] = worstOf(result.poses, "error");
  if (errorPlace !== null) list.push(tile(`${figure(errorPlace)} cm`, "largest error of a position" + answered));
  if (errorAngle !== null) list.push(tile(`${figure(errorAngle)}\u00b0`, "largest error of an angle" + answered));
  if (result.nees) list.push(tile(result.nees.as_in_verdict.value, `NEES; 95 % lie in ${result.nees.as_in_verdict.within.replace("-", "\u2013")}`));
  return h("div", { class: "tiles" }, list);
}

function drawHead(data, result, onmethod) {
  const { level, word, why } = result.verdict;
  const scene = data.facts.filter(([name]) => name === "scene" || name === "seed").map(([name, value]) => (name === "seed" ? "seed " : "") + value);
  const methods = data.results.map((r) => r.method);
  replace(document.getElementById("head"), 
    h("div", { class: "top" }, h("h1", {}, data.title), h("span", { class: "brand" }, ["Rigproof report", ...scene].join(" \u00b7 ")),
      methods.length > 1 ? h("span", { class: "bar push" }, choice("method", methods, onmethod, data.results.indexOf(result)))
        : h("span", { class: "brand" }, "method " + result.method)),
    h("div", { class: "verdict " + level, role: "status" }, h("div", { class: "word" }, word), h("p", { class: "sentence" }, prose(result.verdict.sentence)),
      why.length ? h("ul", {}, why.map((line) => h("li", {}, prose(line)))) : null),
    tiles(data, result));
}

function drawNavigation(sections) {
  return h("nav", { "aria-label": "Sections" }, sections.map((node) => h("a", { href: "#" + node.id }, node.querySelector("h2").textContent)));
}
