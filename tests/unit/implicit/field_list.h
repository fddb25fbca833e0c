#pragma once

#include <tufa/implicit.h>

#include <memory>
#include <string>
#include <vector>

namespace tufa::test {

struct NamedField {
  std::string name;
  std::shared_ptr<const implicit::Field> field;
};

/// One field of every kind, each of them somewhere within two units of the origin.
[[nodiscard]] std::vector<NamedField> allFields();

}  // namespace tufa::test
