// Stands for Tufa::check in a command that is built without it.
#include <tufa/check.h>

#include <tufa/compare.h>
#include <tufa/error.h>
#include <tufa/repair.h>

#include "checker.h"

namespace tufa {
namespace {

[[noreturn]] void refuse() {
  throw Error(ErrorCode::InvalidArgument,
              "this tufa was built without the mesh checker; configure with -DTUFA_BUILD_CHECK=ON");
}

}  // namespace

bool CheckReport::watertight() const { return false; }

CheckReport check(const Mesh& /*mesh*/, const CheckOptions& /*options*/) { refuse(); }

DistanceReport checkAgainst(const Mesh& /*mesh*/, const openvdb::GridBase& /*grid*/,
                            const DistanceOptions& /*options*/) {
  refuse();
}

std::vector<double> distancesTo(const Mesh& /*mesh*/, const std::vector<Position>& /*points*/,
                                const DistanceOptions& /*options*/) {
  refuse();
}

const std::vector<std::string_view>& comparedNames() {
  static const std::vector<std::string_view> kNone;
  return kNone;
}

Comparison compareMethods(const openvdb::GridBase& /*grid*/, const CompareOptions& /*options*/) {
  refuse();
}

Mesh repair(const Mesh& /*mesh*/, const RepairOptions& /*options*/, RepairReport* /*report*/) {
  refuse();
}

namespace tools {

void requireChecker() { refuse(); }

std::string checkerHelp(const std::string& help) {
  return help + " (not in this build, which has no mesh checker)";
}

}  // namespace tools
}  // namespace tufa
