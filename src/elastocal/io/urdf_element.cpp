#include "elastocal/io/urdf_element.hpp"

#include <algorithm>

#include <tinyxml2.h>

#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {

void UrdfElement::Fail(const std::string& message) const {
  throw InputError(Place(*source_, line()) + message);
}

int UrdfElement::line() const { return xml_->GetLineNum(); }

std::string UrdfElement::Label() const {
  // The inner elements have no name: the nearest one around them tells which is meant.
  std::string label = std::string("<") + xml_->Name() + ">";
  for (const tinyxml2::XMLNode* node = xml_; node != nullptr; node = node->Parent()) {
    const tinyxml2::XMLElement* element = node->ToElement();
    if (element == nullptr || element->Attribute("name") == nullptr) continue;
    const std::string named =
        std::string(element->Name()) + " " + Quote(element->Attribute("name"));
    return element == xml_ ? named : label + " of " + named;
  }
  return label;
}

std::optional<UrdfElement> UrdfElement::Find(const char* child) const {
  const tinyxml2::XMLElement* first = xml_->FirstChildElement(child);
  if (first == nullptr) return std::nullopt;
  if (const tinyxml2::XMLElement* second = first->NextSiblingElement(child)) {
    UrdfElement(*second, *source_)
        .Fail("second <" + std::string(child) + "> in " + Label() + "; one was expected");
  }
  return UrdfElement(*first, *source_);
}

UrdfElement UrdfElement::Get(const char* child) const {
  const std::optional<UrdfElement> found = Find(child);
  if (!found) Fail(Label() + " has no <" + child + ">");
  return *found;
}

bool UrdfElement::Has(const char* attribute) const { return xml_->Attribute(attribute) != nullptr; }

const char* UrdfElement::Attribute(const char* attribute) const {
  const char* value = xml_->Attribute(attribute);
  if (value == nullptr) Fail(Label() + " has no attribute '" + attribute + "'");
  return value;
}

std::string UrdfElement::Text(const char* attribute) const {
  const std::string text = Attribute(attribute);
  const auto is_control = [](unsigned char character) { return character < 0x20; };
  if (text.empty() || std::any_of(text.begin(), text.end(), is_control)) {
    Fail(std::string("attribute '") + attribute + "' of <" + xml_->Name() + "> is " + Quote(text) +
         "; printable text was expected");
  }
  return text;
}

double UrdfElement::Number(const char* attribute) const {
  const char* text = Attribute(attribute);
  const std::optional<double> value = ParseNumber(text);
  if (!value) {
    Fail(std::string("attribute '") + attribute + "' of " + Label() + " is " + Quote(text) +
         "; a finite number was expected");
  }
  return *value;
}

Eigen::Vector3d UrdfElement::Vector(const char* attribute) const {
  const std::string_view text = Attribute(attribute);
  Eigen::Vector3d vector;
  std::string_view rest = Trim(text);
  for (double& component : vector) {
    const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n"));
    const std::optional<double> value = ParseNumber(word);
    rest = Trim(rest.substr(word.size()));
    if (!value || (&component == &vector.z() && !rest.empty())) {
      Fail(std::string("attribute '") + attribute + "' of " + Label() + " is " + Quote(text) +
           "; three finite numbers were expected");
    }
    component = *value;
  }
  return vector;
}

}  // namespace elastocal
