// SPDX-License-Identifier: Apache-2.0
// A fixed arm whose tool carries an inertial unit, and tags that a camera in the room sees.
#include <functional>

#include "elastocal/mistakes/observed_conventions.hpp"
#include "elastocal/mistakes/observed_faults.hpp"
#include "elastocal/mistakes/observed_misfit.hpp"
#include "elastocal/mistakes/observed_mistakes.hpp"
#include "elastocal/observation/seen_tag.hpp"
#include "elastocal/tables/text.hpp"
#include "tests/arm_with_tracker.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

constexpr double kRightMm = 80.0;  // edge of the tags

class ArmWithCamera : public ArmWithTracker {
 protected:
  /// The project with this size for all tags but the third, with a tracker or without.
  /// `unit_known`: the mounting of the inertial unit is known.
  Project ProjectWith(double size_mm, double third_mm, bool tracker = false,
                      bool unit_known = true) const {
    return ParseProject(TextOf(size_mm, third_mm, tracker, unit_known),
                        (folder_.path() / "camera.yaml").string());
  }

  static std::string TextOf(double size_mm, double third_mm, bool tracker, bool unit_known) {
    const char* const ways[] = {"0, 0, 0",  "90, 0, 0",  "-90, 0, 0",
                                "0, 90, 0", "0, -90, 0", "180, 0, 0"};
    std::string text = "robot: {urdf: " + SourceFile("tests/robots/arm6.urdf").string() + "}\n" +
                       "recording: {not_recorded_mm: {finger_left_joint: 10}}\ninstruments:\n";
    text +=
        "  cameras: [{name: cam, xyz_mm: [2600, 0, 700], rpy_deg: [-90, 0, 90], focal_px: "
        "[700, 700], centre_px: [640, 480], mounting_sd_mm: 50, mounting_sd_deg: 5}]\n";
    text += "  inertial_units: [{name: imu, link: flange, rpy_deg: [10, 0, 90]";
    text += std::string(unit_known ? ", mounting_sd_deg: 5" : "") + "}]\n";
    if (tracker) {
      text += "  trackers: [{name: laser}]\n  poses: [{name: body, link: tool, tracker: laser}]\n";
    }
    text += "  tags:\n";
    for (int i = 0; i < 6; ++i) {
      text += "    - {name: tag" + std::to_string(i) + ", link: tool, rpy_deg: [" + ways[i] +
              "], size_mm: " + FormatNumber(i == 2 ? third_mm : size_mm) +
              ", mounting_sd_mm: 20, mounting_sd_deg: 5}\n";
    }
    return text;
  }

  /// The project with the camera's attitude given as that of its body, with x ahead and z up.
  Project ProjectOfCameraAsBody() const {
    std::string text = TextOf(kRightMm, kRightMm, false, true);
    const std::string right = "rpy_deg: [-90, 0, 90], focal_px";
    text.replace(text.find(right), right.size(), "rpy_deg: [0, 0, 180], focal_px");
    return ParseProject(text, (folder_.path() / "camera.yaml").string());
  }

  static ObservedRobot ModelOf(const Project& project) {
    return MakeObservedRobot(project.tree, project.placement, project.contact->setup, {}, {});
  }

  /// What the instruments show, with noise, if tags have the right size.
  Observations Seen(const ObservedRobot& model) const {
    ObservedValues truth;
    truth.robot = truth_.robot;
    Random random(11);
    for (const Quantity& quantity : model.setup.quantities) {
      truth.quantities.push_back({quantity.origin, random.NormalVector(quantity.size(), 5e-3)});
    }
    Observations seen = WithEveryInstrument(model, q_);
    const auto sights = SightsOf(model, seen, truth, ObservedLoads(model, seen, truth.robot));
    for (std::size_t i = 0; i < sights.size(); ++i) {
      Observation& of = seen.all[i];
      const Instrument& instrument = model.instrument(of.instrument);
      if (!instrument.Sees(sights[i])) continue;
      of.measured = instrument.Predict(sights[i]);
      const double noise = of.measured.size() == 8 ? 0.2 : of.measured.size() == 3 ? 0.01 : 1e-4;
      of.measured += random.NormalVector(static_cast<int>(of.measured.size()), noise);
      if (of.measured.size() == 7) of.measured.tail<4>().normalize();
    }
    std::erase_if(seen.all, [](const Observation& of) { return of.measured.size() == 0; });
    return seen;
  }

