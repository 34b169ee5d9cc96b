// outputs.h: checks of the files that a command writes, before any work.
#pragma once

#include <string>
#include <vector>

namespace vog::cli {

/// "vog page m.ply -o m.html": the command with some of the inputs, and an output unless it is empty.
std::string command_line(const std::string& command, const std::vector<std::string>& inputs,
                         const std::string& output = "");

/// throws vog::Error unless the output's extension is one of `extensions`, its name is valid, its
/// folder exists and can be written, and it is none of the inputs. For an extension that another command writes,
/// the message states that command line.
void check_output(const std::string& output, const std::vector<std::string>& inputs,
                  const std::vector<std::string>& extensions);

/// Checks that every file is written once, and that none is read. Files are compared, not names:
/// ./a.png, a link to it and a.png are one. Empty names are no files; devices may be named twice.
/// outputs  files that one command writes
/// inputs   files that it reads; names that are no file, such as those of transfer functions, do
///          not matter
/// throws   vog::Error: "a.exr: would be written twice, as a.exr and as ./a.exr"
void check_distinct(const std::vector<std::string>& outputs,
                    const std::vector<std::string>& inputs);

}  // namespace vog::cli
