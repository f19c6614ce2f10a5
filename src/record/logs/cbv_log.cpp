// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/logs/cbv_log.h"

#include <openssl/evp.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "cbv/cbv_selector.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::record {
namespace {

constexpr int kJpegQuality = 72;
constexpr int kPngEffort = 6;  // of 9, which takes three times as long for 5 % fewer bytes

std::vector<std::uint8_t> encoded(const traffic::CameraImage& image, const char* format,
                                  const std::vector<int>& settings) {
  if (!isWhole(image)) {
    throw core::InputError("an image of " + std::to_string(image.width) + " x " +
                           std::to_string(image.height) + " pixels has " +
                           std::to_string(image.rgb.size()) + " bytes");
  }
  const cv::Mat red_first(image.height, image.width, CV_8UC3,
                          const_cast<std::uint8_t*>(image.rgb.data()));  // only read
  cv::Mat blue_first;
  cv::cvtColor(red_first, blue_first, cv::COLOR_RGB2BGR);
  std::vector<std::uint8_t> bytes;
  cv::imencode(format, blue_first, bytes, settings);
  return bytes;
}

}  // namespace

bool isWhole(const traffic::CameraImage& image) {
  if (image.width <= 0 || image.height <= 0) return false;
  return image.rgb.size() ==
         3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
}

std::string base64(const std::vector<std::uint8_t>& bytes) {
  std::string text((bytes.size() + 2) / 3 * 4, '\0');  // the terminating zero fits, too
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), bytes.data(),
                  static_cast<int>(bytes.size()));
  return text;
}

std::string pngDataUri(const traffic::CameraImage& image) {
  return "data:image/png;base64," +
         base64(encoded(image, ".png", {cv::IMWRITE_PNG_COMPRESSION, kPngEffort}));
}

std::vector<std::uint8_t> jpegOf(const traffic::CameraImage& image) {
  return encoded(image, ".jpg", {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
}

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

bool touches(const traffic::TrafficSnapshot& snapshot, const std::string& id) {
  return std::any_of(
      snapshot.contacts.begin(), snapshot.contacts.end(),
      [&](const traffic::Contact& contact) { return contact.first == id || contact.second == id; });
}

rendering::CameraOptions optionsForPeople(const session::SessionSetup& setup, std::int64_t width,
                                          std::int64_t height) {
  rendering::CameraOptions options = setup.options().camera;
  options.width = width;
  options.height = height;
  options.blind = false;
  return options;
}

rendering::FrontCamera paintedByRole(rendering::FrontCamera camera) {
  camera.setBodyColors(rendering::BodyColors::kByRole);
  return camera;
}

}  // namespace

rendering::FrontCamera cameraForPeople(const session::SessionSetup& setup, std::int64_t width,
                                       std::int64_t height) {
  return paintedByRole({optionsForPeople(setup, width, height), setup.network()});
}

rendering::RigRenderer rigForPeople(const session::SessionSetup& setup, std::int64_t width,
                                    std::int64_t height) {
  rendering::CameraRig rig = setup.rigs().of(traffic::kEgoSlot);
  rig.blind = false;
  for (rendering::RigCamera& camera : rig.cameras) {
    camera.width = width;
    camera.height = height;
  }
  rendering::RigRenderer renderer(rig, setup.network());
  renderer.setBodyColors(rendering::BodyColors::kByRole);
  return renderer;
}

FrontViewLog::FrontViewLog(const session::SessionSetup& setup)
    : setup_(setup), ticks_per_view_(ticksPerView(setup.options())) {}

void FrontViewLog::observe(const traffic::TrafficSnapshot& snapshot) {
  if (ticks_per_view_ == 0) return;
  const bool due = snapshot.tick % ticks_per_view_ == 0;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kBackground) break;  // ego first, then CBVs
    if (vehicle.role != traffic::VehicleRole::kCbv || !canBeDrawn(vehicle)) continue;
    const bool contact = contact_views_ < kMostContactViews && touches(snapshot, vehicle.id);
    if (due || contact) add(snapshot, vehicle, contact);
  }
  while (bytes_ > kFrontViewBytes) thinOut();
}

void FrontViewLog::add(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& vehicle,
                       bool contact) {
  if (!camera_) camera_.emplace(cameraForPeople(setup_, kWidth, kHeight));
  views_.push_back({snapshot.tick, snapshot.time, vehicle.cbv_slot, vehicle.id,
                    jpegOf(camera_->render(snapshot, vehicle)), contact});
  bytes_ += views_.back().jpeg.size();
  contact_views_ += contact ? 1U : 0U;
}

rendering::FrontCamera FrontViewLog::camera(std::int64_t width, std::int64_t height) const {
  if (!camera_) return cameraForPeople(setup_, width, height);
  return paintedByRole({optionsForPeople(setup_, width, height), *camera_});
}

