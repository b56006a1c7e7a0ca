// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/draft.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include <fmt/format.h>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/drafting/arm_rest.hpp"
#include "elastocal/drafting/draft_room.hpp"
#include "elastocal/drafting/root_attitude.hpp"
#include "elastocal/drafting/standing_draft.hpp"
#include "elastocal/drafting/workspaces.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/posture/chain_problem.hpp"
#include "elastocal/posture/mirror.hpp"
#include "elastocal/robot/moving_chain.hpp"
#include "elastocal/robot/physical_inertia.hpp"
#include "elastocal/tables/text.hpp"

namespace elastocal {
namespace {

const DraftedSole* SoleOf(const ProjectDraft& draft, int limb) {
  for (const DraftedSole& sole : draft.soles) {
    if (sole.limb == limb) return &sole;
  }
  return nullptr;
}

/// Finds the limbs' tips in the tree with all soles.
void NameTips(const RobotTree& before, ProjectDraft& draft) {
  for (std::size_t i = 0; i < draft.limbs.limbs.size(); ++i) {
    Limb& limb = draft.limbs.limbs[i];
    const DraftedSole* sole = SoleOf(draft, static_cast<int>(i));
    limb.tip_link =
        FindLink(draft.tree, sole != nullptr ? sole->link : before.links[Size(limb.tip_link)].name);
  }
  for (int b = 0; b < draft.tree.body_count(); ++b) {
    draft.shapes.bodies[Size(b)].link = BodyLink(draft.tree, b);
  }
}

/// Name of the part that carries limbs which do not begin on the root link: torso for arms, waist
/// for legs.
std::string TrunkName(const Limb& limb) { return limb.leg ? "waist" : "torso"; }

/// Name of the chain of a limb from the root link.
std::string WholeName(const Limb& limb) {
  return limb.from_body == 0 ? limb.name : TrunkName(limb) + "_" + limb.name;
}

/// The name, with a number where a chain has it already: a neck with two ears is a trunk as well
/// as the waist is.
std::string FreeName(const ProjectDraft& draft, const std::string& name) {
  std::string free = name;
  const auto taken = [&](const DraftedChain& chain) { return chain.name == free; };
  for (int number = 2; std::ranges::any_of(draft.chains, taken); ++number) {
    free = name + "_" + std::to_string(number);
  }
  return free;
}

/// Adds the chains. Limbs on a moving trunk have two: one of their own joints, and one from the
/// root link. A limb without mirror image is one chain from the root link; a trunk without a head
/// is a chain itself.
void AddChains(ProjectDraft& draft) {
  std::vector<std::pair<int, std::string>> trunks;  // bodies, with the names of their chains
  std::set<int> done;
  for (const Limb& limb : draft.limbs.limbs) {
    if (limb.from_body != 0 && limb.mirror >= 0) {
      draft.chains.push_back({limb.name, BodyLink(draft.tree, limb.from_body), limb.tip_link});
      const std::pair<int, std::string> trunk(limb.from_body, TrunkName(limb));
      if (std::find(trunks.begin(), trunks.end(), trunk) == trunks.end()) trunks.push_back(trunk);
    } else if (limb.from_body != 0) {
      done.insert(limb.from_body);
    }
    draft.chains.push_back({WholeName(limb), 0, limb.tip_link});
  }
  for (const auto& [body, name] : trunks) {
    if (done.contains(body)) continue;
    draft.chains.push_back({FreeName(draft, name), 0, BodyLink(draft.tree, body), true});
  }
}

std::vector<int> Feet(const ProjectDraft& draft, int without) {
  std::vector<int> feet;
  if (!draft.stands) return feet;
  for (const DraftedSole& sole : draft.soles) {
    if (sole.limb != without) feet.push_back(draft.limbs.limbs[Size(sole.limb)].tip_link);
  }
  return feet;
}

ChainSetup SetupOf(const ProjectDraft& draft, const std::string& name, int from, int tip) {
  ChainSetup setup;
  setup.name = name;
  setup.from_link = from;
  setup.tip_link = tip;
  setup.coordinates = ChainCoordinates(draft.tree, from, tip);
  return setup;
}

/// The part of the draft that is needed to mirror a set-up.
MotionSetup MotionOf(const ProjectDraft& draft) {
  MotionSetup motion;
  motion.rest = draft.rest.q;
  motion.spheres = draft.spheres;
  return motion;
}

/// Whether mirrored postures of a set-up are postures of the limb on the other side.
bool CanBeMirrored(const ProjectDraft& draft, const ChainSetup& setup, const DraftedChain& other) {
  constexpr double kSameLimit = 0.02;
  const std::vector<int> there = ChainCoordinates(draft.tree, other.from_link, other.tip_link);
  const auto map = FindMirror(draft.tree, setup.coordinates, there);
  if (!map) return false;
  for (std::size_t i = 0; i < there.size(); ++i) {
    const auto limits = [&](int c) {
      return draft.tree.joints[Size(draft.tree.coordinate_joint[Size(c)])].limits;
    };
    const double sign = map->sign[static_cast<Eigen::Index>(i)];
    const JointLimits here = limits(setup.coordinates[i]), image = limits(there[i]);
    const double lower = sign > 0.0 ? image.lower : -image.upper;
    const double upper = sign > 0.0 ? image.upper : -image.lower;
    // The difference of equal infinities is NaN.
    if (here.lower != lower && !(std::abs(here.lower - lower) < kSameLimit)) return false;
    if (here.upper != upper && !(std::abs(here.upper - upper) < kSameLimit)) return false;
  }
  std::string reason;
  return MirrorSetup(draft.tree, MotionOf(draft), setup, other.name, other.from_link,
                     other.tip_link, &reason)
      .has_value();
}

/// Adds a set-up with its workspace for each limb.
void AddSetups(ProjectDraft& draft) {
  const bool legged = !draft.soles.empty();
  for (std::size_t i = 0; i < draft.limbs.limbs.size(); ++i) {
    const Limb& limb = draft.limbs.limbs[i];
    const bool paired = limb.mirror >= 0;
    ChainSetup setup = SetupOf(draft, paired ? limb.name : WholeName(limb),
                               paired ? BodyLink(draft.tree, limb.from_body) : 0, limb.tip_link);
    setup.support = Feet(draft, limb.leg ? static_cast<int>(i) : -1);
    if (limb.leg && draft.stands) SetLegWorkspace(draft.tree, limb, draft.rest, setup);
    const bool arm = !limb.leg && (paired || limb.from_body == 0) && limb.joints.size() > 2;
    if (arm) SetArmWorkspace(draft.tree, limb, draft.rest, legged, setup);
    draft.designs.push_back(std::move(setup));
  }
  for (const DraftedChain& chain : draft.chains) {
    if (!chain.trunk) continue;
    draft.designs.push_back(SetupOf(draft, chain.name, 0, chain.tip_link));
    draft.designs.back().support = Feet(draft, -1);
  }
}

/// Largest deviation of the palm's direction from that at rest, so that cameras see its markers.
constexpr double kCone = 60.0 * kRadiansPerDegree;

/// Holds the arms of a robot on legs ahead, unless the SRDF has named postures.
void HoldArmsAhead(ProjectDraft& draft, const Semantics& semantics) {
  if (!semantics.states.empty() || draft.soles.empty()) return;
  bool held = false;
  for (ChainSetup& setup : draft.designs) {
    const auto limb = std::find_if(draft.limbs.limbs.begin(), draft.limbs.limbs.end(),
                                   [&](const Limb& l) { return l.tip_link == setup.tip_link; });
    if (limb == draft.limbs.limbs.end() || limb->leg || !setup.box) continue;
    const Limb* other = limb->mirror < 0 ? nullptr : &draft.limbs.limbs[Size(limb->mirror)];
    const bool second = other != nullptr && other < &*limb;
    const auto coordinates = other == nullptr
                                 ? std::vector<int>()
                                 : ChainCoordinates(draft.tree, setup.from_link, other->tip_link);
    const auto map = second ? FindMirror(draft.tree, coordinates, setup.coordinates) : std::nullopt;
    if (map) {
      const auto range = RangesOf(draft.tree, 0.021);
      for (std::size_t i = 0; i < coordinates.size(); ++i) {
        const int c = setup.coordinates[i];
        const double image = map->sign[static_cast<Eigen::Index>(i)] * draft.rest.q[coordinates[i]];
        draft.rest.q[c] = std::clamp(image, range.first[c], range.second[c]);
      }
      setup.largest_turn = kCone;
      continue;
    }
    const auto pairs = PairsMovedBy(draft.tree, draft.spheres, setup.coordinates, semantics);
    if (!HoldAhead(draft.tree, draft.spheres, pairs, setup, draft.sphere_margin, draft.bent_ranges,
                   draft.rest.q)) {
      continue;
    }
    setup.largest_turn = kCone;
    held = true;
  }
  if (held) draft.rest.source += ", the hands ahead";
}

void AddContacts(ProjectDraft& draft, const Semantics& semantics) {
  const std::vector<Eigen::VectorXd> rests = RestingPostures(draft);
  std::set<SpherePair> touching;  // of mirrored chains, once
  for (ChainSetup& setup : draft.designs) {
    const auto candidates = PairsMovedBy(draft.tree, draft.spheres, setup.coordinates, semantics);
    ContactSearch search =
        FindContacts(draft.tree, draft.spheres, candidates, rests, setup, draft.sphere_margin);
    setup.contacts = std::move(search.pairs);
    touching.insert(search.touching_at_rest.begin(), search.touching_at_rest.end());
  }
  if (touching.empty()) return;
  constexpr std::size_t kNamed = 6;
  std::string names;
  std::size_t named = 0;
  for (const auto& [a, b] : touching) {
    if (++named > kNamed) break;
    names += (names.empty() ? "" : ", ") + draft.spheres[Size(a)].name + " and " +
             draft.spheres[Size(b)].name;
  }
  if (touching.size() > kNamed) {
    names += " and " + std::to_string(touching.size() - kNamed) + " pairs more";
  }
  draft.warnings.push_back("spheres that touch in the posture of rest are not checked: " + names);
}

/// Of two limbs that are mirror images, keeps the set-up of the first one for both.
void JoinMirrors(ProjectDraft& draft) {
  std::vector<ChainSetup> joined;
  std::vector<std::string> mirrored;
  for (ChainSetup setup : draft.designs) {
    if (std::find(mirrored.begin(), mirrored.end(), setup.name) != mirrored.end()) continue;
    for (const Limb& limb : draft.limbs.limbs) {
      if (limb.name != setup.name || limb.mirror < 0) continue;
      const Limb& other = draft.limbs.limbs[Size(limb.mirror)];
      const DraftedChain image{other.name, BodyLink(draft.tree, other.from_body), other.tip_link};
      const bool first = std::none_of(joined.begin(), joined.end(), [&](const ChainSetup& before) {
        return before.name == image.name;
      });
      if (first && CanBeMirrored(draft, setup, image)) {
        setup.mirror = image.name;
        mirrored.push_back(image.name);
      }
    }
    joined.push_back(std::move(setup));
  }
  draft.designs = std::move(joined);
}

/// Names the joints of toes, which lie beyond the feet.
void WarnOfToes(ProjectDraft& draft) {
  std::string names;
  for (const int toe : draft.limbs.toes) {
    names += (names.empty() ? "" : ", ") + Quote(draft.tree.joints[Size(toe - 1)].name);
  }
  if (names.empty()) return;
  draft.warnings.push_back(
      "soles are those of the feet without toes, and the joints of toes are not calibrated but "
      "stay at rest: " +
      names);
}

void WarnOfGuesses(ProjectDraft& draft) {
  draft.warnings.insert(draft.warnings.end(), draft.rest.warnings.begin(),
                        draft.rest.warnings.end());
  WarnOfToes(draft);
  int guessed = 0;
  for (const BodyShape& body : draft.shapes.bodies) guessed += body.guessed ? 1 : 0;
  if (guessed > 0) {
    draft.warnings.push_back(
        std::to_string(guessed) + " of " + std::to_string(draft.tree.body_count()) +
        " bodies have no shape that could be read: markers and spheres are on shapes "
        "guessed from joints and masses");
  }
  for (const DraftedSole& sole : draft.soles) {
    if (!draft.stands || (!sole.guessed_size && !sole.guessed_height)) continue;
    draft.warnings.push_back(
        "sole " + Quote(sole.link) + ": its " +
        (sole.guessed_height ? "height and size are guesses" : "size is a guess") +
        ", because the URDF has no shape of the foot; measure it");
  }
  if (draft.stands && draft.motion_effort_share != MotionSetup{}.motion_effort_share) {
    draft.warnings.push_back(
        fmt::format("planned motions use up to {:.0f} % of the motors' efforts, because with "
                    "{:.0f} % the robot could not lift a foot: its own masses must be those of the "
                    "URDF",
                    100.0 * draft.motion_effort_share, 100.0 * MotionSetup{}.motion_effort_share));
  }
  if (!draft.held_because.empty()) {
    draft.warnings.push_back(
        "the draft takes the root link to be held still, for instance on a stand: " +
        draft.held_because);
  }
  for (const Joint& joint : draft.tree.joints) {
    if (joint.mimic || joint.limits.lower < joint.limits.upper) continue;
    draft.warnings.push_back("joint " + Quote(joint.name) + " cannot move: its limits are equal");
  }
}

void WarnOfMasses(ProjectDraft& draft) {
  if (!HasMasses(draft.tree)) {
    draft.warnings.push_back(
        "the robot description has no masses, which statics, plans of motions and the simulator "
        "need");
    return;
  }
  for (std::string& warning : InertiaWarnings(draft.tree)) {
    draft.warnings.push_back(std::move(warning));
  }
}

/// Gives the draft a root link that looks ahead.
void TakeAttitude(const RootAttitude& attitude, const std::string& source, const MeshPlaces& places,
                  RobotTree& described, ProjectDraft& draft) {
  draft.warnings.push_back(
      "the axes of the root link " + Quote(described.links[0].name) +
      " are not those of the robot (x ahead, z up, the x-z plane its plane of symmetry): the copy "
      "of the robot description has a root link " +
      Quote(attitude.link) +
      " whose axes are. What stands in the frame of the root link is in that of the new one; where "
      "a controller must find the old root, take the new link and its joint out of the calibrated "
      "robot description again");
  draft.urdf = AddRootLink(draft.urdf, described, attitude);
  described = ParseUrdf(draft.urdf, source);
  draft.shapes = ReadBodyShapes(described, draft.urdf, source, places);
}

}  // namespace

ProjectDraft DraftProject(const std::string& urdf, const std::string& source,
                          const Semantics& semantics, const MeshPlaces& places) {
  RobotTree described = ParseUrdf(urdf, source);
  if (described.joints.empty()) {
    throw InputError(source + ": the robot has no movable joint; nothing can be calibrated");
  }
  CheckBelongs(semantics, described);
  ProjectDraft draft;
  draft.urdf = urdf;
  draft.shapes = ReadBodyShapes(described, urdf, source, places);
  draft.warnings = draft.shapes.warnings;
  draft.warnings.insert(draft.warnings.end(), described.warnings.begin(), described.warnings.end());
  if (const auto attitude = FindRootAttitude(described, draft.shapes, semantics)) {
    TakeAttitude(*attitude, source, places, described, draft);
  }
  draft.limbs = FindLimbs(described, draft.shapes, semantics);
  draft.soles = FindSoles(described, draft.shapes, draft.limbs);
  draft.urdf = AddSoleLinks(draft.urdf, described, draft.soles);
  draft.tree = ParseUrdf(draft.urdf, source);
  NameTips(described, draft);
  WarnOfMasses(draft);
  draft.stance = ChooseStance(draft.tree, draft.limbs, draft.soles);
  RestOnFeet(draft, semantics);
  if (!draft.stands) draft.stance.reset();
  draft.spheres = CoverRobot(draft.tree, draft.shapes, draft.limbs, draft.rest.q);
  for (std::string& coarse : CoarseCovers(draft.tree, draft.shapes, draft.spheres)) {
    draft.warnings.push_back(std::move(coarse));
  }
  constexpr double kMargin = 0.004;  // share of the longest branch: 5 mm for 1.25 m
  draft.sphere_margin =
      kMetresPerMm * std::max(1.0, std::round(kMargin * LongestBranch(draft.tree) / kMetresPerMm));
  AddChains(draft);
  AddSetups(draft);
  BendLimbs(draft, semantics);
  const double usual_margin = draft.sphere_margin;
  LeaveRoomForCorrections(draft);
  HoldArmsAhead(draft, semantics);
  NarrowWaist(draft);
  draft.clusters = PlaceClusters(draft.tree, draft.shapes, draft.limbs, draft.rest.q);
  ShrinkToMargin(draft, semantics, usual_margin);
  AddContacts(draft, semantics);
  JoinMirrors(draft);
  WarnOfGuesses(draft);
  return draft;
}

}  // namespace elastocal
