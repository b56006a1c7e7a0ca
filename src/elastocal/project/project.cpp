// SPDX-License-Identifier: Apache-2.0
#include "elastocal/project/project.hpp"

#include <algorithm>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/project/project_sections.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

bool Contains(const std::vector<int>& values, int value) {
  return std::find(values.begin(), values.end(), value) != values.end();
}

/// The path that a file names, as seen from the project file.
std::filesystem::path Resolve(const std::filesystem::path& project_file, const std::string& path) {
  return (project_file.parent_path() / path).lexically_normal();
}

void ReadRobot(const YamlValue& section, Project& project) {
  section.ExpectKeys({"urdf"});
  const YamlValue urdf = section.Get("urdf");
  if (urdf.Text().find("://") != std::string::npos) {
    urdf.Fail("found " + Quote(urdf.Text()) +
              "; package:// and other URIs are not resolved: a path, seen from the project file, "
              "was expected");
  }
  project.urdf = Resolve(project.file, urdf.Text());
  std::error_code error;
  if (!std::filesystem::exists(project.urdf, error) && !error) {
    urdf.Fail("there is no file " + project.urdf.string());
  }
  project.tree = ReadUrdf(project.urdf);
}

void CheckChain(const YamlValue& value, const Chain& chain, const RobotTree& tree) {
  const Link& from = tree.links[chain.from_link];
  const Link& tip = tree.links[chain.tip_link];
  if (from.body == tip.body) {
    value.Fail("no joint moves link " + Quote(tip.name) + " against link " + Quote(from.name));
  }
  if (from.body > 0 && !Contains(JointsToBody(tree, tip.body), from.body - 1)) {
    value.Fail("link " + Quote(from.name) + " does not carry link " + Quote(tip.name));
  }
}

void ReadChains(const YamlValue& section, Project& project) {
  for (const YamlValue& value : section.Items()) {
    value.ExpectKeys({"name", "from", "tip"});
    Chain chain;
    CheckFileName(value.Get("name"));
    chain.name = NewName(value.Get("name"), "chain", project.chains);
    if (const auto from = value.Find("from")) chain.from_link = LinkNamedBy(*from, project.tree);
    chain.tip_link = LinkNamedBy(value.Get("tip"), project.tree);
    CheckChain(value, chain, project.tree);
    project.chains.push_back(std::move(chain));
  }
}

/// Checks the patterns of held parameters, which is possible only when joints and markers are
/// known.
void CheckHeld(const YamlValue& section, const Project& project) {
  const auto hold = section.Find("hold");
  if (!hold || project.identifiability.hold.empty() || project.contact) return;
  const ErrorModel model = MakeErrorModel(project.tree, project.markers, project.placement);
  for (const YamlValue& pattern : hold->Items()) {
    const std::string text = pattern.Text();
    FindNamedBy(pattern, [&] { CheckPatterns(model.parameters, {text}); });
  }
}

void ReadSettings(const YamlValue& root, Project& project) {
  if (const auto section = root.Find("placement")) {
    ReadPlacementOptions(*section, project.placement);
  }
  if (const auto section = root.Find("measurement")) {
    ReadMeasurementOptions(*section, project.measurement);
  }
  if (const auto section = root.Find("identifiability")) {
    ReadIdentifiabilityOptions(*section, project.identifiability);
    CheckHeld(*section, project);
  }
  if (const auto section = root.Find("elasticity")) ReadElasticity(*section, project);
  if (const auto section = root.Find("standing")) ReadStanding(*section, project);
  if (const auto section = root.Find("calibration")) {
    ReadCalibrationOptions(*section, project.tree, project.calibration);
  }
  SetMotionDefaults(project);
  if (const auto section = root.Find("collision")) ReadCollision(*section, project);
  if (const auto section = root.Find("design")) ReadDesign(*section, project);
  CarryRest(project);
}

/// Index of a named item of the project. Throws InputError, which proposes a similar name.
template <typename Item>
int FindNamed(const std::vector<Item>& items, const std::string& kind, const Project& project,
              const std::string& name) {
  std::vector<std::string> known;
  for (const Item& item : items) known.push_back(item.name);
  const auto found = std::find(known.begin(), known.end(), name);
  if (found == known.end()) {
    throw InputError("there is no " + kind + " " + Quote(name) + " in " + project.file.string() +
                     DidYouMean(name.substr(0, 60), known));
  }
  return static_cast<int>(found - known.begin());
}

}  // namespace

void CheckFileName(const YamlValue& name) {
  constexpr const char* kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.-";
  const std::string text = name.Text();
  name.Expect(text.find_first_not_of(kPlain) == std::string::npos && text != "." && text != "..",
              "a name that can name a file: letters without accents, digits, '_', '.' and '-'");
}

int LinkNamedBy(const YamlValue& value, const RobotTree& tree) {
  const std::string name = value.Text();
  return FindNamedBy(value, [&] { return FindLink(tree, name); });
}

std::vector<int> LinksNamedBy(const YamlValue& list, const RobotTree& tree) {
  std::vector<int> links;
  for (const YamlValue& value : list.Items()) links.push_back(LinkNamedBy(value, tree));
  return links;
}

