#pragma once

#include <tufa/implicit.h>
#include <tufa/mesh.h>

#include <memory>
#include <string>
#include <vector>

namespace tufa::test {

struct NamedField {
  std::string name;
  std::shared_ptr<const implicit::Field> field;
};

/// An octahedron with a tip on each face, in turns a high one and one so low that it is a dent.
[[nodiscard]] Mesh spikes();

/// One field of every kind, each of them somewhere within two units of the origin.
[[nodiscard]] std::vector<NamedField> allFields();

}  // namespace tufa::test
