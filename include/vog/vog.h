// vog/vog.h: all of the library in one include, and the order in which to read its headers.
// Data flows one way, as plain structs between functions: load -> convert -> render -> shade ->
// image.
//
//   data     volume.h           sparse density volumes: leaves of 8^3 voxels and tiles
//            voxel_values.h     the rule for values that are no density
//            points.h           particles, and their files
//            cells.h            meshes of cells of any shape
//            levels.h           levels of adaptive meshes: volumes of different voxel size, one
//                               field
//            gaussians.h        the model: N truncated 3D Gaussians
//            camera.h           pinhole cameras and named views
//            image.h            depth images (optical depth T), colour images, and their files
//   load     volume_io.h        volumes from and to OpenVDB and NanoVDB files
//            dense.h            volumes from and to dense arrays
//            ply.h              models from and to PLY files
//            sample.h           procedural volumes and particles
//   convert  convert.h          the three below
//            convert_moments.h  voxels to Gaussians by moments, the default
//            convert_paper.h    voxels to Gaussians by the paper's strategies
//            convert_points.h   particles to Gaussians
//            convert_cells.h    cells of any shape to Gaussians
//            lod.h              levels of detail: hierarchies, cuts by view, coarser models
//   render   picture.h          a picture: request, defaults, renderer, numbers and colours
//            scene.h            what there is to draw: models or voxels with their fields
//            renderer.h         renderers by name, and their options
//            field_maps.h       maps of a field: column, mean and deviation
//            volume_picture.h   light of volume rendering
//            clip.h             boxes and planes that cut pictures
//            periodic.h         periodic boxes of simulations
//   shade    shade.h            T to colours by a transfer function
//            quantity.h         column density maps, colour bars, values as files
//            value_transfer.h   transfer functions of a field's values
//   judge    compare.h          differences between two images
//            evaluate.h         tables and figures of many conversions of one data set
//   share    export_html.h      models as one HTML page
//            site.h             models that browsers and views load in parts
//   all      error.h            the exception type
//            linear.h           vectors, matrices, affine maps, boxes
//            memory.h           arrays larger than memory
//            progress.h         progress, interruption, number of threads
//            temporary_file.h   files renamed when complete, and their removal on signals
//            text.h             counts, sizes and names from files as text
//
// Not included here: openvdb.h (volumes from and to OpenVDB grids in memory; needs OpenVDB's
// headers) and distributed.h (one data set divided among processes; used by vog-mpi).
#pragma once

#include "vog/camera.h"
#include "vog/cells.h"
#include "vog/clip.h"
#include "vog/compare.h"
#include "vog/conversion_schema.h"
#include "vog/convert.h"
#include "vog/convert_cells.h"
#include "vog/convert_fields.h"
#include "vog/convert_labels.h"
#include "vog/dense.h"
#include "vog/error.h"
#include "vog/evaluate.h"
#include "vog/exchange.h"
#include "vog/export_html.h"
#include "vog/exposure.h"
#include "vog/field_maps.h"
#include "vog/fields.h"
#include "vog/gaussians.h"
#include "vog/image.h"
#include "vog/levels.h"
#include "vog/linear.h"
#include "vog/lod.h"
#include "vog/memory.h"
#include "vog/model_io.h"
#include "vog/periodic.h"
#include "vog/picture.h"
#include "vog/picture_record.h"
#include "vog/ply.h"
#include "vog/points.h"
#include "vog/progress.h"
#include "vog/quantity.h"
#include "vog/renderer.h"
#include "vog/request_schema.h"
#include "vog/sample.h"
#include "vog/scene.h"
#include "vog/shade.h"
#include "vog/site.h"
#include "vog/surface.h"
#include "vog/temporary_file.h"
#include "vog/text.h"
#include "vog/value_transfer.h"
#include "vog/vogz.h"
#include "vog/vogz_fit.h"
#include "vog/volume.h"
#include "vog/volume_io.h"
#include "vog/volume_picture.h"
#include "vog/voxel_field.h"
#include "vog/voxel_values.h"
#include "vog/voxelize.h"
