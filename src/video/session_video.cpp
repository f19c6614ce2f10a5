// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "video/session_video.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <optional>

#include "e2e_cdiff/core/exceptions.h"
#include "video/video_frame.h"

namespace cdiff::video {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "ffmpeg";
constexpr double kLongestEnd = 60.0;  // [s]

std::vector<std::string> commandLine(const VideoFormat& format, const fs::path& file) {
  const std::string size = std::to_string(format.width) + "x" + std::to_string(format.height);
  return {"-hide_banner", "-nostdin", "-loglevel", "error", "-y",
          // What comes in.
          "-f", "rawvideo", "-pixel_format", "bgr24", "-video_size", size, "-framerate",
          std::to_string(format.rate), "-i", "pipe:0",
          // What goes out; one thread and no dates, so that equal frames give equal files.
          "-an", "-vf", "scale=out_color_matrix=bt709:out_range=tv", "-c:v", "libx264", "-preset",
          "veryfast", "-crf", "22", "-pix_fmt", "yuv420p", "-colorspace", "bt709",
          "-color_primaries", "bt709", "-color_trc", "bt709", "-color_range", "tv", "-threads", "1",
          "-fflags", "+bitexact", "-flags:v", "+bitexact", "-movflags", "+faststart", "-f", "mp4",
          file.string()};
}

fs::path findEncoder() {
  try {
    return core::findProgram(kProgram, kProgram);
  } catch (const core::InputError&) {
    throw core::InputError(
        "a video needs the program 'ffmpeg', which is not in PATH; install the Debian package "
        "ffmpeg, or ask for no video");
  }
}

/// The end of what was printed, in one line.
std::string lastWords(const core::ProcessOutput& output) {
  std::string text = output.end(600);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace

VideoEncoder::VideoEncoder(const fs::path& file, const VideoFormat& format, int longest_pause)
    : folder_(fs::absolute(file).parent_path()),
      name_(file.filename().string()),
      file_(file),
      longest_pause_(longest_pause) {
  try {
    core::OutputFolder::requireFree(folder_.path(), {name_});
    folder_.remove({name_});
    folder_.remove({partName()});
    start(format);
  } catch (...) {
    stop();
    throw;
  }
}

VideoEncoder::~VideoEncoder() { stop(); }

void VideoEncoder::start(const VideoFormat& format) {
  const fs::path program = findEncoder();
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw core::SimulatorError("video '" + file_.string() + "': " + std::strerror(errno));
  }
  input_ = core::FileDescriptor(ends[0]);
  const core::FileDescriptor output(ends[1]);
  const timeval pause{longest_pause_, 0};
  ::setsockopt(input_.get(), SOL_SOCKET, SO_SNDTIMEO, &pause, sizeof(pause));
  process_ = std::make_unique<core::GuardedProcess>(
      program, commandLine(format, folder_.claim(partName())),
      core::environmentWith("AV_LOG_FORCE_NOCOLOR", "1"),
      core::ProcessStreams{{}, output.get(), messages_.descriptor()});
}

void VideoEncoder::write(const std::vector<std::uint8_t>& frame) {
  std::size_t sent = 0;
  while (sent < frame.size()) {
    const ssize_t count =
        ::send(input_.get(), frame.data() + sent, frame.size() - sent, MSG_NOSIGNAL);
    if (count > 0) {
      sent += static_cast<std::size_t>(count);
    } else if (errno == EAGAIN) {
      process_->kill();
      fail("it took nothing for " + std::to_string(longest_pause_) + " s");
    } else if (errno != EINTR) {
      fail("it ended before the session");
    }
  }
}

void VideoEncoder::finish() {
  input_.close();
  const int code = wait();
  if (code != 0) fail("exit code " + std::to_string(code));
  // It exits with 0 when the disk filled up at the very end.
  if (!lastWords(messages_).empty()) fail("it complained");
  const fs::path part = folder_.path() / partName();
  const core::FileDescriptor written(::open(part.c_str(), O_RDONLY | O_CLOEXEC));
  if (!written || ::fsync(written.get()) != 0) fail(std::strerror(errno));
  std::error_code error;
  fs::rename(part, folder_.claim(name_), error);
  if (error) fail(error.message());
  folder_.remove({partName()});
}

int VideoEncoder::wait() {
  if (!process_->waitForEnd(kLongestEnd)) process_->kill();
  return process_->exitCode();
}

void VideoEncoder::stop() {
  input_.close();
  process_.reset();
  try {
    folder_.remove({partName()});
  } catch (const core::InputError&) {
    // It stays on the record, and goes with the next video.
  }
}

void VideoEncoder::fail(const std::string& text) {
  input_.close();
  if (process_) wait();
  const std::string words = lastWords(messages_);
  stop();
  throw core::SimulatorError("video '" + file_.string() + "' was not written: ffmpeg: " + text +
                             (words.empty() ? "" : ": " + words));
}

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
