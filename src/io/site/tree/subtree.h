// subtree.h: trees of a model's chunks: those of one process, and their union under a common root.
#pragma once

#include <cstddef>
#include <vector>

#include "io/site/chunk_folder.h"
#include "io/site/manifest.h"
#include "io/vogz/rounding.h"
#include "vog/distributed.h"
#include "vog/lod.h"
#include "vog/site.h"
#include "vog/vogz.h"

namespace vog::site {

/// Form of all chunks of a model.
struct Coding {
    VogzPrecision precision;
    bool rotated = false;                     ///< whether Gaussians have rotations
    std::vector<vogz::FieldRounding> fields;  ///< field_roundings of the whole model
};

/// A chunk with all below it, whose files are there.
struct Subtree {
    Row row;                        ///< of the chunk; without name and sizes until it is written
    Gaussians chunk;                ///< nodes, then Gaussians, until it is written
    std::vector<SiteLevel> levels;  ///< of the chunk and of all below
};

/// Writes all chunks of a model.
/// is_part  the model is a process's part of one: its coarsest chunk, as large as others, is left to joined_over
Subtree write_tree(ChunkFolder& folder, const Coding& coding, const Gaussians& model,
                   const Hierarchy& hierarchy, bool is_part);
/// Writes the coarsest chunk of a part.
void write_root(ChunkFolder& folder, const Coding& coding, Subtree& tree);

/// Union of parts, its coarsest chunk not written: their coarsest chunks as one, where that has at most `most` Gaussians; else
/// these are written, and nodes of a hierarchy over their Gaussians stand for them all.
Subtree joined(ChunkFolder& folder, const Coding& coding, std::vector<Subtree> parts,
               std::size_t most, const HierarchyBuilder& build);
/// Union of all processes' parts on process 0. Neighbours in the order of processes join first, eight at a time, so that no
/// process holds more than their coarsest chunks.
/// tree   this process's; without Gaussians: none
/// like   model of the same origin, cutoff and fields
Subtree joined_over(const Collective& processes, ChunkFolder& folder, const Coding& coding,
                    Subtree tree, const Gaussians& like, const HierarchyBuilder& build);

}  // namespace vog::site
