#pragma once

#include <tufa/lod.h>
#include <filesystem>
#include <string>
#include <vector>

namespace tufa::tools {

/// What the page of a chain shows beside its pictures.
struct LodPage {
  std::string title;
  std::string summary;                         ///< a line of text
  std::vector<std::string> headings;           ///< of the table
  std::vector<std::vector<std::string>> rows;  ///< of the table, one for each LOD
  bool yUp = true;                             ///< pictures have the volume's y axis up, not z
  int threads = 0;                             ///< most threads; 0: all
  Progress progress;
};

/// Writes one page of HTML that needs no other file: for each LOD a picture, its wireframe, and a
/// map of its distance to `reference`, the uniform mesh. Throws Error(UnwritableFile, Cancelled).
void writeLodPage(const LodChain& chain, const Mesh& reference, const LodPage& page,
                  const std::filesystem::path& path);

}  // namespace tufa::tools
