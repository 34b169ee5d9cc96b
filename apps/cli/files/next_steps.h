// next_steps.h: command lines to try on a file, by its contents.
#pragma once

#include <string>
#include <vector>

#include "files/inputs.h"
#include "vog/scan_io.h"

namespace vog::cli {

/// Contents of a file as far as they decide what can be done with it.
struct FileContents {
    std::string file;
    FileKind kind = FileKind::volume;
    std::vector<VolumeInfo> grids;            ///< of volumes, and of particles in a .vdb
    std::vector<std::string> particle_types;  ///< of a snapshot
    std::vector<std::string> fields;          ///< names of a model's fields
    bool nonfinite = false;        ///< whether splats or particles have numbers that are not finite
    bool measures_volume = false;  ///< whether a model's masses are volumes (--measure volume)
};

/// Prints the contents of files, as vog info does.
/// returns  the same, one entry a file
std::vector<FileContents> print_contents(const std::vector<std::string>& files, bool json);

/// One command line and its effect in a few words.
struct NextStep {
    std::string command, effect;
};
/// Command lines that work on this file as they stand, the simplest first. Empty where vog can do nothing with it.
std::vector<NextStep> next_steps(const FileContents& contents);

/// Advice on a file of a kind that no command reads as its input, such as a picture or a camera; empty: none.
std::string advice_on(const std::string& file);
/// Advice on HDF5 that is no snapshot of particles.
std::string advice_on_hdf5(const std::string& file);
/// A name under which a text with numbers is read; empty: other files. For files of unknown extensions.
std::string advice_on_text(const std::string& file);

/// A word of a shell command: in quotes where it holds other letters than those of plain names.
std::string quoted(const std::string& word);

}  // namespace vog::cli
