#include "tables.h"

#include "table_text.h"

namespace tufa::bench {
namespace {

std::string caseCells(const Case& c) {
  return "| " + c.volume + " | " + number("%.1f", c.activeVoxels * 1e-6) + " | " +
         std::to_string(c.threads) + " | ";
}

}  // namespace

std::string timeTable(const std::vector<Case>& cases) {
  std::string text =
      "| volume | active voxels, millions | threads | mesher | seconds | against volumeToMesh | "
      "CPU seconds | "
      "million voxels a second | extra bytes an active voxel | triangles |\n"
      "| --- | ---: | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const Case& c : cases) {
    for (const Result& result : c.results) {
      const double seconds = median(result.seconds);
      text +=
          caseCells(c) + result.name + " | " + number("%.4f", seconds) + " | " +
          number("%.3f", medianRatio(result, c.results[1])) + " | " +
          number("%.4f", median(result.cpuSeconds)) + " | " +
          number("%.0f", c.activeVoxels * 1e-6 / seconds) + " | " +
          (result.extraBytes ? number("%.1f", *result.extraBytes / c.activeVoxels) : "unknown") +
          " | " + (result.triangles > 0 ? std::to_string(result.triangles) : "") + " |\n";
    }
  }
  return text;
}

std::string stageTable(const std::vector<Case>& cases) {
  if (cases.empty()) return {};
  std::string text = "| volume | active voxels, millions | threads |";
  std::string rule = "| --- | ---: | ---: |";
  for (const StageTime& stage : cases.front().results.front().stages) {
    text += " " + stage.stage + " |";
    rule += " ---: |";
  }
  text += " rest |\n" + rule + " ---: |\n";
  for (const Case& c : cases) {
    const Result& tufa = c.results.front();
    const double whole = median(tufa.seconds);
    double rest = 1;
    text += caseCells(c);
    for (const StageTime& stage : tufa.stages) {
      text += number("%.0f%%", 100 * stage.seconds / whole) + " | ";
      rest -= stage.seconds / whole;
    }
    text += number("%.0f%%", 100 * rest) + " |\n";
  }
  return text;
}

}  // namespace tufa::bench
