#pragma once

#include <tufa/repair.h>

#include <functional>

namespace tufa::checks {

/// The steps of repair() but its checks. `step` is called before each of them, with the share that
/// is done.
[[nodiscard]] Mesh runRepairSteps(const Mesh& mesh, const RepairOptions& options,
                                  RepairReport& report, const std::function<void(double)>& step);

}  // namespace tufa::checks
