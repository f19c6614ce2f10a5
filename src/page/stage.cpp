// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/stage.h"

#include <set>

#include "core/markup.h"
#include "page/top_view.h"

namespace cdiff::page {
namespace {

std::set<int> slotsOf(const record::SessionResult& result) {
  std::set<int> slots;
  for (const record::CbvRecord& record : result.cbv.records()) slots.insert(record.slot);
  return slots;
}

std::string sight(int slot) {
  const std::string number = std::to_string(slot);
  return "<figure class=\"sight\" data-slot=\"" + number +
         "\"><img width=\"320\" height=\"192\" alt=\"Front view of the CBV in slot " + number +
         "\" hidden><p class=\"nothing\">No CBV in slot " + number + "</p><figcaption>Slot " +
         number + "</figcaption></figure>\n";
}

/// What the pictures are, and why there are none.
std::string sightNote(const record::SessionResult& result) {
  const session::ScenarioOptions& options = result.setup.options();
  if (result.cbv.records().empty()) return "No vehicle was selected as CBV: no front view.";
  if (options.report.front_view_rate <= 0.0) {
    return "Front views were not asked for (report.front_view_rate is 0).";
  }
  if (planners::seesImages(options.cbv_planner)) {
    return "What is ahead of each CBV, in more pixels than its planner gets.";
  }
  return "What is ahead of each CBV, drawn for people: its planner " + options.cbv_planner +
         " sees no images.";
}

std::string sights(const record::SessionResult& result) {
  std::string html = "<div class=\"sights\">\n";
  const bool wanted = result.setup.options().report.front_view_rate > 0.0;
  if (wanted && !result.cbv.records().empty()) {
    html += "<div id=\"sights\" hidden>\n";
    for (const int slot : slotsOf(result)) html += sight(slot);
    html += "</div>\n";
  }
  return html + "<p class=\"note\">" + core::escapeMarkup(sightNote(result)) + "</p>\n</div>\n";
}

std::string momentTable() {
  return "<div class=\"scroll\"><table id=\"moment\" hidden><thead><tr><th scope=\"col\">Now</th>"
         "<th scope=\"col\" class=\"number\">Speed [m/s]</th><th scope=\"col\" class=\"number\">"
         "Throttle</th><th scope=\"col\" class=\"number\">Brake</th><th scope=\"col\" "
         "class=\"number\">Steer</th><th scope=\"col\" class=\"number\">Gap [m]</th><th "
         "scope=\"col\" class=\"number\">2D-TTC [s]</th></tr></thead><tbody></tbody></table></div>"
         "\n";
}

std::string paceChoice() {
  std::string html = "<label>Pace <select id=\"pace\">";
  for (const char* pace : {"0.25", "0.5", "1", "2", "4"}) {
    const bool usual = std::string(pace) == "1";
    html += std::string("<option value=\"") + pace + (usual ? "\" selected>" : "\">") + pace +
            "×</option>";
  }
  return html + "</select></label>\n";
}

std::string controls() {
  return "<div class=\"controls\" id=\"controls\" hidden>\n<div class=\"row\"><button "
         "type=\"button\" id=\"play\">Play</button>\n<input type=\"range\" id=\"time\" min=\"0\" "
         "value=\"0\" step=\"1\" aria-label=\"Time of the session\">\n<output id=\"now\" "
         "for=\"time\"></output></div>\n<div class=\"row\">" +
         paceChoice() +
         "<span class=\"group\"><button type=\"button\" id=\"closer\" aria-label=\"Zoom in\">+"
         "</button><button type=\"button\" id=\"farther\" aria-label=\"Zoom "
         "out\">−</button><button "
         "type=\"button\" id=\"whole\">Whole picture</button></span>\n<label><input "
         "type=\"checkbox\" id=\"follow\"> Follow the ego</label></div>\n<p class=\"note "
         "keys\">Keys: space plays and pauses, ← and → step, with shift by 1 s, Home and End. The "
         "address with #t=12.5 opens the page at 12.5 s.</p>\n</div>\n";
}

}  // namespace

std::string stageHtml(const record::SessionResult& result, const MapCanvas& canvas) {
  return "<div class=\"stage\">\n<div>\n<div class=\"map\">\n" + topViewSvg(result, canvas) +
         "</div>\n" + controls() + momentTable() + "</div>\n" + sights(result) + "</div>\n" +
         topViewLegend(canvas);
}

}  // namespace cdiff::page
