// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/front_view_log.h"

#include <algorithm>
#include <cmath>

#include "record/image_data_uri.h"

namespace cdiff::record {
namespace {

constexpr std::int64_t kWidth = 320;   // [pixels]
constexpr std::int64_t kHeight = 192;  // [pixels]

std::uint64_t ticksPerView(const session::ScenarioOptions& options) {
  const double rate = options.report.front_view_rate;
  if (rate <= 0.0) return 0;
  const double ticks = std::round(1.0 / (rate * options.simulation_step));
  return static_cast<std::uint64_t>(std::max(1.0, ticks));
}

bool canBeDrawn(const traffic::Vehicle& vehicle) {
  return vehicle.state.position.allFinite() && std::isfinite(vehicle.state.heading) &&
         std::isfinite(vehicle.state.elevation);
}

}  // namespace

rendering::FrontCamera cameraForPeople(const session::SessionSetup& setup, std::int64_t width,
                                       std::int64_t height) {
  rendering::CameraOptions options = setup.options().camera;
  options.width = width;
  options.height = height;
  options.blind = false;
  return {options, setup.network()};
}

FrontViewLog::FrontViewLog(const session::SessionSetup& setup)
    : setup_(setup), ticks_per_view_(ticksPerView(setup.options())) {}

void FrontViewLog::observe(const traffic::TrafficSnapshot& snapshot) {
  if (ticks_per_view_ == 0 || snapshot.tick % ticks_per_view_ != 0) return;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kBackground) break;  // ego first, then CBVs
    if (vehicle.role != traffic::VehicleRole::kCbv || !canBeDrawn(vehicle)) continue;
    if (!camera_) camera_.emplace(cameraForPeople(setup_, kWidth, kHeight));
    views_.push_back({snapshot.tick, snapshot.time, vehicle.cbv_slot, vehicle.id,
                      jpegOf(camera_->render(snapshot, vehicle))});
    bytes_ += views_.back().jpeg.size();
  }
  while (bytes_ > kFrontViewBytes) thinOut();
}

double FrontViewLog::period() const {
  return static_cast<double>(ticks_per_view_) * setup_.options().simulation_step;
}

void FrontViewLog::thinOut() {
  ticks_per_view_ *= 2;
  const auto left_out = [&](const FrontView& view) { return view.tick % ticks_per_view_ != 0; };
  views_.erase(std::remove_if(views_.begin(), views_.end(), left_out), views_.end());
  bytes_ = 0;
  for (const FrontView& view : views_) bytes_ += view.jpeg.size();
}

}  // namespace cdiff::record
