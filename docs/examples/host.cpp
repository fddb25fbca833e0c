// Inside a program that has threads and a cancel button of its own, such as a modelling tool: a
// limit on threads, OpenVDB's interrupter, and what comes of a cancelled call.

#include <openvdb/util/NullInterrupter.h>
#include <tbb/task_arena.h>

#include <tufa/tufa.h>
#include <atomic>
#include <iostream>

namespace {

/// What a host derives from OpenVDB's interrupter.
struct Button : openvdb::util::NullInterrupter {
  std::atomic<bool> pressed{false};
  std::atomic<int> percent{0};
  bool wasInterrupted(int now) override {
    percent = now;
    return pressed;
  }
};

}  // namespace

int main() {
  const auto grid = tufa::makeShape(tufa::Shape::Torus);
  Button button;
  tufa::ContourOptions options;
  options.progress = tufa::progressOf(button);

  // The arena's threads are all that the call uses.
  tbb::task_arena arena(2);
  tufa::Mesh mesh;
  arena.execute([&] { mesh = tufa::contour(*grid, options); });
  std::cout << mesh.triangleCount() << " triangles at " << button.percent << "%\n";

  button.pressed = true;
  try {
    mesh = tufa::contour(*grid, options);
  } catch (const tufa::Error& error) {
    std::cout << error.what() << "\n";
    return error.code() == tufa::ErrorCode::Cancelled && button.percent < 100 ? 0 : 1;
  }
  return 1;
}
