// The page's contents, folds, colours, tables and pictures.
(() => {
  "use strict";

  const root = document.documentElement, nav = document.getElementById("page_contents");
  const sections = [...document.querySelectorAll("details.section")];

  // --- light and dark ------------------------------------------------------------------------

  const THEME = "bellowsx-report-theme";

  function kept(value) {
    try {
      if (value !== undefined) localStorage.setItem(THEME, value);
      return localStorage.getItem(THEME);
    } catch {
      return null; // a browser that keeps nothing for files
    }
  }

  function connectTheme() {
    const button = document.getElementById("page_theme"), system = matchMedia("(prefers-color-scheme: dark)");
    const isDark = () => (root.dataset.theme ? root.dataset.theme === "dark" : system.matches);
    const label = () => (button.textContent = isDark() ? "Light" : "Dark");
    if (["light", "dark"].includes(kept())) root.dataset.theme = kept();
    button.addEventListener("click", () => {
      root.dataset.theme = isDark() ? "light" : "dark";
      kept(root.dataset.theme);
      label();
    });
    system.addEventListener("change", label);
    label();
    button.hidden = false;
  }

  // --- contents ------------------------------------------------------------------------------

  function connectContents() {
    const fold = nav.querySelector("details"), wide = matchMedia("(min-width: 75rem)");
    const fit = () => (fold.open = wide.matches);
    wide.addEventListener("change", fit);
    fit();
    nav.addEventListener("click", (event) => {
      if (event.target.closest("a") && !wide.matches) fold.open = false;
    });
    const links = new Map([...nav.querySelectorAll("a")].map((link) => [link.hash.slice(1), link]));
    const mark = () => {
      const above = sections.filter((section) => section.getBoundingClientRect().top < 120);
      const here = above.at(-1)?.querySelector("h2").id;
      for (const [id, link] of links) {
        if (id === here) link.setAttribute("aria-current", "true");
        else link.removeAttribute("aria-current");
      }
    };
    addEventListener("scroll", mark, { passive: true });
    mark();
  }

  // --- folds ---------------------------------------------------------------------------------

  /** Open all that an address lies in, and go there. */
  function reveal(hash) {
    const target = document.getElementById(decodeURIComponent(hash.slice(1))), closed = [];
    for (let at = target?.closest("details"); at; at = at.parentElement.closest("details"))
      if (!at.open) closed.push(at);
    for (const fold of closed) fold.open = true;
    if (closed.length) target.scrollIntoView();
  }

  function connectFolds() {
    const button = document.getElementById("page_folds");
    const allOpen = () => sections.every((section) => section.open);
    const label = () => (button.textContent = allOpen() ? "Fold all" : "Open all");
    button.addEventListener("click", () => {
      const open = !allOpen();
      for (const section of sections) section.open = open;
    });
    for (const section of sections) section.addEventListener("toggle", label);
    label();
    button.hidden = sections.length === 0;
    document.addEventListener("click", (event) => {
      const link = event.target.closest('a[href^="#"]');
      if (link) reveal(link.hash);
    });
    addEventListener("hashchange", () => reveal(location.hash));
    reveal(location.hash);
    let closed = [];
    addEventListener("beforeprint", () => {
      closed = [...document.querySelectorAll("main details:not([open])")];
      for (const fold of closed) fold.open = true;
    });
    addEventListener("afterprint", () => {
      for (const fold of closed) fold.open = false;
    });
  }

  // --- tables --------------------------------------------------------------------------------

  const NUMBER = /^[<>≤≥≈~]?\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?)\s*(s|min|h)?(?![a-z])/i;
  const SECONDS = { s: 1, min: 60, h: 3600 };
  const words = new Intl.Collator("en", { numeric: true });

  /** What a cell is sorted by: numbers before words before nothing. */
  function sortKey(cell) {
    const text = cell.textContent.trim();
    const plain = text
      .replace(/[\u2212\u2013](?=[\d.])/g, "-")
      .replace(/(\d)[\u202f,](?=\d{3}(?!\d))/g, "$1");
    const found = NUMBER.exec(plain);
    if (found) return { rank: 0, value: Number(found[1]) * (SECONDS[found[2]?.toLowerCase()] ?? 1), text };
    return { rank: /^[\u2013\u2014-]?$/.test(text) ? 2 : 1, value: 0, text };
  }

  function compare(one, other, sign) {
    if (one.rank !== other.rank) return one.rank - other.rank;
    return sign * (one.value - other.value || words.compare(one.text, other.text));
  }

  function sortBy(table, column, direction) {
    const body = table.tBodies[0], sign = direction === "descending" ? -1 : 1;
    const keyed = table.rowsAsMade.map((row) => ({ row, key: sortKey(row.cells[column]) }));
    if (direction) keyed.sort((one, other) => compare(one.key, other.key, sign));
    body.append(...keyed.map(({ row }) => row));
  }

  function connectTable(table) {
    const heads = [...table.tHead.rows[0].cells];
    table.rowsAsMade = [...table.tBodies[0].rows];
    if (table.rowsAsMade.length < 2) return;
    const next = { none: "ascending", ascending: "descending", descending: "" };
    heads.forEach((head, column) => {
      if (!head.textContent.trim()) return;
      const button = document.createElement("button");
      button.type = "button";
      button.append(...head.childNodes);
      head.append(button);
      button.addEventListener("click", () => {
        const direction = next[head.getAttribute("aria-sort") ?? "none"];
        for (const other of heads) other.removeAttribute("aria-sort");
        if (direction) head.setAttribute("aria-sort", direction);
        sortBy(table, column, direction);
      });
    });
  }

  /** A box that scrolls can be reached and scrolled by keys. */
  function connectBox(box) {
    const fit = () => {
      if (box.scrollWidth > box.clientWidth) {
        box.tabIndex = 0;
        box.setAttribute("role", "region");
        box.setAttribute("aria-label", "Table, scrolls sideways");
      } else for (const name of ["tabindex", "role", "aria-label"]) box.removeAttribute(name);
    };
    new ResizeObserver(fit).observe(box);
  }

  // --- pictures ------------------------------------------------------------------------------

  function connectPictures() {
    const dialog = document.getElementById("page_enlarged"), text = dialog.querySelector("p"), large = new Image();
    text.before(large);
    for (const image of document.querySelectorAll(".picture img")) {
      const button = document.createElement("button");
      button.type = "button";
      button.title = "Enlarge";
      image.replaceWith(button);
      button.append(image);
      button.addEventListener("click", () => {
        large.src = image.src;
        large.alt = text.textContent = image.alt;
        dialog.showModal();
      });
    }
    dialog.addEventListener("click", (event) => {
      if (event.target === dialog || event.target === large) dialog.close();
    });
  }

  connectTheme();
  connectContents();
  connectFolds();
  document.querySelectorAll("main table").forEach(connectTable);
  document.querySelectorAll(".table").forEach(connectBox);
  connectPictures();
})();
