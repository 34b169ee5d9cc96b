// vog/vog.h: everything but the OpenVDB interop header. The headers in the order of the data:
// load -> convert -> render -> shade -> image.
#pragma once

#include "vog/camera.h"
#include "vog/compare.h"
#include "vog/convert.h"
#include "vog/error.h"
#include "vog/evaluate.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/levels.h"
#include "vog/linear.h"
#include "vog/moments.h"
#include "vog/nvdb.h"
#include "vog/ply.h"
#include "vog/points.h"
#include "vog/progress.h"
#include "vog/reference.h"
#include "vog/render.h"
#include "vog/sample.h"
#include "vog/shade.h"
#include "vog/vdb.h"
#include "vog/volume.h"
