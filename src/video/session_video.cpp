// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "video/session_video.h"

#include <cmath>
#include <optional>

#include "video/video_encoder.h"
#include "video/video_frame.h"

namespace cdiff::video {

/// Frame and encoder.
class SessionVideo::Studio {
 public:
  Studio(const session::SessionSetup& setup, const std::filesystem::path& folder)
      : frame_(setup),
        encoder_(folder / kVideoFile,
                 {VideoFrame::kFrameWidth, VideoFrame::kFrameHeight, kVideoRate}),
        ticks_per_frame_(static_cast<std::uint64_t>(
            std::lround(1.0 / (kVideoRate * setup.options().simulation_step)))) {}

  void observe(const session::TickRecord& record) {
    const std::uint64_t tick = record.snapshot->tick;
    if (last_tick_ && tick <= *last_tick_) return;  // the same tick again, ended from outside
    last_tick_ = tick;
    frame_.observe(record);
    if (tick % ticks_per_frame_ == 0) encoder_.write(frame_.draw());
  }

  void finish(const record::SessionResult& result) {
    const std::vector<std::uint8_t> last = frame_.drawVerdict(result);
    for (int i = 0; i < kVerdictFrames; ++i) encoder_.write(last);
    encoder_.finish();
  }

 private:
  VideoFrame frame_;
  VideoEncoder encoder_;
  std::uint64_t ticks_per_frame_;
  std::optional<std::uint64_t> last_tick_;
};

SessionVideo::SessionVideo(const session::SessionSetup& setup,
                           const std::filesystem::path& folder) {
  try {
    studio_ = std::make_unique<Studio>(setup, folder);
  } catch (const std::exception& error) {
    error_ = error.what();
  }
}

SessionVideo::~SessionVideo() = default;

void SessionVideo::observe(const session::TickRecord& record) {
  if (!studio_) return;
  try {
    studio_->observe(record);
  } catch (const std::exception& error) {
    error_ = error.what();
    studio_.reset();
  }
}

void SessionVideo::finish(const record::SessionResult& result) {
  if (!studio_) return;
  try {
    studio_->finish(result);
  } catch (const std::exception& error) {
    error_ = error.what();
  }
  studio_.reset();
}

}  // namespace cdiff::video
