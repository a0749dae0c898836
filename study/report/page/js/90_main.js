// Puts the page together; again when another method is chosen.
const data = JSON.parse(document.getElementById("report-data").textContent);

function show(index) {
  redraws.length = 0;
  attached = false;
  const result = data.results[index];
  drawHead(data, result, show);
  const parts = [
    rigSection(data, result), posesSection(data, result), budgetSection(data, result), methodsSection(data, show), framesSection(data, result),
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
