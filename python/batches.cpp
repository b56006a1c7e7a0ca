// SPDX-License-Identifier: Apache-2.0
#include <dlfcn.h>

#include "bindings.hpp"

namespace elastocal::python {
namespace {

/// Finds the program: in the build or the installation of this module, or on the path.
py::object FindProgram(const py::object& given) {
  if (!given.is_none()) return py::str(given);
  Dl_info module{};
  if (dladdr(reinterpret_cast<void*>(&FindProgram), &module) != 0) {  // NOLINT
    std::error_code error;
    for (const char* place : {ELASTOCAL_BUILT_PROGRAM, ELASTOCAL_INSTALLED_PROGRAM}) {
      const Path program = Path(module.dli_fname).parent_path() / place;
      if (std::filesystem::exists(program, error)) return py::str(program.string());
    }
  }
  const py::object found = py::module_::import("shutil").attr("which")("elastocal");
  if (found.is_none()) {
    throw InputError("program: elastocal is neither beside the module nor on the path");
  }
  return found;
}

/// The program's error message without its own name.
std::string MessageOf(const std::string& said) {
  constexpr std::string_view kError = "error: ";
  const std::size_t at = said.rfind(kError);
  std::string message = at == std::string::npos ? said : said.substr(at + kError.size());
  while (message.ends_with('\n')) message.pop_back();
  return message;
}

py::object Batch(const Path& manifest, const Path& folder, int workers, double level,
                 const py::object& program) {
  ExpectWithin("workers", workers, 0, 1024);
  ExpectBounded("compare --level", level);
  const py::object subprocess = py::module_::import("subprocess");
  py::list words;
  words.append(FindProgram(program));
  for (const std::string& word :
       {std::string("batch"), manifest.string(), std::string("-o"), folder.string(),
        std::string("--workers"), std::to_string(workers), std::string("--json"),
        std::string("-")}) {
    words.append(word);
  }
  words.append("--level");
  words.append(py::repr(py::float_(level)));
  const py::object process =
      subprocess.attr("Popen")(words, "stdout"_a = subprocess.attr("PIPE"),
                               "stderr"_a = subprocess.attr("PIPE"), "text"_a = true);
  py::tuple texts;
  try {
    texts = process.attr("communicate")();
  } catch (const py::error_already_set&) {  // for instance on Ctrl-C
    process.attr("terminate")();
    process.attr("wait")();
    throw;
  }
  const int code = process.attr("returncode").cast<int>();
  if (code == 0 || code == 4) return FromJson(texts[0].cast<std::string>());
  const std::string message = MessageOf(texts[1].cast<std::string>());
  if (code == 2 || code == 3) throw InputError(message);
  throw std::runtime_error("elastocal batch ended with " + std::to_string(code) + ": " + message);
}

}  // namespace

void AddBatches(py::module_& module) {
  module.def(
      "batch", Batch, "manifest"_a, "folder"_a, py::kw_only(), "workers"_a = 0, "level"_a = 0.05,
      "program"_a = py::none(),
      "Does the tasks of a manifest (docs/scale.md) into a folder by the program's command of that "
      "name, which is looked for beside the module and on the path unless `program` names it: the "
      "dict of fleet.json. workers: tasks at a time; 0: one a core. What is done is not done "
      "again.");
}

}  // namespace elastocal::python
