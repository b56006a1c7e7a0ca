// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "elastocal/drafting/draft.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {

/// Drafts a robot of the repository. Under the sanitizers this takes seconds.
inline ProjectDraft DraftFileAnew(const std::string& file) {
  return DraftProject(ReadFile(SourceFile(file)), file, {});
}

/// The same draft, made only once in a program.
inline const ProjectDraft& DraftFile(const std::string& file) {
  static std::map<std::string, ProjectDraft> drafts;
  const auto found = drafts.find(file);
  return found != drafts.end() ? found->second
                               : drafts.emplace(file, DraftFileAnew(file)).first->second;
}

/// A link of 1 kg and the joint about y that carries it.
inline std::string RodXml(const std::string& name, const std::string& parent,
                          const std::string& place, const std::string& type = "revolute") {
  return "<link name='" + name +
         "'><inertial><mass value='1'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' "
         "ixz='0' iyz='0'/></inertial></link><joint name='" +
         name + "_joint' type='" + type + "'><parent link='" + parent + "'/><child link='" + name +
         "'/><origin xyz='" + place + "'/><axis xyz='0 1 0'/>" +
         (type == "revolute" ? "<limit lower='-1' upper='1' velocity='1' effort='100'/>" : "") +
         "</joint>";
}

/// A pole with two arms of two rods each. The root has the geometry `shape`.
inline std::string PoleUrdf(const std::string& shape, const std::string& mass,
                            const std::string& more = "") {
  return "<robot name='pole'><link name='pole'><inertial><mass value='" + mass +
         "'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial><collision>"
         "<geometry>" +
         shape + "</geometry></collision></link>" + RodXml("l1", "pole", "0.2 0.2 0.3") +
         RodXml("l2", "l1", "0.2 0 0.3") + RodXml("r1", "pole", "0.2 -0.2 0.3") +
         RodXml("r2", "r1", "0.2 0 0.3") + more + "</robot>";
}

/// The draft as the reader of projects sees it.
inline Project ReadBack(const ProjectDraft& draft, const ScratchFolder& folder) {
  folder.Write("robot.urdf", draft.urdf);
  return ReadProject(folder.Write("project.yaml", FormatDraft(draft, "robot.urdf")));
}

}  // namespace elastocal