int JointNamedBy(const YamlValue& value, const RobotTree& tree) {
  const std::string name = value.Text();
  return FindNamedBy(value, [&] { return FindJoint(tree, name); });
}

int DriverNamedBy(const std::string& name, const YamlValue& value, const RobotTree& tree) {
  const int joint = FindNamedBy(value, [&] { return FindJoint(tree, name); });
  if (tree.joints[joint].mimic) {
    const int driver = tree.coordinate_joint[tree.joints[joint].coordinate];
    value.Fail("joint " + Quote(name) + " follows joint " + Quote(tree.joints[driver].name) +
               "; name that one");
  }
  return joint;
}

int ChainNamedBy(const YamlValue& value, const Project& project) {
  const std::string name = value.Text();
  return FindNamedBy(value, [&] { return FindChain(project, name); });
}

int FindChain(const Project& project, const std::string& name) {
  return FindNamed(project.chains, "chain", project, name);
}

int FindCluster(const Project& project, const std::string& name) {
  return FindNamed(project.clusters, "cluster", project, name);
}

Project ReadProject(const std::filesystem::path& file) {
  return ParseProject(ReadFile(file), file);
}

Project ParseProject(const std::string& text, const std::filesystem::path& file) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  std::string_view beginning = text;
  if (beginning.starts_with(kByteOrderMark)) beginning.remove_prefix(kByteOrderMark.size());
  if (Trim(beginning).starts_with('<')) {
    throw InputError(Place(file.string(), 1) +
                     "this is XML; a project file (YAML) was expected "
                     "(`elastocal init` drafts one from a robot description)");
  }
  const YamlValue root = YamlValue::Parse(text, file.string());
  root.ExpectKeys({"robot", "couplings", "linkages", "chains", "markers", "torque_sensors",
                   "force_torque_sensors", "recording", "placement", "measurement",
                   "identifiability", "calibration", "elasticity", "collision", "design",
                   "standing", "contact", "instruments"});
  Project project;
  project.file = file;
  ReadRobot(root.Get("robot"), project);
  if (const auto section = root.Find("couplings")) ReadCouplings(*section, project);
  const auto contact = root.Find("contact");
  const auto instruments = root.Find("instruments");
  if (const auto section = root.Find("linkages")) {
    if (contact || instruments) {
      section->Fail("linkages are not known together with " +
                    std::string(contact ? "contact" : "instruments") +
                    "; markers were expected alone");
    }
    ReadLinkages(*section, project);
  }
  if (const auto section = root.Find("chains")) ReadChains(*section, project);
  if (const auto section = root.Find("markers")) {
    ReadMarkers(*section, project);
  } else if (!contact && !instruments) {
    root.Get("markers");
  }
  if (const auto section = root.Find("torque_sensors")) ReadTorqueSensors(*section, project);
  if (const auto section = root.Find("force_torque_sensors")) {
    ReadForceTorqueSensors(*section, project);
  }
  if (const auto section = root.Find("recording")) ReadRecordingColumns(*section, project);
  if (contact) ReadContact(*contact, instruments || !project.markers.empty(), project);
  if (instruments) ReadInstruments(*instruments, project);
  if (project.contact && !project.markers.empty()) ObserveMarkers(project);
  ReadSettings(root, project);
  return project;
}

std::vector<MarkerCluster> RigidClusters(const Project& project) {
  std::vector<char> in_cluster(project.markers.size(), 0);
  for (const MarkerCluster& cluster : project.clusters) {
    for (const int m : cluster.markers) in_cluster[static_cast<std::size_t>(m)] = 1;
  }
  std::vector<MarkerCluster> clusters;
  for (std::size_t m = 0; m < project.markers.size(); ++m) {
    if (in_cluster[m] != 0) continue;
    const int link = project.markers[m].link;
    auto of_link = std::ranges::find(clusters, link, &MarkerCluster::link);
    if (of_link == clusters.end()) {
      std::string name = project.tree.links[static_cast<std::size_t>(link)].name;
      const auto is_taken = [&](const MarkerCluster& one) { return one.name == name; };
      while (std::ranges::any_of(project.clusters, is_taken) ||
             std::ranges::any_of(clusters, is_taken)) {
        name += "_single";
      }
      of_link = clusters.insert(clusters.end(), {name, link, {}});
    }
    of_link->markers.push_back(static_cast<int>(m));
  }
  std::erase_if(clusters, [](const MarkerCluster& one) { return one.markers.size() < 2; });
  clusters.insert(clusters.begin(), project.clusters.begin(), project.clusters.end());
  return clusters;
}

std::vector<std::string> ChainMarkers(const Project& project, const Chain& chain) {
  const RobotTree& tree = project.tree;
  std::vector<int> joints = JointsToBody(tree, tree.links[chain.tip_link].body);
  // Of the joints to the tip, only those after the body of `from` count.
  const auto from = std::find(joints.begin(), joints.end(), tree.links[chain.from_link].body - 1);
  if (from != joints.end()) joints.erase(joints.begin(), from + 1);
  std::vector<std::string> names;
  for (const Marker& marker : project.markers) {
    if (Contains(joints, tree.links[marker.link].body - 1)) names.push_back(marker.name);
  }
  return names;
}

}  // namespace elastocal
