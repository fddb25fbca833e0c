// Calls in company: two at once, inside a caller's arena, under a caller's limit, with OpenVDB's
// interrupter.

#include <gtest/gtest.h>
#include <openvdb/util/NullInterrupter.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <tufa/contour.h>
#include <tufa/shapes.h>
#include <thread>

#include "support/expect_error.h"
#include "support/mesh_oracle.h"

namespace tufa {
namespace {

openvdb::FloatGrid::Ptr makeTorus() {
  ShapeOptions options;
  options.voxelSize = 0.05;
  return makeShape(Shape::Torus, options);
}

Mesh mesh(const openvdb::GridBase& grid, bool uniform) {
  ContourOptions options;
  options.uniform = uniform;
  return contour(grid, options);
}

class InCompany : public ::testing::Test {
 protected:
  void SetUp() override {
    grid = makeTorus();
    uniform = mesh(*grid, true);
    adaptive = mesh(*grid, false);
    ASSERT_GT(adaptive.triangleCount(), 100u);
  }

  void expectSame() const {
    EXPECT_TRUE(test::sameBytes(mesh(*grid, true), uniform));
    EXPECT_TRUE(test::sameBytes(mesh(*grid, false), adaptive));
  }

  openvdb::FloatGrid::Ptr grid;
  Mesh uniform;
  Mesh adaptive;
};

TEST_F(InCompany, TwoCallsAtOnceOnOneGrid) {
  for (int round = 0; round < 3; ++round) {
    Mesh other;
    std::thread second([&] { other = mesh(*grid, false); });
    const Mesh own = mesh(*grid, true);
    second.join();
    EXPECT_TRUE(test::sameBytes(own, uniform));
    EXPECT_TRUE(test::sameBytes(other, adaptive));
  }
}

TEST_F(InCompany, InsideTheCallersArena) {
  for (const int threads : {1, 2, 5}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { expectSame(); });
  }
}

/// Also with more threads asked for than there may be.
TEST_F(InCompany, UnderTheCallersLimit) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  expectSame();
  ContourOptions options;
  options.threads = 4;
  EXPECT_TRUE(test::sameBytes(contour(*grid, options), adaptive));
}

/// The progress of each call comes from the thread that called, never from both at the same time.
TEST_F(InCompany, EachHearsItsOwnProgress) {
  const auto listen = [&](bool& foreign, int& calls) {
    const std::thread::id own = std::this_thread::get_id();
    ContourOptions options;
    options.progress = [&foreign, &calls, own](std::string_view, double) {
      foreign = foreign || std::this_thread::get_id() != own;
      ++calls;
      return true;
    };
    (void)contour(*grid, options);
  };
  bool foreign[2] = {};
  int calls[2] = {};
  std::thread second([&] { listen(foreign[1], calls[1]); });
  listen(foreign[0], calls[0]);
  second.join();
  EXPECT_FALSE(foreign[0] || foreign[1]);
  EXPECT_GT(calls[0], 5);
  EXPECT_GT(calls[1], 5);
}

/// Stops a call at half of its way.
struct StopsHalfWay : openvdb::util::NullInterrupter {
  int last = 0;
  bool wasInterrupted(int percent) override {
    last = percent;
    return percent >= 50;
  }
};

TEST_F(InCompany, TakesOpenVdbsInterrupter) {
  openvdb::util::NullInterrupter never;
  ContourOptions options;
  options.progress = progressOf(never);
  EXPECT_TRUE(test::sameBytes(contour(*grid, options), adaptive));
  StopsHalfWay interrupter;
  options.progress = progressOf(interrupter);
  test::expectError(ErrorCode::Cancelled, "cancelled", [&] { (void)contour(*grid, options); });
  EXPECT_GE(interrupter.last, 50);
}

}  // namespace
}  // namespace tufa