  /// Calibrates with a project that may be wrong, from tables of what was seen.
  ContactRun CalibrateBy(const Project& project,
                         const std::vector<std::string>& accept = {}) const {
    const Project right =
        ProjectWith(kRightMm, kRightMm, project.contact->setup.instruments.size() > 7);
    const ObservedRobot model = ModelOf(right);
    const Observations seen = Seen(model);
    TableWriter table, corners;
    for (const char* column : {"frame", "tag", "corner", "u", "v"}) corners.Add(column);
    corners.EndRow();
    for (const int joint : right.tree.coordinate_joint) {
      const std::string& name = right.tree.joints[static_cast<std::size_t>(joint)].name;
      if (!name.starts_with("finger")) table.Add(name);
    }
    for (const auto& columns : right.contact->columns) {
      for (const std::string& column : columns) table.Add(column);
    }
    table.Add("frame");
    table.EndRow();
    for (int i = 0; i < kPostures; ++i) {
      for (const int joint : right.tree.coordinate_joint) {
        const Joint& of = right.tree.joints[static_cast<std::size_t>(joint)];
        if (!of.name.starts_with("finger")) table.Add(q_(i, of.coordinate));
      }
      for (const Observation& of : seen.all) {
        if (of.posture != i) continue;
        const std::string& name = model.instrument(of.instrument).name;
        if (of.measured.size() != 8) {
          for (const double number : of.measured) table.Add(number);
          continue;
        }
        for (int corner = 0; corner < 4; ++corner) {
          corners.Add(std::to_string(i));
          corners.Add(name.substr(name.find('/') + 1));
          corners.Add(std::to_string(corner));
          corners.Add(of.measured[2 * corner]);
          corners.Add(of.measured[2 * corner + 1]);
          corners.EndRow();
        }
      }
      table.Add(std::to_string(i));
      table.EndRow();
    }
    const auto file = folder_.path() / "table.csv", of_corners = folder_.path() / "corners.csv";
    std::ofstream(file) << table.text();
    std::ofstream(of_corners) << corners.text();
    return CalibrateContacts(project, {file, of_corners}, {.folds = 5, .accept = accept});
  }

  /// The mistake that is named if there are only measurements of this size, which are spoilt
  /// (`alone`: only those of one instrument).
  std::string MistakeOf(int size, const std::function<void(Eigen::VectorXd&)>& spoil,
                        bool unit_known = true, const std::string& alone = "") const {
    const ObservedRobot model = ModelOf(ProjectWith(kRightMm, kRightMm, false, unit_known));
    Observations spoilt = Seen(model);
    bool odd = false;  // every other one suffices, in half the time
    std::erase_if(spoilt.all, [&](const Observation& of) {
      return of.measured.size() != size || (size == 8 && (odd = !odd));
    });
    for (Observation& of : spoilt.all) {
      if (alone.empty() || model.instrument(of.instrument).name == alone) spoil(of.measured);
    }
    std::string found;
    for (const std::string& one : FindObservedMistakes(model, spoilt)) {
      found += (found.empty() ? "" : "; or ") + one;
    }
    return found;
  }

  /// The number that follows `words`.
  static double NumberAfter(const std::string& text, const std::string& words) {
    const std::size_t at = text.find(words);
    EXPECT_NE(at, std::string::npos) << text;
    return at == std::string::npos ? 0.0 : std::stod(text.substr(at + words.size()));
  }
};

TEST_F(ArmWithCamera, RightSizesOfTagsAreDeployed) {
  EXPECT_EQ(First(CalibrateBy(ProjectWith(kRightMm, kRightMm))), "");
  EXPECT_EQ(First(CalibrateBy(ProjectWith(kRightMm, kRightMm, true))), "");
}

