"use strict";
(function () {
  const data = JSON.parse(document.getElementById("playback").textContent);
  const view = document.getElementById("top-view");
  const layer = document.getElementById("vehicles");
  const slider = document.getElementById("time");
  const play = document.getElementById("play");
  const now = document.getElementById("now");
  const pace = document.getElementById("pace");
  const follow = document.getElementById("follow");
  const full = view.viewBox.baseVal;
  const whole = { x: 0, y: 0, w: full.width, h: full.height };
  const scale = Number(view.dataset.magnification);
  const last = data.frames.length - 1;
  if (last < 1) return;

  const boxes = new Map();
  const svgElement = function (name, attributes, parent) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    parent.appendChild(element);
    return element;
  };
  const boxOf = function (index) {
    if (boxes.has(index)) return boxes.get(index);
    const vehicle = data.vehicles[index];
    const l = 0.5 * vehicle[1] * scale, w = 0.5 * vehicle[2] * scale;
    const box = svgElement("g", {}, layer);
    svgElement("title", {}, box).textContent = vehicle[0];
    svgElement("path", { d: `M${-l} ${-w}H${l}V${w}H${-l}Z` }, box);
    svgElement("path", { class: "nose",
      d: `M${0.3 * l} ${-0.8 * w}L${0.8 * l} 0L${0.3 * l} ${0.8 * w}Z` }, box);
    boxes.set(index, box);
    return box;
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
  const zoomTo = function (value) { zoom = Math.min(Math.max(value, 1), 16); look(); };

  const moveCursors = function (time) {
    for (const chart of document.querySelectorAll(".chart:not(.own) svg")) {
      const left = Number(chart.dataset.left), right = Number(chart.dataset.right);
      const x = left + (right - left) * time / Number(chart.dataset.duration);
      const cursor = chart.querySelector(".cursor");
      cursor.setAttribute("transform", `translate(${x} 0)`);
      cursor.style.visibility = "visible";
    }
  };
  const speedOf = function (numbers, index) {
    for (let i = 0; i < numbers.length; i += 6) if (numbers[i] === index) return numbers[i + 5] / 10;
    return null;
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
  const styleOf = function (numbers, index) {
    for (let i = 0; i < numbers.length; i += 6)
      if (numbers[i] === index) return data.styles[numbers[i + 1]];
    return "cbv";
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
  const draw = function (frame) {
    const numbers = data.frames[frame], seen = new Set();
    drawPerceived(frame);
    drawAttention(frame);
    drawPlans(frame);
    let text = data.times[frame].toFixed(1) + " s of " + data.times[last].toFixed(1) + " s";
    for (let i = 0; i < numbers.length; i += 6) {
      const index = numbers[i], box = boxOf(index);
      const x = numbers[i + 2] / 10, y = numbers[i + 3] / 10;
      box.setAttribute("class", "vehicle " + data.styles[numbers[i + 1]]);
      box.setAttribute("transform", `translate(${x} ${y}) rotate(${numbers[i + 4]})`);
      box.style.display = "";
      seen.add(index);
      if (numbers[i + 1] === 0) {
        text += ", ego " + (numbers[i + 5] / 10).toFixed(1) + " m/s";
        if (follow.checked) { center = { x: x, y: y }; look(); }
      }
    }
    for (const [index, box] of boxes) if (!seen.has(index)) box.style.display = "none";
    now.textContent = text;
    slider.setAttribute("aria-valuetext", text);
    moveCursors(data.times[frame]);
    fillMoment(frame);
    showSights(frame);
  };

  const frameAt = function (time) {
    let best = 0;
    data.times.forEach(function (value, i) {
      if (Math.abs(value - time) < Math.abs(data.times[best] - time)) best = i;
    });
    return best;
  };
  let playing = false, began = 0, offset = 0;
  const address = function () {
    try {
      history.replaceState(null, "", "#t=" + data.times[Number(slider.value)]);
    } catch (refused) { /* some browsers allow no addresses in files */ }
  };
  const stop = function () {
    if (playing) address();
    playing = false;
    play.textContent = "Play";
  };
  const show = function (frame) {
    slider.value = Math.min(Math.max(frame, 0), last);
    draw(Number(slider.value));
  };
  const go = function (frame) { stop(); show(frame); address(); };
  const begin = function () {
    began = performance.now();
    offset = data.times[Number(slider.value)];
  };
  const tick = function (clock) {
    if (!playing) return;
    const time = offset + Number(pace.value) * (clock - began) / 1000;
    let frame = Number(slider.value);
    while (frame < last && data.times[frame + 1] <= time) ++frame;
    if (frame !== Number(slider.value)) show(frame);
    if (frame === last) stop(); else requestAnimationFrame(tick);
  };
  const toggle = function () {
    if (playing) { stop(); return; }
    if (Number(slider.value) === last) show(0);
    playing = true;
    play.textContent = "Pause";
    begin();
    requestAnimationFrame(tick);
  };
  play.addEventListener("click", toggle);
  pace.addEventListener("change", begin);
  slider.addEventListener("input", function () { go(Number(slider.value)); });
  const keys = {
    ArrowLeft: (second) => second ? frameAt(data.times[Number(slider.value)] - 1)
                                  : Number(slider.value) - 1,
    ArrowRight: (second) => second ? frameAt(data.times[Number(slider.value)] + 1)
                                   : Number(slider.value) + 1,
    Home: () => 0,
    End: () => last,
  };
  document.addEventListener("keydown", function (event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.target.closest("button, select, summary, a, input[type=checkbox]")) return;
    if (event.key === " ") toggle();
    else if (event.key in keys) go(keys[event.key](event.shiftKey));
    else return;
    event.preventDefault();
  });
  document.getElementById("closer").addEventListener("click", () => zoomTo(zoom * 1.6));
  document.getElementById("farther").addEventListener("click", () => zoomTo(zoom / 1.6));
  document.getElementById("whole").addEventListener("click", function () {
    follow.checked = false;
    zoomTo(1);
  });
  follow.addEventListener("change", function () {
    if (follow.checked && zoom < 2) zoom = 3;
    look();
    draw(Number(slider.value));
  });

  let grip = null;
  view.addEventListener("pointerdown", function (event) {
    if (zoom === 1) return;
    grip = { x: event.clientX, y: event.clientY };
    follow.checked = false;
    view.setPointerCapture(event.pointerId);
    view.classList.add("moving");
  });
  view.addEventListener("pointermove", function (event) {
    if (!grip) return;
    const meter = whole.w / zoom / view.clientWidth;
    center.x -= (event.clientX - grip.x) * meter;
    center.y -= (event.clientY - grip.y) * meter;
    grip = { x: event.clientX, y: event.clientY };
    look();
  });
  const letGo = function () { grip = null; view.classList.remove("moving"); };
  view.addEventListener("pointerup", letGo);
  view.addEventListener("pointercancel", letGo);

  for (const chart of document.querySelectorAll(".chart:not(.own) svg")) {
    chart.addEventListener("click", function (event) {
      const frame = chart.getBoundingClientRect(), left = Number(chart.dataset.left);
      const x = (event.clientX - frame.left) * chart.viewBox.baseVal.width / frame.width;
      const share = (x - left) / (Number(chart.dataset.right) - left);
      go(frameAt(share * Number(chart.dataset.duration)));
    });
  }

  const fromAddress = function () {
    const asked = /^#t=(\d+(?:\.\d+)?)$/.exec(location.hash);
    if (asked) {
      stop();
      show(frameAt(Number(asked[1])));
      focus(Number(slider.value));
    }
    return asked !== null;
  };
  window.addEventListener("hashchange", fromAddress);
  document.addEventListener("click", function (event) {
    const link = event.target.closest("a.time");
    if (link === null) return;
    if (link.hash === location.hash) fromAddress();
    view.scrollIntoView({ block: "center" });
  });

  slider.max = last;
  for (const id of ["controls", "sights", "moment"]) {
    const part = document.getElementById(id);
    if (part) part.hidden = false;
  }
  layer.replaceChildren();
  if (!fromAddress()) {
    show(data.start);
    if (partnerOf(data.start) !== null) focus(data.start);
  }
})();
