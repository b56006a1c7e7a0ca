// SPDX-License-Identifier: Apache-2.0
#include "elastocal/files/yaml_value.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/utf8.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {

/// Builds the values from the parser's events. With yaml-cpp's own nodes, aliases can stand for
/// more values than fit into memory, and a twice given key goes unnoticed.
class YamlBuilder : public YAML::EventHandler {
 public:
  explicit YamlBuilder(const std::string& source) : source_(source) { root_.source_ = source; }

  YamlValue TakeRoot() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (++documents_ > 1) Fail(mark, "a second document begins; one was expected");
  }
  void OnDocumentEnd() override {}

  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override {
    if (KeyIsNext()) Fail(mark, "an empty key");
    Add(mark, YamlValue::Kind::kNothing);
  }

  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    Fail(mark, "aliases (*name) are not read; text that begins with * stands in quotes");
  }

  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                const std::string& value) override {
    if (KeyIsNext()) {
      TakeKey(mark, value);
      return;
    }
    Add(mark, YamlValue::Kind::kScalar).scalar_ = value;
  }

  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {
    Open(mark, YamlValue::Kind::kList);
  }
  void OnSequenceEnd() override { open_.pop_back(); }

  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {
    Open(mark, YamlValue::Kind::kMapping);
  }
  void OnMapEnd() override { open_.pop_back(); }

 private:
  struct OpenValue {
    YamlValue* value;
    bool has_key = false;
    std::string key;
    std::vector<std::string> known_keys;  ///< sorted
  };

  [[noreturn]] void Fail(const YAML::Mark& mark, const std::string& message) const {
    throw InputError(Place(source_, mark.line + 1) + message);
  }

  bool KeyIsNext() const {
    return !open_.empty() && open_.back().value->kind_ == YamlValue::Kind::kMapping &&
           !open_.back().has_key;
  }

  void TakeKey(const YAML::Mark& mark, const std::string& key) {
    OpenValue& mapping = open_.back();
    auto& known = mapping.known_keys;
    const auto place = std::lower_bound(known.begin(), known.end(), key);
    if (place != known.end() && *place == key) Fail(mark, "the key " + Quote(key) + " comes twice");
    known.insert(place, key);
    mapping.key = key;
    mapping.has_key = true;
  }

  std::string PathOfNext() const {
    if (open_.empty()) return "";
    const YamlValue& parent = *open_.back().value;
    if (parent.kind_ == YamlValue::Kind::kList) {
      return parent.path_ + "[" + std::to_string(parent.entries_.size()) + "]";
    }
    return parent.path_ + (parent.path_.empty() ? "" : ".") + open_.back().key.substr(0, 60);
  }

  YamlValue& Add(const YAML::Mark& mark, YamlValue::Kind kind) {
    YamlValue value;
    value.kind_ = kind;
    value.line_ = mark.line + 1;
    value.source_ = source_;
    value.path_ = PathOfNext();
    if (open_.empty()) return root_ = std::move(value);
    OpenValue& parent = open_.back();
    parent.has_key = false;
    return parent.value->entries_.emplace_back(parent.key, std::move(value)).second;
  }

  void Open(const YAML::Mark& mark, YamlValue::Kind kind) {
    constexpr std::size_t kDeepest = 20;
    if (KeyIsNext()) Fail(mark, "a list or mapping stands where a key was expected");
    if (open_.size() >= kDeepest) Fail(mark, "nested more than 20 levels deep");
    open_.push_back({&Add(mark, kind), false, "", {}});
  }

  const std::string& source_;
  int documents_ = 0;
  YamlValue root_;
  /// Values in which the next one may stand, the innermost last. Nothing is added to an outer one
  /// while an inner one is open, so that the pointers stay valid.
  std::vector<OpenValue> open_;
};

YamlValue YamlValue::Parse(const std::string& text, const std::string& source) {
  if (text.size() > 1u << 20) {
    throw InputError(source +
                     ": has more than 1 MiB; a file in YAML that this program reads has less");
  }
  RequireUtf8(text, source);
  YamlBuilder builder(source);
  std::istringstream stream(text);
  try {
    YAML::Parser parser(stream);
    while (parser.HandleNextDocument(builder)) {
    }
  } catch (const YAML::Exception& error) {
    throw InputError(Place(source, std::max(0, error.mark.line) + 1) +
                     "malformed YAML: " + error.msg);
  }
  return builder.TakeRoot();
}

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

double YamlValue::Number(const NumberRange& range) const {
  const bool takes_infinity = range.or_infinity || (range.with_upper && std::isinf(range.upper));
  if (takes_infinity && kind_ == Kind::kScalar && scalar_ == ".inf") {
    return std::numeric_limits<double>::infinity();
  }
  const std::optional<double> found = kind_ == Kind::kScalar ? ParseNumber(scalar_) : std::nullopt;
  Expect(found && range.Contains(*found), range.InWords());
  return found.value_or(0.0);
}

double YamlValue::Bounded() const { return Number(BoundsOf(path_)); }

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

void YamlValue::Read(const char* key, double& option, const NumberRange& range, double unit) const {
  if (const auto value = Find(key)) option = unit * value->Number(range);
}

void YamlValue::Read(const char* key, int& option, int least, int most) const {
  if (const auto value = Find(key)) option = static_cast<int>(value->Integer(least, most));
}

void YamlValue::ReadBounded(const char* key, double& option, double unit) const {
  if (const auto value = Find(key)) option = unit * value->Bounded();
}

void YamlValue::ReadBounded(const char* key, int& option) const {
  const auto value = Find(key);
  if (!value) return;
  const NumberRange range = BoundsOf(value->path_);
  option = static_cast<int>(value->Integer(static_cast<std::int64_t>(range.lower),
                                           static_cast<std::int64_t>(range.upper)));
}

void YamlValue::Read(const char* key, bool& option) const {
  if (const auto value = Find(key)) option = value->Boolean();
}

}  // namespace elastocal
