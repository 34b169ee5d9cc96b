// machine_report.h: facts about this build and this machine, for vog doctor and bug reports.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace vog::cli {

/// Facts as JSON: build, system, processor, memory, OpenGL, CUDA, OptiX, libraries, programs. Parts that are absent
/// have "found": false and a "reason".
/// open_gl  name of the OpenGL that draws without a display; throws vog::Error with the reason where there is none.
///          Empty: a build without the window
nlohmann::ordered_json machine_report(const std::function<std::string()>& open_gl);

/// The report as lines of text.
std::string machine_text(const nlohmann::ordered_json& report);

}  // namespace vog::cli
