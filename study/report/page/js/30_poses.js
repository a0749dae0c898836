// Poses with sigma, error and bound; the same as a picture.
const indexOfCamera = (data, name) => data.cameras.findIndex((camera) => camera.name === name);
const nameCell = (data, name) => ({ node: withSwatch(indexOfCamera(data, name), name), plain: name });
const nameOf = (pose, between) => (between ? `${pose.parent}\u2013${pose.child}` : pose.child);
const poseHead = () => ["tx [cm]", "ty [cm]", "tz [cm]", ...ANGLES.map((name) => name + " [deg]")].map(withSigmaHead);
const axisNames = () => AXES.map((name, i) => `${name} [${unitOf(i)}]`);

function withSigma(value, sigma, decimals) {
  const number = fixed(value, decimals);
  if (!(sigma > 0)) return { node: number, plain: number, raw: [value, ""] };
  const pm = `\u00b1${fixed(sigma, decimals)}`;
  return { node: h("span", {}, number, h("span", { class: "pm" }, "\u2009" + pm)), plain: number + pm, raw: [value, sigma] };
}

function poseRows(data, result) {
  return result.poses.map((pose) => [
    nameCell(data, pose.child),
    ...pose.values.map((value, axis) => {
      if (!pose.observable[axis]) return { text: "refused", plain: "" };
      const sigma = pose.value_sigmas ? inUnit(pose.value_sigmas[axis], axis) : 0;
      return withSigma(inUnit(value, axis), sigma, sigma > 0 ? decimalsFor(sigma) : 4);
    })]);
}

function errorRows(data, transforms, between) {
  const rows = [];
  for (const pose of transforms) {
    const name = between ? nameOf(pose, true) : nameCell(data, pose.child);
    const cells = (list, write) => AXES.map((_, axis) => {
      if (!pose.observable[axis]) return { text: list === pose.error || !pose.error ? "refused" : "", plain: "" };
      const value = list ? inUnit(list[axis], axis) : null;
      return value === null ? "\u2013" : { raw: value, ...write(value, axis) };
    });
    const decimals = (axis) => decimalsFor(pose.sigma ? inUnit(pose.sigma[axis], axis) : pose.bound ? inUnit(pose.bound[axis], axis) : 0.01);
    const kinds = [];
    if (pose.error) {
      kinds.push(["error", cells(pose.error, (value, axis) => ({
        text: signed(value, decimals(axis)), over: pose.sigma && pose.sigma[axis] > 0 && Math.abs(value) > 4 * inUnit(pose.sigma[axis], axis),
      }))]);
    }
    if (pose.sigma) kinds.push(["sigma", cells(pose.sigma, (value, axis) => ({ text: fixed(value, decimals(axis)) }))]);
    if (pose.bound) kinds.push(["bound", cells(pose.bound, (value, axis) => ({ text: fixed(value, Math.max(decimals(axis), decimalsFor(value))) }))]);
    kinds.forEach(([kind, list], i) => rows.push(Object.assign([named(name, i === 0), kind, ...list], { first: i === 0 && rows.length > 0 })));
  }
  return rows;
}

