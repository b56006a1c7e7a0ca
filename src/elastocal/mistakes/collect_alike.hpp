// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace elastocal {

/// Elements that one model explains together, and the error that it leaves.
struct AlikeSet {
  std::vector<std::size_t> elements;
  double error = 0.0;
};

/// Error that one model leaves of these elements together.
using ErrorTogether = std::function<double(const std::vector<std::size_t>&)>;

/// Collects elements into sets whose error is below `most`, the largest set first. Each set takes
/// all elements that fit, in their order: all at once or, where that fails, by halves, so that few
/// foreign elements among many take few fits. `errors` has the error of each element by itself.
///
/// Where all n differ, this would take (n - 1)^2 fits. None if more than `most_fits` are needed.
std::optional<std::vector<AlikeSet>> CollectAlike(const std::vector<double>& errors, double most,
                                                  int most_fits, const ErrorTogether& error_of);

}  // namespace elastocal
