// Images with corners: small ones in a grid, a large one in a dialog.
const STRIDE = 6;  // of a frame's corners: id, u, v, and the covariance's uu, uv, vv
const cornersOf = (frame) => {
  const list = [];
  for (let i = 0; frame.corners && i < frame.corners.length; i += STRIDE) {
    const [id, u, v, uu, uv, vv] = frame.corners.slice(i, i + STRIDE);
    const truth = frame.true ? frame.true.slice((i / STRIDE) * 2, (i / STRIDE) * 2 + 2) : null;
    list.push({ id, u, v, uu, uv, vv, truth: truth && truth[0] !== null ? truth : null });
  }
  return list;
};
const fitOf = (result, index) => result.corner_fit.differences[index];
const leftOut = (data, result, index) => data.frames[index].left_out || result.left_out_frames[index] || null;
const frameRms = (result, index) => {
  const fit = fitOf(result, index);
  return fit ? rms(fit.filter((v) => v !== null)) : null;
};

let imagesOnce = null;
const images = () => (imagesOnce ??= JSON.parse(document.getElementById("report-images").textContent));
const pictureOf = (index, which) => {
  const pair = images()[index];
  return pair && pair[which] ? "data:image/jpeg;base64," + pair[which] : null;
};

// Pixel centres are integers: the image begins half a pixel before the first.
function cornersDrawing(frame, value, box, radius) {
  const corners = cornersOf(frame), [x, y, width, height] = box;
  return s("svg", { viewBox: `${x - 0.5} ${y - 0.5} ${width} ${height}`, preserveAspectRatio: "none", "aria-hidden": "true" },
    corners.length > 1 ? s("polyline", { points: corners.map((c) => `${c.u},${c.v}`).join(" "), fill: "none", stroke: value, "stroke-width": radius * 0.7, "stroke-opacity": 0.85 }) : null,
    corners.map((c) => s("circle", { cx: c.u, cy: c.v, r: radius, fill: value, stroke: "#fff", "stroke-width": radius * 0.35 })),
    corners.filter((c) => c.id === 0).map((c) => s("circle", { cx: c.u, cy: c.v, r: radius * 2.6, fill: "none", stroke: "#e02020", "stroke-width": radius * 0.7 })));
}

// Cells of the image whose depth lies on the ground plane; nothing where there is no plane.
const groundOf = (index) => (images()[index] || [])[2] || null;
function groundDrawing([columns, cells]) {
  const rows = cells.length / columns, nodes = [];
  for (const found of cells.matchAll(/g+/g)) {
    // A run may go on in the next row.
    for (let at = found.index, end = at + found[0].length; at < end; ) {
      const row = Math.floor(at / columns), stop = Math.min(end, (row + 1) * columns);
      nodes.push(s("rect", { x: at % columns, y: row, width: stop - at, height: 1 }));
      at = stop;
    }
  }
  return s("svg", { class: "ground", viewBox: `0 0 ${columns} ${rows}`, preserveAspectRatio: "none", "aria-hidden": "true",
    fill: "#18c964", "fill-opacity": 0.38, "shape-rendering": "crispEdges" }, nodes);
}
function groundSentence(index, camera) {
  const ground = groundOf(index);
  if (!ground) return camera.has_depth ? "No ground plane was found in the depth of this image." : "";
  const on = ground[1].split("g").length - 1, measured = ground[1].replaceAll(".", "").length;
  return `Green: depth that lies on the ground plane fitted here, ${Math.round((100 * on) / measured)} % of where there is depth.`;
}

function frameTitle(data, index) {
  const frame = data.frames[index];
  return `${data.cameras[frame.camera].name}, ${frame.stop >= 0 ? "stop " + frame.stop : frame.file}`;
}