// The residuals are as small as with the right size. The lengths of the robot tell the size.
TEST_F(ArmWithCamera, AWrongSizeOfAllTagsIsNamed) {
  for (const double factor : {0.96, 1.04}) {
    SCOPED_TRACE(factor);
    const Project project = ProjectWith(factor * kRightMm, factor * kRightMm);
    const std::string named = First(CalibrateBy(project));
    EXPECT_EQ(named.find("size_mm of the tags seems "), 0u) << named;
    // The tolerance is 0.2 %, because each length of this robot has an error of 1 mm.
    EXPECT_NEAR(NumberAfter(named, "size_mm of the tags seems "), factor, 0.006);
    EXPECT_NEAR(NumberAfter(named, "correct the project, where "), kRightMm, 0.5);
    EXPECT_NE(named.find("instead of " + FormatNumber(factor * kRightMm)), std::string::npos);
    EXPECT_EQ(named.find("--accept"), std::string::npos) << named;
  }
  ExpectInputError([&] { CalibrateBy(ProjectWith(82.0, 82.0), {"scale=1.025"}); },
                   {"no instrument measures lengths", "size_mm"});
}

TEST_F(ArmWithCamera, TheAttitudeOfACamerasBodyIsNamed) {
  Observations seen = Seen(ModelOf(ProjectWith(kRightMm, kRightMm)));
  std::erase_if(seen.all, [](const Observation& of) { return of.measured.size() != 8; });
  const auto found = FindObservedMistakes(ModelOf(ProjectOfCameraAsBody()), seen);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0],
            "rpy_deg of cameras is that of a body with x ahead and z up: that of z ahead, x to the "
            "right of the image and y down was expected");
}

// Other lengths tell the size here: those of the other tags, or those of a tracker.
TEST_F(ArmWithCamera, AWrongSizeBesideRightLengthsIsNamed) {
  const std::string third = First(CalibrateBy(ProjectWith(kRightMm, 1.15 * kRightMm)));
  EXPECT_EQ(third.find("size_mm of tag2 is 1.1"), 0u) << third;
  EXPECT_NEAR(NumberAfter(third, "size_mm of tag2 is "), 1.15, 0.01);
  const std::string all = First(CalibrateBy(ProjectWith(1.1 * kRightMm, 1.1 * kRightMm, true)));
  EXPECT_EQ(all.find("size_mm of all tags is 1."), 0u) << all;
  EXPECT_NEAR(NumberAfter(all, "size_mm of all tags is "), 1.1, 0.01);
}

// A tag whose size is far off contradicts the others in every image.
TEST_F(ArmWithCamera, ATagThatIsWrongAsAWholeIsNamed) {
  const ContactRun run = CalibrateBy(ProjectWith(kRightMm, kRightMm / 25.4));
  std::string said;
  for (const std::string& text : run.verdict.objections) said += text + "\n";
  for (const std::string& text : run.verdict.remarks) said += text + "\n";
  EXPECT_NE(said.find("observations of tag 'tag2' contradict the others"), std::string::npos)
      << said;
  EXPECT_NEAR(NumberAfter(said, "In its images it is about "), 25.4, 2.0) << said;
}

TEST_F(ArmWithCamera, OtherConventionsOfImagesAreNamed) {
  EXPECT_EQ(MistakeOf(8,
                      [](Eigen::VectorXd& uv) {
                        for (int i = 0; i < 8; i += 2) std::swap(uv[i], uv[i + 1]);
                      }),
            "u and v of the corners of tags are exchanged: u to the right and v down was expected");
  EXPECT_EQ(MistakeOf(8,
                      [](Eigen::VectorXd& uv) {
                        for (int i = 1; i < 8; i += 2) uv[i] = 960.0 - uv[i];
                      }),
            "v of the corners of tags is counted upwards: v from the upper edge of the image down "
            "was expected");
  // The first is the order of OpenCV, the second begins below left.
  for (const auto& [first, place] : {std::pair(3, "above left"), std::pair(0, "below left")}) {
    EXPECT_EQ(MistakeOf(8,
                        [first = first](Eigen::VectorXd& uv) {
                          const Eigen::VectorXd right = uv;
                          for (int i = 0; i < 4; ++i) {
                            uv.segment<2>(2 * i) = right.segment<2>(2 * ((first - i + 4) % 4));
                          }
                        }),
              std::string("the corners of tags run clockwise from ") + place +
                  ": counterclockwise from below left was expected");
  }
  const auto from_below_right = [](Eigen::VectorXd& uv) {
    const Eigen::VectorXd right = uv;
    for (int i = 0; i < 4; ++i) uv.segment<2>(2 * i) = right.segment<2>(2 * ((i + 1) % 4));
  };
  EXPECT_EQ(MistakeOf(8, from_below_right),
            "the corners of tags are counted from below right, or tags are turned by 90 degrees "
            "about their z: counterclockwise from below left of a tag that stands as rpy_deg says "
            "was expected");
}

