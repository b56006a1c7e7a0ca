// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/drafting/draft.hpp"
#include "elastocal/files/yaml_word.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

/// A length in mm without decimals; never "-0".
std::string Mm(double metres) { return fmt::format("{:.0f}", std::round(metres * 1e3) + 0.0); }

template <typename Point>
std::string MmList(const Point& p) {
  std::string text;
  for (Eigen::Index i = 0; i < p.size(); ++i) text += (i == 0 ? "" : ", ") + Mm(p[i]);
  return "[" + text + "]";
}

class DraftWriter {
 public:
  explicit DraftWriter(const ProjectDraft& draft) : draft_(draft), tree_(draft.tree) {}

  std::string Write(const std::string& urdf) {
    text_ = fmt::format(
        "# Drafted by elastocal init. Everything here follows from the robot description and from\n"
        "# rules; look at it, correct what is wrong, and measure where the markers really are.\n"
        "# docs/formats.md explains each key. Lengths in mm, angles in degrees, positions in the\n"
        "# frame of the link named. Settings left out have their default values.\n\n"
        "robot: {{urdf: {}}}\n\n",
        YamlWord(urdf));
    WriteChains();
    WriteMarkers();
    text_ +=
        "# Joints with a torque sensor are not in a URDF. List them here; without them, statics\n"
        "# give the torques.\n# torque_sensors: [" +
        YamlWord(tree_.joints[Size(LimbJoint())].name) + "]\n\n";
    WriteSpheres();
    WriteDesign();
    WriteSoles();
    return text_;
  }

 private:
  /// A joint for an example: of an arm or a leg if there is one, never of a wheel.
  int LimbJoint() const {
    for (const Limb& limb : draft_.limbs.limbs) {
      if (limb.mirror >= 0 && !limb.joints.empty()) return limb.joints.back();
    }
    return draft_.limbs.limbs.empty() ? 0 : draft_.limbs.limbs.front().joints.back();
  }

  const std::string& LinkName(int link) const { return tree_.links[Size(link)].name; }

  void WriteChains() {
    text_ +=
        "# Limbs of the robot, from the link `from` (default: the root link) to the link `tip`.\n"
        "chains:\n";
    for (const DraftedChain& chain : draft_.chains) {
      const std::string from =
          chain.from_link == 0 ? "" : "from: " + YamlWord(LinkName(chain.from_link)) + ", ";
      text_ += fmt::format("  - {{name: {}, {}tip: {}}}\n", YamlWord(chain.name), from,
                           YamlWord(LinkName(chain.tip_link)));
    }
    text_ += "\n";
  }

  void WriteMarkers() {
    text_ += fmt::format(
        "# Clusters of three: {} markers, at places on the links' shapes where cameras see them, "
        "no\n"
        "# two distances in a cluster alike. Put yours where it suits and correct the positions "
        "to\n"
        "# about 10 mm; calibration estimates them.\n"
        "markers:\n  reference: {}  # on the root link\n  clusters:\n",
        3 * draft_.clusters.size(), YamlWord(draft_.clusters[0].name));
    for (const DraftedCluster& cluster : draft_.clusters) {
      text_ +=
          fmt::format("    - {{name: {}, link: {}, positions_mm: [{}, {}, {}]}}{}\n",
                      YamlWord(cluster.name), YamlWord(LinkName(BodyLink(tree_, cluster.body))),
                      MmList(cluster.points[0]), MmList(cluster.points[1]),
                      MmList(cluster.points[2]), cluster.guessed ? "  # guessed: no shape" : "");
    }
    text_ += "\n";
  }

  void WriteSpheres() {
    text_ += fmt::format(
        "# {} spheres that cover the links, to keep limbs apart.\n"
        "collision:\n  margin_mm: {}\n  spheres:\n",
        draft_.spheres.size(), Mm(draft_.sphere_margin));
    for (const CollisionSphere& sphere : draft_.spheres) {
      const int body = tree_.links[Size(sphere.link)].body;
      text_ += fmt::format("    - {{name: {}, link: {}, centre_mm: {}, radius_mm: {}}}{}\n",
                           YamlWord(sphere.name), YamlWord(LinkName(sphere.link)),
                           MmList(sphere.p_link_centre), Mm(sphere.radius),
                           draft_.shapes.bodies[Size(body)].guessed ? "  # guessed" : "");
    }
    text_ += "\n";
  }

