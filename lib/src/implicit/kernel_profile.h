#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "implicit/convolution.h"
#include "implicit/interval.h"

namespace tufa::implicit {

/// A kernel of convolution, its slope and its curvature, by a distance in widths.
struct Profile {
  ConvolutionKernel kernel;
  [[nodiscard]] double value(double r) const {
    switch (kernel) {
      case ConvolutionKernel::Gaussian:
        return std::exp(-r * r);
      case ConvolutionKernel::Polynomial:
        return r < 1 ? square(1 - r * r) : 0;
      case ConvolutionKernel::Cauchy:
        break;
    }
    return 1 / square(1 + r * r);
  }
  /// The distance where the kernel is steepest.
  [[nodiscard]] double steepest() const {
    switch (kernel) {
      case ConvolutionKernel::Gaussian:
        return std::numbers::sqrt2 / 2;
      case ConvolutionKernel::Polynomial:
        return 1 / std::numbers::sqrt3;
      case ConvolutionKernel::Cauchy:
        break;
    }
    return 1 / std::sqrt(5.0);
  }
  /// The greatest slope at this distance or a longer one.
  [[nodiscard]] double steepestFrom(double distance) const {
    const double r = std::max(distance, steepest());
    switch (kernel) {
      case ConvolutionKernel::Gaussian:
        return 2 * r * std::exp(-r * r);
      case ConvolutionKernel::Polynomial:
        return r < 1 ? 4 * r * (1 - r * r) : 0;
      case ConvolutionKernel::Cauchy:
        break;
    }
    return 4 * r / (square(1 + r * r) * (1 + r * r));
  }
  /// The most that its gradient changes by a unit of the way from a distance on: the larger of
  /// |k''| and |k'| / r, or what either reaches further out.
  [[nodiscard]] double curvatureFrom(double r) const {
    const double s = r * r;
    switch (kernel) {
      case ConvolutionKernel::Gaussian:
        return s < 1.5 ? std::max(2 * std::exp(-s), 0.893) : (4 * s - 2) * std::exp(-s);
      case ConvolutionKernel::Polynomial:
        return s < 1 ? 8 : 0;
      case ConvolutionKernel::Cauchy:
        break;
    }
    const double cube = square(1 + s) * (1 + s);
    return s < 0.6 ? std::max(4 / cube, 1.221) : (20 * s - 4) / (cube * (1 + s));
  }
  /// Beyond it the kernel is 0, as doubles go.
  [[nodiscard]] double reach() const {
    constexpr double kUnderflow = 27.4;
    if (kernel == ConvolutionKernel::Cauchy) return kInfinity;
    return kernel == ConvolutionKernel::Gaussian ? kUnderflow : 1;
  }
  /// Over a line without end.
  [[nodiscard]] double total() const {
    if (kernel == ConvolutionKernel::Gaussian) return std::sqrt(std::numbers::pi);
    return kernel == ConvolutionKernel::Polynomial ? 16.0 / 15 : std::numbers::pi / 2;
  }
};

}  // namespace tufa::implicit
