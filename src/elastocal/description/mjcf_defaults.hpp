// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/files/xml_element.hpp"

namespace elastocal {

/// The defaults of joints in the section `default` of an MJCF, by class.
class MjcfJointDefaults {
 public:
  explicit MjcfJointDefaults(const XmlElement& mujoco);

  /// The element that gives an attribute of a joint: the joint itself, or else the default of its
  /// class or of a class around that. A joint that names no class has `childclass`, that of its
  /// body (empty: the outermost class). Nothing if MuJoCo's own default counts. Throws InputError
  /// for an unknown class.
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
