#include <algorithm>
#include <cmath>
#include <numbers>

#include "shapes/fields.h"
#include "shapes/hash.h"

namespace tufa::shapes {
namespace {

/// A height and its slopes along x and y.
struct Height {
  double value = 0;
  double slopeX = 0;
  double slopeY = 0;
};

/// Perlin's quintic fade, whose first and second derivatives vanish at both ends.
double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }
double fadeSlope(double t) { return 30 * t * t * (t * (t - 2) + 1); }

/// Value noise in [-1, 1] on the integer lattice.
Height valueNoise(double x, double y, std::uint64_t seed) {
  const double cellX = std::floor(x);
  const double cellY = std::floor(y);
  const auto corner = [&](int dx, int dy) {
    return 2 * randomAt(seed, static_cast<std::int64_t>(cellX) + dx,
                        static_cast<std::int64_t>(cellY) + dy, 0) -
           1;
  };
  const double a = corner(0, 0);
  const double b = corner(1, 0) - a;
  const double c = corner(0, 1) - a;
  const double d = corner(1, 1) - a - b - c;
  const double u = fade(x - cellX);
  const double v = fade(y - cellY);
  return {a + b * u + c * v + d * u * v, fadeSlope(x - cellX) * (b + d * v),
          fadeSlope(y - cellY) * (c + d * u)};
}

/// Hills by fractal noise on the square [-1, 1]^2, cut by its sides and closed below. The field is
/// the height above the ground over the length of (grad h, 1): the distance, to first order.
class Terrain final : public DistanceField {
 public:
  explicit Terrain(std::uint32_t seed) : seed_(seed) {}

  [[nodiscard]] double halfExtent() const override { return 1; }

  [[nodiscard]] double distance(const Vec3& point) const override {
    return combine(point, heightAt(point.x(), point.y()));
  }

  [[nodiscard]] ValueRange range(const Vec3& center, double radius) const override {
    const double above = center.z() - heightAt(center.x(), center.y()).value;
    const double change = radius + heightChange(radius);
    const double slab = slabDistance(center);
    return {std::max(atMostSteep(above - change), slab - radius),
            std::max(atLeastFlat(above + change), slab + radius)};
  }

  void sample(const BlockLattice& lattice, double /*band*/,
              std::array<double, BlockLattice::kSamples>& values) const override {
    std::size_t n = 0;
    for (int x = 0; x < BlockLattice::kSide; ++x) {
      for (int y = 0; y < BlockLattice::kSide; ++y) {
        const Vec3 foot = lattice.point(x, y, 0);
        const Height height = heightAt(foot.x(), foot.y());
        for (int z = 0; z < BlockLattice::kSide; ++z) {
          values[n++] = combine(lattice.point(x, y, z), height);
        }
      }
    }
  }

 private:
  static constexpr int kOctaves = 6;
  static constexpr double kAmplitude = 0.3;
  static constexpr double kFrequency = 1.5;
  static constexpr double kGain = 0.45;     ///< amplitude of an octave to the one before
  static constexpr double kLacunarity = 2;  ///< frequency of an octave to the one before
  static constexpr double kBottom = -0.6;
  /// Steepest slope of valueNoise(): each component is at most fadeSlope(1/2) times a difference
  /// of 2.
  static constexpr double kSteepestNoise = 1.875 * 2 * std::numbers::sqrt2;

  [[nodiscard]] Height heightAt(double x, double y) const {
    // Each octave is rotated against the one before, so that their lattices do not line up.
    const double turnCos = 0.8;
    const double turnSin = 0.6;
    Height sum;
    double c = 1;
    double s = 0;
    double amplitude = kAmplitude;
    double frequency = kFrequency;
    for (int octave = 0; octave < kOctaves; ++octave) {
      const Height noise = valueNoise(frequency * (c * x - s * y), frequency * (s * x + c * y),
                                      (std::uint64_t{seed_} << 8) + octave);
      sum.value += amplitude * noise.value;
      sum.slopeX += amplitude * frequency * (c * noise.slopeX + s * noise.slopeY);
      sum.slopeY += amplitude * frequency * (c * noise.slopeY - s * noise.slopeX);
      const double nextCos = c * turnCos - s * turnSin;
      s = s * turnCos + c * turnSin;
      c = nextCos;
      amplitude *= kGain;
      frequency *= kLacunarity;
    }
    return sum;
  }

  /// How much the height may change within a horizontal distance.
  static double heightChange(double radius) {
    double change = 0;
    double amplitude = kAmplitude;
    double frequency = kFrequency;
    for (int octave = 0; octave < kOctaves; ++octave) {
      change += amplitude * std::min(2.0, kSteepestNoise * frequency * radius);
      amplitude *= kGain;
      frequency *= kLacunarity;
    }
    return change;
  }

  static double steepestSecant() {
    static const double secant = [] {
      double slope = 0;
      double octaveSlope = kAmplitude * kFrequency * kSteepestNoise;
      for (int octave = 0; octave < kOctaves; ++octave, octaveSlope *= kGain * kLacunarity) {
        slope += octaveSlope;
      }
      return std::hypot(1.0, slope);
    }();
    return secant;
  }

  /// Least and greatest value of the field for a height above ground, whatever the slope there.
  static double atMostSteep(double above) { return above > 0 ? above / steepestSecant() : above; }
  static double atLeastFlat(double above) { return above > 0 ? above : above / steepestSecant(); }

  static double slabDistance(const Vec3& p) {
    return std::max({std::abs(p.x()) - 1, std::abs(p.y()) - 1, kBottom - p.z()});
  }

  static double combine(const Vec3& point, const Height& height) {
    const double secant =
        std::sqrt(1 + height.slopeX * height.slopeX + height.slopeY * height.slopeY);
    return std::max((point.z() - height.value) / secant, slabDistance(point));
  }

  std::uint32_t seed_;
};

}  // namespace

std::unique_ptr<DistanceField> makeTerrain(std::uint32_t seed) {
  return std::make_unique<Terrain>(seed);
}

}  // namespace tufa::shapes
