// record_fuzz.cpp: Records of pictures in PNG, EXR and JSON files; what is read is written and read again.
#include "fuzz_target.h"
#include "vog/picture_record.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    const std::filesystem::path file = input_file(input, ".json");
    PictureRecord record;
    if (!accepted([&] { record = read_record(file); })) return;
    const std::string text = record_json(record);
    PictureRecord again;
    expect(accepted([&] { again = record_of_json(text); }), "a record that is written is read");
    expect(record_json(again) == text, "a record survives");
}

}  // namespace vog::fuzz