// Detected, expected with what its noise allows, and true corners, with differences magnified about the expected place.
function cornersClose(data, result, index, magnified) {
  const frame = data.frames[index], camera = data.cameras[frame.camera];
  const fit = fitOf(result, index), box = frame.crop || [0, 0, camera.width, camera.height], unit = Math.max(box[2], box[3]) / 420;
  // What no lens model follows comes on top of the detector's noise, the same in all directions.
  const nodes = [], value = cameraColor(frame.camera), lens2 = (camera.lens_residual_px || 0) ** 2;
  cornersOf(frame).forEach((c, i) => {
    const fitted = fit && fit[2 * i] !== null, difference = fitted ? [fit[2 * i], fit[2 * i + 1]] : [0, 0];
    const at = [c.u - difference[0], c.v - difference[1]], far = (d) => [at[0] + magnified * d[0], at[1] + magnified * d[1]];
    if (fitted) {
      const half = 0.5 * Math.atan2(2 * c.uv, c.uu - c.vv), mean = (c.uu + c.vv) / 2 + lens2, away = Math.hypot((c.uu - c.vv) / 2, c.uv);
      nodes.push(s("ellipse", { cx: at[0], cy: at[1], rx: 2 * magnified * Math.sqrt(mean + away), ry: 2 * magnified * Math.sqrt(Math.max(0, mean - away)),
        transform: `rotate(${(half * 180) / Math.PI} ${at[0]} ${at[1]})`, fill: "#ffe14d", "fill-opacity": 0.35, stroke: "#ffe14d", "stroke-width": unit }));
      const [x, y] = far(difference);
      nodes.push(s("line", { x1: at[0], y1: at[1], x2: x, y2: y, stroke: value, "stroke-width": 1.8 * unit }));
      nodes.push(s("circle", { cx: x, cy: y, r: 2.6 * unit, fill: value, stroke: "#fff", "stroke-width": 0.8 * unit }));
    } else nodes.push(s("circle", { cx: c.u, cy: c.v, r: 2.6 * unit, fill: value, stroke: "#fff", "stroke-width": 0.8 * unit }));
    if (c.truth) {
      const [x, y] = far([c.truth[0] - at[0], c.truth[1] - at[1]]), d = 3.4 * unit;
      nodes.push(s("path", { d: `M${x - d} ${y - d}L${x + d} ${y + d}M${x - d} ${y + d}L${x + d} ${y - d}`, stroke: "#18c964", "stroke-width": 1.4 * unit }));
    }
  });
  return s("svg", { viewBox: `${box[0] - 0.5} ${box[1] - 0.5} ${box[2]} ${box[3]}`, role: "img", "aria-label": "Corners of the board" }, nodes);
}

// So that a typical difference is a thirtieth of a typical board's width.
function firstMagnification(data, result) {
  const sizes = [], differences = [];
  data.frames.forEach((frame, index) => {
    if (frame.crop) sizes.push(Math.max(frame.crop[2], frame.crop[3]));
    const size = frameRms(result, index);
    if (size !== null) differences.push(size);
  });
  const typical = quantile(differences, 0.5);
  return typical > 0 ? Math.min(4, Math.max(0, Math.log10(quantile(sizes, 0.5) / 30 / typical))) : 0;
}

const framePicture = (source, box, overlay, label) => h("div", { class: "picture", style: { aspectRatio: `${box[2]} / ${box[3]}` } },
  source ? h("img", { src: source, alt: label }) : null, overlay);

class FrameDialog {
  constructor(data, result) {
    Object.assign(this, { data, result, list: [], at: 0, scale: firstMagnification(data, result) });
    // What has the focus stays when another image is drawn: only what stands below is replaced.
    const button = (label, text, onclick) => h("button", { type: "button", "aria-label": label, onclick }, text);
    this.title = h("h3", { "aria-live": "polite" });
    this.facts = h("span", { class: "soft" });
    this.content = h("div", { style: { marginTop: "0" } });
    this.node = h("dialog", { "aria-label": "Image" },
      h("div", { class: "bar" }, this.title, this.facts,
        h("span", { class: "copy push" }, button("previous image", "\u2190", () => this.step(-1)), button("next image", "\u2192", () => this.step(1)),
          h("button", { type: "button", autofocus: true, onclick: () => this.node.close() }, "close"))),
      this.content);
    this.node.addEventListener("keydown", (event) => {
      if (event.target.matches("input, select")) return;
      if (event.key === "ArrowRight") this.step(1);
      if (event.key === "ArrowLeft") this.step(-1);
    });
    this.node.addEventListener("click", (event) => { if (event.target === this.node) this.node.close(); });
  }
  open(list, at) {
    Object.assign(this, { list, at });
    this.draw();
    if (!this.node.open) this.node.showModal();
  }
  step(by) {
    this.at = (this.at + by + this.list.length) % this.list.length;
    this.draw();
  }
  draw() {
    const { data, result } = this, index = this.list[this.at], frame = data.frames[index];
    const out = leftOut(data, result, index), size = frameRms(result, index);
    this.title.textContent = frameTitle(data, index);
    this.facts.textContent = [`image ${frame.file || "(none)"}`, frame.corners ? plural(frame.corners.length / STRIDE, "corner") : "",
      size !== null ? `rms ${figure(size)} px` : ""].filter(Boolean).join(" \u00b7 ");
    replace(this.content,
      out ? h("p", { style: { color: color("bad"), marginTop: "6px" } }, "left out: ", prose(out.sentence), " ", h("code", {}, out.code)) : null,
      h("div", { class: "big" }, this.wholeImage(index), frame.corners ? this.closeUp(index) : null));
  }
  wholeImage(index) {
    const frame = this.data.frames[index], camera = this.data.cameras[frame.camera], whole = pictureOf(index, 0);
    const box = [0, 0, camera.width, camera.height], ground = groundOf(index);
    return h("div", {},
      framePicture(whole, box, [ground ? groundDrawing(ground) : null, cornersDrawing(frame, cameraColor(frame.camera), box, camera.width / 260)], "The whole image"),
      whole ? h("p", { class: "small soft", style: { marginTop: "6px" } }, groundSentence(index, camera)) : null);
  }
  closeUp(index) {
    const { data, result } = this, frame = data.frames[index], camera = data.cameras[frame.camera];
    const box = frame.crop || [0, 0, camera.width, camera.height], place = h("div", {}), told = h("output", {});
    const slider = h("input", { type: "range", min: 0, max: 4, step: 0.05, value: this.scale, oninput: () => { this.scale = Number(slider.value); draw(); } });
    const draw = () => {
      const k = 10 ** this.scale;
      told.textContent = "\u00d7" + (k < 10 ? figure(k) : Math.round(k));
      replace(place, framePicture(pictureOf(index, frame.crop ? 1 : 0), box, cornersClose(data, result, index, k), "The board, cut out"));
    };
    draw();
    return h("div", {}, place, h("div", { class: "bar", style: { marginTop: "8px" } }, h("label", {}, "differences", slider, told)),
      h("p", { class: "small soft", style: { marginTop: "6px" } }, "Dot: detected. Ellipse: expected place with twice the sigma that detector and lens let expect",
        data.has_truth ? "; green cross: true." : ".", " The expected place is that of the board that fits all views of this stop best through the calibrated rig."));
  }
}

