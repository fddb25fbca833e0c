#include "support/openvdb_templates.h"

TUFA_TREE_IS_HERE(BoolTree);
TUFA_TREE_IS_HERE(Int32Tree);
TUFA_TREE_IS_HERE(Vec3STree);
