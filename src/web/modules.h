// modules.h: scripts, shaders and style of pages, without comments.
#pragma once

#include <map>
#include <string>

namespace vog::web {

/// Shaders by the names of their files.
std::map<std::string, std::string> shader_texts();
std::string page_style();
/// Reader of compact models, for the page and for its worker.
std::string reader_script();
/// Rest of the worker's script.
std::string worker_script();
/// The page's own script.
/// streams  its models are streamed
/// ranges   from one file, by ranges
std::string page_script(bool streams, bool ranges);

}  // namespace vog::web
