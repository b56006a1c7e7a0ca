#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "elastocal/contact/touch_geometry.hpp"
#include "elastocal/robot/error_model.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {

/// A foot that stands on the floor in every touch and does not move.
struct ContactFoot {
  int link = 0;
  /// Where it stands; the floor's frame is where the first foot stands, z up.
  Transform T_floor_foot = Transform::Identity();
  double share = 0.5;  ///< of the weight
};

/// A plate of the robot and the table that it touches: one table for each plate.
struct ContactPlate {
  std::string name;
  int link = 0;
  PlateFace face = {};
};

/// How a robot that stands on its feet touches tables.
struct ContactSetup {
  std::vector<ContactFoot> feet;
  std::vector<ContactPlate> plates;
  /// Patterns of parameters that have one value in common, such as the compliance of both hips.
  std::vector<std::vector<std::string>> common = {};
  std::vector<std::string> hold = {};  ///< patterns of parameters that stay nominal
  double outlier_probability = 0.01;   ///< that touches without a single outlier have one named
};

/// One touch.
struct Touch {
  int plate = 0;    ///< of the setup
  int session = 0;  ///< of Touches::sessions
  int file = 0;     ///< of Touches::files
  int line = 0;     ///< of the file
};

/// The robot has been started anew between two sessions of one plate, or the table been moved a
/// little.
struct ContactSession {
  int plate = 0;
  std::string name;
};

/// Touches with the positions of all joints.
struct Touches {
  std::vector<std::string> files;
  std::vector<ContactSession> sessions;
  std::vector<Touch> touches;
  Eigen::MatrixXd q;  ///< touches x coordinates of the tree, rad or m

  int count() const { return static_cast<int>(touches.size()); }
};

/// The robot as touches see it. Its reference frame is that of the root link; legs 0 to feet - 1 of
/// `robot` are the feet, the following ones the links of the plates.
struct ContactModel {
  ErrorModel robot;
  ContactSetup setup;
  /// By parameter of the robot: which unknown it is; -1: it stays nominal (T0 and what is held).
  /// Parameters in common have the same one.
  std::vector<int> unknown;
  int unknown_count = 0;
};

/// `torsion`, `bending`: joints that give way (ErrorModel). Throws InputError for patterns that
/// match nothing, and for parameters in common of different kinds.
ContactModel MakeContactModel(const RobotTree& tree, const PlacementOptions& placement,
                              const ContactSetup& setup, const std::vector<int>& torsion,
                              const std::vector<int>& bending);

/// Leaves out of the estimate the parameters of joints that move no foot and no plate of `touches`.
void KeepTouchedUnknowns(const Touches& touches, ContactModel& model);

/// The touches of some plates or files.
Touches SelectTouches(const Touches& touches, const std::vector<int>& which);

}  // namespace elastocal
