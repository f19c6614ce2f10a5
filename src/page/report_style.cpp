// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/report_style.h"

namespace cdiff::page {

const char kReportStyleSheet[] = R"CSS(
:root {
  color-scheme: light dark;
  --page: #ffffff; --text: #1c2024; --soft: #5d6670; --line: #d9dde2; --panel: #f5f6f8;
  --ground: #eef1ec; --road: #d3d7dc; --edge: #a3a9b1; --lane: #aeb4bc; --halo: #ffffff;
  --ego: #c62828; --bg: #1f6fc4; --goal: #2e7d32; --conflict: #111417; --contact: #e65100;
  --c0: #7b1fa2; --c1: #d01884; --c2: #5b3bd1; --c3: #a06bc4; --c4: #4a0d66;
  --passed: #1b6e36; --passed-back: #e2f4e6; --failed: #a31919; --failed-back: #fde8e6;
  --error: #5b2a86; --error-back: #f1e8fa; --struck: #7a4a00; --struck-back: #fdf0d5;
}
@media screen and (prefers-color-scheme: dark) {
  :root {
    --page: #14171a; --text: #e6e9ec; --soft: #9aa4ae; --line: #343a41; --panel: #1d2125;
    --ground: #181c1a; --road: #363c43; --edge: #5b636c; --lane: #555d66; --halo: #14171a;
    --ego: #ff6b60; --bg: #6ab0ff; --goal: #7bd389; --conflict: #ffffff; --contact: #ffa14a;
    --c0: #d29bea; --c1: #ff85cf; --c2: #ab9bff; --c3: #ecd6f7; --c4: #a25fd0;
    --passed: #8fe0a3; --passed-back: #12301c; --failed: #ffb0a8; --failed-back: #3d1513;
    --error: #d9b8f5; --error-back: #2e1d3d; --struck: #ffd08a; --struck-back: #3a2a0c;
  }
}
* { box-sizing: border-box; }
body { margin: 0; background: var(--page); color: var(--text);
  font: 15px/1.45 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
main { max-width: 1440px; margin: 0 auto; padding: 20px 24px 60px; }
h1 { font-size: 1.6rem; margin: 0; overflow-wrap: anywhere; }
h2 { font-size: 1.15rem; margin: 34px 0 10px; }
.sub { margin: 2px 0 14px; color: var(--soft); overflow-wrap: anywhere; }
.note { color: var(--soft); margin: 6px 0; }
.banner { display: flex; gap: 16px; align-items: center; padding: 14px 18px; border-radius: 8px;
  border-left: 6px solid; }
.banner p { margin: 2px 0 0; color: var(--text); overflow-wrap: anywhere; }
.banner strong { font-size: 1.3rem; }
.banner .sign { font-size: 2rem; line-height: 1; font-weight: 700; }
.banner.passed { color: var(--passed); background: var(--passed-back); }
.banner.failed { color: var(--failed); background: var(--failed-back); }
.banner.struck { color: var(--struck); background: var(--struck-back); }
.banner.not_judged { color: var(--soft); background: var(--panel); }
.banner.error, .banner.interrupted { color: var(--error); background: var(--error-back); }
.figures { display: grid; grid-template-columns: repeat(auto-fill, minmax(200px, 1fr)); gap: 10px;
  margin-top: 16px; }
.figure { background: var(--panel); border-radius: 8px; padding: 10px 14px; display: flex;
  flex-direction: column; }
.figure .name, .figure .under { color: var(--soft); font-size: .85rem; overflow-wrap: anywhere; }
.figure .value { font-size: 1.45rem; font-weight: 600; font-variant-numeric: tabular-nums; }
.figure small { font-size: .9rem; font-weight: 400; }
.banner .story { margin-top: 6px; }
.late { padding: 10px 18px; margin: 0 0 16px; border-radius: 8px; color: var(--text); background: var(--error-back);
  border-left: 6px solid var(--error); overflow-wrap: anywhere; }
.stage { display: grid; gap: 14px 20px; grid-template-columns: minmax(0, 1fr); }
@media (min-width: 980px) { .stage { grid-template-columns: minmax(0, 1fr) 330px; } }
.sights { min-width: 0; }
#sights { display: grid; gap: 10px; grid-template-columns: repeat(auto-fill, minmax(220px, 1fr)); }
#sights[hidden] { display: none; }
.sight { margin: 0; min-width: 0; border-left: 5px solid var(--own, var(--line)); padding-left: 8px; }
.sight img { display: block; width: 100%; height: auto; border-radius: 6px; }
.sight img[hidden] { display: none; }
.sight .nothing { margin: 0; aspect-ratio: 5 / 3; display: grid; place-items: center;
  color: var(--soft); background: var(--panel); border-radius: 6px; }
.sight .nothing[hidden] { display: none; }
.sight figcaption { color: var(--soft); font-size: .88rem; margin-top: 3px; overflow-wrap: anywhere; }
#moment { font-size: .84rem; width: 100%; }
#moment[hidden] { display: none; }
#moment td:first-child { border-left: 5px solid var(--own); padding-left: 7px;
  overflow-wrap: anywhere; min-width: 6em; }
.keys { font-size: .85rem; margin: 0; }
.map { border: 1px solid var(--line); border-radius: 8px; overflow: hidden; background: var(--ground); }
#top-view { display: block; width: 100%; height: auto; --zoom: 1; --pin: 1; }
#top-view.moving { cursor: grabbing; }
svg path, svg circle { fill: none; stroke-linejoin: round; stroke-linecap: round;
  vector-effect: non-scaling-stroke; }
svg path.road { fill: var(--road); fill-rule: evenodd; stroke: var(--edge); stroke-width: 1; }
svg path.road.other { opacity: .45; }
svg path.lane { stroke: var(--lane); stroke-width: .8; stroke-dasharray: 3 4; }
svg path.route { stroke: var(--goal); stroke-width: 7; opacity: .3; stroke-linecap: butt; }
svg path.planned { stroke-width: 2; stroke-dasharray: 7 5; opacity: .85; }
svg path.trail { stroke-width: 2.6; }
svg path.trail.bg { stroke-width: 1.2; opacity: .45; }
.ego { --own: var(--ego); } .bg { --own: var(--bg); } .c0 { --own: var(--c0); }
.c1 { --own: var(--c1); } .c2 { --own: var(--c2); } .c3 { --own: var(--c3); } .c4 { --own: var(--c4); }
svg path.ego, svg path.bg, svg path.cbv { stroke: var(--own); }
.vehicle path { fill: var(--own); stroke: var(--halo); stroke-width: 1; }
.vehicle path.nose { fill: var(--halo); stroke: none; }
.vehicle.start path { fill: none; stroke: var(--ego); stroke-width: 1.5; stroke-dasharray: 3 2; }
.vehicle.start path.nose { display: none; }
svg circle.goal { stroke: var(--goal); stroke-width: 3; fill: var(--page); }
svg path.conflict { stroke: var(--conflict); stroke-width: 2.6; }
svg circle.contact { stroke: var(--contact); stroke-width: 3; }
svg path.scale { stroke: var(--text); stroke-width: 2; }
svg path.north { fill: var(--text); }
svg text { fill: var(--text); font-size: 12px; }
svg text.name { font-size: 13px; font-weight: 600; paint-order: stroke; stroke: var(--halo);
  stroke-width: 3px; stroke-linejoin: round; }
.pin { transform: scale(calc(var(--pin) / var(--zoom))); }
.controls { margin: 10px 0; }
.controls .row { display: flex; flex-wrap: wrap; gap: 8px 14px; align-items: center; margin: 6px 0; }
.controls input[type=range] { flex: 1 1 220px; min-width: 0; accent-color: var(--ego); }
.controls output { min-width: 17em; font-variant-numeric: tabular-nums; }
.controls .group { display: inline-flex; gap: 4px; }
select { font: inherit; color: inherit; background: var(--panel); border: 1px solid var(--line);
  border-radius: 6px; padding: 3px 6px; }
:focus-visible { outline: 2px solid var(--bg); outline-offset: 2px; }
button { font: inherit; color: inherit; background: var(--panel); border: 1px solid var(--line);
  border-radius: 6px; padding: 4px 12px; cursor: pointer; }
#play { min-width: 5.2em; }
.legend { display: flex; flex-wrap: wrap; gap: 4px 18px; margin: 8px 0; color: var(--soft);
  font-size: .88rem; }
.legend .item { display: inline-flex; gap: 6px; align-items: center; }
.legend svg { width: 28px; height: 14px; }
.charts { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 440px), 1fr));
  gap: 10px 24px; }
