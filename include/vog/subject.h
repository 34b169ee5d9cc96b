// vog/subject.h: Box of the data, and the part of it that a picture shows: views frame them.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "vog/linear.h"

namespace vog {

struct CellSource;
struct Collective;
struct Gaussians;
struct Volume;

/// How data stand, as far as their file says or implies it. 0: not known.
struct Standing {
    Vec3d up;     ///< unit vector, upright in pictures
    Vec3d front;  ///< unit vector to an eye that sees the front, of scans of people

    bool known() const { return up != Vec3d{}; }
    friend bool operator==(const Standing&, const Standing&) = default;
};

/// Units of data, as their files state them ("kpc", "g/cm3"; vog/units.h). Empty: not known.
struct Units {
    std::string length{};   ///< unit of world lengths
    std::string density{};  ///< unit of the density

    friend bool operator==(const Units&, const Units&) = default;
};

/// Extent and units of the source of a model, which its volume and the model share.
struct Content {
    Box voxels;  ///< box of the active voxels, world units; empty: no voxels, or not known
    /// Points, world units, whose convex hull holds what a picture shows: 99.9 % of the light of the data as fog, seen along
    /// any axis. None: not known.
    std::vector<Vec3d> hull;
    Standing standing{};
    Units units{};
    /// Whether a model is fitted to pictures of its own values: slices then show their mean.
    bool by_value = false;

    /// Content of both; its hull is unknown where one is, its units where they differ. How the first stands counts, and a length that is known.
    void include(const Content& other);
    /// Box of the hull; empty where that is not known.
    Box hull_box() const {
        Box box;
        for (const Vec3d& point : hull) box.include(point);
        return box;
    }
};

/// Data as a view frames them.
struct Subject {
    Box box;  ///< Box of the data, world units: the `paper` view and distances in radii
    Content
        content;  ///< fitted pictures hold its hull; the corners of the box where that is not known

    Subject() = default;
    Subject(const Box& box);

    /// Frames both. Data without voxels have their box among the other's.
    void include(const Subject& other);
};

/// Content of volumes, a mesh's levels for example; voxels that finer levels hide count as well.
/// Light is 1 - exp(-T) of the columns of a lattice of 96 cells along the longest edge, along x, y and z, at the extinction
/// where the 99th percentile of the columns has T = 4. Columns below 0.02 do not count.
/// box         of all, world units
/// collective  null, or of processes that hold a part each
Content content_of(std::span<const Volume* const> volumes, const Box& box,
                   const Collective* collective = nullptr);
Content content_of(std::span<const Volume> volumes, const Box& box);
/// Content of cells.
/// box  of all points, world units
Content content_of(const CellSource& source, const Box& box);
/// Subject of a model: Gaussians::content, or the hull that its Gaussians have as fog.
/// collective  null, or of processes that hold a part each of a model with one box
Subject subject_of(const Gaussians& model, const Collective* collective = nullptr);
/// Subject of a box whose content is known, or not.
Subject subject_of(const Box& box, Content content);
/// Subject of the parts that processes hold.
Subject joined(const Subject& part, const Collective& collective);
/// Box of the active voxels, world units; empty for none.
Box voxel_box(const Volume& volume);

}  // namespace vog
