#pragma once

// The whole of Tufa::tufa. The checker, <tufa/check.h>, is apart: it links CGAL under the GPL.
#include <tufa/advise.h>
#include <tufa/attributes.h>
#include <tufa/chunks.h>
#include <tufa/contour.h>
#include <tufa/error.h>
#include <tufa/extract.h>
#include <tufa/filter.h>
#include <tufa/float_mesh.h>
#include <tufa/fwd.h>
#include <tufa/implicit.h>
#include <tufa/import.h>
#include <tufa/io.h>
#include <tufa/labels.h>
#include <tufa/lod.h>
#include <tufa/memory.h>
#include <tufa/mesh.h>
#include <tufa/octree.h>
#include <tufa/picture.h>
#include <tufa/progress.h>
#include <tufa/quads.h>
#include <tufa/rays.h>
#include <tufa/shapes.h>
#include <tufa/unite.h>
#include <tufa/version.h>
#include <tufa/voxelize.h>