double FrontViewLog::period() const {
  return static_cast<double>(ticks_per_view_) * setup_.options().simulation_step;
}

void FrontViewLog::thinOut() {
  ticks_per_view_ *= 2;
  const auto left_out = [&](const FrontView& view) {
    return !view.contact && view.tick % ticks_per_view_ != 0;
  };
  views_.erase(std::remove_if(views_.begin(), views_.end(), left_out), views_.end());
  bytes_ = 0;
  for (const FrontView& view : views_) bytes_ += view.jpeg.size();
}

namespace {

/// Arc length of the conflict point on the conflict-aware route [m]. The route rounds corners, so
/// it lies near the distance along lanes; elsewhere the route may cross the same place again.
double conflictArcLength(const geometry::Polyline& path, const cbv::ConflictPoint& conflict) {
  constexpr double kSlack = 5.0;  // [m]
  const double begin = std::clamp(0.8 * conflict.cbv_distance - kSlack, 0.0, path.length());
  const double end = std::clamp(conflict.cbv_distance + kSlack, begin, path.length());
  return path.project(conflict.position.head<2>(), begin, end).arc_length;
}

CbvRecord newRecord(const cbv::CbvAssignment& assignment, std::pmr::memory_resource* memory) {
  const map::Route& route = assignment.conflict_aware_route;
  const std::vector<Eigen::Vector3d>& points = route.path().points();
  return {assignment.slot,
          assignment.vehicle_id,
          assignment.selected_tick,
          assignment.interaction_score,
          assignment.conflict_point,
          0,             // decisions_driven
          std::nullopt,  // released_tick
          kSessionEnd,
          route.length(),
          {points.begin(), points.end(), memory}};
}

bool sameStay(const CbvRecord& record, const cbv::CbvAssignment& assignment) {
  return record.vehicle_id == assignment.vehicle_id &&
         record.selected_tick == assignment.selected_tick;
}

}  // namespace

double CbvRecord::routeCompletionPercent() const {
  if (release_reason == cbv::kRouteEnd) return 100.0;
  return route_length > 0.0 ? std::min(100.0, 100.0 * arc_length / route_length) : 0.0;
}

bool CbvRecord::routeCompleted() const {
  constexpr double kCompletePercent = 95.0;
  return conflict_point_passed || routeCompletionPercent() >= kCompletePercent;
}

void CbvLog::observe(const traffic::TrafficSnapshot& snapshot, const cbv::CbvSelection& selection) {
  follow(snapshot);
  close(selection);
  for (const cbv::CbvAssignment& assignment : selection.assignments) {
    CbvRecord& record = recordOf(assignment);
    const traffic::Vehicle* vehicle = snapshot.find(assignment.vehicle_id);
    const bool driven = vehicle != nullptr && vehicle->role == traffic::VehicleRole::kCbv;
    if (driven) ++record.decisions_driven;
  }
  for (const cbv::RejectedCandidate& candidate : selection.rejected) {
    ++rejected_[candidate.reason];
    ++rejected_vehicles_[candidate.reason][candidate.vehicle_id];
  }
}

CbvRecord& CbvLog::recordOf(const cbv::CbvAssignment& assignment) {
  const auto known = open_.find(assignment.slot);
  if (known != open_.end()) return records_[known->second.record];
  Stay& stay = open_[assignment.slot];
  stay.record = records_.size();
  stay.path = assignment.conflict_aware_route.path();
  if (!stay.path.empty()) {
    stay.conflict_arc_length = conflictArcLength(stay.path, assignment.conflict_point);
  }
  records_.push_back(newRecord(assignment, rejected_vehicles_.get_allocator().resource()));
  return records_.back();
}

void CbvLog::follow(const traffic::TrafficSnapshot& snapshot) {
  for (const auto& [slot, stay] : open_) {
    CbvRecord& record = records_[stay.record];
    const traffic::Vehicle* vehicle = snapshot.find(record.vehicle_id);
    if (vehicle == nullptr || stay.path.empty()) continue;
    record.arc_length =
        cbv::advancedArcLength(stay.path, record.arc_length, vehicle->state.position);
    if (record.arc_length >= stay.conflict_arc_length) record.conflict_point_passed = true;
  }
}

void CbvLog::close(const cbv::CbvSelection& selection) {
  for (auto slot = open_.begin(); slot != open_.end();) {
    CbvRecord& record = records_[slot->second.record];
    const cbv::CbvAssignment* assignment = selection.find(slot->first);
    if (assignment != nullptr && sameStay(record, *assignment)) {
      ++slot;
      continue;
    }
    record.released_tick = selection.tick;
    record.release_reason = "not_stated";
    for (const cbv::ReleasedCbv& released : selection.released) {
      const bool same = released.slot == record.slot && released.vehicle_id == record.vehicle_id;
      if (same) record.release_reason = released.reason;
    }
    slot = open_.erase(slot);
  }
}