TEST_F(ArmWithCamera, AnotherOrderOfTheCornersOfOneTagIsNamed) {
  const auto clockwise = [](Eigen::VectorXd& uv) {
    const Eigen::VectorXd right = uv;
    for (int i = 0; i < 4; ++i) uv.segment<2>(2 * i) = right.segment<2>(2 * ((4 - i) % 4));
  };
  EXPECT_EQ(MistakeOf(8, clockwise, true, "cam/tag1"),
            "the corners of tags run clockwise from below left (tag1 alone): counterclockwise from "
            "below left was expected");
}

TEST_F(ArmWithCamera, TagsInAnotherUnitAreNamed) {
  Observations seen = Seen(ModelOf(ProjectWith(kRightMm, kRightMm)));
  std::erase_if(seen.all, [](const Observation& of) { return of.measured.size() != 8; });
  seen = SelectPostures(seen, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11});
  const ObservedRobot larger = ModelOf(ProjectWith(10.0 * kRightMm, 10.0 * kRightMm));
  const WrittenConvention cm = TagsInOtherUnits(larger, seen).front();
  EXPECT_EQ(cm.what, "size_mm of tags is 10 times too large");
  EXPECT_LT(MisfitOfNominal(*cm.robot, seen).squares, 0.1 * MisfitOfNominal(larger, seen).squares);
  // With small tags, other poses of the cameras explain much.
  const ObservedRobot smaller = ModelOf(ProjectWith(0.1 * kRightMm, 0.1 * kRightMm));
  const ObservationFit fit = EstimateObserved(smaller, seen, {}).fit;
  const std::string fault = FindObservedFault(smaller, seen, fit);
  EXPECT_EQ(fault.find("size_mm of tags is 10 times too small"), 0u) << fault;
}

// The result is right. But a project that is so far off may mean another tag.
TEST_F(ArmWithCamera, AMountingFarFromTheProjectIsSaid) {
  std::string text = TextOf(kRightMm, kRightMm, false, true);
  const std::string right = "centre_px: [640, 480]", of_tag = "rpy_deg: [90, 0, 0]";
  text.replace(text.find(right), right.size(), "centre_px: [480, 640]");
  text.replace(text.find(of_tag), of_tag.size(), "rpy_deg: [90, -90, 0]");
  const ContactRun run = CalibrateBy(ParseProject(text, (folder_.path() / "far.yaml").string()));
  EXPECT_EQ(First(run), "");
  std::string remarks;
  for (const std::string& remark : run.verdict.remarks) remarks += remark + "\n";
  EXPECT_NE(remarks.find("cam.centre by "), std::string::npos) << remarks;
  EXPECT_NE(remarks.find("tag1.mounting_turn by "), std::string::npos) << remarks;
}

TEST_F(ArmWithCamera, LeftHandedInertialUnitsAreNamed) {
  const std::string right =
      ": 9.81 m/s^2 along the axis that points up while the robot is at rest was expected";
  EXPECT_EQ(MistakeOf(3, [](Eigen::VectorXd&) {}), "");
  const auto reversed = [](Eigen::VectorXd& shown) { shown *= -1.0; };
  EXPECT_EQ(MistakeOf(3, reversed), "all axes of inertial units are reversed" + right);
  EXPECT_EQ(MistakeOf(3, [](Eigen::VectorXd& shown) { std::swap(shown[0], shown[1]); }),
            "x and y of inertial units are exchanged" + right);
  EXPECT_EQ(MistakeOf(3, [](Eigen::VectorXd& shown) { std::swap(shown[0], shown[2]); }),
            "z and x of inertial units are exchanged" + right);
  EXPECT_EQ(MistakeOf(3, [](Eigen::VectorXd& shown) { shown[1] *= -1.0; }),
            "y of inertial units is reversed" + right);
  // If the mounting is unknown, a turned unit explains as much with any of the axes reversed.
  EXPECT_EQ(MistakeOf(3, reversed, false),
            "the axes of inertial units are left-handed (all or one of them reversed, or two "
            "exchanged)" +
                right);
}

}  // namespace
}  // namespace elastocal
