// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/ends_of_limbs.hpp"

#include <algorithm>

namespace elastocal {

std::vector<int> EndsOfLimbs(const Project& project) {
  std::vector<int> ends;
  for (const Chain& chain : project.chains) {
    const bool moves = project.tree.links[static_cast<std::size_t>(chain.tip_link)].body > 0;
    if (moves && std::ranges::find(ends, chain.tip_link) == ends.end()) {
      ends.push_back(chain.tip_link);
    }
  }
  return ends;
}

}  // namespace elastocal
