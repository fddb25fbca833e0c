// How soon a call stops when it is asked to: the longest stretch without a question in each stage
// of a whole run, then runs that are cancelled at moments spread over it.

#include <tufa/chunks.h>
#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/lod.h>
#include <tufa/shapes.h>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

namespace {

double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double secondsSince(double start) { return now() - start; }

using Call = std::function<void(const tufa::Progress&)>;

/// Runs the call to its end and prints, for each stage, how long it took and its longest silence.
double measureSilence(const Call& call) {
  struct Stage {
    double longest = 0;
    double all = 0;
  };
  std::vector<std::pair<std::string, Stage>> stages;
  const auto start = now();
  auto last = start;
  std::string current = "(before the first)";
  call([&](std::string_view name, double) {
    const double silence = secondsSince(last);
    if (stages.empty() || stages.back().first != current) stages.emplace_back(current, Stage());
    stages.back().second.longest = std::max(stages.back().second.longest, silence);
    stages.back().second.all += silence;
    current = name;
    last = now();
    return true;
  });
  stages.emplace_back("(after the last)", Stage{secondsSince(last), secondsSince(last)});
  std::printf("%-20s %10s %18s\n", "stage", "seconds", "longest silence ms");
  for (const auto& [name, stage] : stages) {
    std::printf("%-20s %10.2f %18.1f\n", name.c_str(), stage.all, 1e3 * stage.longest);
  }
  return secondsSince(start);
}

/// Seconds from the moment the caller wants to stop to the return of the call.
double measureCancel(const Call& call, double after, std::string& stage) {
  const auto start = now();
  try {
    call([&](std::string_view name, double) {
      stage = name;
      return secondsSince(start) < after;
    });
  } catch (const tufa::Error&) {
  }
  return secondsSince(start) - after;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "adaptive";
  const double voxel = argc > 2 ? std::atof(argv[2]) : 0.002;
  const int cancels = argc > 3 ? std::atoi(argv[3]) : 10;
  tufa::ShapeOptions shape;
  shape.voxelSize = voxel;
  const auto grid = tufa::makeShape(tufa::Shape::Sphere, shape);
  std::printf("%llu active voxels, %s\n", static_cast<unsigned long long>(grid->activeVoxelCount()),
              what.c_str());
  const Call call = [&](const tufa::Progress& progress) {
    if (what == "lod") {
      tufa::LodOptions options;
      options.contour.progress = progress;
      options.contour.threads = 1;
      (void)tufa::buildLods(*grid, options);
      return;
    }
    if (what == "chunks") {
      tufa::ChunkOptions options;
      options.contour.progress = progress;
      options.contour.threads = 1;
      (void)tufa::buildChunks(*grid, options, [](const tufa::ChunkIndex&, tufa::Chunk&&) {});
      return;
    }
    tufa::ContourOptions options;
    options.uniform = what == "uniform";
    options.progress = progress;
    options.threads = 1;
    (void)tufa::contour(*grid, options);
  };
  const double whole = measureSilence(call);
  double worst = 0;
  for (int n = 0; n < cancels; ++n) {
    const double after = whole * (n + 0.5) / cancels;
    std::string stage;
    const double latency = measureCancel(call, after, stage);
    worst = std::max(worst, latency);
    std::printf("asked after %6.2f s, in %s: back after %.1f ms\n", after, stage.c_str(),
                1e3 * latency);
  }
  std::printf("largest: %.1f ms\n", 1e3 * worst);
}
