"use strict";
(function () {
  const data = JSON.parse(document.getElementById("playback").textContent);
  const slider = document.getElementById("time");
  const play = document.getElementById("play");
  const now = document.getElementById("now");
  const pace = document.getElementById("pace");
  const last = data.frames.length - 1;
  if (last < 1) return;
  const player = makePlayer(data);

  const moveCursors = function (time) {
    for (const chart of document.querySelectorAll(".chart:not(.own) svg")) {
      const left = Number(chart.dataset.left), right = Number(chart.dataset.right);
      const x = left + (right - left) * time / Number(chart.dataset.duration);
      const cursor = chart.querySelector(".cursor");
      cursor.setAttribute("transform", `translate(${x} 0)`);
      cursor.style.visibility = "visible";
    }
  };
  const draw = function (frame) {
    const speed = player.draw(frame);
    let text = data.times[frame].toFixed(1) + " s of " + data.times[last].toFixed(1) + " s";
    if (speed !== null) text += ", ego " + speed.toFixed(1) + " m/s";
    now.textContent = text;
    slider.setAttribute("aria-valuetext", text);
    moveCursors(data.times[frame]);
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
  player.watchControls(() => draw(Number(slider.value)));

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
      player.focus(Number(slider.value));
    }
    return asked !== null;
  };
  window.addEventListener("hashchange", fromAddress);
  document.addEventListener("click", function (event) {
    const link = event.target.closest("a.time");
    if (link === null) return;
    if (link.hash === location.hash) fromAddress();
    player.view.scrollIntoView({ block: "center" });
  });

  slider.max = last;
  for (const id of ["controls", "sights", "moment"]) {
    const part = document.getElementById(id);
    if (part) part.hidden = false;
  }
  if (!fromAddress()) {
    show(data.start);
    if (player.partnerOf(data.start) !== null) player.focus(data.start);
  }
})();
