// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/design_observations.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/observation/observation_fit.hpp"
#include "elastocal/pipeline/contact_earlier.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/planning/posture_information.hpp"
#include "elastocal/robot/zero_offset.hpp"
#include "elastocal/tables/json_text.hpp"
#include "elastocal/validation/common_parameters.hpp"

namespace elastocal {
namespace {

/// A posture that may be chosen.
struct Candidate {
  int plate = -1;  ///< index of the plate that touches; -1: instruments look
  Eigen::VectorXd q;
};

std::vector<Candidate> ListCandidates(const ObservationDesign& drawn, int plates) {
  std::vector<Candidate> candidates;
  for (std::size_t k = 0; k < drawn.postures.size(); ++k) {
    const int plate = drawn.postures[k].chain == kLooks ? -1 : static_cast<int>(k);
    for (const Eigen::VectorXd& q : drawn.postures[k].q) {
      candidates.push_back({plate < plates ? plate : -1, q});
    }
  }
  return candidates;
}

/// Observations of the nominal robot in the candidates.
Observations NominalObservations(const Project& project, const ObservationSetup& setup,
                                 const ObservedRobot& model,
                                 const std::vector<Candidate>& candidates) {
  Observations all;
  all.files = {"nominal"};
  all.q.resize(static_cast<Eigen::Index>(candidates.size()), model.robot.tree.coordinate_count());
  const int plates = static_cast<int>(setup.plates.size());
  const bool mixed = !project.contact->plate_column.empty();
  for (int i = 0; i < static_cast<int>(candidates.size()); ++i) {
    const Candidate& of = candidates[Size(i)];
    all.q.row(i) = of.q.transpose();
    all.postures.push_back({0, i});
    if (of.plate >= 0) all.all.push_back({i, of.plate, {}, {}});
    for (int n = plates; n < static_cast<int>(setup.instruments.size()); ++n) {
      if (of.plate < 0 || mixed) all.all.push_back({i, n, {}, {}});
    }
  }
  ObservedValues nominal;
  nominal.robot = Eigen::VectorXd::Zero(model.robot.parameter_count());
  for (const Quantity& quantity : model.setup.quantities) {  // with the tilt of a held root
    nominal.quantities.push_back({quantity.origin, Eigen::VectorXd::Zero(quantity.size())});
  }
  const std::vector<Sight> sights = SightsOf(model, all, nominal, {});
  std::vector<Observation> seen;
  for (std::size_t i = 0; i < sights.size(); ++i) {
    const Instrument& instrument = model.instrument(all.all[i].instrument);
    if (!instrument.Sees(sights[i])) continue;
    seen.push_back(all.all[i]);
    seen.back().measured = instrument.Predict(sights[i]);
  }
  all.all = std::move(seen);
  return all;
}

/// The robot of the project, with its nominal observations.
ObservedRobot RobotOfProject(const Project& project, const ObservationSetup& setup,
                             const std::vector<Candidate>& candidates, Observations& observations) {
  observations =
      NominalObservations(project, setup, MakeRobotOfProject(project, {{}, setup, {}}), candidates);
  return MakeRobotOfProject(project, {observations, setup, {}});
}

/// Standard deviations of changes of the joints' parameters; 0 for other joints.
Eigen::VectorXd SizesOf(const std::vector<std::string>& joints, const EarlierEstimate& earlier,
                        const ObservedRobot& model, const Project& project) {
  Eigen::VectorXd sizes = SizeOfChanges(earlier, model.robot, project.calibration.prior);
  if (joints.empty()) return sizes;
  std::set<std::string> known;
  for (std::size_t i = 0; i < earlier.names.size(); ++i) {
    const std::string joint = OwnerName(earlier.names[i]);
    known.insert(joint);
    const bool wanted = std::find(joints.begin(), joints.end(), joint) != joints.end();
    if (!wanted) sizes[static_cast<Eigen::Index>(i)] = 0.0;
  }
  for (const std::string& joint : joints) {
    if (known.contains(joint)) continue;
    throw InputError(fmt::format("joint '{}': the calibration does not know it; it knows {}", joint,
                                 fmt::join(known, ", ")));
  }
  return sizes;
}

/// The robot of an earlier calibration, with its nominal observations.
ObservedRobot RobotAfterEarlier(const Project& project, const ObservationSetup& setup,
                                const std::vector<Candidate>& candidates,
                                const ObservationDesignOptions& options,
                                Observations& observations) {
  const EarlierContacts earlier = ReadEarlierContacts(options.after, project);
  observations = NominalObservations(project, setup,
                                     MakeStoredRobot(earlier.stored, project, setup), candidates);
  ObservedRobot model = MakeRobotAfterEarlier(earlier, project, {observations, setup, {}});
  model.earlier = MakeEarlierOfContacts(earlier, model, project, options.days);
  return model;
}

/// Observations in the candidates, as residuals of the nominal robot.
class CandidateResiduals {
 public:
  CandidateResiduals(const ObservedRobot& model, const Observations& observations, int candidates)
      : fit_(StartFit(model, observations)),
        residuals_(model, observations, fit_.loads, fit_.spread, fit_.weights, {}, fit_.values),
        candidates_(candidates) {
    residuals_.Evaluate(residuals_.Start(), true);
    for (const Observation& of : observations.all) posture_.push_back(of.posture);
  }

  PostureInformation Information() const { return {residuals_, posture_, candidates_}; }
  const ObservationResiduals& residuals() const { return residuals_; }

