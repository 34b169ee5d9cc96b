// cuda.h: Types of CUDA's driver interface that OptiX's headers name.
#pragma once

using CUcontext = struct CUctx_st*;
using CUstream = struct CUstream_st*;
