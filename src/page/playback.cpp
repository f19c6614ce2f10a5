// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/playback.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/markup.h"
#include "e2e_cdiff/core/angle.h"
#include "page/pictures/top_view.h"
#include "record/logs/front_view_log.h"

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

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPoses = 60000;

std::size_t poseCount(const record::Timeline& timeline) {
  std::size_t count = 0;
  for (const record::TimelineFrame& frame : timeline.frames()) count += frame.poses.size();
  return count;
}

constexpr float kLongestFrameTime = 100.0F;  // to a collision [s]
constexpr double kFrameRounding = 1e-6;      // [s]

/// 0 where there is no number.
long rounded(double value) { return std::isfinite(value) ? std::lround(value) : 0; }

double hundredths(double value) { return std::round(100.0 * value) / 100.0; }

/// Six whole numbers per vehicle: index, style, x and y [0.1 pixel], heading clockwise [deg], speed
/// [0.1 m/s].
Json frameNumbers(const record::TimelineFrame& frame, const MapCanvas& canvas,
                  const std::vector<std::size_t>& cbv_styles) {
  Json numbers = Json::array();
  for (auto pose = frame.poses.rbegin(); pose != frame.poses.rend(); ++pose) {
    if (!canvas.shows({pose->x, pose->y})) continue;
    const Eigen::Vector2d pixel = canvas.toPixels({pose->x, pose->y});
    const std::size_t style = pose->role == traffic::VehicleRole::kEgo   ? 0
                              : pose->role == traffic::VehicleRole::kCbv ? cbv_styles[pose->vehicle]
                                                                         : 1;
    numbers.push_back(pose->vehicle);
    numbers.push_back(style);
    numbers.push_back(rounded(10.0 * pixel.x()));
    numbers.push_back(rounded(10.0 * pixel.y()));
    numbers.push_back(rounded(-core::radiansToDegrees(static_cast<double>(pose->heading))));
    numbers.push_back(rounded(10.0 * static_cast<double>(pose->speed)));
  }
  return numbers;
}

/// Seven numbers per driven vehicle: index, slot (-1: the ego), throttle, brake, steer [%], gap
/// [cm] and 2D-TTC [0.01 s], both negative where not defined.
Json momentNumbers(const record::TimelineFrame& frame) {
  Json numbers = Json::array();
  for (const record::TimelinePose& pose : frame.poses) {
    if (pose.role == traffic::VehicleRole::kBackground) break;  // ego first, then CBVs
    numbers.push_back(pose.vehicle);
    numbers.push_back(pose.slot);
    for (const float value : {pose.throttle, pose.brake, pose.steer, pose.gap,
                              std::min(pose.time_to_collision, kLongestFrameTime)}) {
      numbers.push_back(rounded(100.0 * static_cast<double>(value)));
    }
  }
  return numbers;
}

/// By slot: [time [s], vehicle index, JPEG].
Json viewLists(const record::SessionResult& result) {
  std::map<std::string, std::size_t> indices;
  for (const record::TimelineVehicle& vehicle : result.timeline.vehicles()) {
    indices.emplace(vehicle.id, indices.size());
  }
  Json lists = Json::object();
  for (const record::FrontView& view : result.front_views.views()) {
    const auto vehicle = indices.find(view.vehicle_id);
    if (vehicle == indices.end()) continue;  // it came and went between two frames
    lists[std::to_string(view.slot)].push_back(
        {hundredths(view.time), vehicle->second, record::base64(view.jpeg)});
  }
  return lists;
}

/// The frame that the page shows first: the closest approach, else the last.
std::size_t firstShown(const Json& times, const record::Timeline& timeline) {
  const auto& gap = timeline.smallestGap();
  std::size_t shown = times.empty() ? 0 : times.size() - 1;
  if (!gap) return shown;
  while (shown > 0 && times[shown].get<double>() > gap->time + kFrameRounding) --shown;
  return shown;
}

/// Index of the style that each vehicle has as CBV.
std::vector<std::size_t> cbvStyles(const record::SessionResult& result) {
  std::vector<std::size_t> styles;
  for (const record::TimelineVehicle& vehicle : result.timeline.vehicles()) {
    const std::string style = styleOf(traffic::VehicleRole::kCbv, vehicle.id, result.cbv);
    styles.push_back(2 + static_cast<std::size_t>(style.back() - '0'));
  }
  return styles;
}

void addVehicles(Json& data, const record::SessionResult& result) {
  for (const record::TimelineVehicle& vehicle : result.timeline.vehicles()) {
    data["vehicles"].push_back({vehicle.id, vehicle.length, vehicle.width});
  }
}

void addFrames(Json& data, const record::SessionResult& result, const MapCanvas& canvas) {
  const std::vector<std::size_t> cbv_styles = cbvStyles(result);
  const auto& frames = result.timeline.frames();
  const std::size_t stride = 1 + poseCount(result.timeline) / kMostPoses;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i % stride != 0 && i + 1 != frames.size()) continue;
    data["times"].push_back(hundredths(frames[i].time));
    data["frames"].push_back(frameNumbers(frames[i], canvas, cbv_styles));
    data["moments"].push_back(momentNumbers(frames[i]));
  }
}

/// `<` never appears, so no text can end the script element.
std::string safeInScript(const std::string& json) {
  std::string safe;
  for (const char letter : json) {
    if (letter == '<') {
      safe += "\\u003c";
    } else {
      safe += letter;
    }
  }
  return safe;
}

}  // namespace

std::string playbackJson(const record::SessionResult& result, const MapCanvas& canvas) {
  Json data = {{"styles", {"ego", "bg", "cbv c0", "cbv c1", "cbv c2", "cbv c3", "cbv c4"}},
               {"vehicles", Json::array()},
               {"times", Json::array()},
               {"frames", Json::array()},
               {"moments", Json::array()},
               {"period", result.front_views.period()},
               {"views", viewLists(result)}};
  addVehicles(data, result);
  addFrames(data, result, canvas);
  data["start"] = firstShown(data["times"], result.timeline);
  return safeInScript(data.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace cdiff::page
