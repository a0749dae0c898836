"use strict";
// Elements, numbers and colours. All text goes through textContent: what is in the data cannot become markup.
const SVG = "http://www.w3.org/2000/svg";

function fill(node, properties, children) {
  for (const [key, value] of Object.entries(properties || {})) {
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (key === "style") Object.assign(node.style, value);
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(key, value === true ? "" : value);
  }
  node.append(...children.flat(4).filter((child) => child !== null && child !== undefined && child !== false));
  return node;
}
const replace = (node, ...children) => { node.replaceChildren(); return fill(node, {}, children); };
const h = (tag, properties, ...children) => fill(document.createElement(tag), properties, children);
const s = (tag, properties, ...children) => fill(document.createElementNS(SVG, tag), properties, children);

const color = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
const dark = matchMedia("(prefers-color-scheme: dark)");
const isPrinted = () => matchMedia("print").matches;
// The same camera has the same colour everywhere; the style sheet has them.
const CAMERA_COLORS = 8;
const cameraColorName = (index) => "camera-" + (index % CAMERA_COLORS);
const cameraColor = (index) => color(cameraColorName(index));
// Black or white, whichever is read better on "#rrggbb": by the contrast of WCAG 2.
function inkOn(background) {
  const [red, green, blue] = [1, 3, 5].map((at) => parseInt(background.slice(at, at + 2), 16) / 255).map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4));
  return 0.2126 * red + 0.7152 * green + 0.0722 * blue > 0.179 ? "#111" : "#fff";
}

const AXES = ["tx", "ty", "tz", "rx", "ry", "rz"];
const ANGLES = ["roll", "pitch", "yaw"];
const unitOf = (axis) => (axis < 3 ? "cm" : "deg");
const inUnit = (value, axis) => (value === null || value === undefined ? null : axis < 3 ? 100 * value : (180 / Math.PI) * value);

// Two digits of a sigma whose first is 1 or 2, else one.
function decimalsFor(sigma) {
  if (!(sigma > 0) || !isFinite(sigma)) return 3;
  const power = Math.floor(Math.log10(sigma));
  const first = Math.floor(sigma / 10 ** power);
  return Math.min(6, Math.max(0, -power + (first <= 2 ? 1 : 0)));
}
const minus = (text) => text.replace("-", "\u2212");
const fixed = (value, decimals) => {
  if (value === null || !isFinite(value)) return "\u2013";
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : minus(text);
};
const signed = (value, decimals) => {
  const text = fixed(value, decimals);
  return Number(value.toFixed(decimals)) > 0 ? "+" + text : text;
};
const figure = (value, digits = 2) => {
  if (value === null || value === undefined || !isFinite(value)) return "\u2013";
  if (value === 0) return "0";
  const decimals = Math.min(6, Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(value)))));
  return fixed(value, decimals);
};
const sentence = (text) => text.replaceAll("+-", "\u00b1");
// A sentence for a person: what stands between backticks is code.
const prose = (text) => sentence(text).split(/`([^`]+)`/).map((part, i) => (i % 2 ? h("code", {}, part) : part));
const plural = (count, noun) => `${count} ${noun}${count === 1 ? "" : "s"}`;
const rms = (values) => Math.sqrt(values.reduce((sum, v) => sum + v * v, 0) / Math.max(1, values.length));
const quantile = (values, q) => {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted.length ? sorted[Math.min(sorted.length - 1, Math.floor(q * sorted.length))] : 0;
};
const roundStep = (value) => {
  const power = 10 ** Math.floor(Math.log10(value));
  const leading = value / power;
  return power * (leading >= 5 ? 5 : leading >= 2 ? 2 : 1);
};

function section(id, title, lead, ...children) {
  return h("section", { id, "aria-labelledby": id + "-title" }, h("h2", { id: id + "-title" }, title),
    lead ? h("p", { class: "lead" }, lead) : null, ...children);
}
// On paper, what is chosen stands as text.
function choice(label, names, onchange, value = 0) {
  const printed = h("b", { class: "printed" }, names[value]);
  const select = h("select", { onchange: () => { printed.textContent = names[select.value]; onchange(Number(select.value)); } },
    names.map((name, i) => h("option", { value: i, selected: i === value }, name)));
  return h("label", {}, label, select, printed);
}
function checkbox(label, checked, onchange) {
  const box = h("input", { type: "checkbox", checked, onchange: () => onchange(box.checked) });
  return h("label", {}, box, label);
}
const swatch = (index) => h("span", { class: "dot", style: { background: `var(--${cameraColorName(index)})` }, "aria-hidden": "true" });
// Long names may break after an underscore, and parts of more than twenty letters anywhere.
const pieces = (part) => (part.length > 20 ? part.match(/.{1,10}/gsu) : part);
const breakable = (name) => name.split(/(?<=_)/).flatMap(pieces).map((part, i) => (i ? [h("wbr", {}), part] : part));
const withSwatch = (index, name) => h("span", { class: "named" }, swatch(index), h("span", {}, breakable(name)));

// What depends on the theme or on the size of its place is drawn once it has one, and again when the theme changes.
const redraws = [];
let attached = false;
function whenShown(draw) {
  redraws.push(draw);
  if (attached) draw();
}
function redrawAll() { for (const draw of redraws) draw(); }
dark.addEventListener("change", redrawAll);
matchMedia("print").addEventListener("change", redrawAll);

// Paper cannot be clicked: what is folded is printed, too.
let folded = [];
addEventListener("beforeprint", () => {
  folded = [...document.querySelectorAll("details:not([open])")];
  for (const node of folded) node.open = true;
});
addEventListener("afterprint", () => { for (const node of folded) node.open = false; });

// `legend`: which names it shows, since a chart that is drawn anew would forget them; several charts may share one.
function chart(node, optionOf, height, legend = { selected: {} }) {
  if (height) node.style.height = height + "px";
  let instance = null;
  const draw = () => {
    if (!instance) {
      instance = echarts.init(node, null, { renderer: "svg" });
      instance.on("legendselectchanged", (event) => {
        Object.assign(legend.selected, event.selected);
        if (legend.onchange) legend.onchange();
      });
      new ResizeObserver(() => instance.resize()).observe(node);
    }
    if (isPrinted()) instance.resize();
    const option = optionOf();
    instance.setOption({
      animation: false,
      textStyle: { fontFamily: getComputedStyle(document.body).fontFamily, color: color("ink") },
      aria: { enabled: true },
      ...option,
      ...(option.legend ? { legend: { ...option.legend, selected: legend.selected } } : {}),
    }, true);
  };
  whenShown(draw);
  return draw;
}
const axisStyle = () => ({
  axisLine: { lineStyle: { color: color("line") } }, axisTick: { show: false },
  axisLabel: { color: color("soft"), hideOverlap: true }, splitLine: { lineStyle: { color: color("faint") } },
  nameTextStyle: { color: color("soft") },
});
const tooltipStyle = () => ({
  backgroundColor: color("card"), borderColor: color("line"), textStyle: { color: color("ink"), fontSize: 13 }, renderMode: "richText",
});