.chart { margin: 0; min-width: 0; }
.chart figcaption { font-weight: 600; font-size: .92rem; margin-bottom: 2px; }
.chart svg { display: block; width: 100%; height: auto; }
svg path.bars { stroke-width: 1.8; stroke: var(--own); fill: var(--own); fill-opacity: .18; }
svg path.stay { stroke: var(--own); stroke-width: 9; stroke-linecap: butt; }
.chart .note { font-size: .88rem; }
.chart path.grid { stroke: var(--line); stroke-width: 1; }
.chart text { fill: var(--soft); }
svg text.end { text-anchor: end; } svg text.middle { text-anchor: middle; }
svg path.series { stroke-width: 2; }
svg path.series.dot { stroke-width: 6; stroke-linecap: round; }
svg circle.mark { fill: var(--page); stroke: var(--conflict); stroke-width: 2; }
.chart text.mark-text { fill: var(--text); font-weight: 600; paint-order: stroke;
  stroke: var(--page); stroke-width: 3px; }
.chart path.cursor { stroke: var(--soft); stroke-width: 1; visibility: hidden; }
h3 { font-size: 1.02rem; margin: 0; overflow-wrap: anywhere; }
h4 { font-size: .95rem; margin: 14px 0 4px; }
.approach { border-left: 5px solid var(--own); padding: 2px 0 2px 16px; margin: 0 0 26px; }
.approach .sub { margin-bottom: 8px; }
.views { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 300px), 1fr));
  gap: 10px 16px; align-items: start; }
