"use strict";
// What the player of a session draws at a time: the picture from above with zoom and drag, the table of the moment, the front views.
// `data` holds lists by frame (times, frames, moments, plans, touched, gazes, perceived), vehicles, styles and views; page/player_parts.h
// says what their numbers are. A page may add to them and exchange them between two calls of `draw`.
const makePlayer = function (data) {
  const view = document.getElementById("top-view");
  const layer = document.getElementById("vehicles");
  const follow = document.getElementById("follow");
  const full = view.viewBox.baseVal;
  const whole = { x: 0, y: 0, w: full.width, h: full.height };
  const scale = Number(view.dataset.magnification);
  const boxes = new Map();
  const svgElement = function (name, attributes, parent) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    parent.appendChild(element);
    return element;
  };
  // A vehicle (id, length, width) around the origin, nose to the right.
  const bodyOf = function (vehicle, parent) {
    const l = 0.5 * vehicle[1] * scale, w = 0.5 * vehicle[2] * scale;
    const box = svgElement("g", {}, parent);
    svgElement("title", {}, box).textContent = vehicle[0];
    svgElement("path", { d: `M${-l} ${-w}H${l}V${w}H${-l}Z` }, box);
    svgElement("path", { class: "nose",
      d: `M${0.3 * l} ${-0.8 * w}L${0.8 * l} 0L${0.3 * l} ${0.8 * w}Z` }, box);
    return box;
  };
  const boxOf = function (index) {
    if (!boxes.has(index)) boxes.set(index, bodyOf(data.vehicles[index], layer));
    return boxes.get(index);
  };
  const put = function (box, style, x, y, turn) {
    box.setAttribute("class", "vehicle " + style);
    box.setAttribute("transform", `translate(${x} ${y}) rotate(${turn})`);
  };

  let zoom = 1;
  let center = { x: whole.w / 2, y: whole.h / 2 };
  const look = function () {
    const w = whole.w / zoom, h = whole.h / zoom;
    if (!follow.checked) {
      center.x = Math.min(Math.max(center.x, w / 2), whole.w - w / 2);
      center.y = Math.min(Math.max(center.y, h / 2), whole.h - h / 2);
    }
    view.setAttribute("viewBox", `${center.x - w / 2} ${center.y - h / 2} ${w} ${h}`);
    view.style.setProperty("--zoom", zoom);
  };
  const zoomTo = function (value) { zoom = Math.min(Math.max(value, 1), 16); look(); };
  // A picture so many meters wide.
  const zoomToWidth = (meters) => zoomTo(whole.w / (meters * Number(view.dataset.pixelsPerMeter)));
  const nearestGap = function (frame) {
    const numbers = data.moments[frame];
    let found = null;
    for (let i = 0; i < numbers.length; i += 7)
      if (numbers[i + 1] >= 0 && numbers[i + 5] >= 0 && (found === null || numbers[i + 5] < found[1]))
        found = [numbers[i], numbers[i + 5]];
    return found;
  };
  // The vehicle that the ego touches in a frame, else its nearest CBV; null without either.
  const partnerOf = function (frame) {
    if (data.touched[frame] >= 0) return data.touched[frame];
    const near = nearestGap(frame);
    return near === null ? null : near[0];
  };
  // Shows ego and partner of a frame, the picture at least 60 m wide.
  const focus = function (frame) {
    const numbers = data.frames[frame], partner = partnerOf(frame), places = [];
    for (let i = 0; i < numbers.length; i += 6)
      if (numbers[i + 1] === 0 || numbers[i] === partner)
        places.push({ x: numbers[i + 2] / 10, y: numbers[i + 3] / 10 });
    if (places.length === 0) return;
    const middle = (key) => places.reduce((sum, at) => sum + at[key], 0) / places.length;
    center = { x: middle("x"), y: middle("y") };
    let apart = 0;
    for (const at of places) apart = Math.max(apart, Math.hypot(at.x - center.x, at.y - center.y));
    follow.checked = false;
    zoomTo(whole.w / Math.max(60 * Number(view.dataset.pixelsPerMeter), 6 * apart));
  };

  const speedOf = function (numbers, index) {
    for (let i = 0; i < numbers.length; i += 6) if (numbers[i] === index) return numbers[i + 5] / 10;
    return null;
  };
  const styleOf = function (numbers, index) {
    for (let i = 0; i < numbers.length; i += 6)
      if (numbers[i] === index) return data.styles[numbers[i + 1]];
    return "cbv";
  };
  const cell = function (row, text, style) {
    const element = row.insertCell();
    element.textContent = text;
    element.className = style;
  };
  const fillMoment = function (frame) {
    const body = document.querySelector("#moment tbody"), numbers = data.moments[frame];
    body.replaceChildren();
    for (let i = 0; i < numbers.length; i += 7) {
      const row = body.insertRow(), index = numbers[i], slot = numbers[i + 1];
      row.className = slot < 0 ? "ego" : styleOf(data.frames[frame], index);
      const speed = speedOf(data.frames[frame], index);
      cell(row, slot < 0 ? "ego" : data.vehicles[index][0], "");
      cell(row, speed === null ? "–" : speed.toFixed(1), "number");
      for (let k = 2; k < 5; ++k) cell(row, (numbers[i + k] / 100).toFixed(2), "number");
      for (let k = 5; k < 7; ++k) {
        cell(row, numbers[i + k] < 0 ? "–" : (numbers[i + k] / 100).toFixed(2), "number");
      }
    }
  };
  const vehicleInSlot = function (frame, slot) {
    const numbers = data.moments[frame];
    for (let i = 0; i < numbers.length; i += 7) if (numbers[i + 1] === slot) return numbers[i];
    return null;
  };
  const viewAt = function (slot, index, time) {
    let found = null;
    for (const view of data.views[slot] || []) {
      if (view[0] > time + 0.005) break;
      if (view[1] === index && time - view[0] < 1.5 * data.period) found = view;
    }
    return found;
  };
  const showSights = function (frame) {
    for (const sight of document.querySelectorAll(".sight")) {
      const slot = Number(sight.dataset.slot), index = vehicleInSlot(frame, slot);
      const view = index === null ? null : viewAt(slot, index, data.times[frame]);
      const image = sight.querySelector("img"), nothing = sight.querySelector(".nothing");
      image.hidden = view === null;
      nothing.hidden = view !== null;
      nothing.textContent = index === null ? "No CBV now" : "No picture yet";
      sight.className = "sight " + (index === null ? "" : styleOf(data.frames[frame], index));
      let text = index === null ? "" : data.vehicles[index][0];
      if (view !== null) {
        image.setAttribute("src", "data:image/jpeg;base64," + view[2]);
        text += ` at ${view[0].toFixed(1)} s`;
      }
      sight.querySelector("figcaption").textContent = text;
    }
  };
  const placeOf = function (numbers, index) {
    for (let i = 0; i < numbers.length; i += 6)
      if (numbers[i] === index) return `${numbers[i + 2] / 10} ${numbers[i + 3] / 10}`;
    return null;
  };
  const drawAttention = function (frame) {
    const lines = document.getElementById("gazes");
    if (lines === null) return;
    lines.replaceChildren();
    const gazes = data.gazes[frame], numbers = data.frames[frame];
    for (let i = 0; i < gazes.length; i += 3) {
      const from = placeOf(numbers, gazes[i]), to = placeOf(numbers, gazes[i + 1]);
      if (from === null || to === null) continue;
      const line = svgElement("path", { class: "gaze", d: `M${from}L${to}` }, lines);
      line.style.setProperty("--weight", gazes[i + 2] / 100);
    }
  };
  const drawPlans = function (frame) {
    const lines = document.getElementById("plans"), texts = data.plans[frame];
    lines.replaceChildren();
    for (let i = 0; i < texts.length; i += 2)
      svgElement("path", { class: "plan", d: texts[i + 1] }, lines);
  };
  const drawPerceived = function (frame) {
    const paths = document.getElementById("perceived");
    if (paths === null) return;
    paths.replaceChildren();
    const texts = data.perceived[frame];
    for (let i = 0; i < texts.length; i += 3) {
      const path = svgElement("path", { class: "perceived " + texts[i], d: texts[i + 2] }, paths);
      path.style.setProperty("--opacity", texts[i + 1] / 100);
    }
  };
  // Draws a frame; the ego's speed in it [m/s], null without an ego.
  const draw = function (frame) {
    const numbers = data.frames[frame], seen = new Set();
    drawPerceived(frame);
    drawAttention(frame);
    drawPlans(frame);
    let speed = null;
    for (let i = 0; i < numbers.length; i += 6) {
      const index = numbers[i], box = boxOf(index);
      const x = numbers[i + 2] / 10, y = numbers[i + 3] / 10;
      put(box, data.styles[numbers[i + 1]], x, y, numbers[i + 4]);
      box.style.display = "";
      seen.add(index);
      if (numbers[i + 1] === 0) {
        speed = numbers[i + 5] / 10;
        if (follow.checked) { center = { x: x, y: y }; look(); }
      }
    }
    for (const [index, box] of boxes) if (!seen.has(index)) box.style.display = "none";
    fillMoment(frame);
    showSights(frame);
    return speed;
  };
  // `again` draws the present frame once more.
  const watchControls = function (again) {
    document.getElementById("closer").addEventListener("click", () => zoomTo(zoom * 1.6));
    document.getElementById("farther").addEventListener("click", () => zoomTo(zoom / 1.6));
    document.getElementById("whole").addEventListener("click", function () {
      follow.checked = false;
      zoomTo(1);
    });
    follow.addEventListener("change", function () {
      if (follow.checked && zoom < 2) zoom = 3;
      look();
      again();
    });
  };

  let grip = null;
  view.addEventListener("pointerdown", function (event) {
    if (zoom === 1) return;
    grip = { x: event.clientX, y: event.clientY };
    view.setPointerCapture(event.pointerId);
    view.classList.add("moving");
  });
  view.addEventListener("pointermove", function (event) {
    if (!grip) return;
    follow.checked = false;
    const meter = whole.w / zoom / view.clientWidth;
    center.x -= (event.clientX - grip.x) * meter;
    center.y -= (event.clientY - grip.y) * meter;
    grip = { x: event.clientX, y: event.clientY };
    look();
  });
  const letGo = function () { grip = null; view.classList.remove("moving"); };
  view.addEventListener("pointerup", letGo);
  view.addEventListener("pointercancel", letGo);

  layer.replaceChildren();
  return { view, layer, svgElement, bodyOf, boxOf, put, look, zoomTo, zoomToWidth, focus, partnerOf, draw, watchControls };
};