  void WriteRest() {
    text_ += "  # The posture of rest: " + draft_.rest.source + ".\n";
    std::string list;
    for (int c = 0; c < tree_.coordinate_count(); ++c) {
      const Joint& joint = tree_.joints[Size(tree_.coordinate_joint[Size(c)])];
      const bool turns = joint.type == JointType::kRevolute;
      // The reader moves positions that are left out from zero into the limits.
      const double value = draft_.rest.q[c] / (turns ? kRadiansPerDegree : kMetresPerMm);
      if (std::abs(value) < 5e-4) continue;
      list += fmt::format("    {}: {:.3f}{}\n", YamlWord(joint.name), value, turns ? "" : "  # mm");
    }
    text_ += list.empty() ? "" : "  rest_deg:\n" + list;
  }

  void WriteRanges() {
    if (draft_.ranges.empty() && draft_.bent_ranges.empty()) return;
    text_ += "  range_deg:\n";
    const auto write = [&](const auto& ranges, const char* why) {
      for (const auto& [c, range] : ranges) {
        const Joint& joint = tree_.joints[Size(tree_.coordinate_joint[Size(c)])];
        const double unit = joint.type == JointType::kRevolute ? kRadiansPerDegree : kMetresPerMm;
        text_ += fmt::format("    {}: [{:.1f}, {:.1f}]  # {}\n", YamlWord(joint.name),
                             range[0] / unit, range[1] / unit, why);
      }
    };
    write(draft_.ranges, "beyond, feet could not stay on the floor");
    write(draft_.bent_ranges, "a straighter limb leaves no room for corrections");
  }

  void WriteRoom() {
    if (draft_.room.empty()) return;
    text_ += "  room_deg:  # free at the limits of joints, for later corrections of commands\n";
    for (const auto& [c, room] : draft_.room) {
      const Joint& joint = tree_.joints[Size(tree_.coordinate_joint[Size(c)])];
      text_ += fmt::format("    {}: {:.0f}\n", YamlWord(joint.name), room / kRadiansPerDegree);
    }
  }

  void WriteDesign() {
    text_ += "# What the calibration postures keep to, chain by chain.\ndesign:\n";
    WriteRest();
    WriteRanges();
    WriteRoom();
    text_ += fmt::format("  effort_share: {}  # of the URDF's effort; plan moves within {} of it\n",
                         kDraftedEffort, draft_.motion_effort_share);
    if (draft_.motion_effort_share != MotionSetup{}.motion_effort_share) {
      text_ += fmt::format("  motion_effort_share: {}  # with less, it could not lift a foot\n",
                           draft_.motion_effort_share);
    }
    text_ += "  chains:\n";
    for (const ChainSetup& setup : draft_.designs) WriteSetup(setup);
    text_ += "\n";
  }

  void WriteSetup(const ChainSetup& setup) {
    text_ += fmt::format("    - chain: {}\n", YamlWord(setup.name));
    if (!setup.mirror.empty()) text_ += fmt::format("      mirror: {}\n", YamlWord(setup.mirror));
    if (!setup.support.empty()) {
      std::string feet;
      for (const int link : setup.support)
        feet += (feet.empty() ? "" : ", ") + YamlWord(LinkName(link));
      text_ += fmt::format("      support: [{}]\n", feet);
    }
    if (setup.box) {
      text_ +=
          fmt::format("      box_mm: {{lower: {}, upper: {}}}  # of the tip, from the root link\n",
                      MmList(setup.box->lower), MmList(setup.box->upper));
    }
    if (setup.largest_turn < 0.999 * M_PI) {
      text_ += fmt::format("      cone_deg: {:.0f}\n", setup.largest_turn / kRadiansPerDegree);
    }
    if (setup.floor_z) {
      text_ += fmt::format("      floor_mm: {}  # a little above the soles\n", Mm(*setup.floor_z));
    }
    if (setup.contacts.empty()) return;
    text_ += "      contacts:\n";
    for (const auto& [a, b] : setup.contacts) {
      text_ += fmt::format("        - [{}, {}]\n", YamlWord(draft_.spheres[Size(a)].name),
                           YamlWord(draft_.spheres[Size(b)].name));
    }
  }

