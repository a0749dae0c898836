// Puts the page together; again when another method is chosen.
const data = JSON.parse(document.getElementById("report-data").textContent);

// What is focused, or else the section at the window's upper edge, and how far below that edge it stands.
const FOCUSABLE = "a, button, select, input, summary, canvas, [tabindex]";
function placeInPage() {
  const focused = document.activeElement, root = focused.closest("section, #head");
  const isSeen = (node) => { const { top, bottom } = node.getBoundingClientRect(); return bottom > 0 && top < innerHeight; };
  const at = root ? [...root.querySelectorAll(FOCUSABLE)].indexOf(focused) : -1;
  const anchor = root && isSeen(focused) ? null : [...document.querySelectorAll("main > section")].find(isSeen);
  return { root: root && root.id, at, anchor: anchor && anchor.id, top: (anchor || focused).getBoundingClientRect().top };
}
function returnTo({ root, at, anchor, top }) {
  const focused = at < 0 ? null : document.getElementById(root)?.querySelectorAll(FOCUSABLE)[at];
  if (focused) focused.focus({ preventScroll: true });
  const node = anchor ? document.getElementById(anchor) : focused;
  if (node) scrollBy({ top: node.getBoundingClientRect().top - top, behavior: "instant" });
}

function change(index) {
  const place = placeInPage();
  show(index);
  returnTo(place);
}
function show(index) {
  redraws.length = 0;
  attached = false;
  const result = data.results[index];
  drawHead(data, result, change);
  const parts = [
    rigSection(data, result), posesSection(data, result), budgetSection(data, result), methodsSection(data, change), framesSection(data, result),
    cornersSection(data, result), findingsSection(result), leftOutSection(data, result), alsoSection(data, result), originSection(data),
  ].filter(Boolean);
  document.getElementById("head").append(drawNavigation(parts));
  replace(document.getElementById("main"), ...parts);
  attached = true;
  redrawAll();
}
if (data.kind === "sweep") showSweep(data);
else if (data.kind === "history") showHistory(data);
else show(0);
