// Public calls inside a group of TBB's tasks that the program cancels while they run: TBB then
// skips the loops of that group without a word. The calls' own loops must not be among them.

#include <gtest/gtest.h>
#include <openvdb/thread/Threading.h>
#include <tbb/task_group.h>

#include <tufa/chunks.h>
#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/lod.h>
#include <tufa/shapes.h>
#include <tufa/voxelize.h>
#include <functional>
#include <random>
#include <sstream>

#include "support/mesh_oracle.h"
#include "support/scratch_folder.h"

namespace tufa {
namespace {

/// A public call: takes a progress and returns what it made as bytes.
using Call = std::function<std::string(const Progress& progress)>;

template <class Number>
void add(std::string& bytes, const std::vector<Number>& numbers) {
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number));
}

std::string bytesOf(const Mesh& mesh) {
  std::string bytes;
  add(bytes, mesh.positions);
  add(bytes, mesh.normals);
  add(bytes, mesh.triangles);
  add(bytes, mesh.quads);
  return bytes;
}

std::string bytesOf(const openvdb::FloatGrid& grid) {
  std::ostringstream stream;
  grid.tree().writeTopology(stream);
  grid.tree().writeBuffers(stream);
  return stream.str();
}

/// Where a call's group is cancelled: at its progress call of that number; 0: before it begins.
struct Cancelling {
  std::size_t at = 0;
  bool current = false;  ///< the group that TBB says the progress call belongs to
};

/// Runs a call in a group that is cancelled meanwhile.
std::string runCancelled(const Call& call, const Cancelling& cancelling) {
  std::string bytes;
  tbb::task_group_context context;
  tbb::task_group group(context);
  group.run_and_wait([&] {
    if (cancelling.at == 0) context.cancel_group_execution();
    std::size_t calls = 0;
    bytes = call([&](std::string_view, double) {
      if (++calls != cancelling.at) return true;
      cancelling.current ? openvdb::thread::cancelGroupExecution()
                         : context.cancel_group_execution();
      return true;
    });
  });
  return bytes;
}

class CancelledGroup : public ::testing::Test {
 protected:
  /// Cancels the group before the call and at 50 random times of it. The call must end as if there
  /// were no group, or say that it was cancelled.
  static void expectNoWrongResult(const Call& call) {
    std::size_t calls = 0;
    const std::string right = call([&](std::string_view, double) { return ++calls > 0; });
    ASSERT_FALSE(right.empty());
    std::mt19937 random(1);
    std::vector<Cancelling> times = {{0, false}};
    for (int i = 0; i < 50 && calls > 0; ++i) times.push_back({1 + random() % calls, i % 2 == 0});
    for (const Cancelling& cancelling : times) {
      try {
        EXPECT_TRUE(runCancelled(call, cancelling) == right)
            << "a wrong result, cancelled at call " << cancelling.at << " of " << calls;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::Cancelled) << error.what();
      }
    }
  }

  static openvdb::FloatGrid::Ptr makeTorus(const Progress& progress = {}) {
    ShapeOptions options;
    options.voxelSize = 0.08;
    options.progress = progress;
    return makeShape(Shape::Torus, options);
  }

  const openvdb::FloatGrid::Ptr grid = makeTorus();
  const test::ScratchFolder folder;
};

TEST_F(CancelledGroup, ChangesNoMesh) {
  for (const bool uniform : {true, false}) {
    expectNoWrongResult([&](const Progress& progress) {
      ContourOptions options;
      options.uniform = uniform;
      options.progress = progress;
      return bytesOf(contour(*grid, options));
    });
  }
}

TEST_F(CancelledGroup, ChangesNoChain) {
  expectNoWrongResult([&](const Progress& progress) {
    LodOptions options;
    options.levels = 3;
    options.contour.progress = progress;
    std::string bytes;
    for (const Lod& lod : buildLods(*grid, options).levels) bytes += bytesOf(lod.mesh);
    return bytes;
  });
}

TEST_F(CancelledGroup, ChangesNoChunk) {
  expectNoWrongResult([&](const Progress& progress) {
    ChunkOptions options;
    options.chunkSize = 16;
    options.levels = 2;
    options.contour.progress = progress;
    std::string bytes;
    std::vector<Chunk> chunks;
    (void)buildChunks(*grid, options, [&](const ChunkIndex&, Chunk&& chunk) {
      for (std::size_t level = 0; level < chunk.levels.size(); ++level) {
        bytes += bytesOf(meshForMask(chunk, level, 0));
      }
      // A sink is a function of the program's, too.
      openvdb::thread::cancelGroupExecution();
    });
    return bytes;
  });
}

TEST_F(CancelledGroup, ChangesNoGrid) {
  expectNoWrongResult([&](const Progress& progress) { return bytesOf(*makeTorus(progress)); });
  const Mesh mesh = contour(*grid);
  expectNoWrongResult([&](const Progress& progress) {
    VoxelizeOptions options;
    options.voxelSize = 0.1;
    options.progress = progress;
    return bytesOf(*voxelize(mesh, options));
  });
}

TEST_F(CancelledGroup, ChangesNoFile) {
  const LodChain chain = buildLods(*grid);
  expectNoWrongResult([&](const Progress& progress) {
    LodWriteOptions options;
    options.compression = GlbCompression::Meshopt;
    options.progress = progress;
    writeLods(chain, folder / "m.glb", options);
    return test::readBytes(folder / "m.glb");
  });
  expectNoWrongResult([&](const Progress& progress) {
    WriteOptions options;
    options.compression = GlbCompression::Quantized;
    options.progress = progress;
    write(chain.levels.front().mesh, folder / "w.glb", options);
    return test::readBytes(folder / "w.glb");
  });
  expectNoWrongResult([&](const Progress&) {
    writeGrids({grid}, folder / "g.vdb");
    const GridInfo info = describeGrids(folder / "g.vdb").at(0);
    const auto stored = readGrid(folder / "g.vdb")->metaValue<openvdb::Int64>("file_voxel_count");
    return std::to_string(info.activeVoxels) + " " + std::to_string(info.memoryBytes) + " " +
           std::to_string(stored);
  });
}

}  // namespace
}  // namespace tufa