  void WriteSoles() {
    if (!draft_.stands) {
      text_ += draft_.soles.empty() ? "# No legs were found: the root link is held still.\n"
                                    : "# The root link is held still, for instance on a stand: " +
                                          draft_.held_because + ".\n";
      return;
    }
    text_ +=
        "# The undersides of the feet: x ahead, y to the left, z upwards in the link's frame; or\n"
        "# balls about the link's origin.\n"
        "standing:\n  soles:\n";
    for (const DraftedSole& sole : draft_.soles) {
      std::string note = sole.added ? "  # the link was added to the copy of the URDF" : "";
      if (sole.guessed_height) {
        note += "; height and size are guesses, measure them";
      } else if (sole.guessed_size) {
        note += note.empty() ? "  # the size is a guess, measure it" : "; the size is a guess";
      }
      text_ += sole.ball_radius
                   ? fmt::format("    - {{link: {}, ball_radius_mm: {}}}{}\n", YamlWord(sole.link),
                                 Mm(*sole.ball_radius), note)
                   : fmt::format("    - {{link: {}, lower_mm: {}, upper_mm: {}}}{}\n",
                                 YamlWord(sole.link), MmList(sole.lower), MmList(sole.upper), note);
    }
    if (draft_.stance) {
      text_ +=
          fmt::format("  stance_mm: {:.0f}  # wider than in the zero posture: room for errors\n",
                      *draft_.stance / kMetresPerMm);
    }
  }

  const ProjectDraft& draft_;
  const RobotTree& tree_;
  std::string text_;
};

}  // namespace

std::string FormatDraft(const ProjectDraft& draft, const std::string& urdf) {
  return DraftWriter(draft).Write(urdf);
}

void RequireReadable(const ProjectDraft& draft, const std::filesystem::path& file,
                     const std::filesystem::path& urdf) {
  try {
    ParseProject(FormatDraft(draft, std::filesystem::absolute(urdf).string()), file);
  } catch (const InputError& error) {
    throw InputError("the draft of " + Quote(draft.tree.name) +
                     " is no project that can be read, so nothing is written (" + error.what() +
                     "); please report this with the robot description");
  }
}

std::string FormatDraftSummary(const ProjectDraft& draft) {
  using Json = nlohmann::ordered_json;
  Json chains = Json::array(), designs = Json::array(), soles = Json::array();
  for (const DraftedChain& chain : draft.chains) {
    chains.push_back({{"name", chain.name},
                      {"from", draft.tree.links[Size(chain.from_link)].name},
                      {"tip", draft.tree.links[Size(chain.tip_link)].name}});
  }
  for (const ChainSetup& setup : draft.designs) {
    designs.push_back(
        {{"chain", setup.name}, {"mirror", setup.mirror}, {"contacts", setup.contacts.size()}});
  }
  for (const DraftedSole& sole : draft.soles) {
    soles.push_back({{"link", sole.link},
                     {"added", sole.added},
                     {"guessed_size", sole.guessed_size},
                     {"guessed_height", sole.guessed_height}});
  }
  const Json json = {{"robot", draft.tree.name},
                     {"chains", chains},
                     {"markers", 3 * draft.clusters.size()},
                     {"spheres", draft.spheres.size()},
                     {"meshes", draft.shapes.meshes},
                     {"rest", draft.rest.source},
                     {"stands", draft.stands},
                     {"soles", soles},
                     {"stance_mm", draft.stance ? Json(*draft.stance / kMetresPerMm) : Json()},
                     {"design", designs},
                     {"warnings", draft.warnings}};
  return JsonText(json);
}

}  // namespace elastocal