function framesSection(data, result) {
  if (!data.frames.length) return null;
  const dialog = new FrameDialog(data, result), grid = h("div", { class: "frames", tabindex: "0", role: "region", "aria-label": "Images" });
  const cameras = ["all cameras", ...data.cameras.map((c) => c.name)], kinds = ["all images", "used", "left out"], orders = ["by stop", "by residual"];
  const filter = { camera: 0, kind: 0, order: 0 }, count = h("span", { class: "soft" });
  const seen = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      seen.unobserve(target);
      drawThumb(target);
    }
  }, { root: grid, rootMargin: "400px" });
  function drawThumb(node) {
    const index = Number(node.dataset.index), frame = data.frames[index], camera = data.cameras[frame.camera], source = pictureOf(index, 0);
    replace(node.querySelector(".picture"), source ? h("img", { src: source, alt: "" }) : h("span", { class: "none" }, "no image"),
      cornersDrawing(frame, cameraColor(frame.camera), [0, 0, camera.width, camera.height], camera.width / 130));
  }
  function thumb(index, list, at) {
    const frame = data.frames[index], camera = data.cameras[frame.camera], out = leftOut(data, result, index), size = frameRms(result, index);
    return h("button", { type: "button", class: "frame" + (out ? " out" : ""), "data-index": index, onclick: () => dialog.open(list, at) },
      h("span", { class: "picture", style: { aspectRatio: `${camera.width} / ${camera.height}` } }),
      h("span", { class: "caption" }, h("b", {}, breakable(frameTitle(data, index))), h("br"),
        h("span", { class: "soft" }, out ? prose(out.sentence) : size !== null ? `rms ${figure(size)} px` : frame.corners ? plural(frame.corners.length / STRIDE, "corner") : "")));
  }
  function show() {
    let list = data.frames.map((_, i) => i).filter((i) => (filter.camera === 0 || data.frames[i].camera === filter.camera - 1) &&
      (filter.kind === 0 || (filter.kind === 2) === Boolean(leftOut(data, result, i))));
    list.sort((a, b) => (filter.order === 1 ? (frameRms(result, b) ?? -1) - (frameRms(result, a) ?? -1)
      : data.frames[a].stop - data.frames[b].stop || data.frames[a].camera - data.frames[b].camera));
    count.textContent = plural(list.length, "image");
    seen.disconnect();
    replace(grid, ...list.map((index, at) => thumb(index, list, at)));
    for (const node of grid.children) seen.observe(node);
    grid.scrollTop = 0;
  }
  show();
  const set = (key) => (value) => { filter[key] = value; show(); };
  return section("images", "Images", "Every image with its detected corners; the first corner has a ring. Choose one to see it larger, with residuals magnified.",
    h("div", { class: "card" }, h("div", { class: "bar" }, choice("of", cameras, set("camera")), choice("show", kinds, set("kind")), choice("sorted", orders, set("order")), count), grid), dialog.node);
}
