// results_fuzz.cpp: Readers of files that vog writes for itself: results of an evaluation, index of a model.
#include "evaluate/evaluation_json.h"
#include "fuzz_target.h"
#include "vog/distributed.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    const std::filesystem::path file = input_file(input, ".json");
    accepted([&] { expect(!read_model_index(file).empty(), "an index names a model"); });
    Evaluation results;
    if (!accepted([&] { results = evaluation::read_results(file); })) return;
    const std::filesystem::path again = scratch_file("again.json");
    evaluation::write_results(again, results);
    expect(accepted([&] { results = evaluation::read_results(again); }),
           "results that are written are read");
}

}  // namespace vog::fuzz
