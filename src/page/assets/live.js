"use strict";
// The live page: shows what its socket tells, and sends what its controls ask for. Everything that comes from outside becomes text.
(function () {
  const scene = JSON.parse(document.getElementById("scene").textContent);
  const data = { styles: scene.styles, vehicles: [], times: [0], frames: [[]], moments: [[]], plans: [[]],
    touched: [-1], views: {}, period: scene.period };
  const player = makePlayer(data);
  const part = (id) => document.getElementById(id);
  const news = { frame: null, run: "", pace: 1, values: null, points: [], over: false };
  const make = function (name, parent, text, style) {
    const element = document.createElement(name);
    if (text !== undefined) element.textContent = text;
    if (style) element.className = style;
    parent.appendChild(element);
    return element;
  };

  // What is asked for.
  const address = new URL("socket", location.href);
  address.protocol = "ws:";
  address.hash = "";
  const socket = new WebSocket(address);
  const waiting = new Map();  // what was asked, by number
  let asked = 0;
  const say = function (text, refused) {
    part("said").textContent = text;
    part("said").className = refused ? "refused" : "";
  };
  const send = function (command, text) {
    if (socket.readyState !== WebSocket.OPEN) return;
    waiting.set(++asked, text);
    socket.send(JSON.stringify({ id: asked, ...command }));
  };
  const steer = (what, value, text) => send({ do: "steer", what: what, value: String(value) },
    (text || what + " " + value) + ": in force from the next decision on");
  const due = new Map();  // the newest value of each slider that moves
  const slide = function (what, value) {
    const known = due.has(what);
    due.set(what, value);
    if (!known) setTimeout(function () { steer(what, due.get(what)); due.delete(what); }, 100);
  };
  const answer = function (one) {
    const text = waiting.get(one.id);
    waiting.delete(one.id);
    if (one.refused !== "") say("Refused: " + one.refused, true);
    else if (text) say(text, false);
  };

  // Controls of the pace.
  const paused = () => news.run === "paused";
  const toggle = function () {
    if (paused()) send({ do: "resume" }, "The session goes on");
    else send({ do: "pause" }, "Paused before the next tick");
  };
  const step = () => send({ do: "step", ticks: Number(part("ticks").value) },
    part("ticks").selectedOptions[0].textContent + " done");
  part("play").addEventListener("click", toggle);
  part("step").addEventListener("click", step);
  part("pace").addEventListener("change", () => send({ do: "pace", value: part("pace").value },
    "Pace: " + part("pace").selectedOptions[0].textContent));
  document.addEventListener("keydown", function (event) {
    if (event.ctrlKey || event.altKey || event.metaKey || event.target.closest("button, select, input, summary, a")) return;
    if (event.key === " ") toggle();
    else if (event.key === "ArrowRight" && paused()) step();
    else return;
    event.preventDefault();
  });
  const fillRun = function () {
    const texts = { playing: "Running", paused: "Paused", stepping: "Stepping", over: "Over" };
    part("headline").textContent = texts[news.run] || news.run;
    part("play").textContent = paused() ? "Play" : "Pause";
    part("step").disabled = !paused();
    const known = Array.from(part("pace").options).some((option) => option.value === String(news.pace));
    if (known && document.activeElement !== part("pace")) part("pace").value = String(news.pace);
  };

  // Controls of the guidance.
  const rows = new Map();  // by objective
  const touched = new Map();  // when a slider was moved last
  const free = (element) => performance.now() - (touched.get(element) || -1e4) > 1500;
  const watchNumber = function (what, range, number) {
    const move = function (from, to) {
      from.addEventListener("input", function () {
        touched.set(range, performance.now());
        if (from.value === "") return;
        to.value = from.value;
        slide(what, from.value);
      });
    };
    move(range, number);
    move(number, range);
  };
  const showNumber = function (range, number, value) {
    if (!free(range) || document.activeElement === number) return;
    range.value = value;
    number.value = value;
  };
  const objectiveRow = function (name) {
    const row = part("objectives").tBodies[0].insertRow();
    const word = name.replaceAll("_", " ");
    make("td", row, word);
    const weight = make("td", row), range = make("input", weight), number = make("input", weight);
    Object.assign(range, { type: "range", min: 0, max: 50, step: 0.5 });
    Object.assign(number, { type: "number", min: 0, step: "any" });
    range.setAttribute("aria-label", "Weight of " + word);
    number.setAttribute("aria-label", "Weight of " + word + " as a number");
    watchNumber("weight." + name, range, number);
    const value = make("td", row, "–", "number");
    const bar = make("span", make("td", row, undefined, "bar"));
    rows.set(name, { row, range, number, value, bar });
  };
  if (scene.guided) for (const name of scene.objectives) objectiveRow(name);
  part("all").addEventListener("click", function () {
    part("all").textContent = part("objectives").classList.toggle("all") ? "Active ones only" : "All objectives";
  });
  watchNumber("target_speed", part("speed"), part("speed-number"));
  part("profile").addEventListener("change", () => steer("profile", part("profile").value));
  const fillValues = function () {
    const values = news.values;
    if (values.profile && document.activeElement !== part("profile")) part("profile").value = values.profile;
    if (!Number.isNaN(Number(values.target_speed)))
      showNumber(part("speed"), part("speed-number"), values.target_speed);
    for (const [name, row] of rows) {
      showNumber(row.range, row.number, values.weights[name]);
      row.row.classList.toggle("idle", Number(values.weights[name]) === 0);
    }
  };
  // Share of each objective in the sum that the plan of one CBV was chosen by.
  const fillObjectives = function (reports) {
    const report = reports.find((one) => one[0] === chosen) || reports[0];
    part("objectives-of").textContent = report ? "CBV " + report[0] : "no CBV is driven now";
    const shares = new Map(report ? report[1].map((one) => [one[0], one]) : []);
    let most = 1e-9;
    for (const one of shares.values()) most = Math.max(most, Math.abs(one[1] * one[2]));
    for (const [name, row] of rows) {
      const one = shares.get(name);
      row.value.textContent = one ? one[2].toFixed(2) : "–";
      row.bar.style.width = one ? 100 * Math.abs(one[1] * one[2]) / most + "%" : "0";
      row.bar.className = one && one[1] * one[2] < 0 ? "below" : "";
    }
    part("challenge").textContent = report ? report[2] : "";
  };

  // Vehicles: chosen by a click in the picture, or by id.
  let chosen = "";
  const vehicleNow = function () {
    const numbers = data.frames[0];
    for (let i = 0; i < numbers.length; i += 6)
      if (data.vehicles[numbers[i]][0] === chosen) return numbers.slice(i, i + 6);
    return null;
  };
  const showChosen = function () {
    const layer = part("chosen"), numbers = vehicleNow();
    layer.replaceChildren();
    let role = "";
    if (numbers !== null) {
      const size = Math.max(14, 0.9 * data.vehicles[numbers[0]][1] * Number(player.view.dataset.magnification));
      player.svgElement("circle", { class: "chosen", cx: numbers[2] / 10, cy: numbers[3] / 10, r: size }, layer);
      role = numbers[1] === 0 ? "ego" : numbers[1] === 1 ? "background" : "CBV";
    }
    part("who").textContent = chosen === "" ? "Click a vehicle in the picture, or write its id."
      : numbers === null ? "Not in the picture now." : `${role}, ${(numbers[5] / 10).toFixed(1)} m/s`;
    part("choose").disabled = chosen === "" || role === "CBV" || role === "ego";
    part("release").disabled = chosen === "" || role === "background" || role === "ego";
    part("remove").disabled = chosen === "" || role === "ego";
  };
  const choose = function (id) {
    chosen = id;
    if (part("vehicle").value !== id) part("vehicle").value = id;
    showChosen();
    if (news.frame !== null) fillObjectives(news.frame.objectives);
  };
  part("vehicle").addEventListener("input", () => choose(part("vehicle").value));
  part("choose").addEventListener("click", () => steer("choose", chosen, chosen + " is to become a CBV"));
  part("release").addEventListener("click", () => steer("release", chosen, chosen + " becomes background"));
  part("remove").addEventListener("click", () => steer("remove", chosen, chosen + " is taken away"));
  let pressed = null;
  player.view.addEventListener("pointerdown", function (event) { pressed = [event.clientX, event.clientY]; });
  player.view.addEventListener("click", function (event) {
    if (pressed === null || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
    const place = new DOMPoint(event.clientX, event.clientY);
    const toScreen = player.view.getScreenCTM(), numbers = data.frames[0];
    let nearest = 24, found = "";
    for (let i = 0; i < numbers.length; i += 6) {
      const at = new DOMPoint(numbers[i + 2] / 10, numbers[i + 3] / 10).matrixTransform(toScreen);
      const apart = Math.hypot(at.x - place.x, at.y - place.y);
      if (apart < nearest) { nearest = apart; found = data.vehicles[numbers[i]][0]; }
    }
    choose(found);
  });

  // The picture.
  const drawn = new Map();  // trails by vehicle and style
  const drawTrails = function (points) {
    for (const point of points) {
      for (const [id, style, x, y] of point[1]) {
        const key = style + " " + id;
        if (!drawn.has(key)) {
          const line = player.svgElement("path", { class: "trail " + data.styles[style] }, part("trails"));
          drawn.set(key, { line, d: "", last: -1 });
        }
        const trail = drawn.get(key);
        trail.d += (trail.d === "" || point[0] - trail.last > 0.5 ? "M" : "L") + `${x / 10} ${y / 10}`;
        trail.last = point[0];
      }
    }
    for (const trail of drawn.values()) trail.line.setAttribute("d", trail.d);
  };
  const pin = function (x, y, parent) {
    const place = player.svgElement("g", { transform: `translate(${x / 10} ${y / 10})` }, parent);
    return player.svgElement("g", { class: "pin" }, place);
  };
  const drawConflicts = function (conflicts) {
    const layer = part("conflicts");
    layer.replaceChildren();
    for (const [id, style, x, y, route] of conflicts) {
      player.svgElement("path", { class: "planned " + data.styles[style], d: route }, layer);
      const mark = player.svgElement("path", { class: "conflict", d: "M-6 -6L6 6M6 -6L-6 6" }, pin(x, y, layer));
      player.svgElement("title", {}, mark).textContent = "conflict point of " + id;
    }
  };
  // Names of the vehicles that are driven.
  const drawNames = function (numbers) {
    const layer = part("names");
    layer.replaceChildren();
    for (let i = 0; i < numbers.length; i += 6) {
      if (numbers[i + 1] === 1) continue;
      const name = player.svgElement("text", { class: "name middle", y: -14 }, pin(numbers[i + 2], numbers[i + 3], layer));
      name.textContent = data.vehicles[numbers[i]][0].slice(0, 40);
    }
  };
  const drawGhosts = function (ghosts) {
    const layer = part("ghosts");
    layer.replaceChildren();
    for (const [id, x, y, turn] of ghosts)
      player.put(player.bodyOf(["competent driver in the ego's place, attacked by " + id, 4.5, 1.8], layer),
        "ghost", x / 10, y / 10, turn);
  };
  const drawContacts = function (contacts) {
    const layer = part("contacts");
    if (layer.childElementCount === contacts.length) return;
    layer.replaceChildren();
    for (const [text, x, y] of contacts) {
      const ring = player.svgElement("circle", { class: "contact", r: 11 }, pin(x, y, layer));
      player.svgElement("title", {}, ring).textContent = text;
    }
  };
  const fillIds = function (frame) {
    const ids = frame.vehicles.map((vehicle) => vehicle[1]);
    const list = part("vehicles-there");
    if (list.dataset.ids === ids.join(" ")) return;
    list.dataset.ids = ids.join(" ");
    list.replaceChildren();
    for (const id of ids) make("option", list).value = id;
  };
  const takeFrame = function (frame) {
    for (const [index, id, length, width] of frame.vehicles) data.vehicles[index] = [id, length, width];
    data.times[0] = frame.time;
    data.frames[0] = frame.numbers;
    data.moments[0] = frame.moment;
    data.plans[0] = frame.plans;
    for (const slot of frame.slots) sightOf(slot);
  };
  const sightOf = function (slot) {
    const old = document.querySelector(`.sight[data-slot="${slot}"]`);
    if (old !== null || scene.period <= 0) return;
    part("sights").appendChild(part("sight").content.firstElementChild.cloneNode(true)).dataset.slot = slot;
  };
  const drawFrame = function () {
    const frame = news.frame;
    takeFrame(frame);
    const speed = player.draw(0);
    part("now").textContent = `${frame.time.toFixed(2)} s` + (speed === null ? "" : `, ego ${speed.toFixed(1)} m/s`);
    drawConflicts(frame.conflicts);
    drawNames(frame.numbers);
    drawGhosts(frame.ghosts);
    drawContacts(frame.contacts);
    fillObjectives(frame.objectives);
    fillIds(frame);
    showChosen();
  };
  player.watchControls(function () { if (news.frame !== null) player.draw(0); });

  // Charts that grow: one line a vehicle, from the begin to now.
  const kWidth = 540, kHeight = 190, kLeft = 42, kRight = 528, kTop = 12, kBottom = 166;
  const niceStep = function (span, count) {
    const raw = span / count, power = 10 ** Math.floor(Math.log10(raw));
    return power * [1, 2, 5, 10].find((factor) => factor * power >= raw * (1 - 1e-9));
  };
  const linesOf = function (column, longest) {
    const stride = 1 + Math.floor(news.points.length / 1500), lines = new Map();
    for (let i = 0; i < news.points.length; i += stride) {
      const [time, vehicles] = news.points[i];
      for (const vehicle of vehicles) {
        const value = vehicle[column];
        if (value < 0 || value > longest) continue;
        const key = vehicle[1] + " " + vehicle[0];
        if (!lines.has(key)) lines.set(key, { style: data.styles[vehicle[1]], places: [] });
        lines.get(key).places.push([time, value]);
      }
    }
    return lines;
  };
  const drawChart = function (id, column, least, longest, unit) {
    const svg = part(id), lines = linesOf(column, longest);
    const last = news.points.length === 0 ? 0 : news.points[news.points.length - 1][0];
    const end = Math.max(10, last);
    let top = least;
    for (const line of lines.values()) for (const place of line.places) top = Math.max(top, place[1]);
    const step = niceStep(top, 4), seconds = niceStep(end, 8);
    top = step * Math.ceil(top / step - 1e-9);
    const x = (time) => (kLeft + (kRight - kLeft) * time / end).toFixed(1);
    const y = (value) => (kBottom - (kBottom - kTop) * value / top).toFixed(1);
    const text = (style, px, py, content) =>
      { player.svgElement("text", { class: style, x: px, y: py }, svg).textContent = content; };
    svg.replaceChildren();
    for (let value = 0; value <= top + 1e-9; value += step) {
      player.svgElement("path", { class: "grid", d: `M${kLeft} ${y(value)}H${kRight}` }, svg);
      text("tick end", kLeft - 6, Number(y(value)) + 4, String(Number(value.toFixed(6))));
    }
    for (let time = 0; time <= end + 1e-9; time += seconds) {
      const farthest = time + seconds > end + 1e-9;
      text(farthest ? "tick end" : "tick middle", farthest ? Math.min(Number(x(time)) + 12, kWidth - 2) : x(time), kHeight - 7,
        Number(time.toFixed(6)) + (farthest ? " s" : ""));
    }
    for (const line of lines.values()) {
      let d = "", before = -1;
      for (const [time, value] of line.places) {
        d += (before < 0 || time - before > 0.5 + end / 500 ? "M" : "L") + x(time) + " " + y(value);
        before = time;
      }
      player.svgElement("path", { class: "series " + line.style, d: d + "h0.1" }, svg);
    }
    text("tick end", kRight, kTop + 4, unit);
  };
  const drawCharts = function () {
    drawChart("speed-chart", 4, 5, 1e9, "m/s");
    drawChart("ttc-chart", 5, 10, 10, "s");
    drawChart("gap-chart", 6, 10, 60, "m");
    drawChart("score-chart", 7, 1, 1, "");
  };

  // Tables.
  const fillVerdict = function (verdict) {
    part("so-far").textContent = verdict.text;
    part("banner").className = "banner " + verdict.style;
    const body = part("rules").tBodies[0];
    body.replaceChildren();
    for (const [outcome, word, text] of verdict.rules) {
      const row = make("tr", body, undefined, outcome);
      make("td", row, word);
      make("td", row, text);
    }
    part("no-rules").hidden = verdict.rules.length > 0;
  };
  const addRows = function (id, lists) {
    for (const list of lists) {
      const row = make("tr", part(id).tBodies[0]);
      for (const text of list) make("td", row, text);
    }
    if (lists.length > 0) part(id).hidden = false;
    if (lists.length > 0) part("no-" + id).hidden = true;
  };

  // What comes.
  let changed = false;
  const draw = function () {
    changed = false;
    if (news.frame !== null) drawFrame();
    drawCharts();
  };
  const take = function (message) {
    for (const one of message.answers || []) answer(one);
    if (message.frame) news.frame = message.frame;
    if (message.points) {
      news.points.push(...message.points);
      drawTrails(message.points);
    }
    for (const [slot, view] of Object.entries(message.views || {})) data.views[slot] = [view];
    if (message.run !== undefined) { news.run = message.run; news.pace = message.pace; fillRun(); }
    if (message.values) { news.values = message.values; fillValues(); }
    if (message.verdict) fillVerdict(message.verdict);
    addRows("changes", message.changes || []);
    for (const [at, , text, refused] of message.changes || [])
      if (refused !== "") say(`Refused at ${at} s: ${text} (${refused})`, true);
    addRows("faults", message.faults || []);
    if (message.over) {
      news.over = true;
      part("headline").textContent = "Over";
      if (message.over.report) {
        say("The session is over. Its report opens here.", false);
        location.replace("report.html");
      } else {
        say("The session is over. It has no report; the result folder holds what it wrote.", true);
      }
    }
    if (!changed && !document.hidden) requestAnimationFrame(draw);
    changed = changed || !document.hidden;
  };
  socket.addEventListener("message", (event) => take(JSON.parse(event.data)));
  socket.addEventListener("close", function () {
    if (news.over) return;
    part("headline").textContent = "No connection";
    part("so-far").textContent = "The session is over, or has dropped this page. Its report is in the result folder. " +
      "Where the session still runs, loading this page again shows it.";
    for (const control of document.querySelectorAll("button, select, input")) control.disabled = true;
  });
  document.addEventListener("visibilitychange", function () { if (!document.hidden) requestAnimationFrame(draw); });

  for (const id of ["sights", "moment"]) part(id).hidden = false;
  player.zoomToWidth(Math.min(window.innerWidth < 600 ? 110 : 180, scene.width));
  drawCharts();
  showChosen();
  document.documentElement.dataset.ready = "yes";
})();
