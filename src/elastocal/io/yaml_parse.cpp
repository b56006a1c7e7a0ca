#include <algorithm>
#include <sstream>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

#include "elastocal/io/text.hpp"
#include "elastocal/io/yaml_value.hpp"
#include "elastocal/math/input_error.hpp"

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
    throw InputError(source + ": has more than 1 MiB; a project file (YAML) was expected");
  }
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

}  // namespace elastocal
