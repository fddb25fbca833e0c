#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "grid/openvdb_templates.h"
#include "side.h"

namespace tufa::fuzz {

/// Hands out the input byte by byte, and, when it has ended, bytes that follow from it.
class Source {
 public:
  Source(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}

  int below(int bound) { return next() % bound; }
  bool coin() { return next() % 2 != 0; }
  int next() {
    if (at_ < size_) {
      state_ = (state_ ^ data_[at_]) * 0x9E3779B97F4A7C15u;
      return data_[at_++];
    }
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<int>(state_ >> 56);
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
  std::size_t at_ = 0;
  std::uint64_t state_ = 1;
};

template <class Value>
Value valueFrom(Source& source, bool wild) {
  using Limits = std::numeric_limits<Value>;
  const std::array<Value, 16> special{Value(0),
                                      Value(-0.0),
                                      Value(1),
                                      Value(-1),
                                      Value(0.5),
                                      Value(-0.5),
                                      Limits::denorm_min(),
                                      -Limits::denorm_min(),
                                      Limits::min(),
                                      -Limits::min(),
                                      Limits::epsilon(),
                                      Value(1e30),
                                      Value(-1e30),
                                      Limits::quiet_NaN(),
                                      Limits::infinity(),
                                      -Limits::infinity()};
  if (wild && source.coin()) return special[static_cast<std::size_t>(source.below(16))];
  return static_cast<Value>((source.next() - 128) / 64.0);
}

/// A small grid of any topology and any values.
template <class GridT>
typename GridT::Ptr gridOfType(Source& source) {
  using Value = typename GridT::ValueType;
  const int smallest = kSide < 4 ? 1 : 2;
  const int bound = kSide - smallest + 1;
  const bool hasTiles = kSide >= 8;
  const bool wild = source.coin();
  auto grid = GridT::create(source.coin() ? Value(3) : Value(-3));
  // Most small grids lie in one node of the root: each more costs as much as all else.
  const int least = kSide >= 8 || source.below(16) == 0 ? -8 : 0;
  const openvdb::Coord first =
      openvdb::Coord(least).offsetBy(source.below(16), source.below(16), source.below(16));
  const int sizes[3] = {smallest + source.below(bound), smallest + source.below(bound),
                        smallest + source.below(bound)};
  for (int tiles = hasTiles ? source.below(3) : 0; tiles > 0; --tiles) {
    const openvdb::Coord at((source.below(4) - 2) * 8, (source.below(4) - 2) * 8,
                            (source.below(4) - 2) * 8);
    grid->tree().addTile(1, at, valueFrom<Value>(source, wild), source.coin());
  }
  const int holes = source.below(4);  // of four samples, how many are missing or inactive
  auto accessor = grid->getAccessor();
  const openvdb::CoordBBox box(first, first.offsetBy(sizes[0] - 1, sizes[1] - 1, sizes[2] - 1));
  for (auto at = box.begin(); at; ++at) {
    const Value value = valueFrom<Value>(source, wild);
    if (holes > 0 && source.below(8) < holes) {
      if (source.coin()) accessor.setValueOff(*at, value);
    } else {
      accessor.setValue(*at, value);
    }
  }
  constexpr std::array kClasses{openvdb::GRID_UNKNOWN, openvdb::GRID_LEVEL_SET,
                                openvdb::GRID_FOG_VOLUME};
  grid->setGridClass(kClasses[static_cast<std::size_t>(source.below(3))]);
  openvdb::math::Mat4d matrix = openvdb::math::Mat4d::identity();
  if (source.coin()) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        matrix[row][column] = (source.next() - 128) / 128.0;
      }
      matrix[3][row] = std::ldexp(source.next() - 128, source.below(20));
    }
  }
  // OpenVDB itself refuses matrices that flatten space.
  if (std::abs(matrix.getMat3().det()) > 1e-3) {
    grid->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  }
  return grid;
}

/// Of floats or doubles.
inline openvdb::GridBase::Ptr gridFrom(Source& source) {
  openvdb::initialize();
  if (source.coin()) return gridOfType<openvdb::FloatGrid>(source);
  return gridOfType<openvdb::DoubleGrid>(source);
}

}  // namespace tufa::fuzz
