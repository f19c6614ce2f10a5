// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/safetensors.h"

#include <Eigen/Core>
#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>

#include "core/file.h"
#include "core/output_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "inference/safetensors_header.h"

namespace cdiff::inference {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kLengthBytes = 8;
constexpr std::uint64_t kMaxHeader = 8u << 20;
constexpr std::uint64_t kMaxData = std::uint64_t{4} << 30;  // 100 times the shipped networks
constexpr std::uint64_t kPiece = 1u << 20;                  // read at once where it is only hashed
constexpr std::size_t kChecksumDigits = 64;
constexpr std::size_t kAlignment = 8;  // of the data section, as other writers do

static_assert(sizeof(Eigen::half) == 2 && sizeof(float) == 4);
#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "safetensors are little endian; this reader copies them as they are"
#endif

/// An open file of known size.
class Input {
 public:
  Input(const fs::path& file, std::string source) : source_(std::move(source)) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status)) failOn(source_, "no such file");
    if (!fs::is_regular_file(status)) {
      failOn(source_, fs::is_directory(status) ? "is a folder; a file was expected"
                                               : "is not a regular file");
    }
    size_ = fs::file_size(file, error);
    if (error) failOn(source_, "cannot read: " + error.message());
    stream_.open(file, std::ios::binary);
    if (!stream_) failOn(source_, std::string("cannot read: ") + std::strerror(errno));
  }

  const std::string& source() const { return source_; }
  std::uint64_t size() const { return size_; }
  void read(char* target, std::uint64_t count) {
    stream_.read(target, static_cast<std::streamsize>(count));
    if (!stream_) failOn(source_, "truncated while it was read");
  }
  void goBack(std::uint64_t count) {
    stream_.seekg(-static_cast<std::streamoff>(count), std::ios::cur);
    if (!stream_) failOn(source_, "cannot read it a second time");
  }

 private:
  std::string source_;
  std::uint64_t size_ = 0;
  std::ifstream stream_;
};

/// Length of the header [bytes]; fits the file and the limit.
std::uint64_t readHeaderLength(Input& input) {
  if (input.size() < kLengthBytes) {
    failOn(input.source(), "truncated: " + std::to_string(input.size()) +
                               " bytes; the 8 bytes of the header's length were expected");
  }
  std::uint64_t length = 0;
  input.read(reinterpret_cast<char*>(&length), kLengthBytes);
  if (length > kMaxHeader) {
    failOn(input.source(), "the header's length " + std::to_string(length) +
                               " exceeds the limit of " + std::to_string(kMaxHeader) + " bytes");
  }
  if (length > input.size() - kLengthBytes) {
    failOn(input.source(), "truncated: a header of " + std::to_string(length) +
                               " bytes is announced, " +
                               std::to_string(input.size() - kLengthBytes) + " follow");
  }
  return length;
}

SafetensorsHeader readHeader(Input& input) {
  const std::uint64_t length = readHeaderLength(input);
  std::string text(length, '\0');
  input.read(text.data(), length);
  if (text.empty() || text.front() != '{') {
    failOn(input.source(), "the header does not begin with '{'; a JSON object was expected");
  }
  return parseHeader(text, input.size() - kLengthBytes - length, input.source());
}

std::size_t elementCount(const std::vector<std::int64_t>& shape) {
  std::size_t count = 1;
  for (const std::int64_t size : shape) count *= static_cast<std::size_t>(size);
  return count;
}

