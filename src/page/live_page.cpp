// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/live_page.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "page/pictures/charts.h"
#include "page/pictures/top_view.h"
#include "page/player_parts.h"
#include "planners/registry.h"
#include "record/session_text.h"
#include "session/session_request.h"
#include "session/steered_cbvs.h"

namespace cdiff::page {
namespace {

using LiveJson = nlohmann::ordered_json;
using traffic::VehicleRole;

constexpr double kPictureAge = 5.0;    // of a front view that is still shown [s]
constexpr double kAroundRoute = 60.0;  // what the picture shows around the ego route [m]

/// The ego route and what lies around it: where the session will go is not known yet.
MapCanvas liveCanvas(const session::SessionSetup& setup) {
  const auto& route = setup.egoRoute().path().points();
  Region region;
  if (!route.empty()) region = {route.front().head<2>(), route.front().head<2>()};
  for (const Eigen::Vector3d& point : route) {
    region.low = region.low.cwiseMin(point.head<2>());
    region.high = region.high.cwiseMax(point.head<2>());
  }
  return MapCanvas(region.grown(kAroundRoute));
}

Markup row(const Markup& content) { return element("div", {{"class", "row"}}, content) + "\n"; }

Markup paceControls() {
  const std::vector<std::pair<std::string, std::string>> paces = {
      {"0.1", "0.1×"}, {"0.25", "0.25×"},           {"0.5", "0.5×"}, {"1", "1×"}, {"2", "2×"},
      {"4", "4×"},     {"0", "as fast as possible"}};
  const std::vector<std::pair<std::string, std::string>> ticks = {
      {"1", "1 tick"}, {"2", "1 decision"}, {"20", "1 second"}};
  return row(pageButton("play", "Pause") + pageButton("step", "Step", {core::flag("disabled")}) +
             element("label", {}, "by " + pageChoice("ticks", ticks, "2")) +
             element("label", {}, "Pace " + pageChoice("pace", paces, "1")) +
             element("output", {{"id", "now"}}));
}

Markup liveControls() {
  return element("div", {{"class", "controls"}, {"id", "controls"}},
                 "\n" + paceControls() + row(zoomButtons() + "\n" + followBox(true)) +
                     element("p", {{"id", "said"}, {"role", "status"}}) + "\n" +
                     element("p", {{"class", "note keys"}},
                             "Keys: space pauses and plays, → steps. Colors are those of the "
                             "report. Vehicles are chosen by a click.")) +
         "\n";
}

Markup panel(const std::string& title, const Markup& content) {
  return element("div", {{"class", "panel"}}, element("h3", {}, title) + "\n" + content) + "\n";
}

Markup vehiclePanel() {
  const Markup id = element("input", {{"type", "text"},
                                      {"id", "vehicle"},
                                      {"list", "vehicles-there"},
                                      {"aria-label", "Id of a vehicle"},
                                      {"maxlength", "100"}}) +
                    element("datalist", {{"id", "vehicles-there"}}) +
                    element("span", {{"id", "who"}});
  const core::Attribute off = core::flag("disabled");
  return panel("Vehicle", row(id) + row(pageButton("choose", "Make it a CBV", {off}) +
                                        pageButton("release", "Release it", {off}) +
                                        pageButton("remove", "Take it away", {off})));
}

/// A slider and a number that follow each other.
Markup speedControl() {
  const Markup range = element("input", {{"type", "range"},
                                         {"id", "speed"},
                                         {"min", "0.5"},
                                         {"max", "20"},
                                         {"step", "0.5"},
                                         {"aria-label", "Target speed of the CBVs"}});
  const Markup number = element("input", {{"type", "number"},
                                          {"id", "speed-number"},
                                          {"min", "0.5"},
                                          {"max", "40"},
                                          {"step", "any"},
                                          {"aria-label", "Target speed of the CBVs in m/s"}});
  return row(element("label", {}, "Target speed v*") + range + number + " m/s");
}

Markup objectiveTable() {
  Markup head;
  for (const char* name : {"Objective", "Weight w", "Value J", "w · J"})
    head += element("th", {{"scope", "col"}}, name);
  return element("table", {{"id", "objectives"}},
                 element("thead", {}, element("tr", {}, head)) + element("tbody"));
}

/// What the CBVs are told; without objectives where their planner follows none.
Markup guidancePanel(const session::SessionSetup& setup) {
  const session::ScenarioOptions& options = setup.options();
  const bool guided = planners::canBeGuided(options.cbv_planner);
  std::vector<std::pair<std::string, std::string>> profiles;
  for (const std::string& name : guidance::shippedProfiles()) profiles.emplace_back(name, name);
  const core::Attribute shown = guided ? core::Attribute("class", "row") : core::flag("hidden");
  const Markup choice =
      element("div", {shown}, element("label", {}, "Profile " + pageChoice("profile", profiles))) +
      "\n";
  const Markup table =
      guided ? Markup()
             : pageNote("The planner " + options.cbv_planner + " follows no objectives.");
  const Markup objectives = element(
      "div", {guided ? core::Attribute("class", "scroll") : core::flag("hidden")},
      objectiveTable() +
          row(pageButton("all", "All objectives") +
              element("span", {{"class", "note"}},
                      "Values: the plan of " + element("span", {{"id", "objectives-of"}}))));
  return panel("What the CBVs are told",
               choice + speedControl() + table + objectives +
                   element("p", {{"class", "note"}, {"id", "challenge"}}));
}

Markup liveStage(const session::SessionSetup& setup, const MapCanvas& canvas) {
  const Markup map =
      element("div", {{"class", "map"}}, "\n" + liveTopViewSvg(setup, canvas)) + "\n";
  const Markup left =
      element("div", {}, "\n" + map + liveControls() + momentTable() + vehiclePanel()) + "\n";
  const bool views = setup.options().report.front_view_rate > 0.0;
  const Markup sights =
      element("div", {{"id", "sights"}, core::flag("hidden")}) + "\n" +
      pageNote(views ? "Front views of the CBVs appear here."
                     : "Front views were not asked for (report.front_view_rate is 0).") +
      element("template", {{"id", "sight"}}, sightFigure(0));
  return element(
             "div", {{"class", "stage"}},
             "\n" + left + element("div", {{"class", "sights"}}, sights + guidancePanel(setup))) +
         "\n" + topViewLegend(canvas) +
         pageNote(
             "A dashed green box is a competent driver in the ego's place, who can still answer "
             "the "
             "attack (mode challenging).");
}

Markup liveChart(const char* id, const std::string& caption) {
  const Markup svg = svgPicture(caption, {kChartWidth, kChartHeight}, {{"id", id}}, {});
  return chartFigure("chart own", caption, svg) + "\n";
}

Markup liveCharts() {
  return element("div", {{"class", "charts"}},
                 "\n" + liveChart("speed-chart", "Speed of ego and CBVs") +
                     liveChart("ttc-chart",
                               "2D-TTC: each CBV with the ego; the ego with anyone; up to 10 s") +
                     liveChart("gap-chart", "Gap between the outlines of ego and CBV, up to 60 m") +
                     liveChart("score-chart", "Interaction score of each CBV at its selection")) +
         "\n";
}

/// A table that the script fills, hidden until it has a row; `none` is shown before.
Markup liveTable(const std::string& id, const std::vector<std::string>& head,
                 const std::string& none) {
  Markup cells;
  for (const std::string& name : head) cells += element("th", {{"scope", "col"}}, name);
  std::vector<core::Attribute> attributes = {{"id", id}};
  if (!none.empty()) attributes.push_back(core::flag("hidden"));
  const Markup table = element("table", attributes,
                               element("thead", {}, element("tr", {}, cells)) + element("tbody"));
  return element("div", {{"class", "scroll"}}, table) + "\n" +
         element("p", {{"class", "note"}, {"id", "no-" + id}}, none) + "\n";
}

std::vector<PageSection> liveSections() {
  return {{"Over time", liveCharts()},
          {"Verdict so far", liveTable("rules", {"So far", "Rule"}, "")},
          {"Steering",
           liveTable("changes", {"At [s]", "By", "Changed", "Refused"}, "Nothing was steered.")},
          {"Faults", liveTable("faults", {"At [s]", "Where", "What"}, "No fault.")}};
}

Markup liveHeader(const session::ScenarioOptions& options) {
  const Markup text = element("strong", {{"id", "headline"}}, "Connecting") +
                      element("span", {{"id", "so-far"}, {"class", "word"}});
  const Markup banner =
      element("div", {{"class", "banner running"}, {"id", "banner"}, {"role", "status"}},
              element("div", {}, text)) +
      "\n";
  return pageHeader(options.name,
                    "live · " + options.mode + " · seed " + std::to_string(options.seed) +
                        " · ego " + options.ego_planner + " · CBV " + options.cbv_planner +
                        " · method " + session::methodText(session::methodOf(options)),
                    banner + pageNote("The ego (red) is under test. CBVs, critical background "
                                      "vehicles (purple), are driven against it. All else is "
                                      "traffic (blue)."));
}

/// What the script has to know from the start.
std::string sceneJson(const session::SessionSetup& setup, const MapCanvas& canvas) {
  const session::ScenarioOptions& options = setup.options();
  const double rate = options.report.front_view_rate;
  LiveJson scene = {{"styles", vehicleStyles()},
                    {"guided", planners::canBeGuided(options.cbv_planner)},
                    {"objectives", LiveJson::array()},
                    {"period", rate > 0.0 ? kPictureAge : 0.0},
                    {"width", canvas.region().high.x() - canvas.region().low.x()}};
  for (const guidance::WeightedObjective& entry : options.guidance.objectives)
    scene["objectives"].push_back(entry.name);
  return scene.dump(-1, ' ', false, LiveJson::error_handler_t::replace);
}

}  // namespace

std::string livePage(const session::SessionSetup& setup) {
  const MapCanvas canvas = liveCanvas(setup);
  const Markup stage = pageSection("What happens", liveStage(setup, canvas));
  return pageDocument(setup.options().name + " – live", {&kLiveStyle},
                      liveHeader(setup.options()) + stage + pageSections(liveSections()),
                      core::jsonElement("scene", sceneJson(setup, canvas)) +
                          core::scriptElement(kPlayerScript) + core::scriptElement(kLiveScript));
}

std::string livePagePolicy(const std::string& host) {
  return "default-src 'none'; script-src " + scriptHash(kPlayerScript) + " " +
         scriptHash(kLiveScript) + " " + scriptHash(kReportScript) +
         "; style-src 'unsafe-inline'; img-src data:; connect-src ws://" + host +
         "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
}

namespace {

long tenths(double value) { return roundedNumber(10.0 * value); }

/// Styles of the vehicles by their index, as CBVs.
std::vector<std::size_t> stylesOf(const std::pmr::vector<record::TimelineVehicle>& vehicles,
                                  const std::vector<std::string>& cbvs) {
  std::vector<std::size_t> styles;
  for (const record::TimelineVehicle& vehicle : vehicles) {
    const auto found = std::find(cbvs.begin(), cbvs.end(), vehicle.id);
    styles.push_back(cbvStyleNumber(static_cast<std::size_t>(found - cbvs.begin())));
  }
  return styles;
}

std::string challengeText(const guidance::ChallengeReport& report) {
  if (report.state.empty()) return {};
  std::string text = "Mode challenging: the CBV " + report.state;
  if (!report.reason.empty()) text += " (" + report.reason + ")";
  if (report.last_brake_time)
    text += "; the ego must brake within " + core::formatFixed(*report.last_brake_time, 1) + " s";
  return text + ".";
}

LiveJson objectivesOf(const planning::PlannedAction& action) {
  LiveJson items = LiveJson::array();
  for (const guidance::ObjectiveReport& one : action.guidance.objectives) {
    const double value = std::isfinite(one.value) ? one.value : 0.0;
    items.push_back({one.name, one.weight, value});
  }
  return {action.vehicle_id, items, challengeText(action.guidance.challenge)};
}

std::string planLine(const planning::PlannedAction& action, const traffic::Vehicle& vehicle,
                     const MapCanvas& canvas) {
  Points line = {vehicle.state.position};
  for (const planning::RolloutPoint& point : action.rollout) {
    if (point.state.position.allFinite()) line.push_back(point.state.position);
  }
  return line.size() < 2 ? "" : canvas.line(line);
}

/// What the planners of the CBVs want: plans, ghosts, objectives.
void addPlans(LiveJson& frame, const LiveTick& tick, const MapCanvas& canvas) {
  for (const char* key : {"plans", "ghosts", "objectives"}) frame[key] = LiveJson::array();
  for (const planning::PlannedAction& action : tick.decision->actions) {
    const traffic::Vehicle* vehicle = tick.snapshot.find(action.vehicle_id);
    if (vehicle == nullptr || vehicle->role != VehicleRole::kCbv) continue;
    frame["plans"].push_back(action.vehicle_id);
    frame["plans"].push_back(planLine(action, *vehicle, canvas));
    frame["objectives"].push_back(objectivesOf(action));
    const auto& ghost = action.guidance.challenge.ghost;
    if (!ghost || !ghost->position.allFinite()) continue;
    const Eigen::Vector2d at = canvas.toPixels(ghost->position);
    frame["ghosts"].push_back({action.vehicle_id, tenths(at.x()), tenths(at.y()),
                               roundedNumber(-core::radiansToDegrees(ghost->heading))});
  }
}

LiveJson conflictsOf(const LiveTick& tick, const MapCanvas& canvas) {
  LiveJson conflicts = LiveJson::array();
  for (const cbv::CbvAssignment& one : tick.decision->assignments) {
    const traffic::Vehicle* vehicle = tick.snapshot.find(one.vehicle_id);
    if (vehicle == nullptr || vehicle->role != VehicleRole::kCbv) continue;
    const Eigen::Vector2d at = canvas.toPixels(one.conflict_point.position.head<2>());
    const auto place =
        std::find(tick.decision->cbvs.begin(), tick.decision->cbvs.end(), one.vehicle_id);
    conflicts.push_back(
        {one.vehicle_id,
         cbvStyleNumber(static_cast<std::size_t>(place - tick.decision->cbvs.begin())),
         tenths(at.x()), tenths(at.y()),
         canvas.line(inPlane(one.conflict_aware_route.path().points()))});
  }
  return conflicts;
}

LiveJson contactsOf(const LiveTick& tick, const MapCanvas& canvas) {
  LiveJson contacts = LiveJson::array();
  for (const record::TimelineContact& contact : tick.decision->contacts) {
    if (!contact.position) continue;
    const Eigen::Vector2d at = canvas.toPixels(*contact.position);
    contacts.push_back({"contact of " + contact.first + " and " + contact.second + " at " +
                            core::formatFixed(contact.time, 2) + " s",
                        tenths(at.x()), tenths(at.y())});
  }
  return contacts;
}

}  // namespace

LiveWriter::LiveWriter(const session::SessionSetup& setup)
    : canvas_(liveCanvas(setup)), index_(setup.options().simulation_step) {}

LiveJson LiveWriter::frame(const LiveTick& tick) {
  const record::TimelineFrame poses = index_.frameOf(tick.snapshot);
  LiveJson frame = {
      {"time", tick.snapshot.time},
      {"vehicles", LiveJson::array()},
      {"slots", LiveJson::array()},
      {"numbers", frameNumbers(poses, canvas_, stylesOf(index_.vehicles(), tick.decision->cbvs))},
      {"moment", momentNumbers(poses)}};
  for (const record::TimelinePose& pose : poses.poses) {
    const record::TimelineVehicle& vehicle = index_.vehicles()[pose.vehicle];
    frame["vehicles"].push_back({pose.vehicle, vehicle.id, vehicle.length, vehicle.width});
    if (pose.role == VehicleRole::kCbv) frame["slots"].push_back(pose.slot);
  }
  addPlans(frame, tick, canvas_);
  frame["conflicts"] = conflictsOf(tick, canvas_);
  frame["contacts"] = contactsOf(tick, canvas_);
  return frame;
}

LiveJson LiveWriter::point(const LivePoint& point) const {
  const auto decimals = [](double value) { return std::round(100.0 * value) / 100.0; };
  LiveJson vehicles = LiveJson::array();
  for (const LivePoint::Vehicle& vehicle : point.vehicles) {
    const Eigen::Vector2d at = canvas_.toPixels({vehicle.pose.x, vehicle.pose.y});
    vehicles.push_back({vehicle.id, vehicle.style, tenths(at.x()), tenths(at.y()),
                        decimals(static_cast<double>(vehicle.pose.speed)),
                        decimals(static_cast<double>(vehicle.pose.time_to_collision)),
                        decimals(static_cast<double>(vehicle.pose.gap)), decimals(vehicle.score)});
  }
  return {decimals(point.time), vehicles};
}

LiveJson LiveWriter::view(const record::FrontView& view) const {
  const auto& vehicles = index_.vehicles();
  const auto found = std::find_if(vehicles.begin(), vehicles.end(), [&](const auto& vehicle) {
    return vehicle.id == view.vehicle_id;
  });
  if (found == vehicles.end()) return nullptr;
  return {view.time, found - vehicles.begin(), record::base64(view.jpeg)};
}

LiveJson LiveWriter::verdict(const record::Verdict& so_far, bool by_hand) {
  // What these rules ask for can still come.
  const std::set<std::string> open = {"status", "route_completion", "driving_score"};
  LiveJson rules = LiveJson::array();
  std::size_t broken = 0;
  for (const record::Check& check : so_far.checks) {
    if (check.name == "session" || check.name == "status") continue;
    const bool waits = check.outcome == record::CheckOutcome::kFailed && open.count(check.name) > 0;
    const std::string outcome = waits ? "skipped" : record::toText(check.outcome);
    const bool bad = outcome == "failed" || outcome == "struck";
    broken += bad ? 1 : 0;
    rules.push_back({outcome, waits ? "open" : outcome, check.text});
  }
  std::string text = "No rule judges this session.";
  if (!rules.empty()) {
    text = broken == 0 ? "No rule is broken so far."
                       : std::to_string(broken) + " of " + std::to_string(rules.size()) +
                             " rules are broken so far.";
  }
  if (by_hand) text += " It is steered by hand, so it will not be judged.";
  return {{"style", broken > 0 ? "failed" : "running"}, {"text", text}, {"rules", rules}};
}

}  // namespace cdiff::page
