#include "side.h"

namespace tufa::fuzz {

const int kSide = TUFA_FUZZ_SIDE;

}  // namespace tufa::fuzz
