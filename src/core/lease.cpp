// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "core/lease.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <utility>

#include "core/folder_access.h"
#include "core/holder.h"
#include "core/host.h"
#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::core {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBeatDigits = 12;

/// The beat stands last, with a fixed number of digits, so that it is changed in place.
std::string beatText(std::size_t number) {
  const std::string digits = std::to_string(number);
  return std::string(kBeatDigits - std::min(kBeatDigits, digits.size()), '0') + digits + "\n";
}

/// Invalid where the file has gone, or cannot be opened just now. Another user's may be for reading
/// alone. Throws UnreadableLease.
FileDescriptor openLease(const fs::path& file) {
  constexpr int kFlags = O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  FileDescriptor descriptor(::open(file.c_str(), kFlags | O_RDWR));
  if (!descriptor && (errno == EACCES || errno == EROFS))
    descriptor = FileDescriptor(::open(file.c_str(), kFlags | O_RDONLY));
  const int reason = errno;
  struct stat status {};
  const bool regular =
      descriptor && ::fstat(descriptor.get(), &status) == 0 && S_ISREG(status.st_mode);
  const bool lasts = reason == EACCES || reason == EPERM || reason == ELOOP || reason == EISDIR;
  if (regular || (!descriptor && !lasts)) return descriptor;
  throw UnreadableLease("'" + file.string() + "' is no lease that can be read (" +
                        (descriptor ? std::string("no regular file") : writeErrorText(reason)) +
                        "); remove it where nobody works on its run");
}

/// Whether a process of this host has signed the lease; one that is gone counts as such.
bool isOfThisHost(const std::map<std::string, std::string>& facts) {
  const auto boot = facts.find("boot");
  return boot != facts.end() && boot->second == bootId();
}

}  // namespace

Lease::~Lease() {
  // Whoever took the work over may have a file of that name, too.
  if (isHeld()) ::unlink(file_.c_str());
}

bool Lease::isHeld() const {
  struct stat own {};
  struct stat named {};
  return ::fstat(descriptor_.get(), &own) == 0 && ::lstat(file_.c_str(), &named) == 0 &&
         isSame(own, named);
}

void Lease::beat(std::size_t number) const {
  struct stat status {};
  if (::fstat(descriptor_.get(), &status) != 0) return;
  const std::string text = beatText(number);
  const off_t place = status.st_size - static_cast<off_t>(text.size());
  // Where the folder is gone, isHeld() says so.
  if (::pwrite(descriptor_.get(), text.data(), text.size(), place) < 0) return;
  ::fsync(descriptor_.get());
}

LeaseFolder::LeaseFolder(fs::path folder, const LeaseTerms& terms)
    : folder_(std::move(folder)), terms_(terms) {}

LeaseFolder::~LeaseFolder() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ending_ = true;
  }
  changed_.notify_all();
  if (beating_.joinable()) beating_.join();
}

std::map<std::string, LeaseFolder::Generations> LeaseFolder::list() const {
  std::map<std::string, Generations> found;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder_, none)) {
    const std::string name = entry.path().filename().string();
    const std::size_t dot = name.rfind('.');
    const std::string digits = dot == std::string::npos ? "" : name.substr(dot + 1);
    if (name.front() == '.' || digits.empty() || digits.size() > 9 ||
        digits.find_first_not_of("0123456789") != std::string::npos)
      continue;
    found[name.substr(0, dot)][std::stoul(digits)] = entry.path();
  }
  return found;
}

bool LeaseFolder::isLeftBehind(const fs::path& file) {
  const FileDescriptor descriptor = openLease(file);
  if (!descriptor) return false;  // released just now
  const auto facts = holderFacts(descriptor.get());
  if (isOfThisHost(facts)) {
    if (::flock(descriptor.get(), LOCK_EX | LOCK_NB) == 0) return true;
    if (errno == EWOULDBLOCK) return false;
    // A shared disk may lock no file for reading alone: then it is judged as another host's.
  }
  const auto now = std::chrono::steady_clock::now();
  const auto [place, added] = seen_.try_emplace(file.filename().string(), Seen{facts, now, false});
  Seen& seen = place->second;
  if (seen.facts != facts) seen = {facts, now, true};
  return std::chrono::duration<double>(now - seen.since).count() > terms_.expiry;
}

