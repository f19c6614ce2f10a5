// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <boost/make_shared.hpp>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "e2e_cdiff/core/exceptions.h"
#include "ros/serialization.h"

namespace cdiff::ros {

/// A connection record of a bag: topic and message type.
struct BagConnection {
  std::string topic;
  std::string type;    ///< "e2e_cdiff/TrafficSnapshot"
  std::string md5sum;  ///< MD5 of the type's definition
};

/// One message as the bag holds it; valid until the reader goes on.
struct BagMessage {
  const BagConnection* connection = nullptr;
  std::string_view bytes;
};

/// The messages of a bag (ROS bag format 2.0) in the order of the file, read chunk by chunk without
/// the bag's index. A bag whose recording was cut off, or of which bytes are lost, gives what is
/// whole and names the rest. rosbag's C++ library refuses such bags, and its reindexing exists in
/// Python only.
class BagReader {
 public:
  /// Throws InputError naming the file when it cannot be read, is empty, is no bag of format 2.0 or
  /// is encrypted.
  explicit BagReader(const std::filesystem::path& file);
  ~BagReader();
  BagReader(const BagReader&) = delete;
  BagReader& operator=(const BagReader&) = delete;

  /// The next message; false after the last.
  bool next(BagMessage& message);
  /// Back to the first message. Damage that was found is not named again.
  void rewind();
  /// What is known of the bag's topics: all of them in a whole bag.
  std::vector<BagConnection> connections() const;
  /// What of the file cannot be read, one sentence each in the order found; complete after the last
  /// message.
  const std::vector<std::string>& damage() const { return damage_; }

 private:
  class Bytes;
  struct Chunk;
  void scan();
  bool takeRecord(std::uint64_t& offset);
  bool takeChunk(std::uint64_t& offset);
  void skipDamage(std::uint64_t& offset);
  void checkEnd(std::uint64_t scanned);
  void addConnection(std::uint32_t id, std::string_view topic, std::string_view header);
  bool openChunk();
  void leaveChunk();
  void noteUnknown(std::uint32_t id);
  void note(const std::string& text);

  std::filesystem::path file_;
  std::unique_ptr<Bytes> bytes_;
  std::vector<Chunk> chunks_;
  std::map<std::uint32_t, BagConnection> connections_;
  std::set<std::uint32_t> unknown_;  ///< connections without a topic
  std::vector<std::string> damage_;
  bool has_index_ = false;
  std::uint64_t index_position_ = 0;
  std::uint64_t chunks_promised_ = 0;
  std::size_t next_chunk_ = 0;
  std::string text_;          ///< records of the present chunk
  std::uint64_t cursor_ = 0;  ///< in it
};

/// A message of a known type. Throws InputError when the bytes are none.
template <class Message>
boost::shared_ptr<const Message> decode(const BagMessage& message) {
  auto decoded = boost::make_shared<Message>();
  const auto refuse = [&](const std::string& why) {
    return core::InputError("a message on '" + message.connection->topic +
                            "' cannot be read: " + why);
  };
  try {
    // The stream does not write.
    auto* begin = reinterpret_cast<std::uint8_t*>(const_cast<char*>(message.bytes.data()));
    ::ros::serialization::IStream stream(begin, static_cast<std::uint32_t>(message.bytes.size()));
    ::ros::serialization::deserialize(stream, *decoded);
    if (stream.getLength() != 0) throw refuse("it is longer than its type");
  } catch (const core::InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw refuse(error.what());
  }
  return decoded;
}

}  // namespace cdiff::ros
