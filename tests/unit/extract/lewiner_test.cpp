// Beside scikit-image's marching cubes, by the tables of Lewiner, Lopes, Vieira and Tavares 2003:
// where they and mc33 differ in the topology of a cell, which of them has that of the trilinear
// surface.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "unit/extract/mc33_cells.h"

namespace tufa::extraction {
namespace {

using cells::chosenFor;
using cells::Topology;
using cells::topologyOf;

/// A Python that has scikit-image, if there is one.
std::string pythonWithLewiner() {
  for (const std::string python : {"python3", "/usr/bin/python3"}) {
    const std::string asks = python + " -c 'import skimage.measure' > /dev/null 2>&1";
    if (std::system(asks.c_str()) == 0) return python;
  }
  return "";
}

/// What scikit-image makes of each cell.
std::vector<Topology> lewinerOf(const std::string& python, const std::vector<CornerValues>& cells) {
  const auto folder = std::filesystem::path(::testing::TempDir());
  const std::string in = folder / "lewiner_cells.bin", out = folder / "lewiner_topology.txt";
  std::ofstream file(in, std::ios::binary);
  for (const CornerValues& cell : cells) {
    file.write(reinterpret_cast<const char*>(cell.data()), sizeof cell);
  }
  file.close();
  const std::string line = python + " '" + TUFA_LEWINER_SCRIPT + "' '" + in + "' '" + out + "'";
  EXPECT_EQ(std::system(line.c_str()), 0) << line;
  std::ifstream results(out);
  std::vector<Topology> all;
  for (Topology one; results >> one.components >> one.euler;) all.push_back(one);
  return all;
}

TEST(Mc33, IsRightWhereverScikitImagesLewinerDiffers) {
  const std::string python = pythonWithLewiner();
  if (python.empty()) GTEST_SKIP() << "no Python has scikit-image (python3-skimage)";
  cells::Cells random(5);
  std::vector<CornerValues> cells;
  while (cells.size() < 20'000) {
    const CornerValues values = random.next();
    const CornerMask mask = cells::maskOf(values);
    bool certain = true;
    (void)cells::trilinear(values, certain);
    if (certain && mask != 0 && mask != 255) cells.push_back(values);
  }
  const std::vector<Topology> others = lewinerOf(python, cells);
  ASSERT_EQ(others.size(), cells.size());
  int differ = 0, oursRight = 0, othersRight = 0, tunnels = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    bool certain = true;
    const Topology truth = cells::trilinear(cells[i], certain);
    const Topology ours = topologyOf(chosenFor(cells[i]));
    if (ours == others[i]) continue;
    ++differ;
    oursRight += ours == truth ? 1 : 0;
    othersRight += others[i] == truth ? 1 : 0;
    tunnels += truth.euler < truth.components ? 1 : 0;
  }
  std::cout << differ << " of " << cells.size() << " cells differ; mc33 is right in " << oursRight
            << ", scikit-image in " << othersRight << "; " << tunnels << " have a tunnel\n";
  EXPECT_EQ(oursRight, differ);
  EXPECT_EQ(othersRight, 0);
  // Both are after the same surface: this is no comparison of apples with pears.
  EXPECT_LT(differ, static_cast<int>(cells.size() / 10));
}

}  // namespace
}  // namespace tufa::extraction