/// Gives a file that is signed and locked already its name; 0, or the reason why it has not got it.
int LeaseFolder::placeOnce(const fs::path& file, FileDescriptor& descriptor) const {
  makeFolder(folder_);
  Draft draft = makeDraft(
      folder_, holderSignature(terms_.program) + "boot: " + bootId() + "\nbeat: " + beatText(0));
  if (!draft.descriptor) return errno;
  descriptor = std::move(draft.descriptor);
  const int reason = placeUnlessThere(draft.path, file);
  ::unlink(draft.path.c_str());
  return reason;
}

/// None where the name is taken. Another process may remove draft and folder meanwhile.
FileDescriptor LeaseFolder::place(const fs::path& file) const {
  constexpr int kTries = 10;
  FileDescriptor descriptor;
  int reason = ENOENT;
  for (int i = 0; i < kTries && reason == ENOENT; ++i) reason = placeOnce(file, descriptor);
  if (reason != 0 && reason != EEXIST) failOn(file, "write", reason);
  return reason == 0 ? std::move(descriptor) : FileDescriptor();
}

std::shared_ptr<const Lease> LeaseFolder::claim(const std::string& name) {
  const Generations before = list()[name];
  for (const auto& [generation, file] : before) {
    if (!isLeftBehind(file)) return nullptr;
  }
  const std::size_t next = before.empty() ? 1 : before.rbegin()->first + 1;
  const fs::path file = folder_ / (name + "." + std::to_string(next));
  const bool foreign = std::any_of(before.begin(), before.end(), [this](const auto& left) {
    return seen_.count(left.second.filename().string()) != 0;
  });
  FileDescriptor descriptor = place(file);
  if (!descriptor) return nullptr;
  // NOLINTNEXTLINE(modernize-make-shared): the constructor is private
  const std::shared_ptr<const Lease> lease(new Lease(file, std::move(descriptor), foreign));
  const Generations after = list()[name];
  for (const auto& [generation, other] : after) {
    const bool known = generation == next || before.count(generation) != 0;
    if (!known) return nullptr;  // somebody claimed it from another list: nobody gets it now
  }
  for (const auto& [generation, left] : before) ::unlink(left.c_str());
  const std::lock_guard<std::mutex> lock(mutex_);
  held_.push_back(lease);
  if (!beating_.joinable()) beating_ = std::thread([this] { keepBeating(); });
  return lease;
}

/// Of a file that isLeftBehind() has looked at.
bool LeaseFolder::isAlive(const fs::path& file) const {
  const auto seen = seen_.find(file.filename().string());
  return seen == seen_.end() || seen->second.changed;
}

std::map<std::string, LeaseHolder> LeaseFolder::holders() {
  std::map<std::string, LeaseHolder> found;
  for (const auto& [name, generations] : list()) {
    const fs::path& file = generations.rbegin()->second;
    const FileDescriptor descriptor = openLease(file);
    if (descriptor && !isLeftBehind(file))
      found[name] = {holderText(holderFacts(descriptor.get())), isAlive(file)};
  }
  return found;
}

void LeaseFolder::removeLeftBehind() {
  for (const auto& [name, generations] : list()) {
    for (const auto& [generation, file] : generations) {
      try {
        if (isLeftBehind(file)) ::unlink(file.c_str());
      } catch (const UnreadableLease&) {
        // whoever asks for holders, or claims the run, hears of it
      }
    }
  }
  removeLeftDrafts(folder_);
  ::rmdir(folder_.c_str());  // refused where a lease is in it
}

void LeaseFolder::keepBeating() {
  std::unique_lock<std::mutex> lock(mutex_);
  const auto period = std::chrono::duration<double>(terms_.beat);
  for (std::size_t number = 1; !changed_.wait_for(lock, period, [this] { return ending_; });
       ++number)
    beatAll(number);
}

void LeaseFolder::beatAll(std::size_t number) {
  std::vector<std::weak_ptr<const Lease>> held;
  for (const auto& entry : held_) {
    const auto lease = entry.lock();
    if (!lease) continue;
    lease->beat(number);
    held.push_back(entry);
  }
  held_ = std::move(held);
}

}  // namespace cdiff::core