// One axis: a row a camera with the error, what was stated (1 and 2 sigma), and what the data allow at best.
function forestPanel(data, transforms, axis, between) {
  const rows = transforms.filter((pose) => pose.observable[axis] && (pose.sigma || pose.error));
  if (!rows.length) return null;
  // Long names stand above their bars, over the whole width.
  const names = rows.map((pose) => nameOf(pose, between)), isLong = Math.max(...names.map((name) => name.length)) > (between ? 15 : 11);
  const width = 340, left = isLong ? 8 : between ? 104 : 78, right = 12, top = 26, step = isLong ? 38 : 24, height = top + step * rows.length + 22;
  let extent = 0;
  for (const pose of rows) {
    const sigma = pose.sigma ? inUnit(pose.sigma[axis], axis) : 0;
    const error = pose.error ? Math.abs(inUnit(pose.error[axis], axis)) : 0;
    extent = Math.max(extent, 1.05 * (error + 2 * sigma), 1.1 * error, 1.3 * (pose.bound && pose.bound[axis] !== null ? inUnit(pose.bound[axis], axis) : 0));
  }
  if (!(extent > 0)) extent = 1e-3;
  const x = (value) => left + ((value / extent + 1) / 2) * (width - left - right);
  const tick = roundStep(extent * 0.999), nodes = [];
  for (const value of [-tick, 0, tick]) {
    nodes.push(s("line", { x1: x(value), x2: x(value), y1: top - 4, y2: height - 18, stroke: value === 0 ? color("soft") : color("line") }));
    nodes.push(s("text", { x: x(value), y: height - 4, "text-anchor": "middle" }, value === 0 ? "0" : minus(String(+value.toPrecision(2)))));
  }
  rows.forEach((pose, i) => {
    const y = top + step * i + (isLong ? 24 : 10), stroke = between ? color("accent") : cameraColor(indexOfCamera(data, pose.child));
    const error = pose.error ? inUnit(pose.error[axis], axis) : 0;
    const line = (half, thick) => s("line", { x1: x(Math.max(-extent, error - half)), x2: x(Math.min(extent, error + half)), y1: y, y2: y, stroke, "stroke-width": thick, "stroke-linecap": "round" });
    const sigma = pose.sigma ? inUnit(pose.sigma[axis], axis) : 0;
    const group = [s("text", { class: "name", ...(isLong ? { x: left, y: y - 11 } : { x: left - 10, y: y + 4, "text-anchor": "end" }) }, shortened(names[i], 50))];
    if (sigma > 0) group.push(line(2 * sigma, 1.6), line(sigma, 4));
    const bound = pose.bound && pose.bound[axis] !== null ? inUnit(pose.bound[axis], axis) : 0;
    if (bound > 0) for (const side of [-bound, bound]) group.push(s("line", { x1: x(side), x2: x(side), y1: y - 6, y2: y + 6, stroke: color("ink"), "stroke-width": 1.4, "stroke-dasharray": "2 2" }));
    if (pose.error) group.push(s("circle", { cx: x(error), cy: y, r: 4.4, fill: stroke, stroke: color("card"), "stroke-width": 1.5 }));
    const told = [pose.error ? `error ${figure(error)}` : "", sigma > 0 ? `sigma ${figure(sigma)}` : "", bound > 0 ? `bound ${figure(bound)}` : ""].filter(Boolean);
    nodes.push(s("g", {}, s("title", {}, `${nameOf(pose, between)} ${AXES[axis]}: ${told.join(", ")} ${unitOf(axis)}`), group));
  });
  const title = `${AXES[axis]} [${unitOf(axis)}]`;
  return s("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title + " of each camera" }, s("text", { class: "title", x: left, y: 14 }, title), nodes);
}
const shortened = (text, longest) => (text.length > longest ? text.slice(0, longest - 1) + "\u2026" : text);

function forestLegend(hasTruth, hasBound) {
  const icon = (...nodes) => s("svg", { width: 44, height: 16, "aria-hidden": "true" }, nodes);
  const bar = (x1, x2, thick) => s("line", { x1, x2, y1: 8, y2: 8, stroke: color("soft"), "stroke-width": thick, "stroke-linecap": "round" });
  return h("div", { class: "legend" },
    hasTruth ? h("span", {}, icon(s("circle", { cx: 22, cy: 8, r: 4.4, fill: color("soft") })), "error") : null,
    h("span", {}, icon(bar(4, 40, 1.6), bar(13, 31, 4)), "stated: 1 and 2 sigma"),
    hasBound ? h("span", {}, icon(...[12, 32].map((x) => s("line", { x1: x, x2: x, y1: 1, y2: 15, stroke: color("ink"), "stroke-width": 1.4, "stroke-dasharray": "2 2" }))), "what the data allow at best, 1 sigma") : null);
}

function forest(data, transforms, between) {
  const holder = h("div", {});
  whenShown(() => replace(holder, 
    h("div", { class: "forest" }, AXES.map((_, axis) => forestPanel(data, transforms, axis, between))),
    forestLegend(transforms.some((t) => t.error), transforms.some((t) => t.bound))));
  return holder;
}

// What the drive determines, in a sentence.
function determinedInWords(result) {
  const open = result.poses.map((pose) => [pose.child, AXES.filter((_, axis) => !pose.observable[axis])]).filter(([, axes]) => axes.length);
  if (!result.poses.length) return "";
  if (open.length) return `The drive leaves open ${open.map(([name, axes]) => `${axes.length === AXES.length ? "all" : axes.join(", ")} of ${name}`).join("; ")}. `;
  const count = result.poses.length;
  return `The drive determines all six degrees of freedom of ${count === 1 ? result.poses[0].child : `all ${count} cameras`}. `;
}

function posesSection(data, result) {
  const head = ["camera", ...poseHead()];
  const rows = poseRows(data, result);
  const cards = [];
  if (rows.length)
    cards.push(h("div", { class: "card" }, h("div", { class: "bar" }, h("h3", {}, `Pose in ${result.poses[0].parent}`), copyButtons(() => [head, rows])),
      table(head, rows, { caption: "Poses" })));
  else cards.push(h("div", { class: "card" }, "No pose is answered."));
  const both = [["robot", result.poses, false], ["between", result.pairs, true]].filter(([, list]) => list.some((t) => t.sigma || t.error));
  if (both.length) {
    const card = h("div", { class: "card" });
    const show = (which) => {
      const [, list, between] = both[which];
      const known = list.filter((t) => t.sigma || t.error || t.bound);
      const columns = [between ? "pair" : "camera", { text: "", raw: "kind" }, ...axisNames()], cells = errorRows(data, known, between);
      const names = both.map(([kind]) => (kind === "robot" ? "camera in robot" : "between cameras"));
      replace(card, h("div", { class: "bar" }, h("h3", {}, data.has_truth ? "Error, stated sigma, bound" : "Stated sigma"),
        both.length > 1 ? choice("of", names, show, which) : null, copyButtons(() => [columns, cells])),
      forest(data, known, between), h("details", { open: !between, style: { marginTop: "12px" } }, h("summary", {}, "as a table"), table(columns, cells, { text: [0, 1], caption: "Errors" })));
    };
    show(0);
    cards.push(card);
  }
  const lead = determinedInWords(result) + (data.has_truth
    ? "Angles of a pose are roll, pitch and yaw of the camera's body axes; errors are along and about the parent's axes. The bound is the least standard deviation that any unbiased method can have with these data and what is stated of lenses, board and depth; a method that finds them better than stated may be a little below it."
    : "Angles of a pose are roll, pitch and yaw of the camera's body axes; sigmas are standard deviations that the method states.");
  return section("poses", "Poses", lead, ...cards);
}
