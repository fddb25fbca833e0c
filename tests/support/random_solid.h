#pragma once

#include <string>

namespace tufa::test {

/// The text of a scene for implicit::readScene(): up to six primitives (boxes, spheres, cylinders,
/// tori, wedges of 20 to 80 degrees), turned and moved anyhow, joined, cut and intersected. About
/// two units across. The same for a seed on every machine; some are empty.
[[nodiscard]] std::string randomSolid(unsigned seed);

/// The same of a stack of thin plates at small angles, about 1.4 units long and 0.03 to 0.12 thick,
/// which pass through each other, and beside each other at less than any distance.
[[nodiscard]] std::string randomPlates(unsigned seed);

}  // namespace tufa::test
