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

/// The draft of a robot of the repository, which takes seconds under the sanitizers.
inline ProjectDraft DraftFileAnew(const std::string& file) {
  return DraftProject(ReadFile(SourceFile(file)), file, {});
}

/// The same, once in a program.
inline const ProjectDraft& DraftFile(const std::string& file) {
  static std::map<std::string, ProjectDraft> drafts;
  const auto found = drafts.find(file);
  return found != drafts.end() ? found->second
                               : drafts.emplace(file, DraftFileAnew(file)).first->second;
}

/// The draft as its reader sees it.
inline Project ReadBack(const ProjectDraft& draft, const ScratchFolder& folder) {
  folder.Write("robot.urdf", draft.urdf);
  return ReadProject(folder.Write("project.yaml", FormatDraft(draft, "robot.urdf")));
}

}  // namespace elastocal
