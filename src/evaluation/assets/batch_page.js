"use strict";
(function () {
  const section = document.getElementById("runs");
  const table = section.querySelector("table"), body = table.tBodies[0];
  const filter = document.getElementById("filter"), shown = document.getElementById("shown");
  const rows = [...body.rows];

  const wordsOf = (row) => row.textContent.toLowerCase();
  const cellOf = (row) => row.cells[0].textContent + " · " + row.cells[1].textContent;
  const show = function () {
    const text = filter.value.trim(), words = text.toLowerCase().split(/\s+/);
    let count = 0;
    for (const row of rows) {
      const fits = text.includes(" · ") ? cellOf(row) === text
                                        : words.every((word) => wordsOf(row).includes(word));
      row.hidden = !fits;
      count += fits ? 1 : 0;
    }
    shown.textContent = `${count} of ${rows.length}`;
  };
  filter.addEventListener("input", show);
  for (const link of document.querySelectorAll("a[data-filter]")) {
    link.addEventListener("click", function () {
      filter.value = link.dataset.filter;
      show();
    });
  }

  const valueOf = function (row, column) {
    const text = row.cells[column].textContent.trim();
    return text !== "" && !Number.isNaN(Number(text)) ? Number(text) : text;
  };
  const before = function (a, b) {
    const numbers = [typeof a === "number", typeof b === "number"];
    if (numbers[0] && numbers[1]) return a - b;
    if (numbers[0] !== numbers[1]) return numbers[0] ? -1 : 1;
    return a.localeCompare(b);
  };
  [...table.tHead.rows[0].cells].forEach(function (head, column) {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", function () {
      const down = head.ariaSort === "ascending";
      for (const other of table.tHead.rows[0].cells) other.ariaSort = null;
      head.ariaSort = down ? "descending" : "ascending";
      rows.sort((a, b) => before(valueOf(a, column), valueOf(b, column)) * (down ? -1 : 1));
      body.append(...rows);
    });
  });
  section.querySelector(".filter").hidden = false;
  show();
})();
