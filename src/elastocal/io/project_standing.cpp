#include <set>

#include "elastocal/io/project_sections.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

Eigen::Vector2d ReadCorner(const YamlValue& value) {
  const std::vector<YamlValue> items = value.Items();
  value.Expect(items.size() == 2, "two numbers, x and y");
  return kMetresPerMm * Eigen::Vector2d(items[0].Number(), items[1].Number());
}

}  // namespace

void ReadStanding(const YamlValue& section, Project& project) {
  section.ExpectKeys({"soles"});
  const YamlValue list = section.Get("soles");
  std::set<int> links;
  for (const YamlValue& value : list.Items()) {
    value.ExpectKeys({"link", "lower_mm", "upper_mm"});
    Sole sole{LinkNamedBy(value.Get("link"), project.tree), ReadCorner(value.Get("lower_mm")),
              ReadCorner(value.Get("upper_mm"))};
    value.Expect((sole.lower.array() < sole.upper.array()).all(),
                 "a lower corner below the upper one");
    value.Expect(links.insert(sole.link).second, "a link that is no sole yet");
    project.soles.push_back(sole);
  }
  list.Expect(project.soles.size() == 1 || project.soles.size() == 2, "one or two soles");
}

}  // namespace elastocal
