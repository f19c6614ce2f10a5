// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "record/session_result.h"
#include "rendering/front_camera.h"
#include "session/session_observer.h"
#include "session/session_setup.h"
#include "video/video_highlights.h"
#include "video/video_map.h"

namespace cdiff::video {

/// One picture of the video: a head line, the front view of the CBV nearest to the ego above a
/// table of ego and CBVs, and the world from above; at the end the verdict over it. A contact of
/// the ego stays for kContactTime: marked, named, and with the front view of the moment.
class VideoFrame {
 public:
  // [pixels]
  static constexpr int kFrameWidth = 1280;
  static constexpr int kFrameHeight = 720;

  /// `setup` must outlive the frame.
  explicit VideoFrame(const session::SessionSetup& setup);
  /// Every tick in order.
  void observe(const session::TickRecord& record);
  /// The last tick; height x width x 3 bytes: blue, green, red.
  std::vector<std::uint8_t> draw();
  /// The same under the verdict and what happened.
  std::vector<std::uint8_t> drawVerdict(const record::SessionResult& result);

 private:
  void drawScene();
  void drawHead();
  void drawFrontView();
  /// What the ego's cameras see, side by side, where it has several.
  void drawEgoCameras();
  void drawCbvView(cv::Mat view, const traffic::Vehicle& cbv, const std::string& note);
  void drawContact(cv::Mat view, const ContactMark& contact) const;
  void drawTable();
  void drawRow(const traffic::Vehicle& vehicle, int y);
  std::vector<std::uint8_t> bytes() const;

  const session::SessionSetup& setup_;
  rendering::FrontCamera camera_;
  std::optional<rendering::RigRenderer> ego_cameras_;  ///< of a rig of several
  VideoMap map_;
  traffic::TrafficSnapshot snapshot_;  ///< the last one
  FollowedCbv followed_;
  std::string shown_;  ///< CBV of the front view; empty without one
  ContactMarks contacts_;
  cv::Mat contact_view_;  ///< front view at the ego's last contact with a CBV; empty before
  double contact_view_end_ = -1.0;  ///< until when it is shown [s]
  cv::Mat picture_;
};

}  // namespace cdiff::video
