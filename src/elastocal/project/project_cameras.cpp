// SPDX-License-Identifier: Apache-2.0
#include "elastocal/project/project_sections.hpp"

namespace elastocal {
namespace {

int OptionalLink(const YamlValue& value, const RobotTree& tree) {
  const auto link = value.Find("link");
  return link ? LinkNamedBy(*link, tree) : -1;
}

MountedCamera ReadCamera(const YamlValue& value, Project& project) {
  value.ExpectKeys({"name", "link", "xyz_mm", "rpy_deg", "mounting_sd_mm", "mounting_sd_deg",
                    "focal_px", "centre_px", "distortion", "focal_sd_share"});
  CameraSetup camera;
  camera.name = value.Get("name").Text();
  camera.link = OptionalLink(value, project.tree);
  camera.T_parent = PoseFromMm(value);
  value.ReadBounded("mounting_sd_mm", camera.mounting_sd_m, kOneMm);
  value.ReadBounded("mounting_sd_deg", camera.mounting_sd_rad, kOneDegree);
  value.ReadBounded("focal_sd_share", camera.focal_sd);
  const Eigen::VectorXd focal = NumbersOf(value.Get("focal_px"), 2);
  const Eigen::VectorXd centre = NumbersOf(value.Get("centre_px"), 2);
  Camera& numbers = camera.camera;
  numbers.fx = focal[0];
  numbers.fy = focal[1];
  numbers.cx = centre[0];
  numbers.cy = centre[1];
  if (const auto distortion = value.Find("distortion")) {
    const Eigen::VectorXd of = NumbersOf(*distortion, 5);
    numbers.k1 = of[0];
    numbers.k2 = of[1];
    numbers.p1 = of[2];
    numbers.p2 = of[3];
    numbers.k3 = of[4];
  }
  return AddCamera(project.contact->setup, camera);
}

MountedTag ReadTag(const YamlValue& value, Project& project) {
  value.ExpectKeys(
      {"name", "link", "xyz_mm", "rpy_deg", "size_mm", "mounting_sd_mm", "mounting_sd_deg"});
  TagSetup tag;
  tag.name = value.Get("name").Text();
  tag.link = OptionalLink(value, project.tree);
  tag.T_parent = PoseFromMm(value);
  tag.size = kOneMm * value.Get("size_mm").Bounded();
  value.ReadBounded("mounting_sd_mm", tag.mounting_sd_m, kOneMm);
  value.ReadBounded("mounting_sd_deg", tag.mounting_sd_rad, kOneDegree);
  return AddTag(project.contact->setup, tag);
}

}  // namespace

void ReadCameras(const YamlValue& section, Project& project) {
  std::vector<MountedCamera> cameras;
  std::vector<MountedTag> tags;
  const auto check = [](const YamlValue& value, const char* what, const auto& known) {
    for (const auto& other : known) {
      if (other.of.name != value.Get("name").Text()) continue;
      value.Get("name").Fail(std::string("a second ") + what + " of the name " +
                             Quote(other.of.name));
    }
  };
  for (const YamlValue& value : InstrumentList(section, "cameras")) {
    check(value, "camera", cameras);
    cameras.push_back(ReadCamera(value, project));
  }
  for (const YamlValue& value : InstrumentList(section, "tags")) {
    check(value, "tag", tags);
    check(value, "thing", cameras);
    tags.push_back(ReadTag(value, project));
  }
  section.Expect(cameras.empty() == tags.empty(), "both cameras and tags, or neither");
  section.Expect(cameras.size() * tags.size() <= kMostInstruments, "at most 1000 views of tags");
  for (const MountedCamera& camera : cameras) {
    for (const MountedTag& tag : tags) {
      ContactProject& contact = *project.contact;
      contact.seen_tags.push_back(
          {camera.of.name, tag.of.name, static_cast<int>(contact.setup.instruments.size())});
      AddSeenTag(contact.setup, camera, tag);
      contact.columns.emplace_back();
    }
  }
}

}  // namespace elastocal
