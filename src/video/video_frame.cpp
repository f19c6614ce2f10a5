// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "video/video_frame.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/text.h"
#include "metrics/formulas/ttc_2d.h"
#include "record/session_text.h"
#include "video/video_highlights.h"

namespace cdiff::video {
namespace {

using traffic::Vehicle;
using traffic::VehicleRole;

// [pixels]
constexpr int kHeadHeight = 44;
constexpr int kViewWidth = 640;
constexpr int kViewHeight = 384;
constexpr int kTableTop = kHeadHeight + kViewHeight;
constexpr int kRowHeight = 40;
constexpr int kRows = 5;  // of vehicles that the table shows
constexpr int kBarWidth = 84;
constexpr std::int64_t kWidestView = 213;  // of the ego's cameras
constexpr double kLongestTime = 100.0;     // to a collision that is shown [s]
// Left edges of the table's columns.
constexpr int kNameX = 30;
constexpr int kSpeedX = 190;
constexpr int kThrottleX = 300;
constexpr int kBrakeX = 400;
constexpr int kSteerX = 500;

// The box with the verdict.
constexpr int kBoxWidth = 900;   // [pixels]
constexpr int kLineHeight = 28;  // [pixels]
constexpr std::size_t kMostLines = 14;

/// A value in [low, 1] as a bar that grows from 0.
void drawBar(cv::Mat picture, const cv::Point& left, double value, double low,
             const cv::Scalar& color) {
  const cv::Rect frame(left.x, left.y, kBarWidth, 12);
  cv::rectangle(picture, frame, ink::kRoad, cv::FILLED);
  const double zero = -low / (1.0 - low);
  const double share = (std::clamp(value, low, 1.0) - low) / (1.0 - low);
  const auto pixel = [&](double part) {
    return left.x + static_cast<int>(std::lround(part * kBarWidth));
  };
  const int from = pixel(std::min(zero, share));
  const int to = std::max(from + 1, pixel(std::max(zero, share)));
  cv::rectangle(picture, cv::Rect(from, left.y, to - from, 12), color, cv::FILLED);
}

std::vector<std::string> wrapped(const std::string& text, int width, double size) {
  std::vector<std::string> lines;
  for (const std::string& word : core::splitText(text, ' ')) {
    const bool fits = !lines.empty() && textWidth(lines.back() + " " + word, size) <= width;
    if (fits) {
      lines.back() += " " + word;
    } else {
      lines.push_back(cutText(word, width, size));
    }
  }
  return lines;
}

cv::Scalar inkOf(record::Outcome outcome) {
  switch (outcome) {
    case record::Outcome::kPassed:
      return ink::kPassed;
    case record::Outcome::kStruck:
      return ink::kStruck;
    case record::Outcome::kFailed:
      return ink::kFailed;
    case record::Outcome::kNotJudged:
      return ink::kSoft;
    case record::Outcome::kError:
    case record::Outcome::kInterrupted:
      break;
  }
  return ink::kError;
}

/// Why, and what happened.
std::vector<std::string> verdictLines(const record::SessionResult& result, int width) {
  std::vector<std::string> sentences = result.verdict.reasons;
  for (const std::string& sentence : record::sessionStory(result)) sentences.push_back(sentence);
  std::vector<std::string> lines;
  for (const std::string& sentence : sentences) {
    for (std::string& line : wrapped(sentence, width, 0.6)) lines.push_back(std::move(line));
  }
  if (lines.size() > kMostLines) lines.resize(kMostLines);
  return lines;
}

}  // namespace

VideoFrame::VideoFrame(const session::SessionSetup& setup)
    : setup_(setup),
      camera_(record::cameraForPeople(setup, kViewWidth, kViewHeight)),
      map_(setup, {kFrameWidth - kViewWidth, kFrameHeight - kHeadHeight}),
      contacts_(setup),
      picture_(kFrameHeight, kFrameWidth, CV_8UC3) {
  const auto cameras = static_cast<std::int64_t>(setup.rigs().of(traffic::kEgoSlot).cameras.size());
  if (cameras < 2) return;
  const std::int64_t width = std::min<std::int64_t>(kWidestView, kViewWidth / cameras);
  ego_cameras_.emplace(record::rigForPeople(setup, width, width * 3 / 5));
}

void VideoFrame::observe(const session::TickRecord& record) {
  snapshot_ = *record.snapshot;
  map_.observe(record);
  const Vehicle* nearest = followed_.update(snapshot_);
  shown_ = nearest == nullptr ? "" : nearest->id;
  contacts_.update(snapshot_);
  const ContactMark* contact = contacts_.ofEgo();
  if (contact == nullptr || contact->begin < snapshot_.time) return;
  const Vehicle* partner = snapshot_.find(contact->partner);
  if (partner == nullptr || partner->role != VehicleRole::kCbv || !isPlaced(*partner)) return;
  contact_view_.create(kViewHeight, kViewWidth, CV_8UC3);
  drawCbvView(contact_view_, *partner,
              ", at the contact, " + core::formatFixed(snapshot_.time, 2) + " s");
  contact_view_end_ = snapshot_.time + kContactTime;
}

std::vector<std::uint8_t> VideoFrame::draw() {
  drawScene();
  return bytes();
}

void VideoFrame::drawScene() {
  picture_.setTo(ink::kPage);
  map_.draw(picture_(cv::Rect(kViewWidth, kHeadHeight, kFrameWidth - kViewWidth,
                              kFrameHeight - kHeadHeight)),
            contacts_.marks());
  drawFrontView();
  if (ego_cameras_) drawEgoCameras();
  drawTable();
  drawHead();
}

void VideoFrame::drawHead() {
  const session::ScenarioOptions& options = setup_.options();
  const std::string time = "t = " + core::formatFixed(snapshot_.time, 1) + " s";
  writeText(picture_, time, {kFrameWidth - 16 - textWidth(time, 0.75, true), 30}, 0.75, ink::kText,
            true);
  const std::string what = options.name + "  |  " + options.mode + "  |  seed " +
                           std::to_string(options.seed) + "  |  ego " + options.ego_planner +
                           ", CBV " + options.cbv_planner;
  writeText(picture_, cutText(what, kFrameWidth - 200, 0.6), {14, 29}, 0.6, ink::kText);
}

void VideoFrame::drawFrontView() {
  cv::Mat view = picture_(cv::Rect(0, kHeadHeight, kViewWidth, kViewHeight));
  const Vehicle* cbv = shown_.empty() ? nullptr : snapshot_.find(shown_);
  if (snapshot_.time <= contact_view_end_) {
    contact_view_.copyTo(view);
  } else if (cbv != nullptr) {
    drawCbvView(view, *cbv, ", nearest to the ego");
  } else {
    view.setTo(ink::kPanel);
    const std::string text = "No CBV is driven";
    writeText(view, text, {(kViewWidth - textWidth(text, 0.8)) / 2, kViewHeight / 2}, 0.8,
              ink::kSoft);
  }
  if (const ContactMark* contact = contacts_.ofEgo()) drawContact(view, *contact);
}

void VideoFrame::drawEgoCameras() {
  const Vehicle* ego = snapshot_.ego();
  if (ego == nullptr || !isPlaced(*ego)) return;
  const std::vector<rendering::RigCamera>& cameras = ego_cameras_->rig().cameras;
  int x = kViewWidth;
  std::size_t index = 0;
  for (rendering::RenderedView& view : ego_cameras_->render(snapshot_, *ego)) {
    traffic::CameraImage& image = view.image;
    const cv::Rect place(x, kFrameHeight - image.height, image.width, image.height);
    const cv::Mat red_first(image.height, image.width, CV_8UC3, image.rgb.data());
    cv::cvtColor(red_first, picture_(place), cv::COLOR_RGB2BGR);
    writeText(picture_, cutText(cameras[index++].name, image.width - 8, 0.4),
              {place.x + 4, place.y + 14}, 0.4, ink::kPage);
    x += image.width;
  }
}

void VideoFrame::drawCbvView(cv::Mat view, const Vehicle& cbv, const std::string& note) {
  traffic::CameraImage image = camera_.render(snapshot_, cbv);
  const cv::Mat red_first(image.height, image.width, CV_8UC3, image.rgb.data());
  cv::cvtColor(red_first, view, cv::COLOR_RGB2BGR);
  const std::string name = cutText(
      "CBV " + cbv.id + ", slot " + std::to_string(cbv.cbv_slot) + note, kViewWidth - 40, 0.6);
  cv::rectangle(view, cv::Rect(0, 0, textWidth(name, 0.6) + 28, 32),
                inkOf(VehicleRole::kCbv, cbv.cbv_slot), cv::FILLED);
  writeText(view, name, {14, 22}, 0.6, ink::kPage);
}

void VideoFrame::drawContact(cv::Mat view, const ContactMark& contact) const {
  std::vector<std::string> lines = wrapped(contact.reason, kViewWidth - 28, 0.5);
  if (lines.size() > 3) lines.resize(3);
  const int height = 34 + 20 * static_cast<int>(lines.size());
  const cv::Rect plate(0, kViewHeight - height, kViewWidth, height);
  cv::rectangle(view, plate, inkOf(contact), cv::FILLED);
  const std::string head =
      "Contact at " + core::formatFixed(contact.begin, 2) + " s: " + contact.label;
  writeText(view, cutText(head, kViewWidth - 28, 0.6), {14, plate.y + 23}, 0.6, ink::kPage, true);
  for (std::size_t i = 0; i < lines.size(); ++i)
    writeText(view, lines[i], {14, plate.y + 44 + 20 * static_cast<int>(i)}, 0.5, ink::kPage);
}

void VideoFrame::drawTable() {
  const auto column = [&](const std::string& text, int x) {
    writeText(picture_, text, {x, kTableTop + 26}, 0.5, ink::kSoft);
  };
  column("m/s", kSpeedX);
  column("throttle", kThrottleX);
  column("brake", kBrakeX);
  column("steer", kSteerX);
  int row = 0;
  for (const Vehicle& vehicle : snapshot_.vehicles) {
    if (vehicle.role == VehicleRole::kBackground || row == kRows) break;  // ego, then CBVs
    drawRow(vehicle, kTableTop + 36 + kRowHeight * row);
    ++row;
  }
  const Vehicle* ego = snapshot_.ego();
  if (ego == nullptr) return;
  const auto ttc = metrics::interactionOf(*ego, snapshot_, {}).ttc_2d;
  const bool soon = ttc && *ttc < kLongestTime;
  writeText(picture_, "2D-TTC of the ego: " + (soon ? core::formatFixed(*ttc, 1) + " s" : "none"),
            {kNameX, kFrameHeight - 18}, 0.6, ink::kText);
}

void VideoFrame::drawRow(const Vehicle& vehicle, int y) {
  const cv::Scalar color = inkOf(vehicle.role, vehicle.cbv_slot);
  cv::rectangle(picture_, cv::Rect(12, y + 6, 10, 24), color, cv::FILLED);
  const std::string name = vehicle.role == VehicleRole::kEgo ? "ego" : vehicle.id;
  writeText(picture_, cutText(name, kSpeedX - kNameX - 10, 0.55), {kNameX, y + 24}, 0.55,
            ink::kText);
  writeText(picture_, core::formatFixed(vehicle.state.speed, 1), {kSpeedX, y + 24}, 0.6,
            ink::kText);
  if (!vehicle.applied_action) return;
  drawBar(picture_, {kThrottleX, y + 12}, vehicle.applied_action->throttle, 0.0, ink::kPassed);
  drawBar(picture_, {kBrakeX, y + 12}, vehicle.applied_action->brake, 0.0, ink::kFailed);
  // Positive to the left, as the wheel turns.
  drawBar(picture_, {kSteerX, y + 12}, -vehicle.applied_action->steer, -1.0, ink::kBackground);
}

std::vector<std::uint8_t> VideoFrame::drawVerdict(const record::SessionResult& result) {
  drawScene();
  const std::vector<std::string> lines = verdictLines(result, kBoxWidth - 60);
  const int height = 90 + kLineHeight * static_cast<int>(lines.size());
  const cv::Rect box((kFrameWidth - kBoxWidth) / 2, (kFrameHeight - height) / 2, kBoxWidth, height);
  const std::string word = capitalsOf(result.verdict.outcome);
  const cv::Scalar color = inkOf(result.verdict.outcome);
  cv::rectangle(picture_, box, ink::kPage, cv::FILLED);
  cv::rectangle(picture_, box, color, 4, cv::LINE_AA);
  writeText(picture_, word + ": status " + traffic::toText(result.status), {box.x + 28, box.y + 46},
            1.0, color, true);
  int y = box.y + 84;
  for (const std::string& line : lines) {
    writeText(picture_, line, {box.x + 28, y}, 0.6, ink::kText);
    y += kLineHeight;
  }
  return bytes();
}

std::vector<std::uint8_t> VideoFrame::bytes() const {
  return {picture_.datastart, picture_.dataend};
}

}  // namespace cdiff::video
