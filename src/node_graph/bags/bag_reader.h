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

namespace cdiff::node_graph {

/// A connection record of a bag: topic and message type.
struct BagConnection {
  std::string topic;
  std::string type;    ///< "e2e_cdiff/TrafficSnapshot"
  std::string md5sum;  ///< MD5 of the type's definition
};

/// One message as the bag holds it, not yet decoded; valid until the next call of BagReader::next.
struct BagMessage {
  const BagConnection* connection = nullptr;
  std::string_view bytes;  ///< serialized content
};

/// Reads the messages of a bag (ROS bag format 2.0) in the order of the file, chunk by chunk,
/// without the bag's index: used by RecordedSession and for drives recorded elsewhere. From a bag
/// that was cut off or damaged it reads the intact messages and reports what is lost (damage()),
/// whereas rosbag's C++ library refuses such bags and only its Python tools can reindex them.
class BagReader {
 public:
  /// Throws InputError naming the file when it cannot be read, is empty, is not a bag of format 2.0
  /// or is encrypted.
  explicit BagReader(const std::filesystem::path& file);
  ~BagReader();
  BagReader(const BagReader&) = delete;
  BagReader& operator=(const BagReader&) = delete;

  /// The next message; false after the last.
  bool next(BagMessage& message);
  /// Goes back to the first message. Damage already found is not listed twice.
  void rewind();
  /// Connections found so far: all of the bag's where it is intact.
  std::vector<BagConnection> connections() const;
  /// What cannot be read, one sentence each in the order found; complete once next() returns false.
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
  std::set<std::uint32_t> unknown_;  ///< ids of connections whose record is lost
  std::vector<std::string> damage_;
  bool has_index_ = false;
  std::uint64_t index_position_ = 0;
  std::uint64_t chunks_promised_ = 0;
  std::size_t next_chunk_ = 0;
  std::string text_;          ///< decompressed records of the current chunk
  std::uint64_t cursor_ = 0;  ///< offset in text_ of the next record
};

/// Decodes a message into its type. Throws InputError naming the topic when the bytes do not match.
template <class Message>
boost::shared_ptr<const Message> decode(const BagMessage& message) {
  auto decoded = boost::make_shared<Message>();
  const auto refuse = [&](const std::string& why) {
    return core::InputError("a message on '" + message.connection->topic +
                            "' cannot be read: " + why);
  };
  try {
    // IStream takes a non-const pointer, but only reads.
    auto* begin = reinterpret_cast<std::uint8_t*>(const_cast<char*>(message.bytes.data()));
    ros::serialization::IStream stream(begin, static_cast<std::uint32_t>(message.bytes.size()));
    ros::serialization::deserialize(stream, *decoded);
    if (stream.getLength() != 0) throw refuse("it is longer than its type");
  } catch (const core::InputError&) {
    throw;
  } catch (const std::exception& error) {
    throw refuse(error.what());
  }
  return decoded;
}

}  // namespace cdiff::node_graph
