#include "elastocal/io/yaml_value.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

#include "elastocal/io/text.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {

void YamlValue::Fail(const std::string& message) const {
  throw InputError(Place(source_, line_) + (path_.empty() ? "" : path_ + ": ") + message);
}

std::string YamlValue::Shown() const {
  switch (kind_) {
    case Kind::kNothing:
      return "nothing";
    case Kind::kScalar:
      return Quote(scalar_);
    case Kind::kList:
      return "a list";
    case Kind::kMapping:
      break;
  }
  return "a mapping";
}

void YamlValue::Expect(bool fine, const std::string& expected) const {
  if (!fine) Fail("found " + Shown() + "; expected " + expected);
}

const std::vector<std::pair<std::string, YamlValue>>& YamlValue::Entries() const {
  Expect(kind_ == Kind::kMapping || kind_ == Kind::kNothing, "a mapping (key: value)");
  return entries_;
}

void YamlValue::ExpectKeys(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : Entries()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    std::string hint = DidYouMean(key.substr(0, 60), known);
    if (hint.empty()) {
      for (const std::string& name : known) hint += (hint.empty() ? "; expected " : ", ") + name;
    }
    throw InputError(Place(source_, value.line_) + (path_.empty() ? "" : path_ + ": ") +
                     "unknown key " + Quote(key) + hint);
  }
}

std::optional<YamlValue> YamlValue::Find(const std::string& key) const {
  for (const auto& [name, value] : Entries()) {
    if (name == key) return value;
  }
  return std::nullopt;
}

YamlValue YamlValue::Get(const std::string& key) const {
  std::optional<YamlValue> found = Find(key);
  if (!found) Fail("the key '" + key + "' is missing");
  return *std::move(found);
}

std::vector<YamlValue> YamlValue::Items() const {
  Expect(kind_ == Kind::kList || kind_ == Kind::kNothing, "a list");
  std::vector<YamlValue> items;
  for (const auto& [unused, value] : entries_) items.push_back(value);
  return items;
}

std::string YamlValue::Text() const {
  constexpr std::size_t kLongest = 1000;
  Expect(kind_ == Kind::kScalar && !scalar_.empty() && scalar_.size() <= kLongest,
         "text of 1 to 1000 characters");
  Expect(scalar_.find('\0') == std::string::npos, "text without NUL characters");
  return scalar_;
}

double YamlValue::Number() const {
  const std::optional<double> number = kind_ == Kind::kScalar ? ParseNumber(scalar_) : std::nullopt;
  Expect(number.has_value(), "a number");
  return number.value_or(0.0);
}

double YamlValue::PositiveOrInfinity() const {
  if (kind_ == Kind::kScalar && scalar_ == ".inf") return std::numeric_limits<double>::infinity();
  const std::optional<double> number = kind_ == Kind::kScalar ? ParseNumber(scalar_) : std::nullopt;
  Expect(number.value_or(0.0) > 0.0, "a number above 0, or .inf");
  return number.value_or(0.0);
}

std::int64_t YamlValue::Integer(std::int64_t least, std::int64_t most) const {
  std::int64_t value = 0;
  const char* end = scalar_.data() + scalar_.size();
  const auto [stop, error] = std::from_chars(scalar_.data(), end, value);
  Expect(kind_ == Kind::kScalar && error == std::errc() && stop == end && value >= least &&
             value <= most,
         "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return value;
}

bool YamlValue::Boolean() const {
  Expect(kind_ == Kind::kScalar && (scalar_ == "true" || scalar_ == "false"), "true or false");
  return scalar_ == "true";
}

}  // namespace elastocal
