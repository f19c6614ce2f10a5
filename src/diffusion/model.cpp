// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "e2e_cdiff/diffusion/model.h"

#include <algorithm>
#include <system_error>
#include <vector>

#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/file.h"
#include "e2e_cdiff/core/text.h"
#include "model_metadata.h"

namespace cdiff::diffusion {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEncoderFile = "encoder.safetensors";
constexpr const char* kDenoiserFile = "denoiser.safetensors";

using TensorLister = std::vector<TensorShape> (*)(const Architecture&);

/// One of the two files of a model.
struct Part {
  SafetensorsFile content;
  std::string source;
  Model description;  ///< architecture, normaliser and spread only
};

void requireAgreement(const Part& first, const Part& second) {
  const Model& left = first.description;
  const Model& right = second.description;
  const auto fail = [&](const std::string& what) {
    throw core::InputError(first.source + " and " + second.source + " disagree about the " + what +
                           "; they are not of one model");
  };
  if (!(left.architecture == right.architecture)) {
    fail("architecture (" + left.architecture.toJson() + " and " + right.architecture.toJson() +
         ")");
  }
  if (left.normalizer.mean != right.normalizer.mean ||
      left.normalizer.scale != right.normalizer.scale) {
    fail("normalizer");
  }
  if (left.spread != right.spread) fail("spread");
}

/// `other` is the model's other file when that has been read: what the two say of the model is
/// compared before any tensor is read.
Part readPart(const fs::path& file, const std::string& format, TensorLister tensors,
              const Part* other) {
  Part part;
  part.source = "weight file '" + file.string() + "'";
  part.content = readSafetensors(file, [&](const Metadata& metadata) {
    part.description.architecture = readArchitecture(metadata, format, part.source);
    readScales(metadata, part.source, part.description);
    if (other != nullptr) requireAgreement(*other, part);
    return tensors(part.description.architecture);
  });
  return part;
}

/// Names of the shipped models, sorted.
std::vector<std::string> shippedModels(const fs::path& weights) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(weights, error)) {
    if (fs::exists(entry.path() / kDenoiserFile, error)) {
      names.push_back(entry.path().filename().string());
    }
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// A plain name is a shipped model first; everything else is a folder.
fs::path folderOf(const std::string& name_or_folder) {
  const fs::path given(name_or_folder);
  const bool plain =
      !name_or_folder.empty() && given == given.filename() && given != "." && given != "..";
  const fs::path weights = core::shareFolder() / "weights";
  std::error_code error;
  if (plain && fs::is_directory(weights / given, error)) return weights / given;
  if (!name_or_folder.empty() && fs::is_directory(given, error)) {
    return fs::canonical(given);
  }
  const std::vector<std::string> names = shippedModels(weights);
  const std::string nearest = core::nearestName(name_or_folder, names);
  throw core::InputError(
      "model '" + name_or_folder + "' is neither a folder nor a shipped model in '" +
      weights.string() + "', which holds " +
      (names.empty() ? "none"
                     : core::joinText(names, ", ") + "; the nearest is '" + nearest + "'"));
}

void requireTensors(const std::map<std::string, Tensor>& tensors,
                    const std::vector<TensorShape>& expected, const std::string& what) {
  for (const TensorShape& shape : expected) {
    const auto found = tensors.find(shape.name);
    if (found == tensors.end() || found->second.shape != shape.shape) {
      throw core::InputError("the model's " + what + " lacks tensor '" + shape.name +
                             "' or has it in another shape");
    }
  }
  if (tensors.size() != expected.size()) {
    throw core::InputError("the model's " + what + " has " + std::to_string(tensors.size()) +
                           " tensors; " + std::to_string(expected.size()) + " were expected");
  }
}

SafetensorsFile fileOf(const Model& model, const std::string& format,
                       const std::map<std::string, Tensor>& tensors, const Metadata& facts) {
  SafetensorsFile content{describeModel(model, format), tensors};
  content.metadata.insert(facts.begin(), facts.end());
  return content;
}

}  // namespace

Model loadModel(const std::string& name_or_folder) {
  const fs::path folder = folderOf(name_or_folder);
  Part denoiser = readPart(folder / kDenoiserFile, kDenoiserFormat, denoiserTensors, nullptr);
  Part encoder = readPart(folder / kEncoderFile, kEncoderFormat, encoderTensors, &denoiser);
  Model model = std::move(denoiser.description);
  model.name = folder.filename().string();
  model.sha256 =
      core::sha256(encoder.content.metadata.at("sha256") + denoiser.content.metadata.at("sha256"));
  model.encoder = std::move(encoder.content.tensors);
  model.denoiser = std::move(denoiser.content.tensors);
  return model;
}

std::string modelFilesSha256(const std::string& name_or_folder) {
  const fs::path folder = folderOf(name_or_folder);
  return core::sha256(core::sha256(core::readFile(folder / kEncoderFile, "weight file")) +
                      core::sha256(core::readFile(folder / kDenoiserFile, "weight file")));
}

void saveModel(const Model& model, const fs::path& folder, TensorType type,
               const std::map<std::string, std::string>& training_facts) {
  validateDescription(model);
  requireTensors(model.encoder, encoderTensors(model.architecture), "encoder");
  requireTensors(model.denoiser, denoiserTensors(model.architecture), "denoiser");
  for (const auto& fact : training_facts) {
    if (!isReservedKey(fact.first)) continue;
    throw core::InputError("training fact '" + fact.first + "' has the name of a reserved key");
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw core::InputError("cannot make the folder '" + folder.string() + "': " + error.message());
  }
  writeSafetensors(folder / kEncoderFile,
                   fileOf(model, kEncoderFormat, model.encoder, training_facts), type);
  writeSafetensors(folder / kDenoiserFile,
                   fileOf(model, kDenoiserFormat, model.denoiser, training_facts), type);
}

}  // namespace cdiff::diffusion
