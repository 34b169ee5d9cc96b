// script_fuzz.cpp: Parser of the window's scripts.
#include "fuzz_target.h"
#include "script/script.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    const std::filesystem::path file = input_file(input, ".txt");
    accepted([&] {
        for (const viewer::Action& action : viewer::read_script(file))
            expect(action.line > 0 && !action.verb.empty(), "an action has a line and a verb");
    });
}

}  // namespace vog::fuzz
