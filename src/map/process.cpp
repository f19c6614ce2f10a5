// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/map/process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::map {
namespace {

[[noreturn]] void failStarting(const std::string& program, int error) {
  throw core::InputError("cannot start '" + program + "': " + std::strerror(error) +
                         (error == ENOENT ? "; install Debian's package sumo" : ""));
}

std::vector<std::string> childEnvironment() {
  std::vector<std::string> environment;
  for (char** entry = environ; *entry != nullptr; ++entry) environment.emplace_back(*entry);
  if (std::getenv("SUMO_HOME") == nullptr) environment.emplace_back("SUMO_HOME=/usr/share/sumo");
  return environment;
}

std::vector<char*> pointersTo(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (std::string& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

/// Starts the program with both outputs on `output`.
pid_t start(std::vector<std::string> arguments, int output) {
  std::vector<std::string> environment = childEnvironment();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, output, STDERR_FILENO);
  pid_t child = -1;
  const int error = posix_spawnp(&child, arguments.front().c_str(), &actions, nullptr,
                                 pointersTo(arguments).data(), pointersTo(environment).data());
  posix_spawn_file_actions_destroy(&actions);
  if (error == 0) return child;
  ::close(output);
  failStarting(arguments.front(), error);
}

std::string readAll(int descriptor) {
  std::string text;
  std::array<char, 4096> buffer{};
  while (true) {
    const ssize_t count = ::read(descriptor, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return text;
    text.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

ProcessResult runProcess(const std::vector<std::string>& arguments) {
  std::array<int, 2> pipe_ends{};
  if (::pipe2(pipe_ends.data(), O_CLOEXEC) != 0) failStarting(arguments.front(), errno);
  pid_t child = -1;
  try {
    child = start(arguments, pipe_ends[1]);
  } catch (const core::InputError&) {
    ::close(pipe_ends[0]);
    throw;
  }
  ::close(pipe_ends[1]);
  ProcessResult result;
  result.output = readAll(pipe_ends[0]);
  ::close(pipe_ends[0]);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace cdiff::map
