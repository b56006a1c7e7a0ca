// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "elastocal/files/bounds.hpp"

namespace elastocal {

constexpr NumberRange kPositive = {0.0};
constexpr NumberRange kNotNegative = {.lower = 0.0, .with_lower = true};
constexpr NumberRange kPositiveOrInfinity = {.lower = 0.0, .with_upper = true};
constexpr NumberRange kFraction = {0.0, 1.0};
constexpr NumberRange kFractionOrOne = {.lower = 0.0, .upper = 1.0, .with_upper = true};

/// A value of a YAML file that knows its line and the keys that lead to it. If the file does not
/// hold what a method asks for, the method throws InputError naming file, line and key, what was
/// found and what was expected.
class YamlValue {
 public:
  /// Reads one document. Anchors, aliases, twice given keys, keys that are not text, more than one
  /// document, text that is not UTF-8, more than 1 MiB and nesting beyond 20 levels are errors, as
  /// is malformed YAML.
  static YamlValue Parse(const std::string& text, const std::string& source);

  [[noreturn]] void Fail(const std::string& message) const;
  /// Unless `fine`, throws InputError with the value found and `expected`.
  void Expect(bool fine, const std::string& expected) const;

  int line() const { return line_; }
  bool IsScalar() const { return kind_ == Kind::kScalar; }

  /// For a mapping. An empty value (`key:` and the end of the line) is an empty mapping.
  void ExpectKeys(const std::vector<std::string>& known) const;
  std::optional<YamlValue> Find(const std::string& key) const;
  YamlValue Get(const std::string& key) const;
  const std::vector<std::pair<std::string, YamlValue>>& Entries() const;

  /// For a list. An empty value is an empty list.
  std::vector<YamlValue> Items() const;

  /// Text that is not empty and not unreasonably long.
  std::string Text() const;
  /// A finite number.
  double Number() const;
  double Number(const NumberRange& range) const;
  /// A number within the bounds of the keys that lead to it; bounds.hpp must have an entry for
  /// them.
  double Bounded() const;
  /// A whole number of at least `least` and at most `most`.
  std::int64_t Integer(std::int64_t least, std::int64_t most) const;
  bool Boolean() const;

  /// For a mapping: sets `option` to the value of the key (a number times `unit`). It stays as it
  /// is if there is no such key.
  void Read(const char* key, double& option, const NumberRange& range, double unit = 1.0) const;
  void Read(const char* key, int& option, int least, int most) const;
  void Read(const char* key, bool& option) const;
  /// Read within the bounds of the keys (bounds.hpp).
  void ReadBounded(const char* key, double& option, double unit = 1.0) const;
  void ReadBounded(const char* key, int& option) const;

 private:
  friend class YamlBuilder;
  enum class Kind { kNothing, kScalar, kList, kMapping };

  std::string Shown() const;

  Kind kind_ = Kind::kNothing;
  int line_ = 1;
  std::string source_, path_;
  std::string scalar_;
  std::vector<std::pair<std::string, YamlValue>> entries_;  ///< of a list: with empty keys
};

}  // namespace elastocal
