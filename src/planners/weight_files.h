// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/planning/planner_descriptor.h"
#include "inference/safetensors.h"

namespace cdiff::planners {

// The weights of planners whose network is one safetensors file.

/// Whose weights a file holds.
struct WeightKind {
  const char* planner;                        ///< name of the planner and of its training task
  const char* file;                           ///< in the folder of the weights
  const char* format;                         ///< metadata key "format"
  const char* learns_from = "--data FOLDER";  ///< as its training is told, for messages
};

/// The option that names a planner's weights.
struct WeightOptions {
  std::string weights;  ///< folder, or the name of one in weights/ of the package

  void describe(core::OptionsVisitor& visitor);
  void validate() const {}
  /// Throws InputError where the package's share folder is not found.
  std::filesystem::path folder() const;
};

/// The file in `folder`. Throws InputError with the command that trains it where there is none.
std::filesystem::path weightFile(const WeightKind& kind, const std::filesystem::path& folder);
std::string weightSha256(const WeightKind& kind, const std::filesystem::path& folder);

using WeightTensors = std::map<std::string, inference::Tensor>;
using WeightMetadata = std::map<std::string, std::string>;

/// Throws InputError naming the file and what is wrong: none, of another planner, of other sizes;
/// see readSafetensors. `expected`: names and shapes, given the file's metadata and its name for
/// messages.
WeightTensors readWeights(const WeightKind& kind, const std::filesystem::path& folder,
                          const std::function<std::vector<inference::TensorShape>(
                              const WeightMetadata&, const std::string&)>& expected);

/// A network as a weight file holds it: sizes, which its metadata names, and tensors.
template <class Architecture>
struct NetworkWeights {
  Architecture architecture;
  WeightTensors weights;
};

template <class Architecture>
WeightMetadata networkMetadata(const WeightKind& kind, const Architecture& architecture) {
  return {{"format", kind.format}, {"architecture", core::dumpOptions(architecture)}};
}

/// The YAML text of the sizes. Throws InputError where the metadata lacks it.
core::YamlSource architectureText(const WeightMetadata& metadata, const std::string& source);

/// As readWeights; `tensorsOf`: names and shapes by architecture.
template <class Architecture>
NetworkWeights<Architecture> readNetwork(
    const WeightKind& kind, const std::filesystem::path& folder,
    std::vector<inference::TensorShape> (*tensorsOf)(const Architecture&)) {
  NetworkWeights<Architecture> network;
  network.weights =
      readWeights(kind, folder, [&](const WeightMetadata& metadata, const std::string& source) {
        core::loadOptions(architectureText(metadata, source), network.architecture);
        network.architecture.validate();
        return tensorsOf(network.architecture);
      });
  return network;
}

/// Of a learned planner: what it is given and how a decision comes from that, for the record of a
/// session, and whether its kernels depend on the instruction set.
struct NetworkText {
  const char* conditioning;
  const char* sampling;
  bool has_kernels = true;
};
planning::NetworkFacts networkFactsOf(const WeightKind& kind, const NetworkText& text,
                                      const std::string& weights);

/// A descriptor with all that follows from the kind; `Options` derive from WeightOptions.
template <class Options>
planning::PlannerDescriptor learnedDescriptor(const WeightKind& kind, const NetworkText& text) {
  planning::PlannerDescriptor descriptor;
  descriptor.name = kind.planner;
  descriptor.options = planning::makePlannerOptions<Options>;
  descriptor.network = [kind, text](const planning::PlannerOptionsTable& table,
                                    const guidance::GuidanceOptions&) {
    return networkFactsOf(kind, text, table.of<Options>().weights);
  };
  descriptor.weights_sha256 = [kind](const planning::PlannerOptionsTable& table) {
    return weightSha256(kind, table.of<Options>().folder());
  };
  return descriptor;
}

}  // namespace cdiff::planners
