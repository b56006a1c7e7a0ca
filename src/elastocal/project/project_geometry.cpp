// SPDX-License-Identifier: Apache-2.0
#include "elastocal/project/project_sections.hpp"

namespace elastocal {

Eigen::VectorXd NumbersOf(const YamlValue& list, std::size_t size) {
  const std::vector<YamlValue> items = list.Items();
  list.Expect(items.size() == size, std::to_string(size) + " numbers");
  Eigen::VectorXd numbers(static_cast<Eigen::Index>(size));
  for (std::size_t i = 0; i < size; ++i) {
    numbers[static_cast<Eigen::Index>(i)] = items[i].Bounded();
  }
  return numbers;
}

Eigen::Vector3d DirectionFrom(const YamlValue& value) {
  const std::vector<YamlValue> numbers = value.Items();
  value.Expect(numbers.size() == 3, "three numbers [x, y, z]");
  Eigen::Vector3d direction;
  for (int i = 0; i < 3; ++i) direction[i] = numbers[i].Bounded();
  value.Expect(direction.norm() > 0.0, "a direction");
  return direction.normalized();
}

Eigen::Vector3d PointFromMm(const YamlValue& value) {
  const std::vector<YamlValue> coordinates = value.Items();
  if (coordinates.size() != 3) {
    value.Fail("found " + std::to_string(coordinates.size()) +
               (coordinates.size() == 1 ? " number" : " numbers") +
               "; expected three coordinates [x, y, z] in mm");
  }
  Eigen::Vector3d point;
  for (int i = 0; i < 3; ++i) point[i] = kOneMm * coordinates[i].Bounded();
  return point;
}

Eigen::Vector3d OptionalPoint(const YamlValue& value, const char* key) {
  const auto point = value.Find(key);
  return point ? PointFromMm(*point) : Eigen::Vector3d::Zero();
}

Transform PoseFromMm(const YamlValue& value) {
  const auto rpy = value.Find("rpy_deg");
  const Eigen::Vector3d turn =
      rpy ? Eigen::Vector3d(kOneDegree * NumbersOf(*rpy, 3)) : Eigen::Vector3d::Zero();
  return FromXyzRpy(OptionalPoint(value, "xyz_mm"), turn);
}

}  // namespace elastocal
