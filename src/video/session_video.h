// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "record/session_result.h"
#include "session/session_observer.h"

namespace cdiff::video {

/// Name of the video in the result folder.
inline constexpr const char* kVideoFile = "session.mp4";
/// Frames per second.
inline constexpr int kVideoRate = 10;
/// Frames with the verdict.
inline constexpr int kVerdictFrames = 20;

/// Makes session.mp4 while a session runs: 1280 x 720 pixels, 10 frames per simulated second; the
/// front view of the CBV nearest to the ego and what ego and CBVs do on the left, the world from
/// above around the ego on the right; two seconds with the verdict at the end. Frames are functions
/// of the session alone.
class SessionVideo : public session::SessionObserver {
 public:
  /// Writes `folder`/session.mp4; an earlier one is removed. `setup` must outlive the video. What
  /// goes wrong here and later is kept in `error`: a video never ends a session.
  SessionVideo(const session::SessionSetup& setup, const std::filesystem::path& folder);
  ~SessionVideo() override;

  /// The front view is that of the CBV nearest to the ego; contacts of the ego stay for 1.5 s.
  void observe(const session::TickRecord& record) override;
  /// Adds the verdict and gives the file its name. Call once, when the result is complete.
  void finish(const record::SessionResult& result);
  /// Why there is no video, naming who must act; empty when all is well.
  const std::string& error() const { return error_; }

 private:
  class Studio;
  std::unique_ptr<Studio> studio_;  ///< nullptr after an error
  std::string error_;
};

}  // namespace cdiff::video
