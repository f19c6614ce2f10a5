"use strict";
(function () {
  const data = JSON.parse(document.getElementById("courses").textContent);
  const slider = document.getElementById("time");
  const play = document.getElementById("play");
  const now = document.getElementById("now");
  const longest = data.courses.reduce(
    (best, course) => course.times.length > best.length ? course.times : best, []);
  const last = longest.length - 1;
  if (last < 1) return;

  const svgElement = function (name, attributes, parent) {
    const element = document.createElementNS("http://www.w3.org/2000/svg", name);
    for (const key in attributes) element.setAttribute(key, attributes[key]);
    parent.appendChild(element);
    return element;
  };
  const draw = function (course, picture, frame) {
    const layer = picture.querySelector(".vehicles");
    const shown = Math.min(frame, course.frames.length - 1);
    const numbers = course.frames[shown];
    layer.replaceChildren();
    picture.style.opacity = frame > shown ? 0.55 : 1;
    for (let i = 0; i < numbers.length; i += 5) {
      const vehicle = course.vehicles[numbers[i]];
      const l = 0.5 * vehicle[1] * data.scale, w = 0.5 * vehicle[2] * data.scale;
      const box = svgElement("g", {
        class: "vehicle " + data.styles[numbers[i + 1]],
        transform: `translate(${numbers[i + 2] / 10} ${numbers[i + 3] / 10}) rotate(${numbers[i + 4]})`,
      }, layer);
      svgElement("title", {}, box).textContent = vehicle[0];
      svgElement("path", { d: `M${-l} ${-w}H${l}V${w}H${-l}Z` }, box);
      svgElement("path", { class: "nose",
        d: `M${0.3 * l} ${-0.8 * w}L${0.8 * l} 0L${0.3 * l} ${0.8 * w}Z` }, box);
    }
    if (course.contact !== null && course.times[shown] >= course.contact[0] - 1e-6)
      svgElement("circle", { class: "contact", cx: course.contact[1], cy: course.contact[2], r: 11 },
        layer);
  };
  const show = function (frame) {
    slider.value = Math.min(Math.max(frame, 0), last);
    const at = Number(slider.value);
    for (const picture of document.querySelectorAll("svg.course"))
      draw(data.courses[Number(picture.dataset.course)], picture, at);
    now.textContent = longest[at].toFixed(1) + " s of " + longest[last].toFixed(1) + " s";
  };
  let playing = false, began = 0, offset = 0;
  const stop = function () { playing = false; play.textContent = "Play"; };
  const tick = function (clock) {
    if (!playing) return;
    const time = offset + (clock - began) / 1000;
    let frame = Number(slider.value);
    while (frame < last && longest[frame + 1] <= time) ++frame;
    if (frame !== Number(slider.value)) show(frame);
    if (frame === last) stop(); else requestAnimationFrame(tick);
  };
  play.addEventListener("click", function () {
    if (playing) { stop(); return; }
    if (Number(slider.value) === last) show(0);
    playing = true;
    play.textContent = "Pause";
    began = performance.now();
    offset = longest[Number(slider.value)];
    requestAnimationFrame(tick);
  });
  slider.addEventListener("input", function () { stop(); show(Number(slider.value)); });
  document.addEventListener("keydown", function (event) {
    if (event.target.closest("button, input")) return;
    if (event.key === "ArrowLeft") { stop(); show(Number(slider.value) - 1); }
    else if (event.key === "ArrowRight") { stop(); show(Number(slider.value) + 1); }
    else return;
    event.preventDefault();
  });
  slider.max = last;
  const first = longest.findIndex((time) => time >= data.start - 1e-6);
  show(first < 0 ? last : first);
})();
