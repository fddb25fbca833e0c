#include "uniform/ambiguity.h"

namespace tufa::uniform {
namespace {

// The bilinear interpolant has the value (a c - b d) / (a + c - b - d) at its saddle (Nielson and
// Hamann 1991).
bool saddleIsInside(const std::array<double, 4>& v) {
  const double numerator = v[0] * v[2] - v[1] * v[3];
  const double denominator = v[0] + v[2] - v[1] - v[3];
  return denominator < 0 ? numerator > 0 : numerator < 0;
}

// Where a linear function from a to b is zero; half way if both are zero.
double zeroBetween(double a, double b) { return a == b ? 0.5 : a / (a - b); }

// Whether the bilinear interpolant is inside where the two chords between opposite crossings cross.
bool chordsMeetInside(const std::array<double, 4>& v) {
  // Corners at (0,0), (1,0), (1,1), (0,1); crossings on the edges v = 0, u = 1, v = 1, u = 0.
  const double bottom = zeroBetween(v[0], v[1]);
  const double right = zeroBetween(v[1], v[2]);
  const double top = zeroBetween(v[3], v[2]);
  const double left = zeroBetween(v[0], v[3]);
  // One chord is u = bottom + s (top - bottom), v = s; the other v = left + u (right - left).
  const double lean = top - bottom, slope = right - left;
  const double s = (left + bottom * slope) / (1 - lean * slope + 1e-300);
  const double u = bottom + s * lean;
  const double value = (v[0] * (1 - u) + v[1] * u) * (1 - s) + (v[3] * (1 - u) + v[2] * u) * s;
  return value < 0;
}

}  // namespace

bool joinsInside(Ambiguity rule, const std::array<double, 4>& values) {
  switch (rule) {
    case Ambiguity::Separate:
    case Ambiguity::Original:  // which asks the corners of a cell, and no face
      return false;
    case Ambiguity::Join:
      return true;
    case Ambiguity::Asymptotic:
      return saddleIsInside(values);
    case Ambiguity::Chord:
      return chordsMeetInside(values);
  }
  return false;
}

}  // namespace tufa::uniform
