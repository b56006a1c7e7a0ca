// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace elastocal {

/// The first sentence, or an empty one.
inline std::string First(const std::vector<std::string>& found) {
  return found.empty() ? "" : found.front();
}

/// Expects one mistake, whose sentence begins with `begin` and contains `accept`.
inline void ExpectNamed(const std::vector<std::string>& found, const std::string& begin,
                        const std::string& accept) {
  ASSERT_EQ(found.size(), 1u) << First(found);
  EXPECT_EQ(found[0].find(begin), 0u) << found[0];
  EXPECT_NE(found[0].find(accept), std::string::npos) << found[0];
}

}  // namespace elastocal
