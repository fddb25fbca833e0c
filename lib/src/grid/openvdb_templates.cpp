#include "grid/openvdb_templates.h"

TUFA_TREE_IS_HERE(FloatTree);
TUFA_TREE_IS_HERE(DoubleTree);
