// main.cpp: vog_view_module FILE writes vog-view.js, when vog is built.
#include <cstdio>
#include <exception>
#include <fstream>

#include "vog/export_html.h"

int main(int argc, char** argv) {
    try {
        std::ofstream out(argc == 2 ? argv[1] : "", std::ios::binary);
        if (out << vog::view_module() << std::flush) return 0;
        std::fputs("usage: vog_view_module FILE, expected a file that can be written\n", stderr);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
    }
    return 1;
}
