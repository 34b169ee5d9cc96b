// chunk_fields.h: fields of a run of Gaussians, and links of a run of nodes, as bytes.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "io/vogz/columns.h"
#include "io/vogz/rounding.h"
#include "vog/lod.h"

namespace vog::vogz {

/// index   Gaussians of the chunk
/// spread  geometric mean of each one's rounded scales: gradients are rounded by the change over it
std::string field_chunk(const ScalarField& field, const FieldRounding& rounding,
                        std::span<const std::uint32_t> index, std::span<const double> spread,
                        Compression compression);
std::string field_chunk(const VectorField& field, const FieldRounding& rounding,
                        std::span<const std::uint32_t> index, std::span<const double> spread,
                        Compression compression);

/// Sets Gaussians [begin, begin + spread.size()) of a field of allocated arrays.
/// throws  vog::Error for corrupt bytes
void read_field(MemoryBytes& in, const FieldRounding& rounding, Compression compression,
                ScalarField& field, std::size_t begin, std::span<const double> spread);
void read_field(MemoryBytes& in, const FieldRounding& rounding, Compression compression,
                VectorField& field, std::size_t begin, std::span<const double> spread);

/// Nodes [begin, end): numbers of children, radius and error, both rounded up.
/// step  VogzPrecision::step; balls grow by what it may displace the Gaussians in them
std::string link_chunk(const Hierarchy& hierarchy, std::size_t begin, std::size_t end, double step,
                       Compression compression);
/// hierarchy  with arrays of counts, radius and error allocated
void read_links(MemoryBytes& in, Compression compression, Hierarchy& hierarchy, std::size_t begin,
                std::size_t end);

}  // namespace vog::vogz
