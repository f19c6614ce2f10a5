// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/file_descriptor.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {

// Work that processes of several hosts share: each piece has a name, and a file of that name in a
// common folder says who does it.

/// Whom a lease names, and when others count it as left behind [s of their own steady clock].
struct LeaseTerms {
  std::string program;  ///< names the holder to people ("cdiff worker")
  double beat = 10.0;   ///< period in which the holder changes its file
  /// For how long a file of another host must stay the same to be left behind. A file of this host
  /// is left behind as soon as its process has ended.
  double expiry = 120.0;
};

/// A lease of which nobody can say whether its holder lives: no file, or one of another user that
/// we may not read.
class UnreadableLease : public InputError {
 public:
  using InputError::InputError;
};

/// The right to do one piece of work, as long as the object exists.
class Lease {
 public:
  ~Lease();
  Lease(const Lease&) = delete;
  Lease& operator=(const Lease&) = delete;

  /// Whether no other process has taken the work over, as one may that saw no beat for too long.
  bool isHeld() const;
  /// Whether it was taken over from a process of another host, which may only have stood still.
  bool isFromAnotherHost() const { return from_another_host_; }

 private:
  friend class LeaseFolder;
  Lease(std::filesystem::path file, FileDescriptor descriptor, bool from_another_host)
      : file_(std::move(file)),
        descriptor_(std::move(descriptor)),
        from_another_host_(from_another_host) {}
  void beat(std::size_t number) const;

  std::filesystem::path file_;
  FileDescriptor descriptor_;  ///< locked
  bool from_another_host_;
};

/// Who holds a lease that is not left behind.
struct LeaseHolder {
  std::string text;       ///< "'cdiff worker', process 12 on host h, since 2026-01-31 14:05:09"
  bool is_alive = false;  ///< of this host, or its file has changed since it was first seen
};

/// The folder of leases NAME.GENERATION, as one process sees it. No clock of another host counts:
/// each host watches by its own clock whether a file changes. A lease that was left behind is taken
/// over by a file of the next generation, which only one process can place. Not for several
/// threads.
class LeaseFolder {
 public:
  /// Reads and makes nothing.
  LeaseFolder(std::filesystem::path folder, const LeaseTerms& terms);
  ~LeaseFolder();
  LeaseFolder(const LeaseFolder&) = delete;
  LeaseFolder& operator=(const LeaseFolder&) = delete;

  /// The lease of a name; null where another process has it. Makes the folder where it is missing.
  /// Throws InputError naming the file that cannot be written.
  std::shared_ptr<const Lease> claim(const std::string& name);
  /// Who holds leases that are not left behind, by name of the work.
  std::map<std::string, LeaseHolder> holders();
  /// Removes what was left behind, and the folder where it is empty then.
  void removeLeftBehind();

 private:
  struct Seen {
    std::map<std::string, std::string> facts;
    std::chrono::steady_clock::time_point since;
    bool changed = false;  ///< since it was first seen
  };
  using Generations = std::map<std::size_t, std::filesystem::path>;

  std::map<std::string, Generations> list() const;
  bool isLeftBehind(const std::filesystem::path& file);
  bool isAlive(const std::filesystem::path& file) const;
  int placeOnce(const std::filesystem::path& file, FileDescriptor& descriptor) const;
  FileDescriptor place(const std::filesystem::path& file) const;
  void keepBeating();
  void beatAll(std::size_t number);

  std::filesystem::path folder_;
  LeaseTerms terms_;
  std::map<std::string, Seen> seen_;  ///< files of others, by name
  std::mutex mutex_;                  ///< guards the members below
  std::condition_variable changed_;
  std::vector<std::weak_ptr<const Lease>> held_;
  bool ending_ = false;
  std::thread beating_;
};

}  // namespace cdiff::core
