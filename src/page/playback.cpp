// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/playback.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "core/text.h"
#include "page/approach_section.h"
#include "page/page_parts.h"
#include "page/pictures/attention.h"
#include "page/pictures/map_canvas.h"
#include "page/pictures/perception.h"
#include "page/pictures/top_view.h"
#include "page/player_parts.h"
#include "record/logs/cbv_log.h"

namespace cdiff::page {
namespace {

std::set<int> slotsOf(const record::SessionResult& result) {
  std::set<int> slots;
  for (const record::CbvRecord& record : result.cbv.records()) slots.insert(record.slot);
  return slots;
}

/// What the pictures are, and why there are none.
std::string sightNote(const record::SessionResult& result) {
  const session::ScenarioOptions& options = result.setup.options();
  if (result.cbv.records().empty()) return "No vehicle was selected as CBV: no front view.";
  if (options.report.front_view_rate <= 0.0) {
    return "Front views were not asked for (report.front_view_rate is 0).";
  }
  if (planners::seesImages(options.cbv_planner)) {
    return "What is ahead of each CBV, in more pixels than its planner gets and in this page's "
           "colors: ego red, CBVs purple. Planners see colors that say nothing.";
  }
  return "What is ahead of each CBV, drawn for people (ego red, CBVs purple): its planner " +
         options.cbv_planner + " sees no images.";
}

Markup sights(const record::SessionResult& result) {
  Markup html = "\n";
  const bool wanted = result.setup.options().report.front_view_rate > 0.0;
  if (wanted && !result.cbv.records().empty()) {
    Markup views = "\n";
    for (const int slot : slotsOf(result)) views += sightFigure(slot);
    html += element("div", {{"id", "sights"}, core::flag("hidden")}, views) + "\n";
  }
  return element("div", {{"class", "sights"}}, html + pageNote(sightNote(result))) + "\n";
}

Markup paceChoice() {
  std::vector<std::pair<std::string, std::string>> paces;
  for (const std::string pace : {"0.25", "0.5", "1", "2", "4"})
    paces.emplace_back(pace, pace + "×");
  return element("label", {}, "Pace " + pageChoice("pace", paces, "1")) + "\n";
}

Markup slider() {
  const Markup range = element("input", {{"type", "range"},
                                         {"id", "time"},
                                         {"min", "0"},
                                         {"value", "0"},
                                         {"step", "1"},
                                         {"aria-label", "Time of the session"}});
  return pageButton("play", "Play") + "\n" + range + "\n" +
         element("output", {{"id", "now"}, {"for", "time"}});
}

Markup controls() {
  const Markup keys = element(
      "p", {{"class", "note keys"}},
      "Keys: space plays and pauses, ← and → step, with shift by 1 s, Home and End. The address "
      "with #t=12.5 opens the page at 12.5 s.");
  const Markup content =
      element("div", {{"class", "row"}}, slider()) + "\n" +
      element("div", {{"class", "row"}}, paceChoice() + zoomButtons() + "\n" + followBox(false)) +
      "\n" + keys;
  return element("div", {{"class", "controls"}, {"id", "controls"}, core::flag("hidden")},
                 "\n" + content + "\n") +
         "\n";
}

/// A moment worth a look, by its time [s].
using Moments = std::multimap<double, std::string>;

/// Contacts, those of the ego alone where there are too many to list, and each CBV's closest
/// approach.
Moments momentsOf(const record::SessionResult& result) {
  constexpr std::size_t kMostContacts = 12;
  const auto& contacts = result.timeline.contacts();
  Moments moments;
  for (const record::TimelineContact& contact : contacts) {
    const bool own = contact.first == traffic::kEgoId || contact.second == traffic::kEgoId;
    if (own || contacts.size() <= kMostContacts)
      moments.emplace(contact.time, contact.first + " and " + contact.second + " touch");
  }
  for (const record::Approach* approach : result.approaches.nearest()) {
    if (approach->gap > 0.0)
      moments.emplace(approach->time(), approach->vehicle_id + " is nearest, " +
                                            core::formatFixed(approach->gap, 2) +
                                            " m between outlines");
  }
  return moments;
}

Markup momentList(const record::SessionResult& result) {
  Markup items;
  for (const auto& [time, what] : momentsOf(result))
    items += element("span", {{"class", "item"}}, timeLink(time) + " s: " + what) + "\n";
  if (items.empty()) return items;
  return element("p", {{"class", "moments"}}, "\n" + items) + "\n";
}

}  // namespace

Markup stageHtml(const record::SessionResult& result, const MapCanvas& canvas) {
  const Markup map = element("div", {{"class", "map"}}, "\n" + topViewSvg(result, canvas)) + "\n";
  const Markup left =
      element("div", {}, "\n" + map + momentList(result) + controls() + momentTable()) + "\n";
  return element("div", {{"class", "stage"}}, "\n" + left + sights(result)) + "\n" +
         topViewLegend(canvas, &result.timeline);
}

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostPoses = 60000;

std::size_t poseCount(const record::Timeline& timeline) {
  std::size_t count = 0;
  for (const record::TimelineFrame& frame : timeline.frames()) count += frame.poses.size();
  return count;
}

constexpr double kFrameRounding = 1e-6;  // [s]

double hundredths(double value) { return std::round(100.0 * value) / 100.0; }

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

/// The latest plan of a decision at `time` or up to a second before; nullptr without one.
const record::LoggedPlan* planAt(const record::VehiclePlans* vehicle, double time) {
  constexpr double kLongestAge = 1.0;  // [s]
  if (vehicle == nullptr) return nullptr;
  const auto later = std::upper_bound(
      vehicle->plans.begin(), vehicle->plans.end(), time + kFrameRounding,
      [](double limit, const record::LoggedPlan& plan) { return limit < plan.time; });
  if (later == vehicle->plans.begin() || time - std::prev(later)->time > kLongestAge)
    return nullptr;
  return &*std::prev(later);
}

/// The time that the page shows first: the contact that the verdict turned on, else the closest
/// approach; nullopt without either.
std::optional<double> firstTime(const record::SessionResult& result) {
  const metrics::EgoContact* contact =
      record::decidingContact(result.setup.options(), result.verdict, result.measures.ego_contacts);
  if (contact != nullptr) return contact->seconds;
  const auto& gap = result.timeline.smallestGap();
  return gap ? std::optional<double>(gap->time) : std::nullopt;
}

/// Its frame; the last one without such a time.
std::size_t firstShown(const Json& times, const record::SessionResult& result) {
  const std::optional<double> time = firstTime(result);
  std::size_t shown = times.empty() ? 0 : times.size() - 1;
  if (!time) return shown;
  while (shown > 0 && times[shown].get<double>() > *time + kFrameRounding) --shown;
  return shown;
}

/// Index of the vehicle that the ego touches at a frame; -1 where it touches none.
std::int64_t touchedAt(double time, const record::SessionResult& result) {
  const auto& vehicles = result.timeline.vehicles();
  for (const metrics::EgoContact& contact : result.measures.ego_contacts) {
    if (std::abs(contact.seconds - time) > kFrameRounding) continue;
    const auto found = std::find_if(
        vehicles.begin(), vehicles.end(),
        [&](const record::TimelineVehicle& vehicle) { return vehicle.id == contact.partner; });
    if (found != vehicles.end()) return found - vehicles.begin();
  }
  return -1;
}

/// Index of the style that each vehicle has as CBV.
std::vector<std::size_t> cbvStyles(const record::SessionResult& result) {
  std::vector<std::size_t> styles;
  for (const record::TimelineVehicle& vehicle : result.timeline.vehicles()) {
    const std::string style = styleOf(traffic::VehicleRole::kCbv, vehicle.id, result.cbv);
    styles.push_back(cbvStyleNumber(static_cast<std::size_t>(style.back() - '0')));
  }
  return styles;
}

void addVehicles(Json& data, const record::SessionResult& result) {
  for (const record::TimelineVehicle& vehicle : result.timeline.vehicles()) {
    data["vehicles"].push_back({vehicle.id, vehicle.length, vehicle.width});
  }
}

/// Three whole numbers per line: indices of driver and vehicle, weight [%].
Json attentionNumbers(const record::TimelineFrame& frame) {
  Json numbers = Json::array();
  for (const record::TimelineAttention& gaze : frame.gazes) {
    numbers.push_back(gaze.driver);
    numbers.push_back(gaze.vehicle);
    numbers.push_back(roundedNumber(100.0 * static_cast<double>(gaze.weight)));
  }
  return numbers;
}

/// Three entries per path: CSS class, opacity [%], path data.
Json perceivedTexts(const record::TimelineFrame& frame, const MapCanvas& canvas) {
  Json texts = Json::array();
  for (const PerceivedPath& path : perceivedPaths(frame.perception, canvas)) {
    texts.push_back(path.style);
    texts.push_back(roundedNumber(100.0 * path.opacity));
    texts.push_back(path.data);
  }
  return texts;
}

/// Of each CBV in a frame its index and the plan that it follows then, as path data in pixels.
Json planTexts(const record::TimelineFrame& frame, const record::SessionResult& result,
               const MapCanvas& canvas) {
  Json texts = Json::array();
  for (const record::TimelinePose& pose : frame.poses) {
    if (pose.role == traffic::VehicleRole::kBackground) break;  // ego first, then CBVs
    const std::string& id = result.timeline.vehicles()[pose.vehicle].id;
    const record::LoggedPlan* plan = planAt(result.plans.find(id), frame.time);
    if (plan == nullptr) continue;
    Points line = {plan->start.position};
    for (const record::Waypoint& point : plan->points) {
      if (point.position.allFinite()) line.push_back(point.position);
    }
    texts.push_back(pose.vehicle);
    texts.push_back(canvas.line(line));
  }
  return texts;
}

void addFrames(Json& data, const record::SessionResult& result, const MapCanvas& canvas) {
  const std::vector<std::size_t> cbv_styles = cbvStyles(result);
  const auto& frames = result.timeline.frames();
  const std::size_t stride = 1 + poseCount(result.timeline) / kMostPoses;
  const bool gazes = showsAttention(result.timeline);
  const bool perception = showsPerception(result.timeline);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i % stride != 0 && !frames[i].event && i + 1 != frames.size()) continue;
    data["times"].push_back(hundredths(frames[i].time));
    data["frames"].push_back(frameNumbers(frames[i], canvas, cbv_styles));
    data["moments"].push_back(momentNumbers(frames[i]));
    data["plans"].push_back(planTexts(frames[i], result, canvas));
    data["touched"].push_back(touchedAt(frames[i].time, result));
    if (gazes) data["gazes"].push_back(attentionNumbers(frames[i]));
    if (perception) data["perceived"].push_back(perceivedTexts(frames[i], canvas));
  }
}

}  // namespace

std::string playbackJson(const record::SessionResult& result, const MapCanvas& canvas) {
  Json data = {{"styles", vehicleStyles()}, {"vehicles", Json::array()},
               {"times", Json::array()},    {"frames", Json::array()},
               {"moments", Json::array()},  {"plans", Json::array()},
               {"touched", Json::array()},  {"period", result.front_views.period()},
               {"views", viewLists(result)}};
  addVehicles(data, result);
  addFrames(data, result, canvas);
  data["start"] = firstShown(data["times"], result);
  return data.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace cdiff::page
