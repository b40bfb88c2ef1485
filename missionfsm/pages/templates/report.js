"use strict";
// A link to something inside a folded part unfolds it.
function unfold() {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (!target) return;
  for (let part = target; part; part = part.parentElement) if (part.tagName === "DETAILS") part.open = true;
  target.scrollIntoView();
}
addEventListener("hashchange", unfold);
addEventListener("load", unfold);
document.addEventListener("click", (event) => {
  // A link to where the page already is changes no hash, and has to unfold all the same.
  const link = event.target.closest("a[href^='#']");
  if (link && link.getAttribute("href") === location.hash) unfold();
  const copy = event.target.closest("button[data-copies]");
  if (copy) copied(copy, document.getElementById(copy.dataset.copies).textContent);
  const legend = event.target.closest("button[data-shows]");
  if (legend) {
    const shown = legend.getAttribute("aria-pressed") !== "true";
    legend.setAttribute("aria-pressed", String(shown));
    legend.closest(".map").classList.toggle("hide-" + legend.dataset.shows, !shown);
  }
  const all = event.target.closest("button[data-folds]");
  if (all) {
    const open = all.dataset.folds === "open";
    for (const part of all.closest(".foldable").querySelectorAll("details.fold")) part.open = open;
  }
});
