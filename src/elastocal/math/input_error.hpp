// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace elastocal {

/// A file, setting or name that the user gave is not usable.
///
/// The message names the place (file, and line or key where there is one), what was found and what
/// was expected, so that it can be shown as it is. The program then ends with exit code 3.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// "; did you mean 'X'?" with the candidate nearest to `name` by edit distance, or an empty string
/// where none is near.
template <typename Names>
std::string DidYouMean(const std::string& name, const Names& candidates);

/// Number of single-character edits (Levenshtein distance), without regard to capitals.
int EditDistance(const std::string& a, const std::string& b);

template <typename Names>
std::string DidYouMean(const std::string& name, const Names& candidates) {
  std::string nearest;
  int best = 1 + static_cast<int>(name.size()) / 2;
  for (const std::string& candidate : candidates) {
    const int distance = EditDistance(name, candidate);
    if (distance < best) {
      best = distance;
      nearest = candidate;
    }
  }
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

}  // namespace elastocal
