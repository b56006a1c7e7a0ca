// SPDX-License-Identifier: Apache-2.0
// Covering a drafted robot with spheres.

#include <algorithm>
#include <limits>
#include <regex>

#include <gtest/gtest.h>

#include "elastocal/drafting/draft.hpp"
#include "elastocal/math/numbers.hpp"
#include "tests/draft_files.hpp"

namespace elastocal {
namespace {

/// No point of a shape is more than 15 mm outside the spheres of its link.
void ExpectCovered(const ProjectDraft& shapes, const std::vector<CollisionSphere>& spheres) {
  for (const BodyShape& body : shapes.shapes.bodies) {
    for (const Eigen::Vector3d& p : body.points) {
      double outside = std::numeric_limits<double>::infinity();
      for (const CollisionSphere& sphere : spheres) {
        if (sphere.link != body.link) continue;
        outside = std::min(outside, (p - sphere.p_link_centre).norm() - sphere.radius);
      }
      EXPECT_LT(outside, 0.015) << shapes.tree.links[Size(body.link)].name;
    }
  }
}

TEST(Draft, SpheresCoverTheShapesOfTalosWithin15Millimetres) {
  const ProjectDraft& draft = DraftFile("models/talos/talos.urdf");
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(draft.tree.coordinate_count());
  const auto poses = LinkTransforms(draft.tree, zero);
  ExpectCovered(draft, draft.spheres);
  EXPECT_LT(draft.spheres.size(), 70U);
}

/// One ball around a thin mast and a wide chassis would keep the arms away from everything.
TEST(Draft, AMastOnAChassisIsCoveredShapeByShape) {
  const std::string mast =
      "<collision><origin xyz='-0.2 0 0.6'/><geometry><box size='0.12 0.2 1'/></geometry>"
      "</collision>";
  std::string urdf = PoleUrdf("<box size='0.7 0.5 0.25'/>", "60");
  urdf.insert(urdf.find("</link>"), mast);
  const ProjectDraft draft = DraftProject(urdf, "pole.urdf", {});
  std::size_t count = 0;
  for (const CollisionSphere& sphere : draft.spheres) {
    if (sphere.link != 0) continue;
    ++count;
    EXPECT_LT(sphere.radius, 0.25);  // a common cover of both would have a radius of 0.387 m
  }
  EXPECT_LE(count, 12U);
  EXPECT_EQ(draft.warnings.end(), std::ranges::find_if(draft.warnings, [](const std::string& text) {
              return text.find("coarse") != std::string::npos;
            }));
  ExpectCovered(draft, draft.spheres);
}

/// The URDF of TALOS with its boxes as meshes of twelve triangles in `folder`.
std::string TalosOfMeshes(const ScratchFolder& folder) {
  const std::regex box("<box size=\"([^ ]*) ([^ ]*) ([^\"]*)\"/>");
  std::string urdf = ReadFile(SourceFile("models/talos/talos.urdf")), replaced;
  int count = 0;
  for (std::smatch found; std::regex_search(urdf, found, box); urdf = found.suffix()) {
    std::string obj;
    for (int corner = 0; corner < 8; ++corner) {
      obj += "v";
      for (int i = 0; i < 3; ++i) {
        obj +=
            ((corner >> i) % 2 == 0 ? " -" : " ") + std::to_string(500.0 * std::stod(found[i + 1]));
      }
      obj += "\n";
    }
    for (const char* side : {"1 3 4 2", "5 6 8 7", "1 2 6 5", "3 7 8 4", "1 5 7 3", "2 4 8 6"}) {
      obj += std::string("f ") + side + "\n";
    }
    const std::string name = "box" + std::to_string(++count) + ".obj";
    folder.Write(name, obj);
    replaced += found.prefix().str() + "<mesh filename='" + name + "' scale='1e-3 1e-3 1e-3'/>";
  }
  return replaced + urdf;
}

TEST(DraftStudy, MeshesAreShapesLikeOthers) {
  const ScratchFolder folder;
  const std::string urdf = TalosOfMeshes(folder);
  MeshPlaces places;
  places.urdf = folder.Write("meshes.urdf", urdf);
  const ProjectDraft& boxes = DraftFile("models/talos/talos.urdf");
  const ProjectDraft meshes = DraftProject(urdf, "meshes.urdf", {}, places);
  EXPECT_EQ(meshes.shapes.meshes, 23);  // the meshes for collisions
  ASSERT_EQ(meshes.soles.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    // Half lengths are written in mm with six decimals and read in single precision.
    EXPECT_EQ(meshes.soles[i].link, boxes.soles[i].link);
    EXPECT_LT((meshes.soles[i].lower - boxes.soles[i].lower).norm(), 1e-6);
    EXPECT_LT((meshes.soles[i].upper - boxes.soles[i].upper).norm(), 1e-6);
  }
  EXPECT_EQ(meshes.clusters.size(), boxes.clusters.size());
  // The boxes have surface points that the meshes do not have.
  ExpectCovered(boxes, meshes.spheres);
}

}  // namespace
}  // namespace elastocal
