#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/io/project.hpp"

namespace elastocal {

/// Which column of a motion or a list of postures holds what; counted from 0, -1 where there is
/// none.
struct MotionColumns {
  std::vector<std::string> names;  ///< of all columns
  int time = -1, support = -1;
  std::vector<int> coordinates;  ///< one a coordinate of the tree
};

/// Finds out what the columns of a header mean. `timed`: of a motion, whose column of time is read
/// and which has no markers. Throws InputError beginning with `place`: unknown columns, two that
/// say the same, no time of a motion, no joint.
MotionColumns FindMotionColumns(const std::vector<std::string>& header, const std::string& place,
                                const Project& project, bool timed);

/// What the cells of the column `support` mean.
class SupportNames {
 public:
  explicit SupportNames(const Project& project);

  /// Links that stand on the floor: the tip of a chain or several joined by '+'; `both` feet of a
  /// robot with two legs; `none`. Throws InputError beginning with `place` for anything else.
  std::vector<int> Find(const std::string& cell, const std::string& place) const;

 private:
  std::map<std::string, std::vector<int>> links_;
};

}  // namespace elastocal
