#include "elastocal/io/xml_tags.hpp"

#include <algorithm>

namespace elastocal {
namespace {

constexpr std::string_view kSpaces = " \t\r\n\v\f";
constexpr std::size_t kNone = std::string_view::npos;

/// Place after the next `mark`.
std::size_t After(std::string_view text, std::size_t from, std::string_view mark) {
  const std::size_t found = text.find(mark, from);
  return found == kNone ? kNone : found + mark.size();
}

/// Place of the next '<' that opens a tag.
std::size_t FindTag(std::string_view text, std::size_t from) {
  while ((from = text.find('<', from)) < text.size()) {
    const std::string_view rest = text.substr(from);
    if (rest.starts_with("<!--")) {
      from = After(text, from + 4, "-->");
    } else if (rest.starts_with("<![CDATA[")) {
      from = After(text, from + 9, "]]>");
    } else if (rest.starts_with("<?")) {
      from = After(text, from + 2, "?>");
    } else if (rest.starts_with("<!")) {
      from = After(text, from + 2, ">");
    } else {
      return from;
    }
  }
  return kNone;
}

class TagScanner {
 public:
  TagScanner(std::string_view text, std::size_t begin) : text_(text), place_(begin + 1) {
    tag_.begin = begin;
  }

  std::optional<XmlTag> Scan() {
    SkipSpaces();
    tag_.closing = Take('/');
    tag_.name = Word();
    tag_.name_end = place_;
    for (SkipSpaces(); !AtEnd() && text_[place_] != '>' && text_[place_] != '/'; SkipSpaces()) {
      if (!ScanAttribute()) return std::nullopt;
    }
    tag_.empty = Take('/');
    if (!Take('>') || tag_.name.empty()) return std::nullopt;
    tag_.end = place_;
    return tag_;
  }

 private:
  bool AtEnd() const { return place_ >= text_.size(); }

  bool Take(char expected) {
    if (AtEnd() || text_[place_] != expected) return false;
    ++place_;
    return true;
  }

  void SkipSpaces() { place_ = std::min(text_.find_first_not_of(kSpaces, place_), text_.size()); }

  std::string_view Word() {
    const std::size_t begin = place_;
    place_ = std::min(text_.find_first_of(" \t\r\n\v\f=/<>\"'", place_), text_.size());
    return text_.substr(begin, place_ - begin);
  }

  bool ScanAttribute() {
    XmlAttribute attribute;
    attribute.name = Word();
    SkipSpaces();
    if (!Take('=')) return false;
    SkipSpaces();
    if (AtEnd() || (text_[place_] != '"' && text_[place_] != '\'')) return false;
    const char quote = text_[place_++];
    const std::size_t end = text_.find(quote, place_);
    if (end == kNone) return false;
    attribute.value_begin = place_;
    attribute.value = text_.substr(place_, end - place_);
    place_ = end + 1;
    tag_.attributes.push_back(attribute);
    return true;
  }

  std::string_view text_;
  std::size_t place_;
  XmlTag tag_;
};

}  // namespace

std::optional<XmlTag> NextTag(std::string_view text, std::size_t from) {
  const std::size_t begin = FindTag(text, from);
  if (begin == kNone) return std::nullopt;
  return TagScanner(text, begin).Scan();
}

}  // namespace elastocal
