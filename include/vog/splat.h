// vog/splat.h: SIMD targets of the splat renderer.
#pragma once

#include "vog/renderer.h"
