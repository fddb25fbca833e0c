// Writes frames of a puff of smoke, as a simulation would leave them: a density, a temperature and
// a velocity in world units per second. Empty at first.
//
//     smoke [FOLDER [FRAMES]]      writes FOLDER/smoke.0001.vdb and so on

#include <tufa/tufa.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>

namespace {

constexpr double kVoxel = 0.012;
constexpr double kRise = 1.2;     ///< world units per second
constexpr double kGrowth = 0.25;  ///< of the radius, world units per second
constexpr double kFramesPerSecond = 24;

/// The puff at a time.
struct Puff {
  double seconds = 0;

  [[nodiscard]] double radius() const { return kGrowth * seconds; }
  [[nodiscard]] openvdb::Vec3d centre() const { return {0, 0, kRise * seconds}; }

  /// From 1 in the middle to 0 at a billowing rim.
  [[nodiscard]] double density(const openvdb::Vec3d& p) const {
    const openvdb::Vec3d q = (p - centre()) / radius();
    double billows = 0, size = 0.25;
    for (const double frequency : {4.0, 9.0, 19.0}) {
      billows += size * std::sin(frequency * q.x() + seconds) * std::sin(frequency * q.y() + 1) *
                 std::sin(frequency * q.z() - 2 * seconds);
      size /= 2;
    }
    return std::clamp(1 - q.length() + billows, 0.0, 1.0);
  }
  /// It rises, and grows from its centre.
  [[nodiscard]] openvdb::Vec3s velocity(const openvdb::Vec3d& p) const {
    return openvdb::Vec3s(openvdb::Vec3d(0, 0, kRise) + (p - centre()) / seconds);
  }
};

template <class GridT>
typename GridT::Ptr makeGrid(const char* name) {
  auto grid = GridT::create();
  grid->setName(name);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(kVoxel));
  return grid;
}

void writeFrame(const Puff& puff, const std::filesystem::path& path) {
  const auto density = makeGrid<openvdb::FloatGrid>("density");
  const auto temperature = makeGrid<openvdb::FloatGrid>("temperature");
  const auto velocity = makeGrid<openvdb::Vec3SGrid>("vel");
  density->setGridClass(openvdb::GRID_FOG_VOLUME);
  auto densities = density->getAccessor();
  auto temperatures = temperature->getAccessor();
  auto velocities = velocity->getAccessor();
  const double reach = 1.2 * puff.radius();
  const openvdb::CoordBBox box(
      openvdb::Coord::floor((puff.centre() - openvdb::Vec3d(reach)) / kVoxel),
      openvdb::Coord::ceil((puff.centre() + openvdb::Vec3d(reach)) / kVoxel));
  for (auto voxel = box.begin(); voxel; ++voxel) {
    const openvdb::Vec3d p = kVoxel * (*voxel).asVec3d();
    const double value = puff.density(p);
    if (value <= 0) continue;
    densities.setValue(*voxel, static_cast<float>(value));
    temperatures.setValue(*voxel, static_cast<float>(300 + 600 * value));
    velocities.setValue(*voxel, puff.velocity(p));
  }
  tufa::writeGrids({density, temperature, velocity}, path);
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : "smoke";
  const int frames = argc > 2 ? std::atoi(argv[2]) : 3;
  std::filesystem::create_directories(folder);
  for (int frame = 1; frame <= frames; ++frame) {
    const std::string digits = std::to_string(frame);
    const std::string name =
        "smoke." + std::string(4 - std::min<std::size_t>(4, digits.size()), '0') + digits + ".vdb";
    writeFrame({6 * (frame - 1) / kFramesPerSecond + 1e-6}, folder / name);
  }
  std::cout << "wrote " << frames << " frames to " << folder.string() << "\n";
  return 0;
}
