// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "elastocal/description/calibrated_mjcf.hpp"
#include "elastocal/files/xml_edit.hpp"

namespace elastocal {
namespace {

namespace fs = std::filesystem;

/// Files that the assets of an MJCF name.
struct AssetFiles {
  bool any = false;
  std::vector<XmlElement> models;  ///< other MJCFs, which no compiler's folder is about
};

AssetFiles FindAssetFiles(const XmlElement& root) {
  AssetFiles files;
  for (const XmlElement& section : root.Children()) {
    if (section.Tag() != "asset") continue;
    for (const XmlElement& asset : section.Children()) {
      files.any = files.any || asset.Has("file") || asset.Tag() == "texture";
      if (asset.Tag() == "model" && asset.Has("file")) files.models.push_back(asset);
    }
  }
  return files;
}

bool Includes(const XmlElement& within) {
  const std::vector<XmlElement> children = within.Children();
  return std::any_of(children.begin(), children.end(), [](const XmlElement& child) {
    return child.Tag() == "include" || Includes(child);
  });
}

}  // namespace

std::string MoveMjcf(const std::string& mjcf, const std::string& source, const fs::path& from,
                     const fs::path& to) {
  const auto folder = [](const fs::path& path) {
    return fs::weakly_canonical(path.empty() ? fs::path(".") : path);
  };
  const fs::path back = folder(from).lexically_relative(folder(to));
  if (back.empty() || back == ".") return mjcf;
  const XmlText xml(mjcf, source);
  const XmlElement root = xml.Root();
  if (Includes(root)) {
    root.Fail(
        "it includes other files, which it finds from its own folder; a new model beside it was "
        "expected (-o)");
  }
  const AssetFiles files = FindAssetFiles(root);
  if (!files.any) return mjcf;
  std::vector<XmlEdit> edits;
  const auto lead_back = [&](const XmlElement& element, const char* attribute) {
    const fs::path given = element.Text(attribute);
    if (given.is_relative()) {
      edits.push_back(
          SetAttribute(element, attribute, EscapedXml((back / given).lexically_normal().string())));
    }
  };
  bool meshes = false, textures = false;
  for (const XmlElement& element : root.Children()) {
    if (element.Tag() != "compiler") continue;
    for (const char* attribute : {"assetdir", "meshdir", "texturedir"}) {
      if (!element.Has(attribute)) continue;
      const bool both = attribute[0] == 'a';
      meshes = meshes || both || attribute[0] == 'm';
      textures = textures || both || attribute[0] == 't';
      lead_back(element, attribute);
    }
  }
  for (const XmlElement& model : files.models) lead_back(model, "file");
  if (!meshes || !textures) {
    std::string compiler = "<compiler";
    if (!meshes) compiler += " meshdir=\"" + EscapedXml(back.string()) + "\"";
    if (!textures) compiler += " texturedir=\"" + EscapedXml(back.string()) + "\"";
    edits.push_back(InsertElement(mjcf, root, compiler + "/>"));
  }
  return ApplyEdits(mjcf, std::move(edits));
}

}  // namespace elastocal
