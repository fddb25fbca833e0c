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
      "| volume | active voxels, millions | threads | mesher | seconds | ratio | CPU seconds | "
      "million voxels a second | million vertices a second | extra bytes an active voxel | "
      "triangles |\n"
      "| --- | ---: | ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const Case& c : cases) {
    for (const Result& result : c.results) {
      const double seconds = median(result.seconds);
      const std::string bytes =
          result.extraBytes ? number("%.1f", *result.extraBytes / c.activeVoxels) : "unknown";
      text += caseCells(c) + result.name + " | " + number("%.4f", seconds) + " | " +
              number("%.3f", medianRatio(result, c.results[result.peer])) + " | " +
              number("%.4f", median(result.cpuSeconds)) + " | " +
              number("%.0f", c.activeVoxels * 1e-6 / seconds) + " | " +
              number("%.1f", static_cast<double>(result.vertices) * 1e-6 / seconds) + " | " +
              bytes + " | " + (result.triangles > 0 ? std::to_string(result.triangles) : "") +
              " |\n";
    }
  }
  return text;
}

std::string stageTable(const std::vector<Case>& cases, const std::string& name) {
  std::string head, rows;
  for (const Case& c : cases) {
    for (const Result& result : c.results) {
      if (result.name != name) continue;
      const double whole = median(result.seconds);
      double rest = 1;
      std::string names = "| volume | active voxels, millions | threads |";
      std::string rule = "| --- | ---: | ---: |";
      rows += caseCells(c);
      for (const StageTime& stage : result.stages) {
        names += " " + stage.stage + " |";
        rule += " ---: |";
        rows += number("%.0f%%", 100 * stage.seconds / whole) + " | ";
        rest -= stage.seconds / whole;
      }
      rows += number("%.0f%%", 100 * rest) + " |\n";
      head = names + " rest |\n" + rule + " ---: |\n";
    }
  }
  return head + rows;
}

}  // namespace tufa::bench
