// Stands for fit_blobs.cpp in a library that is built without Ceres Solver's headers.
#include <tufa/error.h>
#include <tufa/fit.h>

namespace tufa {

bool canFitBlobs() { return false; }

BlobFit fitBlobs(const Mesh& /*mesh*/, const FitOptions& /*options*/) {
  throw Error(
      ErrorCode::InvalidArgument,
      "this Tufa was built without Ceres Solver and fits no blobs; install libceres-dev and "
      "configure with -DTUFA_USE_CERES=ON");
}

}  // namespace tufa
