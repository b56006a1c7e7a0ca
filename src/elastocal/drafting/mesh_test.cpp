// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/mesh.hpp"

#include <fstream>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/math/random.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

// A box from the origin to (200, 300, 400) mm in the three formats.
constexpr double kCorners[8][3] = {{0, 0, 0},   {0.2, 0, 0},   {0.2, 0.3, 0},   {0, 0.3, 0},
                                   {0, 0, 0.4}, {0.2, 0, 0.4}, {0.2, 0.3, 0.4}, {0, 0.3, 0.4}};
constexpr int kSides[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                              {2, 3, 7, 6}, {1, 2, 6, 5}, {0, 4, 7, 3}};

std::string Words(const double (&p)[3], double unit) {
  std::string text;
  for (const double x : p) text += " " + std::to_string(x / unit);
  return text;
}

std::string Stl() {
  std::string text = "solid box\n";
  for (const auto& side : kSides) {
    for (const auto& [i, j] : {std::pair(1, 2), std::pair(2, 3)}) {
      text += "facet normal 0 0 0\nouter loop\n";
      for (const int k : {0, i, j}) text += "vertex" + Words(kCorners[side[k]], 1.0) + "\n";
      text += "endloop\nendfacet\n";
    }
  }
  return text + "endsolid box\n";
}

/// The box of quadrilaterals, with a material file that does not exist.
std::string Obj() {
  std::string text = "mtllib nowhere.mtl\no box\n";
  for (const auto& corner : kCorners) text += "v" + Words(corner, 1.0) + "\n";
  text += "usemtl steel\n";
  for (const auto& side : kSides) {
    text += "f";
    for (const int k : side) text += " " + std::to_string(k + 1);
    text += "\n";
  }
  return text;
}

/// The box in millimetres with z upwards. Its points are 100 mm too far along y, and its node moves
/// them back.
std::string Collada() {
  std::string points, indices;
  for (const auto& corner : kCorners) {
    const double shifted[3] = {corner[0], corner[1] + 0.1, corner[2]};
    points += Words(shifted, 1e-3);
  }
  for (const auto& side : kSides) {
    for (const int k : {0, 1, 2, 0, 2, 3}) indices += std::to_string(side[k]) + " ";
  }
  return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
         "version=\"1.4.1\"><asset><unit name=\"mm\" meter=\"0.001\"/><up_axis>Z_UP</up_axis>"
         "</asset><library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array "
         "id=\"a\" count=\"24\">" +
         points +
         "</float_array><technique_common><accessor source=\"#a\" count=\"8\" stride=\"3\"><param "
         "name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" "
         "type=\"float\"/></accessor></technique_common></source><vertices id=\"v\"><input "
         "semantic=\"POSITION\" source=\"#p\"/></vertices><triangles count=\"12\"><input "
         "semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>" +
         indices +
         "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes>"
         "<visual_scene id=\"s\"><node id=\"n\"><translate>0 -100 0</translate><instance_geometry "
         "url=\"#g\"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene "
         "url=\"#s\"/></scene></COLLADA>";
}

TEST(Mesh, StlObjAndColladaGiveTheSameBoxInMetres) {
  const ScratchFolder folder;
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"box.stl", Stl()},
                                   {"box.OBJ", Obj()},
                                   {"box.dae", Collada()}}) {
    std::string reason;
    const std::vector<Triangle> triangles = ReadMesh(folder.Write(name, text), reason);
    EXPECT_EQ(reason, "") << name;
    EXPECT_EQ(triangles.size(), 12U) << name;
    Eigen::Vector3d lower = Eigen::Vector3d::Constant(9.0), upper = -lower;
    for (const Triangle& triangle : triangles) {
      for (const Eigen::Vector3d& p : triangle) {
        lower = lower.cwiseMin(p);
        upper = upper.cwiseMax(p);
      }
    }
    // Vertices have single precision.
    EXPECT_LT(lower.norm(), 1e-6) << name << " " << lower.transpose();
    EXPECT_LT((upper - Eigen::Vector3d(0.2, 0.3, 0.4)).norm(), 1e-6)
        << name << " " << upper.transpose();
    EXPECT_NEAR(VolumeOf(triangles), 0.024, 1e-7) << name;
  }
}

TEST(Mesh, SaysWhyAFileIsNotRead) {
  const ScratchFolder folder;
  for (const auto& [name, text] : {std::pair<std::string, std::string>{"box.stl", "solid"},
                                   {"box.dae", "<COLLADA>"},
                                   {"box.txt", "words"},
                                   {"points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"}}) {
    std::string reason;
    EXPECT_TRUE(ReadMesh(folder.Write(name, text), reason).empty()) << name;
    EXPECT_NE(reason, "") << name;
  }
}

