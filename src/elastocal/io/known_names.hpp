// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/math/input_error.hpp"

namespace elastocal {

/// DidYouMean for a cell of a table. If no candidate is near, it lists up to eight candidates:
/// "; known: left".
template <typename Names>
std::string Known(const std::string& name, const Names& candidates) {
  constexpr int kMostNames = 8;
  std::string text = DidYouMean(name.substr(0, 60), candidates);
  if (!text.empty()) return text;
  int count = 0;
  for (const std::string& candidate : candidates) {
    if (++count > kMostNames) return text + " and others";
    text += (count == 1 ? "; known: " : ", ") + candidate;
  }
  return text;
}

}  // namespace elastocal