/// The bytes of a tensor as float32.
std::vector<float> toFloats(const std::string& bytes, TensorType type) {
  std::vector<float> values(bytes.size() / bytesOf(type));
  if (type == TensorType::kF32) {
    std::memcpy(values.data(), bytes.data(), bytes.size());
    return values;
  }
  std::vector<Eigen::half> halves(values.size());
  std::memcpy(static_cast<void*>(halves.data()), bytes.data(), bytes.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(halves[i]);
  return values;
}

/// Of metadata "sha256".
std::string checksumOf(const SafetensorsHeader& header, const std::string& source) {
  const auto found = header.metadata.find(kChecksumKey);
  if (found == header.metadata.end()) {
    failOn(source, std::string("the metadata lacks the key '") + kChecksumKey + "'");
  }
  if (found->second.size() != kChecksumDigits) {
    failOn(source, "the metadata's sha256 has " + std::to_string(found->second.size()) +
                       " characters; 64 hexadecimal digits were expected");
  }
  return found->second;
}

/// Hashes the data section piece by piece, so that a damaged file costs no memory, and goes back to
/// its start.
void requireChecksum(Input& input, std::uint64_t size, const std::string& expected) {
  if (size > kMaxData) {
    failOn(input.source(), "the data section of " + std::to_string(size) +
                               " bytes exceeds the limit of " + std::to_string(kMaxData) +
                               " bytes");
  }
  core::Sha256 hash;
  std::string piece;
  for (std::uint64_t done = 0; done < size; done += piece.size()) {
    piece.resize(std::min(kPiece, size - done));
    input.read(piece.data(), piece.size());
    hash.update(piece);
  }
  const std::string actual = hash.finish();
  if (actual != expected) {
    failOn(input.source(), "the data section's checksum is " + actual +
                               ", the metadata's sha256 is '" + expected +
                               "'; the file is damaged");
  }
  input.goBack(size);
}

Tensor readTensor(Input& input, const TensorEntry& entry) {
  std::string bytes(entry.end - entry.begin, '\0');
  input.read(bytes.data(), bytes.size());
  Tensor tensor{entry.shape, toFloats(bytes, entry.type)};
  for (std::size_t i = 0; i < tensor.values.size(); ++i) {
    if (std::isfinite(tensor.values[i])) continue;
    failOn(input.source(), "tensor '" + entry.name + "' holds " +
                               core::formatNumber(static_cast<double>(tensor.values[i])) +
                               " at element " + std::to_string(i) +
                               "; finite values were expected");
  }
  return tensor;
}

/// The tensor's bytes as they stand in the file.
std::string toBytes(const std::string& name, const Tensor& tensor, TensorType type) {
  std::string bytes(tensor.values.size() * bytesOf(type), '\0');
  for (std::size_t i = 0; i < tensor.values.size(); ++i) {
    const float value = tensor.values[i];
    const Eigen::half half(value);
    const bool fits =
        std::isfinite(value) && (type == TensorType::kF32 || (Eigen::numext::isfinite)(half));
    if (!fits) {
      throw core::InputError("tensor '" + name + "' holds " +
                             core::formatNumber(static_cast<double>(value)) + " at element " +
                             std::to_string(i) + ", which " +
                             (type == TensorType::kF16 ? "F16" : "F32") + " cannot hold");
    }
    if (type == TensorType::kF32) {
      std::memcpy(&bytes[4 * i], &value, 4);
    } else {
      std::memcpy(&bytes[2 * i], &half.x, 2);
    }
  }
  return bytes;
}

void requireWritable(const std::string& name, const Tensor& tensor) {
  for (const std::int64_t size : tensor.shape) {
    if (size < 0) throw std::invalid_argument("writeSafetensors: negative size in '" + name + "'");
  }
  if (name == kMetadataKey || elementCount(tensor.shape) != tensor.values.size()) {
    throw std::invalid_argument("writeSafetensors: tensor '" + name + "' has " +
                                std::to_string(tensor.values.size()) + " values for shape " +
                                shapeText(tensor.shape));
  }
}

}  // namespace

SafetensorsFile readSafetensors(
    const fs::path& file,
    const std::function<std::vector<TensorShape>(const std::map<std::string, std::string>&)>&
        expected) {
  Input input(file, "weight file '" + file.string() + "'");
  const SafetensorsHeader header = readHeader(input);
  const std::string checksum = checksumOf(header, input.source());
  requireExpected(header, expected(header.metadata), input.source());
  requireChecksum(input, header.entries.empty() ? 0 : header.entries.back().end, checksum);
  SafetensorsFile content;
  content.metadata = header.metadata;
  for (const TensorEntry& entry : header.entries) {
    content.tensors[entry.name] = readTensor(input, entry);
  }
  return content;
}

std::string writeSafetensors(const fs::path& file, const SafetensorsFile& content,
                             TensorType type) {
  std::string data;
  nlohmann::ordered_json header;
  header[kMetadataKey] = content.metadata;
  for (const auto& [name, tensor] : content.tensors) {
    requireWritable(name, tensor);
    const std::size_t begin = data.size();
    data += toBytes(name, tensor, type);
    header[name] = {{"dtype", type == TensorType::kF16 ? "F16" : "F32"},
                    {"shape", tensor.shape},
                    {"data_offsets", {begin, data.size()}}};
  }
  const std::string checksum = core::sha256(data);
  header[kMetadataKey][kChecksumKey] = checksum;
  std::string text = header.dump();
  text.resize((text.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');
  const std::uint64_t length = text.size();
  if (length > kMaxHeader) {
    throw core::InputError("'" + file.string() + "': a header of " + std::to_string(length) +
                           " bytes exceeds the limit of " + std::to_string(kMaxHeader));
  }
  std::string bytes(reinterpret_cast<const char*>(&length), kLengthBytes);
  bytes += text;
  bytes += data;
  core::writeOwnFile(file, bytes);
  return checksum;
}

}  // namespace cdiff::inference