 private:
  ObservationFit fit_;
  ObservationResiduals residuals_;
  std::vector<int> posture_;
  int candidates_;
};

/// How exactly postures tell changes of zeros since an earlier calibration.
std::vector<ZeroSensitivity> ZerosTold(const ObservedRobot& model,
                                       const CandidateResiduals& candidates,
                                       const std::vector<int>& chosen,
                                       const Eigen::VectorXd& sizes) {
  const Eigen::VectorXd told = candidates.Information().OfChanges(chosen);
  std::vector<ZeroSensitivity> zeros;
  for (std::size_t k = 0; k < model.earlier.names.size(); ++k) {
    const int i = FindParameter(model.robot.parameters, model.earlier.names[k]);
    const Parameter& parameter = model.robot.parameters[Size(i)];
    const double size = sizes[static_cast<Eigen::Index>(k)];
    const int unknown = model.unknown[Size(i)];
    if (!IsZeroOffset(parameter, model.robot.tree) || size <= 0.0 || unknown < 0) continue;
    const int entry = candidates.residuals().RobotEntry(unknown);
    const double sd = candidates.residuals().scale()[entry] / std::sqrt(std::max(0.0, told[entry]));
    zeros.push_back({OwnerName(parameter.name), parameter.unit == ParameterUnit::kMetre,
                     sd <= size ? sd : std::numeric_limits<double>::infinity(),
                     SmallestChange(sd, size, model.robot.tree.joints.size())});
  }
  return zeros;
}

double MeanOfRandomSets(const PostureInformation& information, int count, std::uint64_t seed) {
  constexpr int kSets = 10;
  Random random(seed);
  double sum = 0.0;
  for (int set = 0; set < kSets; ++set) {
    std::vector<int> order(Size(information.count()));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int>(i);
    for (int i = 0; i < count; ++i) {
      std::swap(order[Size(i)], order[Size(i + random.Index(information.count() - i))]);
    }
    order.resize(Size(count));
    sum += information.Of(order);
  }
  return sum / kSets;
}

}  // namespace

ObservationDesign DrawObservedPostures(const Project& project, int count, std::uint64_t seed,
                                       const Progress& progress) {
  ObservedPostureSampler sampler(project, seed);
  const ObservationSetup& setup = sampler.setup();
  const int plates = static_cast<int>(setup.plates.size());
  const bool looks = setup.instruments.size() > setup.plates.size();
  ObservationDesign design;
  int done = 0;
  const int total = count * (plates + (looks ? 1 : 0));
  for (int kind = 0; kind < plates + (looks ? 1 : 0); ++kind) {
    ChainPostures of{kind < plates ? setup.plates[Size(kind)].name : kLooks, sampler.support(), {}};
    for (int i = 0; i < count; ++i) {
      const auto q = kind < plates ? sampler.DrawTouch(kind) : sampler.DrawLook();
      if (!q) {
        design.infeasible = (kind < plates ? "plate '" + of.chain + "': no posture"
                                           : std::string("no posture for instruments")) +
                            " was found; what stands in the way most often: " + sampler.Blame();
        return design;
      }
      of.q.push_back(*q);
      ++done;
      if (progress) progress(done, total);
    }
    design.postures.push_back(std::move(of));
  }
  design.candidates = done;
  return design;
}

ObservationDesign DesignObservations(const Project& project,
                                     const ObservationDesignOptions& options,
                                     const Progress& progress) {
  const int kinds =
      static_cast<int>(project.contact ? project.contact->setup.plates.size() : 0) + 1;
  const int each = std::max(options.count, options.count * options.candidates / kinds);
  ObservationDesign design = DrawObservedPostures(project, each, options.seed, progress);
  if (!design.infeasible.empty()) return design;
  const ObservedPostureSampler sampler(project, options.seed);
  const std::vector<Candidate> candidates =
      ListCandidates(design, static_cast<int>(sampler.setup().plates.size()));
  const ObservationSetup& setup = sampler.setup();
  const int drawn = static_cast<int>(candidates.size());
  Observations observations;
  std::vector<int> chosen;
  const auto choose = [&](const ObservedRobot& model) {
    const PostureInformation information =
        CandidateResiduals(model, observations, drawn).Information();
    chosen = information.Choose(options.count);
    design.information = information.Of(chosen);
    design.information_at_random = MeanOfRandomSets(information, options.count, options.seed);
  };
  if (options.after.empty()) {
    choose(RobotOfProject(project, setup, candidates, observations));
  } else {
    const ObservedRobot model =
        RobotAfterEarlier(project, setup, candidates, options, observations);
    const Eigen::VectorXd sizes = SizesOf(options.joints, model.earlier, model, project);
    ObservedRobot changed = model;
    if (options.changes) changed.earlier.covariance.diagonal() += sizes.cwiseAbs2();
    choose(changed);
    design.zeros = ZerosTold(model, CandidateResiduals(model, observations, drawn), chosen, sizes);
  }
  for (ChainPostures& of : design.postures) of.q.clear();
  for (int index : chosen) {
    const Candidate& of = candidates[Size(index)];
    (of.plate >= 0 ? design.postures[Size(of.plate)] : design.postures.back()).q.push_back(of.q);
  }
  std::erase_if(design.postures, [](const ChainPostures& of) { return of.q.empty(); });
  return design;
}

std::string FormatObservationDesign(const ObservationDesign& design) {
  nlohmann::ordered_json json;
  for (const ChainPostures& of : design.postures) {
    json["postures"].push_back({{"name", of.chain}, {"postures", of.q.size()}});
  }
  json["candidates"] = design.candidates;
  json["information_nats"] = design.information;
  json["information_at_random_nats"] = design.information_at_random;
  if (!design.zeros.empty()) json["zeros"] = ZerosJson(design.zeros);
  return JsonText(json);
}

}  // namespace elastocal
