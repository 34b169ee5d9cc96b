# embed_text.cmake: writes OUTPUT, C++ that gives every file of FILES as a string, by its name without folder.
#   OUTPUT    the source to write
#   HEADER    what declares the function
#   FUNCTION  its qualified name: const char* FUNCTION(const std::string& name)
string(CONCAT text "// Made by embed_text.cmake.\n#include \"${HEADER}\"\n\n#include <stdexcept>\n\n"
       "const char* ${FUNCTION}(const std::string& name) {\n")
foreach(file IN LISTS FILES)
    get_filename_component(name ${file} NAME)
    file(READ ${file} source)
    string(APPEND text "    if (name == \"${name}\") return R\"embedded(${source})embedded\";\n")
endforeach()
string(APPEND text "    throw std::logic_error(\"no file \" + name);\n}\n")
file(WRITE ${OUTPUT} "${text}")
