#pragma once

#include <optional>
#include <string>

#include <Eigen/Core>

namespace tinyxml2 {
class XMLElement;
}

namespace elastocal {

/// An element of a URDF with checked access to what is in it. All methods throw InputError naming
/// file and line where the file does not hold what is asked for.
class UrdfElement {
 public:
  /// Both must outlive the new object.
  UrdfElement(const tinyxml2::XMLElement& xml, const std::string& source)
      : xml_(&xml), source_(&source) {}

  [[noreturn]] void Fail(const std::string& message) const;
  int line() const;

  /// The child element of this name. It may not be there twice: which one counts, programs do not
  /// agree on.
  std::optional<UrdfElement> Find(const char* child) const;
  UrdfElement Get(const char* child) const;

  bool Has(const char* attribute) const;
  /// Not empty and without control characters.
  std::string Text(const char* attribute) const;
  double Number(const char* attribute) const;
  /// Three numbers with spaces between them.
  Eigen::Vector3d Vector(const char* attribute) const;

 private:
  const char* Attribute(const char* attribute) const;
  std::string Label() const;

  const tinyxml2::XMLElement* xml_;
  const std::string* source_;
};

}  // namespace elastocal
