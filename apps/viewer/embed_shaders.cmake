# embed_shaders.cmake: writes OUTPUT, C++ that holds every file of SHADERS as a string.
string(CONCAT text "// Made by embed_shaders.cmake.\n#include \"shader_sources.h\"\n\n#include <stdexcept>\n\n"
         "namespace vog::viewer {\n\nconst char* shader_source(const std::string& name) {\n")
foreach(file IN LISTS SHADERS)
    get_filename_component(name ${file} NAME)
    file(READ ${file} source)
    string(APPEND text "    if (name == \"${name}\") return R\"glsl(${source})glsl\";\n")
endforeach()
string(APPEND text "    throw std::logic_error(\"no shader \" + name);\n}\n\n}  // namespace vog::viewer\n")
file(WRITE ${OUTPUT} "${text}")