TEST(Mesh, IsFoundInPackagesAndBesideTheUrdf) {
  const ScratchFolder folder;
  const auto put = [&](const std::string& path) {
    const fs::path file = folder.path() / path;
    fs::create_directories(file.parent_path());
    std::ofstream(file) << "x";
    return file;
  };
  MeshPlaces places;
  places.urdf = folder.path() / "ws/checkout/urdf/robot.urdf";
  const fs::path named = put("ws/checkout/meshes/a.stl");
  const fs::path manifest = put("ws/checkout/package.xml");
  std::ofstream(manifest) << "<package format='2'><name>my_robot</name></package>";
  const fs::path neighbour = put("ws/other/meshes/b.stl");
  const fs::path inside = put("ws/checkout/urdf/c.stl");
  const auto found = [&](const std::string& name) {
    return FindMesh(name, places).value_or("").lexically_normal();
  };
  EXPECT_EQ(found("package://my_robot/meshes/a.stl"), named);
  EXPECT_EQ(found("package://checkout/meshes/a.stl"), named);
  EXPECT_EQ(found("model://other/meshes/b.stl"), neighbour);
  EXPECT_EQ(found("c.stl"), inside);
  EXPECT_EQ(found("../meshes/a.stl"), named);
  EXPECT_EQ(found("file://" + inside.string()), inside);
  EXPECT_EQ(found("package://my_robot/meshes"), "");  // a folder
  EXPECT_EQ(found("package://elsewhere/d.stl"), "");
  const fs::path in_root = put("root/elsewhere/d.stl");
  places.roots = {folder.path() / "root"};
  EXPECT_EQ(found("package://elsewhere/d.stl"), in_root);
  places.roots = {folder.path() / "root/elsewhere"};
  EXPECT_EQ(found("package://elsewhere/d.stl"), in_root);
  // A given folder of a package is the only place that is searched for it.
  places.packages["my_robot"] = folder.path() / "root/elsewhere";
  EXPECT_EQ(found("package://my_robot/d.stl"), in_root);
  EXPECT_EQ(found("package://my_robot/meshes/a.stl"), "");
  EXPECT_EQ(PackageOf("package://my_robot/d.stl"), "my_robot");
  EXPECT_EQ(PackageOf("meshes/d.stl"), "");
}

TEST(Mesh, PointsOnTrianglesLeaveNoHole) {
  Random random(3);
  for (int n = 0; n < 20; ++n) {
    const Triangle t = {random.NormalVector(3, 0.1), random.NormalVector(3, 0.1),
                        random.NormalVector(3, 0.1)};
    const double spacing = 0.02;
    const auto points = SurfacePoints({t}, spacing);
    for (int i = 0; i < 50; ++i) {
      double u = random.Uniform(0.0, 1.0), v = random.Uniform(0.0, 1.0);
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      const Eigen::Vector3d p = t[0] + u * (t[1] - t[0]) + v * (t[2] - t[0]);
      double nearest = std::numeric_limits<double>::infinity();
      for (const Eigen::Vector3d& q : points) nearest = std::min(nearest, (p - q).norm());
      // Neighbouring rows are at most one spacing apart, and so are neighbouring points of a row.
      EXPECT_LT(nearest, spacing);
    }
  }
}

TEST(Mesh, ThinningKeepsTheOutermostPointsAndLeavesNoHole) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i <= 100; ++i) {
    for (int j = 0; j <= 100; ++j) points.emplace_back(0.01 * i, 0.02 * j, 0.3);
  }
  const auto thin = ThinOut(points, 500);
  EXPECT_LE(thin.size(), 500U);
  EXPECT_GE(thin.size(), 250U);  // a step that is 1.2 times longer leaves 1.44 times fewer points
  double left = 1.0, right = 0.0, largest_hole = 0.0;
  for (const Eigen::Vector3d& p : thin) {
    left = std::min(left, p.x());
    right = std::max(right, p.x());
  }
  EXPECT_EQ(left, 0.0);
  EXPECT_EQ(right, 1.0);
  for (const Eigen::Vector3d& p : points) {
    double nearest = 9.0;
    for (const Eigen::Vector3d& q : thin) nearest = std::min(nearest, (p - q).norm());
    largest_hole = std::max(largest_hole, nearest);
  }
  EXPECT_LT(largest_hole, std::sqrt(2.0 * 2.0 / 250.0));  // the diagonal of a cell
  EXPECT_EQ(ThinOut(points, points.size()).size(), points.size());
}

}  // namespace
}  // namespace elastocal
