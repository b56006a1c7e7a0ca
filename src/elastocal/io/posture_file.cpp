// SPDX-License-Identifier: Apache-2.0
#include "elastocal/io/posture_file.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/project/project_sections.hpp"
#include "elastocal/robot/coordinates.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

constexpr double kBeyond = 1e-6;  // rad or m beyond a limit, by rounding of the file

/// A name as YAML text, in quotes.
std::string Quoted(const std::string& name) {
  std::string text = "\"";
  for (char c : name) {
    if (c == '"' || c == '\\') text += '\\';
    text += c;
  }
  return text + "\"";
}

Eigen::VectorXd ReadPosture(const YamlValue& value, const Project& project) {
  const RobotTree& tree = project.tree;
  Eigen::VectorXd q = project.motion.rest;
  for (const auto& [name, position] : value.Entries()) {
    const int joint = DriverNamedBy(name, position, tree);
    const JointLimits& limits = tree.joints[joint].limits;
    const double wanted = position.Bounded();
    position.Expect(wanted >= limits.lower - kBeyond && wanted <= limits.upper + kBeyond,
                    "a position within the joint's limits, " + FormatNumber(limits.lower) + " to " +
                        FormatNumber(limits.upper));
    q[tree.joints[joint].coordinate] = wanted;
  }
  return q;
}

/// The name of a chain, of a plate, or kLooks.
std::string NameOfSet(const YamlValue& value, const Project& project) {
  if (!project.contact) return project.chains[ChainNamedBy(value, project)].name;
  const std::string name = value.Text();
  std::vector<std::string> known = {kLooks};
  for (const ContactPlate& plate : project.contact->setup.plates) known.push_back(plate.name);
  for (const Chain& chain : project.chains) known.push_back(chain.name);
  if (std::find(known.begin(), known.end(), name) != known.end()) return name;
  value.Fail("there is no plate or chain " + Quote(name) + DidYouMean(name.substr(0, 60), known));
}

}  // namespace

std::string FormatPostureFile(const RobotTree& tree, const std::vector<ChainPostures>& chains) {
  std::string text = fmt::format("robot: {}\nchains:\n", Quoted(tree.name));
  for (const ChainPostures& chain : chains) {
    text += fmt::format("  - name: {}\n    support: [", Quoted(chain.chain));
    for (std::size_t i = 0; i < chain.support.size(); ++i) {
      text += (i > 0 ? ", " : "") + Quoted(tree.links[chain.support[i]].name);
    }
    text += "]\n    postures:\n";
    for (const Eigen::VectorXd& q : chain.q) {
      text += "      - {";
      for (int i = 0; i < tree.coordinate_count(); ++i) {
        text += fmt::format("{}{}: {:.12g}", i > 0 ? ", " : "",
                            Quoted(JointOfCoordinate(tree, i).name), q[i]);
      }
      text += "}\n";
    }
  }
  return text;
}

std::vector<ChainPostures> ReadPostureFile(const std::filesystem::path& file,
                                           const Project& project) {
  return ParsePostureFile(ReadFile(file), file.string(), project);
}

std::vector<ChainPostures> ParsePostureFile(const std::string& text, const std::string& source,
                                            const Project& project) {
  const YamlValue root = YamlValue::Parse(text, source);
  root.ExpectKeys({"robot", "chains"});
  std::vector<ChainPostures> chains;
  for (const YamlValue& value : root.Get("chains").Items()) {
    value.ExpectKeys({"name", "support", "postures"});
    ChainPostures chain;
    chain.chain = NameOfSet(value.Get("name"), project);
    if (const auto support = value.Find("support")) {
      chain.support = LinksNamedBy(*support, project.tree);
    }
    for (const YamlValue& posture : value.Get("postures").Items()) {
      chain.q.push_back(ReadPosture(posture, project));
    }
    if (chain.q.empty()) value.Fail("the chain has no posture");
    chains.push_back(std::move(chain));
  }
  if (chains.empty()) root.Fail("there are no chains in it");
  return chains;
}

JointMotion ListPostures(const std::vector<ChainPostures>& chains, const std::string& source) {
  JointMotion motion;
  motion.source = source;
  std::vector<Eigen::VectorXd> rows;
  for (const ChainPostures& chain : chains) {
    for (const Eigen::VectorXd& q : chain.q) {
      rows.push_back(q);
      motion.support.push_back(chain.support);
    }
  }
  motion.q.resize(static_cast<Eigen::Index>(rows.size()), rows.empty() ? 0 : rows[0].size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    motion.q.row(static_cast<Eigen::Index>(i)) = rows[i].transpose();
  }
  return motion;
}

}  // namespace elastocal
