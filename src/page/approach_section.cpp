// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "page/approach_section.h"

#include <algorithm>

#include "core/markup.h"
#include "core/text.h"
#include "page/plan_picture.h"
#include "page/top_view.h"
#include "record/image_data_uri.h"

namespace cdiff::page {
namespace {

constexpr double kLookBack = 3.0;  // from the closest approach to the plan that is shown [s]

std::string view(const traffic::CameraImage& image, const std::string& style,
                 const std::string& caption) {
  return "<figure class=\"" + style + "\"><img width=\"" + std::to_string(image.width) +
         "\" height=\"" + std::to_string(image.height) + "\" alt=\"" + core::escapeMarkup(caption) +
         "\" src=\"" + record::pngDataUri(image) + "\"><figcaption>" + core::escapeMarkup(caption) +
         "</figcaption></figure>\n";
}

std::string speedText(const traffic::Vehicle& vehicle) {
  return core::formatFixed(vehicle.state.speed, 1) + " m/s";
}

/// What a vehicle saw: for people, and as the planner got it.
std::string views(rendering::FrontCamera& camera, const record::Approach& approach,
                  const traffic::Vehicle& vehicle, const std::string& name,
                  const traffic::CameraImage& seen) {
  std::string html = view(camera.render(approach.snapshot, vehicle), "view",
                          "From the " + name + " at " + core::formatFixed(approach.time(), 2) +
                              " s, " + speedText(vehicle));
  if (seen.empty()) return html;
  const double step_age = static_cast<double>(approach.snapshot.tick - seen.tick);
  const std::string when = step_age > 0.0 ? " at the decision " + core::formatFixed(step_age, 0) +
                                                (step_age > 1.0 ? " ticks" : " tick") + " before"
                                          : " at this tick";
  return html +
         view(seen, "view small",
              "What the planner of the " + name + " saw" + when + ": " +
                  std::to_string(seen.width) + " × " + std::to_string(seen.height) + " pixels");
}

std::string planPart(const record::SessionResult& result, const record::Approach& approach) {
  const record::VehiclePlans* vehicle = result.plans.find(approach.vehicle_id);
  if (vehicle == nullptr || vehicle->plans.empty()) return {};
  const record::LoggedPlan* plan =
      result.plans.drivenPlanNear(*vehicle, approach.time() - kLookBack);
  if (plan == nullptr) {
    return "<p class=\"note\">It was not driven long enough to follow a whole plan.</p>\n";
  }
  return planPictures(result, *vehicle, *plan);
}

std::string approachPart(const record::SessionResult& result, const record::Approach& approach,
                         rendering::FrontCamera& camera) {
  const traffic::Vehicle* ego = approach.snapshot.ego();
  const traffic::Vehicle* cbv = approach.snapshot.find(approach.vehicle_id);
  if (ego == nullptr || cbv == nullptr) return {};
  const std::string gap = approach.gap > 0.0
                              ? core::formatFixed(approach.gap, 2) + " m between the outlines"
                              : "the outlines overlap";
  return "<article class=\"approach " +
         styleOf(traffic::VehicleRole::kCbv, approach.vehicle_id, result.cbv) + "\">\n<h3>" +
         core::escapeMarkup(approach.vehicle_id) + " at " + core::formatFixed(approach.time(), 2) +
         " s: " + gap + "</h3>\n<p class=\"sub\">Centres " +
         core::formatFixed(approach.center_distance, 1) + " m apart; CBV " + speedText(*cbv) +
         ", ego " + speedText(*ego) + "</p>\n<div class=\"views\">\n" +
         views(camera, approach, *cbv, "CBV", approach.cbv_image) +
         views(camera, approach, *ego, "ego", approach.ego_image) + "</div>\n" +
         planPart(result, approach) + "</article>\n";
}

}  // namespace

std::vector<const record::Approach*> shownApproaches(const record::ApproachLog& log) {
  std::vector<const record::Approach*> shown;
  for (const record::Approach& approach : log.approaches()) shown.push_back(&approach);
  std::stable_sort(shown.begin(), shown.end(),
                   [](const record::Approach* left, const record::Approach* right) {
                     return left->gap < right->gap;
                   });
  if (shown.size() > kMostApproaches) shown.resize(kMostApproaches);
  return shown;
}

std::string approachSection(const record::SessionResult& result) {
  const std::vector<const record::Approach*> shown = shownApproaches(result.approaches);
  if (shown.empty()) return "<p class=\"note\">No CBV was driven near the ego.</p>\n";
  rendering::FrontCamera camera = record::cameraForPeople(result.setup, 640, 384);
  std::string html;
  const std::size_t count = result.approaches.approaches().size();
  if (count > shown.size()) {
    html += "<p class=\"note\">The " + std::to_string(shown.size()) + " nearest of " +
            std::to_string(count) + " CBVs.</p>\n";
  }
  for (const record::Approach* approach : shown) html += approachPart(result, *approach, camera);
  return html;
}

}  // namespace cdiff::page
