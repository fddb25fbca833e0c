#include "support/random_solid.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <random>

namespace tufa::test {
namespace {

using Json = nlohmann::json;

constexpr double kPi = 3.14159265358979323846;

class Maker {
 public:
  explicit Maker(unsigned seed) : random_(seed) {}

  Json solid() {
    Json object = primitive();
    for (unsigned more = 1 + below(5); more > 0; --more) {
      // Few intersections: of several not much is left.
      static const char* const kWays[] = {"union",      "union",      "union",       "difference",
                                          "difference", "difference", "intersection"};
      const char* const way = kWays[below(7)];
      Json other = primitive();
      object = {{"type", way}, {"objects", {std::move(object), std::move(other)}}};
    }
    return object;
  }

  Json plates() {
    Json objects = Json::array();
    const unsigned count = 3 + below(5);
    for (unsigned i = 0; i < count; ++i) {
      const Json axis{between(-0.3, 0.3), 1, 0.1};
      const Json turn{{"rotate", {{"axis", axis}, {"degrees", between(-25, 25)}}}};
      const Json move{{"translate", {0, 0, 0.12 * i - 0.4}}};
      objects.push_back({{"type", "box"},
                         {"size", {1.4, 1.1, between(0.03, 0.12)}},
                         {"transform", {turn, move}}});
    }
    return objects;
  }

 private:
  // Of the engine's own bits: distributions differ from one standard library to another.
  unsigned below(unsigned end) { return static_cast<unsigned>(random_() % end); }
  double between(double least, double most) {
    return least + (most - least) * (static_cast<double>(random_()) / 4294967296.0);
  }
  // A list in braces is made in order.
  Json triple(double least, double most) {
    return Json{between(least, most), between(least, most), between(least, most)};
  }

  Json primitive() {
    Json object = shape();
    const Json axis = triple(-1, 1);
    const double degrees = below(2) == 0 ? 90.0 * below(2) : between(0, 360);
    object["transform"] = Json::array(
        {{{"rotate", {{"axis", axis}, {"degrees", degrees}}}}, {{"translate", triple(-0.6, 0.6)}}});
    return object;
  }

  Json shape() {
    switch (below(7)) {
      case 0:
      case 1:
        return {{"type", "box"}, {"size", triple(0.3, 1.6)}};
      case 2:
        return {{"type", "sphere"}, {"radius", between(0.25, 0.9)}};
      case 3:
      case 4:
        return cylinder();
      case 5:
        return torus();
      default:
        return wedge();
    }
  }
  Json cylinder() {
    const double below = -between(0.3, 1.2), above = between(0.3, 1.2);
    return {{"type", "cylinder"},
            {"from", {0, 0, below}},
            {"to", {0, 0, above}},
            {"radius", between(0.15, 0.7)}};
  }
  Json torus() {
    const double radius = between(0.3, 0.7);
    return {{"type", "circle"},
            {"center", {0, 0, 0}},
            {"normal", {0, 0, 1}},
            {"radius", radius},
            {"tube", between(0.1, 0.25)}};
  }
  Json wedge() {
    const double angle = between(20, 80) * kPi / 180;
    const auto plane = [](const Json& point, const Json& normal) {
      return Json{{"type", "plane"}, {"point", point}, {"normal", normal}};
    };
    return {{"type", "intersection"},
            {"objects",
             {Json{{"type", "box"}, {"size", {1.2, 1.2, 1.2}}},
              plane({0, 0, 0}, {std::sin(angle), std::cos(angle), 0}),
              plane({0, -0.3, 0}, {0, -1, 0})}}};
  }

  std::mt19937 random_;
};

}  // namespace

std::string randomSolid(unsigned seed) {
  return Json{{"tufa_scene", 1}, {"name", "solid"}, {"objects", {Maker(seed).solid()}}}.dump();
}

std::string randomPlates(unsigned seed) {
  return Json{{"tufa_scene", 1}, {"name", "plates"}, {"objects", Maker(seed).plates()}}.dump();
}

}  // namespace tufa::test
