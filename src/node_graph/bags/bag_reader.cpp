// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/bags/bag_reader.h"

#include <algorithm>
#include <boost/interprocess/file_mapping.hpp>
#include <boost/interprocess/mapped_region.hpp>

#include "core/file.h"
#include "node_graph/bags/bag_records.h"

namespace cdiff::node_graph {
namespace {

namespace fs = std::filesystem;
using core::InputError;

std::string rangeText(std::uint64_t begin, std::uint64_t end) {
  return "bytes " + std::to_string(begin) + " to " + std::to_string(end);
}

}  // namespace

/// The file in memory, read by the system page by page.
class BagReader::Bytes {
 public:
  explicit Bytes(const fs::path& file)
      : mapping_(file.c_str(), boost::interprocess::read_only),
        region_(mapping_, boost::interprocess::read_only) {}
  std::string_view text() const {
    return {static_cast<const char*>(region_.get_address()), region_.get_size()};
  }

 private:
  boost::interprocess::file_mapping mapping_;
  boost::interprocess::mapped_region region_;
};

struct BagReader::Chunk {
  std::string_view compression;
  std::string_view data;
  std::uint64_t size = 0;   ///< decompressed; 0 when the recording was cut off in it
  std::uint64_t begin = 0;  ///< of the data in the file
  bool named = false;       ///< its damage has been reported
};

BagReader::BagReader(const fs::path& file) : file_(file) {
  const std::string name = "bag '" + file.string() + "'";
  std::error_code error;
  core::requireRegularFile(file, "bag");  // to map a pipe waits for its other end
  if (fs::file_size(file, error) == 0) throw InputError(name + " is empty");
  try {
    bytes_ = std::make_unique<Bytes>(file);
  } catch (const boost::interprocess::interprocess_exception& failure) {
    throw InputError("cannot read " + name + ": " + failure.what());
  }
  scan();
}

BagReader::~BagReader() = default;

void BagReader::note(const std::string& text) { damage_.push_back(text); }

/// Finds all chunks, and the connections that the bag's end repeats.
void BagReader::scan() {
  const std::string_view text = bytes_->text();
  const bool has_magic = text.substr(0, kBagMagic.size()) == kBagMagic;
  if (!has_magic && !findChunk(text, 0)) {
    throw InputError("'" + file_.string() +
                     "' is no ROS bag of format 2.0 (its first line is not '" +
                     std::string(kBagMagic.substr(0, kBagMagic.size() - 1)) + "')");
  }
  std::uint64_t offset = has_magic ? kBagMagic.size() : 0;
  bool whole = true;
  while (offset < text.size()) {
    if (takeRecord(offset)) continue;
    whole = false;
    skipDamage(offset);
  }
  if (whole || has_index_) checkEnd(text.size());
}

/// Takes the record at an offset and goes behind it; false when there is none that can be used.
bool BagReader::takeRecord(std::uint64_t& offset) {
  const std::string_view text = bytes_->text();
  const auto record = parseRecord(text, offset);
  if (!record) return false;
  if (record->op == BagOp::kChunk) return takeChunk(offset);
  if (!record->whole()) return false;
  if (record->op == BagOp::kFileHeader) {
    chunks_promised_ = numberIn(record->fields, "chunk_count").value_or(0);
    index_position_ = longNumberIn(record->fields, "index_pos").value_or(0);
    has_index_ = index_position_ != 0;
    if (!textIn(record->fields, "encryptor").empty())
      throw InputError("bag '" + file_.string() + "' is encrypted; decrypt it first");
  }
  if (record->op == BagOp::kConnection) {
    const auto id = numberIn(record->fields, "conn");
    if (!id) return false;
    addConnection(*id, textIn(record->fields, "topic"), record->data);
  }
  offset = record->end();
  return true;
}

/// A chunk whose length does not lead to another record is taken up to the next chunk: its own data
/// says how much of it is good.
bool BagReader::takeChunk(std::uint64_t& offset) {
  const std::string_view text = bytes_->text();
  const auto record = parseRecord(text, offset);
  const auto size = numberIn(record->fields, "size");
  if (!size) return false;
  Chunk chunk{textIn(record->fields, "compression"), record->data, *size, record->data_begin};
  offset = record->end();
  const bool open = record->data_length == 0;
  const bool leads =
      record->whole() && (offset == text.size() || parseRecord(text, offset).has_value());
  if (open || !leads) {
    offset = findChunk(text, record->data_begin).value_or(text.size());
    chunk.data = text.substr(record->data_begin, offset - record->data_begin);
  }
  chunks_.push_back(chunk);
  return true;
}

void BagReader::skipDamage(std::uint64_t& offset) {
  const std::uint64_t end = findChunk(bytes_->text(), offset + 1).value_or(bytes_->text().size());
  note(rangeText(offset, end) + " are no records of a bag");
  offset = end;
}

void BagReader::checkEnd(std::uint64_t size) {
  if (!has_index_) {
    note("its recording was cut off: it has no index");
  } else if (index_position_ > size) {
    note("it ends at byte " + std::to_string(size) + ", before its index at byte " +
         std::to_string(index_position_));
  } else if (chunks_promised_ != chunks_.size()) {
    note("its first record promises " + std::to_string(chunks_promised_) + " chunks; " +
         std::to_string(chunks_.size()) + " can be found");
  }
}

void BagReader::addConnection(std::uint32_t id, std::string_view topic, std::string_view header) {
  const auto fields = parseFields(header);
  if (!fields || topic.empty()) return;
  connections_.try_emplace(id,
                           BagConnection{std::string(topic), std::string(textIn(*fields, "type")),
                                         std::string(textIn(*fields, "md5sum"))});
}

std::vector<BagConnection> BagReader::connections() const {
  std::vector<BagConnection> all;
  for (const auto& [id, connection] : connections_) all.push_back(connection);
  return all;
}

void BagReader::rewind() {
  next_chunk_ = 0;
  text_.clear();
  cursor_ = 0;
}

bool BagReader::openChunk() {
  if (next_chunk_ == chunks_.size()) return false;
  Chunk& chunk = chunks_[next_chunk_++];
  ChunkText opened = decompressChunk(chunk.compression, chunk.data, chunk.size);
  text_ = std::move(opened.bytes);
  cursor_ = 0;
  if (opened.fault.empty() || chunk.named) return true;
  chunk.named = true;
  note(rangeText(chunk.begin, chunk.begin + chunk.data.size()) + ", a part of the recording: " +
       opened.fault + (text_.empty() ? "; nothing of it is left" : "; its start can be read"));
  return true;
}

void BagReader::noteUnknown(std::uint32_t id) {
  if (!unknown_.insert(id).second) return;
  note("the record that names the topic of connection " + std::to_string(id) +
       " is lost, and with it the connection's messages");
}

/// Gives up the rest of the current chunk.
void BagReader::leaveChunk() {
  Chunk& chunk = chunks_[next_chunk_ - 1];
  if (!chunk.named) {
    note("the part that begins at byte " + std::to_string(chunk.begin) +
         " holds no records after its byte " + std::to_string(cursor_));
  }
  chunk.named = true;
  cursor_ = text_.size();
}

bool BagReader::next(BagMessage& message) {
  while (true) {
    if (cursor_ >= text_.size()) {
      if (!openChunk()) return false;
      continue;
    }
    const auto record = parseRecord(text_, cursor_);
    if (!record || !record->whole()) {
      leaveChunk();
      continue;
    }
    cursor_ = record->end();
    const auto id = numberIn(record->fields, "conn");
    if (!id) continue;
    if (record->op == BagOp::kConnection)
      addConnection(*id, textIn(record->fields, "topic"), record->data);
    if (record->op != BagOp::kMessage) continue;
    const auto connection = connections_.find(*id);
    if (connection == connections_.end()) {
      noteUnknown(*id);
      continue;
    }
    message = {&connection->second, record->data};
    return true;
  }
}

}  // namespace cdiff::node_graph