.view { margin: 0; min-width: 0; }
.view img { display: block; width: 100%; height: auto; border-radius: 6px; }
.view.small img { image-rendering: pixelated; }
.view figcaption { color: var(--soft); font-size: .88rem; margin-top: 3px; }
.plan-view { margin: 0; min-width: 0; }
.plan-view figcaption { font-weight: 600; font-size: .92rem; margin-bottom: 2px; }
.plan-view svg { display: block; width: 100%; height: auto; background: var(--ground);
  border: 1px solid var(--line); border-radius: 8px; }
.plan-view path.trail.cbv { stroke-width: 6; opacity: .6; }
svg path.plan { stroke: var(--conflict); stroke-width: 2; stroke-dasharray: 6 4; }
svg path.series.plan { stroke-dasharray: 6 4; }
svg circle.stop { fill: var(--own); stroke: none; }
svg circle.plan-stop { fill: var(--page); stroke: var(--conflict); stroke-width: 1.5; }
.vehicle.later path { fill: none; stroke: var(--own); stroke-width: 1.8; }
.vehicle.plan-end path { fill: none; stroke: var(--conflict); stroke-width: 1.5;
  stroke-dasharray: 4 3; }
.vehicle.later path.nose, .vehicle.plan-end path.nose { display: none; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .92rem; }
th, td { text-align: left; padding: 5px 14px 5px 0; border-bottom: 1px solid var(--line);
  vertical-align: top; overflow-wrap: break-word; }
th { color: var(--soft); font-weight: 600; }
.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
th.number { white-space: normal; }
tr.absent td { color: var(--soft); }
tr.passed td:nth-child(2) { color: var(--passed); font-weight: 600; }
tr.failed td:nth-child(2) { color: var(--failed); font-weight: 600; }
tr.struck td:nth-child(2) { color: var(--struck); font-weight: 600; }
tr.error td:nth-child(2) { color: var(--error); font-weight: 600; }
tr.skipped td { color: var(--soft); }
details { margin-top: 14px; } summary { cursor: pointer; font-weight: 600; }
pre { background: var(--panel); border-radius: 8px; padding: 12px 14px; overflow-x: auto;
  font-size: .85rem; }
@media (max-width: 1300px) { #top-view { --pin: 1.4; } }
@media (max-width: 600px) {
  #top-view { --pin: 2.2; } #top-view .frame text { font-size: 24px; }
  .chart text, .plan-view text { font-size: 17px; }
  main { padding: 14px 12px 40px; }
  .banner { padding: 12px; gap: 10px; }
  .figures { grid-template-columns: 1fr 1fr; }
}
@media print {
  main { max-width: none; padding: 0; }
  body { font-size: 12px; }
  .controls, .scroll { overflow: visible; }
  .controls { display: none; }
  .stage { grid-template-columns: minmax(0, 1fr); }
  #sights { grid-template-columns: repeat(3, 1fr); }
  .charts { grid-template-columns: 1fr 1fr; }
  .figure, .chart, .map, .sight, .views, .approach h3, tr { break-inside: avoid; }
  h2, h3 { break-after: avoid; }
  th, td { padding-right: 8px; }
  * { print-color-adjust: exact; -webkit-print-color-adjust: exact; }
}
)CSS";

}  // namespace cdiff::page
