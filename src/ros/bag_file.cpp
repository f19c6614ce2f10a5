// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/bag_file.h"

#include <algorithm>
#include <cerrno>

#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"
#include "ros/conversions.h"

namespace cdiff::ros {
namespace {

namespace fs = std::filesystem;

/// A bag takes no stamp of zero.
::ros::Time bagStamp(const ::ros::Time& stamp) { return std::max(stamp, ::ros::TIME_MIN); }

}  // namespace

BagFile::BagFile(const fs::path& file, const session::ScenarioOptions& options, Naming naming)
    : file_(file),
      max_cbv_(static_cast<int>(options.max_cbv)),
      reading_{options.camera, options.simulation_step},
      naming_(std::move(naming)),
      bag_(std::make_unique<rosbag::Bag>()) {
  guard([&] {
    if (file_.has_parent_path()) fs::create_directories(file_.parent_path());
    bag_->open(file_.string() + ".active", rosbag::bagmode::Write);
    bag_->setCompression(rosbag::compression::LZ4);
  });
}

BagFile::~BagFile() {
  try {
    bag_->close();
  } catch (const std::exception&) {
    // On a full disk. Its destructor would try once more and end the program, so it gets none.
    static_cast<void>(bag_.release());
  }
  std::error_code ignored;
  if (failed_) fs::remove(file_.string() + ".active", ignored);
}

void BagFile::discard() { failed_ = true; }

/// Errors of the bag name its file.
void BagFile::guard(const std::function<void()>& writing) {
  errno = 0;
  try {
    writing();
  } catch (const std::exception& error) {
    const std::string reason = errno == 0 ? "" : " (" + core::writeErrorText(errno) + ")";
    failed_ = true;
    throw core::InputError("cannot write the bag '" + file_.string() + "': " + error.what() +
                           reason + "; check that the folder exists, is writable and has room");
  }
}

void BagFile::put(const Topic& topic, const ::ros::Time& stamp, const AnyMessage& message) {
  const std::string name = topic.name();
  topic.row().type.write(*bag_, name.front() == '/' ? name : naming_(name), stamp, message);
}

void BagFile::write(const msgs::SessionInfo& info) {
  guard([&] { put(ChannelId::kSession, ::ros::TIME_MIN, shared(info)); });
}

void BagFile::write(const nav_msgs::Path& ego_route) {
  guard([&] { put(ChannelId::kEgoRoute, ::ros::TIME_MIN, shared(ego_route)); });
}

void BagFile::write(const TickMessages& tick) {
  guard([&] { writeTick(tick); });
}

void BagFile::writeTick(const TickMessages& tick) {
  const auto snapshot = tick.get<msgs::TrafficSnapshot>(ChannelId::kTraffic);
  const ::ros::Time stamp = bagStamp(snapshot->header.stamp);
  for (const Channel& row : channels()) {
    if (row.recorded != Recorded::kTick && row.recorded != Recorded::kDecision) continue;
    for (const Topic& topic : topicsOf(row, max_cbv_)) {
      AnyMessage message = tick.find(topic);
      if (!message && row.derive != nullptr && snapshot->decision_tick)
        message = row.derive(tick, reading_, topic.slot);
      if (message) put(topic, stamp, message);
    }
  }
}

void BagFile::finish() {
  guard([&] {
    bag_->close();
    fs::rename(file_.string() + ".active", file_);
  });
}

}  // namespace cdiff::ros
