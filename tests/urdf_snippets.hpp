// SPDX-License-Identifier: Apache-2.0
// Pieces of robot descriptions, for tests of their reader.
#pragma once

#include <initializer_list>
#include <string>

#include "elastocal/description/urdf_reader.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {

inline constexpr const char* kLimit = R"(<limit lower="-1" upper="2" effort="30" velocity="4"/>)";

inline std::string LinkXml(const std::string& name) { return "<link name=\"" + name + "\"/>\n"; }

inline std::string JointXml(const std::string& name, const std::string& type,
                            const std::string& parent, const std::string& child,
                            const std::string& more = kLimit) {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/>" + more + "</joint>\n";
}

/// Parses a robot whose `contents` begin on line 2.
inline RobotTree ParseLinks(const std::string& contents) {
  return ParseUrdf("<robot name=\"r\">\n" + contents + "</robot>\n", "r.urdf");
}

inline void ExpectLinksError(const std::string& contents,
                             std::initializer_list<std::string> parts) {
  ExpectInputError([&] { ParseLinks(contents); }, parts);
}

/// Expects an error in a robot of two links. Its joint is on line 4 and contains `more`.
inline void ExpectJointError(const std::string& type, const std::string& more,
                             std::initializer_list<std::string> parts) {
  ExpectLinksError(LinkXml("a") + LinkXml("b") + JointXml("j", type, "a", "b", more), parts);
}

}  // namespace elastocal