namespace {

/// An approach whose frame lies in `memory`.
Approach emptyApproach(std::pmr::memory_resource* memory) {
  TimelineFrame frame{0.0,
                      std::pmr::vector<TimelinePose>(memory),
                      std::pmr::vector<TimelineAttention>(memory),
                      {},
                      false};
  return {{}, 0.0, 0.0, {}, {std::move(frame), std::pmr::vector<TimelineVehicle>(memory)},
          {}, {},  {},  {}};
}

/// Leaves of an approach the frame of the snapshot, which may be its own.
void reduce(Approach& approach, const traffic::TrafficSnapshot& snapshot) {
  approach.frame = loneFrame(snapshot);
  approach.snapshot = {};
  approach.cbv_image = approach.ego_image = {};
  approach.cbv_views.clear();
  approach.ego_views.clear();
}

}  // namespace

void ApproachLog::observe(const session::TickRecord& record) {
  const traffic::TrafficSnapshot& snapshot = *record.snapshot;
  if (record.selection != nullptr) images_.clear();  // a decision
  if (record.images != nullptr) images_ = *record.images;
  const traffic::Vehicle* ego = snapshot.ego();
  if (ego == nullptr) return;
  for (const traffic::Vehicle& vehicle : snapshot.vehicles) {
    if (vehicle.role == traffic::VehicleRole::kBackground) break;  // ego first, then CBVs
    if (vehicle.role == traffic::VehicleRole::kCbv) compare(snapshot, *ego, vehicle);
  }
}

const Approach* ApproachLog::find(const std::string& vehicle_id) const {
  const auto found = index_by_id_.find(vehicle_id);
  return found == index_by_id_.end() ? nullptr : &approaches_[found->second];
}

void ApproachLog::compare(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& ego,
                          const traffic::Vehicle& cbv) {
  if (traffic::onDifferentLevels(ego, cbv)) return;
  const double gap = geometry::distance(ego.box(), cbv.box());
  if (!std::isfinite(gap)) return;
  const auto [known, added] = index_by_id_.emplace(cbv.id, approaches_.size());
  if (added) approaches_.push_back(emptyApproach(approaches_.get_allocator().resource()));
  Approach& best = approaches_[known->second];
  if (!added && best.gap <= gap) return;
  best.vehicle_id = cbv.id;
  best.gap = gap;
  best.center_distance = (ego.state.position - cbv.state.position).norm();
  if (keepsWhole(known->second)) {
    keepWhole(snapshot, cbv.cbv_slot, best);
  } else {
    reduce(best, snapshot);
  }
}

/// Whether the approach is one of the nearest now. One that is not any more is reduced.
bool ApproachLog::keepsWhole(std::size_t index) {
  if (std::find(whole_.begin(), whole_.end(), index) == whole_.end()) whole_.push_back(index);
  if (whole_.size() <= kMostWhole) return true;
  const auto farthest =
      std::max_element(whole_.begin(), whole_.end(), [&](std::size_t left, std::size_t right) {
        return std::make_pair(approaches_[left].gap, left) <
               std::make_pair(approaches_[right].gap, right);
      });
  Approach& far = approaches_[*farthest];
  const bool own = *farthest == index;
  whole_.erase(farthest);
  if (!own) reduce(far, far.snapshot);
  return !own;
}

void ApproachLog::keepWhole(const traffic::TrafficSnapshot& snapshot, int slot,
                            Approach& approach) {
  approach.snapshot = snapshot;
  approach.cbv_image = imageOf(slot);
  approach.ego_image = imageOf(traffic::kEgoSlot);
  approach.cbv_views = latestViews(slot);
  approach.ego_views = latestViews(traffic::kEgoSlot);
}

std::vector<const Approach*> ApproachLog::nearest() const {
  std::vector<const Approach*> found;
  for (const Approach& approach : approaches_) {
    if (approach.isWhole()) found.push_back(&approach);
  }
  std::stable_sort(found.begin(), found.end(), [](const Approach* left, const Approach* right) {
    return left->gap < right->gap;
  });
  return found;
}

std::vector<session::SlotImage> ApproachLog::latestViews(int slot) const {
  std::vector<session::SlotImage> views;
  for (const session::SlotImage& seen : images_) {
    if (seen.slot == slot && isWhole(seen.image)) views.push_back(seen);
  }
  if (views.size() == 1) views.clear();
  return views;
}

traffic::CameraImage ApproachLog::imageOf(int slot) const {
  for (const session::SlotImage& seen : images_) {
    const bool front = seen.slot == slot && seen.camera == rendering::kFrontCamera;
    if (front && isWhole(seen.image)) return seen.image;
  }
  return {};
}

}  // namespace cdiff::record
