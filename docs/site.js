// What scrolls can be reached by keyboard; the theme wraps tables only after it has loaded.
addEventListener("load", () => setTimeout(() => {
  for (const box of document.querySelectorAll(".md-typeset__scrollwrap, pre > code")) box.tabIndex = 0
}, 300))
