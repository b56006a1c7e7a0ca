#pragma once

#include <vector>

#include <Eigen/Core>

#include "elastocal/contact/contact_residuals.hpp"
#include "elastocal/optim/termination.hpp"

namespace elastocal {

/// Values with what was found to vary, and their uncertainty.
struct ContactFit {
  ContactValues values;
  ContactSpread spread;
  std::vector<double> weights;  ///< by touch: 1, less where it is further off than the noise
                                ///< explains, 0 for one that is left out
  std::vector<JointLoads> loads;
  /// Posterior covariance of the unknowns, SI, and where each unknown of the robot stands in it
  /// (-1: not estimated); then tilts of plates, tables, sessions.
  Eigen::MatrixXd covariance;
  std::vector<int> entry_of_unknown;
  double effective_parameters = 0.0;  ///< numbers that the touches determine
  double degrees_of_freedom = 1.0;    ///< of the uncertainty: numbers left over for the noise
  bool settled = false;               ///< whether the variances came to rest
  Termination termination = Termination::kFailure;
  int iterations = 0;
};

/// Fits what is free, from nominal or from `start`, to the touches whose weight is not 0. The
/// standard deviations of all sources follow from the residuals (restricted maximum likelihood by
/// Harville's fixed point, as VarianceComponent has it); every source but the noise of touches
/// keeps the weight of one number at the standard deviation that it started from, so that a source
/// of which few numbers tell anything neither vanishes nor explodes.
struct ContactFitOptions {
  ContactFreedom freedom = {};
  bool estimate_spread = true;
  /// By medians over touches, which touches gone wrong cannot move.
  bool robust = false;
  int max_updates = 300;
};
ContactFit FitContacts(const ContactModel& model, const Touches& touches, const ContactFit& start,
                       const ContactFitOptions& options);

/// Where every fit begins: nominal robot, all touches, nothing known of variances.
ContactFit StartContacts(const ContactModel& model, const Touches& touches);

/// What is left of each touch, m and rad, touches x 3. Sessions that the fit does not know
/// (`sessions` empty) have no effect.
Eigen::MatrixX3d LeftOfTouches(const ContactModel& model, const Touches& touches,
                               const ContactValues& values);

/// A touch that contradicts the others: it is left out.
struct TouchOutlier {
  int touch = 0;
  Eigen::Vector3d left = Eigen::Vector3d::Zero();  ///< m and rad
};

/// A whole estimate: a fit by medians; touches gone wrong are named and left out (further off than
/// Student's t with four degrees of freedom allows); a fit by squares to the rest.
struct ContactEstimate {
  ContactFit fit;
  std::vector<TouchOutlier> outliers;
};
ContactEstimate EstimateContacts(const ContactModel& model, const Touches& touches,
                                 const ContactFreedom& freedom);

}  // namespace elastocal
