// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "what_if/what_if_page.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "e2e_cdiff/core/angle.h"
#include "page/page_parts.h"
#include "page/pictures/charts.h"
#include "page/pictures/map_canvas.h"
#include "page/pictures/top_view.h"

namespace cdiff::what_if {
namespace {

using core::element;
using core::Markup;
using Json = nlohmann::ordered_json;

/// How much before the take-over the page shows [s].
constexpr double kLead = 2.0;
const Eigen::Vector2d kPictureSize(420.0, 320.0);

/// One of the courses on the page.
struct Panel {
  std::string title;
  std::string outcome;
  const Course* course;
  const char* style;                                          ///< of the ego's line in the chart
  std::optional<std::pair<double, Eigen::Vector2d>> contact;  ///< (time [s], place [m])
};

std::optional<std::pair<double, Eigen::Vector2d>> contactOf(const Course& course) {
  if (!course.contact) return std::nullopt;
  return std::pair(course.contact->seconds, Eigen::Vector2d(course.contact->x, course.contact->y));
}

/// The recorded contact, midway between the two.
std::optional<std::pair<double, Eigen::Vector2d>> recordedContact(const Answer& answer) {
  if (!answer.question.contact) return std::nullopt;
  for (const record::TimelineContact& contact : answer.recorded.timeline.contacts()) {
    const std::string& partner = answer.question.contact->partner;
    const bool own = contact.first == partner || contact.second == partner;
    if (own && contact.position && contact.time == answer.question.contact->seconds)
      return std::pair(contact.time, *contact.position);
  }
  return std::nullopt;
}

std::string outcomeText(const Course& course) {
  std::string text = "no contact";
  if (course.contact) {
    text = "contact with " + course.contact->partner + " at " +
           core::formatFixed(course.contact->seconds, 2) + " s, ego at " +
           core::formatFixed(course.contact->ego_speed, 1) + " m/s";
  }
  if (course.struck_behind > 0)
    text += "; run into from behind by " + std::to_string(course.struck_behind);
  return text;
}

std::vector<Panel> panelsOf(const Answer& answer) {
  const auto& contact = answer.question.contact;
  const std::string recorded = contact ? "contact with " + contact->partner + " at " +
                                             core::formatFixed(contact->seconds, 2) + " s"
                                       : "no contact was named";
  return {{"As recorded", recorded, &answer.recorded, "bg", recordedContact(answer)},
          {answer.driver + ", others answer", outcomeText(answer.closed.course),
           &answer.closed.course, "ego", contactOf(answer.closed.course)},
          {answer.driver + ", others as recorded", outcomeText(answer.open.course),
           &answer.open.course, "cbv c0", contactOf(answer.open.course)}};
}

bool shown(const record::TimelineFrame& frame, const Answer& answer) {
  return frame.time >= answer.take_over - kLead;
}

/// Where the ego is in any of the courses, with a margin.
page::Region regionOf(const std::vector<Panel>& panels, const Answer& answer) {
  constexpr double kMargin = 15.0;  // [m]
  page::Region region{Eigen::Vector2d::Constant(1e9), Eigen::Vector2d::Constant(-1e9)};
  for (const Panel& panel : panels) {
    for (const record::TimelineFrame& frame : panel.course->timeline.frames()) {
      if (!shown(frame, answer)) continue;
      for (const record::TimelinePose& pose : frame.poses) {
        if (pose.role != traffic::VehicleRole::kEgo) continue;
        region.low = region.low.cwiseMin(Eigen::Vector2d(pose.x, pose.y));
        region.high = region.high.cwiseMax(Eigen::Vector2d(pose.x, pose.y));
      }
    }
  }
  return region.grown(kMargin);
}

/// Five whole numbers per vehicle: index, style, x and y [0.1 pixel], heading clockwise [deg].
Json poseNumbers(const record::TimelineFrame& frame, const Course& course,
                 const std::string& partner, const page::MapCanvas& canvas) {
  Json numbers = Json::array();
  for (auto pose = frame.poses.rbegin(); pose != frame.poses.rend(); ++pose) {
    if (!canvas.shows({pose->x, pose->y})) continue;
    const Eigen::Vector2d pixel = canvas.toPixels({pose->x, pose->y});
    const bool ego = pose->role == traffic::VehicleRole::kEgo;
    const bool attacker = course.timeline.vehicles()[pose->vehicle].id == partner;
    const bool cbv = pose->role == traffic::VehicleRole::kCbv;
    numbers.push_back(pose->vehicle);
    numbers.push_back(ego ? 0 : attacker ? 2 : cbv ? 3 : 1);
    numbers.push_back(std::lround(10.0 * pixel.x()));
    numbers.push_back(std::lround(10.0 * pixel.y()));
    numbers.push_back(std::lround(-core::radiansToDegrees(static_cast<double>(pose->heading))));
  }
  return numbers;
}

/// Time [s] and place [pixels] of the ego's contact that ends a course; null without one.
Json contactNumbers(const Panel& panel, const page::MapCanvas& canvas) {
  if (!panel.contact) return nullptr;
  const Eigen::Vector2d pixel = canvas.toPixels(panel.contact->second);
  return {panel.contact->first, std::round(pixel.x()), std::round(pixel.y())};
}

Json courseJson(const Panel& panel, const Answer& answer, const page::MapCanvas& canvas) {
  const auto& contact = answer.question.contact;
  Json json = {{"vehicles", Json::array()}, {"times", Json::array()}, {"frames", Json::array()}};
  json["contact"] = contactNumbers(panel, canvas);
  for (const record::TimelineVehicle& vehicle : panel.course->timeline.vehicles())
    json["vehicles"].push_back({vehicle.id, vehicle.length, vehicle.width});
  for (const record::TimelineFrame& frame : panel.course->timeline.frames()) {
    if (!shown(frame, answer)) continue;
    json["times"].push_back(std::round(100.0 * frame.time) / 100.0);
    json["frames"].push_back(
        poseNumbers(frame, *panel.course, contact ? contact->partner : "", canvas));
  }
  return json;
}

Markup picture(const Panel& panel, const session::SessionSetup& setup,
               const page::MapCanvas& canvas, std::size_t index) {
  const Markup vehicles = element("g", {{"class", "vehicles"}}, " ");
  const Markup svg = page::svgPicture(
      panel.title, kPictureSize, {{"class", "course"}, {"data-course", std::to_string(index)}},
      page::roadSvg(setup, canvas) + page::scaleBarSvg(canvas) + vehicles);
  return element("figure", {{"class", "chart own"}},
                 element("figcaption", {}, panel.title) + element("div", {{"class", "map"}}, svg) +
                     page::pageNote(panel.outcome)) +
         "\n";
}

Markup sliderHtml() {
  const Markup row = element("button", {{"type", "button"}, {"id", "play"}}, "Play") + "\n" +
                     element("input", {{"type", "range"},
                                       {"id", "time"},
                                       {"min", "0"},
                                       {"value", "0"},
                                       {"step", "1"},
                                       {"aria-label", "Time of the session"}}) +
                     "\n" + element("output", {{"id", "now"}, {"for", "time"}});
  return element("div", {{"class", "controls"}}, element("div", {{"class", "row"}}, row)) + "\n";
}

/// Speed of the ego in each course, from the session's start.
Markup speedChart(const std::vector<Panel>& panels, const Answer& answer) {
  page::Chart chart;
  chart.title = "Speed of the ego";
  chart.unit = "m/s";
  for (const Panel& panel : panels) {
    page::ChartSeries series{panel.style, {}};
    for (const record::TimelineFrame& frame : panel.course->timeline.frames()) {
      chart.duration = std::max(chart.duration, frame.time);
      for (const record::TimelinePose& pose : frame.poses) {
        if (pose.role == traffic::VehicleRole::kEgo)
          series.points.emplace_back(frame.time, static_cast<double>(pose.speed));
      }
    }
    chart.series.push_back(series);
  }
  chart.marks = {{answer.take_over, 0.0, "take-over"}};
  Markup legend;
  for (const Panel& panel : panels) legend += page::legendLine(panel.style, panel.title);
  return element("div", {{"class", "charts"}}, page::chartSvg(chart)) + page::pageLegend(legend);
}

/// How often the open answer holds, and the latest take-overs.
Markup answerTable(const Answer& answer) {
  page::HtmlTable table({"Others", "#Take-over [s]", "Contact",
                         "#Latest take-over that avoids, before the contact [s]"});
  const auto row = [&](const std::string& others, const LoopAnswer& loop) {
    table.row({others, core::formatFixed(answer.take_over, 2), outcomeText(loop.course),
               loop.latest ? core::formatFixed(*loop.latest, 1) : "–"});
  };
  row("answer to the driver (closed)", answer.closed);
  row("as recorded (open)", answer.open);
  for (const auto& [shift, avoids] : answer.shifted) {
    table.row({"as recorded, the partner " + core::formatFixed(std::abs(shift), 1) + " s " +
                   (shift < 0.0 ? "earlier" : "later"),
               core::formatFixed(answer.take_over, 2), avoids ? "no contact" : "contact", "–"});
  }
  return table.html();
}

}  // namespace

std::string whatIfPage(const session::SessionSetup& setup, const Answer& answer) {
  const std::vector<Panel> panels = panelsOf(answer);
  const page::MapCanvas canvas(regionOf(panels, answer), kPictureSize);
  const session::ScenarioOptions& options = setup.options();
  Json data = {
      {"styles", {"ego", "bg", "cbv c0", "cbv c1"}},
      {"start", answer.question.contact ? answer.question.contact->seconds : answer.take_over},
      {"scale", canvas.scale() * page::vehicleMagnification(canvas)},
      {"courses", Json::array()}};
  Markup pictures = "\n";
  for (std::size_t i = 0; i < panels.size(); ++i) {
    pictures += picture(panels[i], setup, canvas, i);
    data["courses"].push_back(courseJson(panels[i], answer, canvas));
  }
  const Markup html =
      page::pageHeader("What if " + answer.driver + " had taken over?",
                       options.name + " · " + options.mode + " · seed " +
                           std::to_string(options.seed) + " · ego " + options.ego_planner +
                           " · CBV " + options.cbv_planner,
                       element("p", {{"class", "story"}}, answerText(answer))) +
      page::pageSection("Side by side",
                        element("div", {{"class", "courses"}}, pictures) + sliderHtml()) +
      page::pageSection("Take-overs", answerTable(answer)) +
      page::pageSection("Over time", speedChart(panels, answer));
  return page::pageDocument(
      "What if – " + options.name, {&kWhatIfStyle}, html,
      core::jsonElement("courses", data.dump(-1, ' ', false, Json::error_handler_t::replace)) +
          core::scriptElement(kWhatIfScript));
}

}  // namespace cdiff::what_if
