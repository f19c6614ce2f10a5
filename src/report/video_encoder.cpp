// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/report/video_encoder.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::report {
namespace {

namespace fs = std::filesystem;

constexpr const char* kProgram = "ffmpeg";
constexpr timeval kLongestPause{30, 0};  // of the program between two bites
constexpr std::chrono::seconds kLongestEnd{60};

std::vector<std::string> commandLine(const VideoFormat& format, const fs::path& file) {
  const std::string size = std::to_string(format.width) + "x" + std::to_string(format.height);
  return {kProgram, "-hide_banner", "-nostdin", "-loglevel", "error", "-y",
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

/// What the child gets: our socket as its input, nothing of ours besides.
class SpawnSetup {
 public:
  SpawnSetup(int input, int messages) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, input, STDIN_FILENO);
    posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_adddup2(&actions_, messages, STDERR_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&actions_, 3);
    posix_spawnattr_init(&attributes_);
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_setsigmask(&attributes_, &none);
    // A group of its own: Ctrl-C ends the session, and the session the video.
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  }
  ~SpawnSetup() {
    posix_spawn_file_actions_destroy(&actions_);
    posix_spawnattr_destroy(&attributes_);
  }
  SpawnSetup(const SpawnSetup&) = delete;
  SpawnSetup& operator=(const SpawnSetup&) = delete;
  int spawn(pid_t& process, char* const* argv) {
    return posix_spawnp(&process, kProgram, &actions_, &attributes_, argv, environ);
  }

 private:
  posix_spawn_file_actions_t actions_{};
  posix_spawnattr_t attributes_{};
};

/// The end of what was written to a descriptor, in one line.
std::string lastWords(int descriptor) {
  constexpr off_t kMost = 600;
  const off_t size = ::lseek(descriptor, 0, SEEK_END);
  if (size <= 0) return {};
  std::string text(static_cast<std::size_t>(std::min(size, kMost)), '\0');
  const ssize_t read =
      ::pread(descriptor, text.data(), text.size(), size - static_cast<off_t>(text.size()));
  text.resize(read > 0 ? static_cast<std::size_t>(read) : 0);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  for (char& letter : text) {
    if (letter == '\n') letter = ' ';
  }
  return text;
}

}  // namespace

VideoEncoder::VideoEncoder(fs::path file, const VideoFormat& format)
    : file_(std::move(file)),
      temporary_(file_.string() + ".tmp." + std::to_string(::getpid())),
      messages_(::memfd_create("ffmpeg messages", MFD_CLOEXEC)) {
  std::error_code ignored;
  fs::remove(file_, ignored);
  try {
    start(format);
  } catch (...) {
    stop();
    throw;
  }
}

VideoEncoder::~VideoEncoder() { stop(); }

void VideoEncoder::start(const VideoFormat& format) {
  int ends[2] = {-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
    throw core::SimulatorError("video '" + file_.string() + "': " + std::strerror(errno));
  }
  input_ = ends[0];
  ::setsockopt(input_, SOL_SOCKET, SO_SNDTIMEO, &kLongestPause, sizeof(kLongestPause));
  std::vector<std::string> words = commandLine(format, temporary_);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const int error = SpawnSetup(ends[1], messages_).spawn(process_, argv.data());
  ::close(ends[1]);
  if (error == 0) return;
  process_ = 0;
  if (error == ENOENT) {
    throw core::InputError(
        "a video needs the program 'ffmpeg', which is not in PATH; install the Debian package "
        "ffmpeg, or ask for no video");
  }
  throw core::SimulatorError("cannot start ffmpeg: " + std::string(std::strerror(error)));
}

void VideoEncoder::write(const std::vector<std::uint8_t>& frame) {
  std::size_t sent = 0;
  while (sent < frame.size()) {
    const ssize_t count = ::send(input_, frame.data() + sent, frame.size() - sent, MSG_NOSIGNAL);
    if (count > 0) {
      sent += static_cast<std::size_t>(count);
    } else if (errno != EINTR) {
      fail(errno == EAGAIN ? "it took nothing for 30 s" : "it ended before the session");
    }
  }
}

void VideoEncoder::finish() {
  closeInput();
  const int code = wait();
  std::error_code error;
  if (code != 0) fail("exit code " + std::to_string(code));
  // It exits with 0 when the disk filled up at the very end.
  if (!lastWords(messages_).empty()) fail("it complained");
  const int descriptor = ::open(temporary_.c_str(), O_RDONLY | O_CLOEXEC);
  const bool on_disk = descriptor >= 0 && ::fsync(descriptor) == 0;
  if (descriptor >= 0) ::close(descriptor);
  if (!on_disk) fail(std::strerror(errno));
  fs::rename(temporary_, file_, error);
  if (error) fail(error.message());
}

void VideoEncoder::closeInput() {
  if (input_ >= 0) ::close(input_);
  input_ = -1;
}

int VideoEncoder::wait() {
  const auto end = std::chrono::steady_clock::now() + kLongestEnd;
  int status = 0;
  while (::waitpid(process_, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) ::kill(process_, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  process_ = 0;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void VideoEncoder::stop() {
  closeInput();
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = 0;
  }
  if (messages_ >= 0) ::close(messages_);
  messages_ = -1;
  std::error_code ignored;
  fs::remove(temporary_, ignored);
}

void VideoEncoder::fail(const std::string& text) {
  closeInput();
  if (process_ > 0) wait();
  const std::string words = messages_ >= 0 ? lastWords(messages_) : std::string();
  stop();
  throw core::SimulatorError("video '" + file_.string() + "' was not written: ffmpeg: " + text +
                             (words.empty() ? "" : ": " + words));
}

}  // namespace cdiff::report
