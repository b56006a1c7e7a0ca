// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/files/xml_element.hpp"

namespace elastocal {

/// What the section `default` of an MJCF says of joints, by class.
class MjcfJointDefaults {
 public:
  explicit MjcfJointDefaults(const XmlElement& mujoco);

  /// The element that gives an attribute of a joint: the joint itself, or the default of its class
  /// (`childclass`, that of its body, where it names none; empty: the outermost one) or of a class
  /// around that. None where MuJoCo's own default counts. Throws InputError for an unknown class.
  std::optional<XmlElement> Giver(const XmlElement& joint, const std::string& childclass,
                                  const char* attribute) const;

 private:
  void Collect(const XmlElement& section, const std::string& name, const std::string& around);

  struct Class {
    std::string around;               ///< empty: none
    std::vector<XmlElement> entries;  ///< a later one counts first
  };
  std::map<std::string, Class> classes_;
};

}  // namespace elastocal
