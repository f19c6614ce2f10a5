// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/bags/bag_queue.h"
#include "node_graph/messages/traffic_conversions.h"
#include "record/sample_session.h"
#include "rosbag/view.h"
#include "support/small_files.h"
#include "support/temporary_folder.h"

namespace cdiff::node_graph {
namespace {

namespace fs = std::filesystem;

std::string bagTopic(const std::string& topic) { return "/" + topic; }

TickMessages tickOf(std::uint64_t tick, std::size_t vehicles, std::uint32_t sequence_number) {
  traffic::TrafficSnapshot snapshot = test::sampleSnapshot(tick);
  snapshot.tick = tick;
  snapshot.vehicles.resize(vehicles);
  msgs::TrafficSnapshot message = toMsg(snapshot);
  message.header.seq = sequence_number;
  TickMessages messages;
  messages.add(ChannelId::kTraffic, shared(message));
  return messages;
}

/// 300 ticks, more than find room at once; `number` is the sequence number of their messages.
std::string bagOf(const fs::path& file, std::uint32_t number, bool by_queue) {
  constexpr std::uint64_t kTicks = 300;
  BagFile bag(file, test::sampleOptions(), bagTopic);
  {
    BagQueue queue(bag);
    for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
      if (by_queue)
        queue.write(tickOf(tick, 50, number));
      else
        bag.write(tickOf(tick, 50, number));
    }
    queue.finish();
    EXPECT_EQ(queue.load().written, by_queue ? kTicks : 0U);
    EXPECT_LE(queue.load().most_waiting, BagQueue::kRoom);
  }
  bag.finish();
  return core::readFile(file, "bag");
}

TEST(BagQueue, GivesTheBytesOfABagThatIsWrittenAtOnce) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(bagOf(folder.path() / "a.bag", 0, true), bagOf(folder.path() / "b.bag", 0, false));
}

TEST(BagQueue, KeepsNoNumberOfAConnection) {
  const test::TemporaryFolder folder;
  EXPECT_EQ(bagOf(folder.path() / "a.bag", 7, true), bagOf(folder.path() / "b.bag", 0, true));
}

// A file may have 1 MiB; 100 ticks of 2000 vehicles have more.
TEST(BagQueue, AFullDiskIsNamedToWhoHandsTicksOver) {
  const test::TemporaryFolder folder;
  std::string text;
  {
    const test::SmallFiles small;
    BagFile bag(folder.path() / "a.bag", test::sampleOptions(), bagTopic,
                BagFile::Content::kSessionOnly);  // not compressed
    BagQueue queue(bag);
    try {
      for (std::uint64_t tick = 0; tick < 100; ++tick) queue.write(tickOf(tick, 2000, 0));
      queue.finish();
    } catch (const core::InputError& error) {
      text = error.what();
    }
  }
  EXPECT_NE(text.find("cannot write the bag '" + (folder.path() / "a.bag").string()),
            std::string::npos)
      << text;
  EXPECT_FALSE(fs::exists(folder.path() / "a.bag.active"));
}

/// What the first record of a bag says of its chunks.
std::uint32_t chunksOf(const fs::path& file) {
  constexpr std::size_t kRecord = 4096;  // [bytes]
  std::string begin(kRecord, '\0');
  std::ifstream(file).read(begin.data(), kRecord);
  const std::string field = "chunk_count=";
  std::uint32_t count = 0;
  std::memcpy(&count, begin.data() + begin.find(field) + field.size(), sizeof(count));
  return count;
}

// Chunks have 768 KiB at first, and 3 MiB where the bag has more than 64 MiB; a tick adds to each.
TEST(BagFile, ALongBagHasFewerChunks) {
  constexpr std::uint64_t kMegabyte = std::uint64_t{1} << 20;
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.bag";
  BagFile bag(file, test::sampleOptions(), bagTopic, BagFile::Content::kSessionOnly);
  const TickMessages tick = tickOf(0, 500, 0);
  const auto size = [&] { return fs::file_size(file.string() + ".active"); };
  while (size() < 112 * kMegabyte) bag.write(tick);
  bag.finish();
  EXPECT_GT(chunksOf(file), 60U);
  EXPECT_LE(chunksOf(file), 64 * 4 / 3 + 48 / 3 + 4U);
}

}  // namespace
}  // namespace cdiff::node_graph
