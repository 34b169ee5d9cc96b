// ranks.cpp: MPI calls, each after an exchange of failures.
#include "ranks.h"

#include <fmt/core.h>
#include <mpi.h>

#include <algorithm>
#include <limits>
#include <new>
#include <thread>
#include <type_traits>

namespace vog::mpi {

namespace {

void broadcast(std::string& text, int root, int rank) {
    auto length = static_cast<std::uint64_t>(text.size());
    MPI_Bcast(&length, 1, MPI_UINT64_T, root, MPI_COMM_WORLD);
    if (rank != root) text.resize(length);
    MPI_Bcast(text.data(), static_cast<int>(length), MPI_CHAR, root, MPI_COMM_WORLD);
}

int ranks_on_this_machine() {
    MPI_Comm machine;
    MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
    int count = 1;
    MPI_Comm_size(machine, &count);
    MPI_Comm_free(&machine);
    return count;
}

/// Calls operate(first, count) on consecutive runs, as MPI counts are ints.
template <class Operation>
void in_runs(std::size_t size, const Operation& operate) {
    constexpr std::size_t kRun = std::size_t{1} << 20;
    for (std::size_t first = 0; first < size; first += kRun)
        operate(first, static_cast<int>(std::min(kRun, size - first)));
}

}  // namespace

Ranks::Ranks(int* argc, char*** argv) {
    // Only the main thread calls MPI; vog's parallel loops run on other threads.
    int provided = 0;
    MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &count_);
    const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    threads_per_rank_ = std::max(1, cores / ranks_on_this_machine());
    collective_ = {rank_,
                   count_,
                   [this](std::span<double> values) { sum(values); },
                   [this](std::span<double> values) { max(values); },
                   [this](const std::vector<std::vector<float>>& to) { return exchange(to); },
                   [this](const std::vector<std::string>& to) { return exchange(to); }};
}

Ranks::~Ranks() { MPI_Finalize(); }

void Ranks::agree(const Failure& mine) const {
    const bool failed = mine.exit_code != 0;
    int first = failed ? rank_ : std::numeric_limits<int>::max();
    MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
    if (first == std::numeric_limits<int>::max()) return;

    int failures = failed;
    MPI_Allreduce(MPI_IN_PLACE, &failures, 1, MPI_INT, MPI_SUM, MPI_COMM_WORLD);
    Failure one = mine;
    MPI_Bcast(&one.exit_code, 1, MPI_INT, first, MPI_COMM_WORLD);
    broadcast(one.text, first, rank_);
    // Where all fail alike (a wrong option, a missing file) the number of the rank says nothing.
    if (failures < count_) one.text += fmt::format(" (rank {} of {})", first, count_);
    throw Ended{one};
}

void Ranks::sum(std::span<double> values) const {
    std::vector<double> all(first() ? values.size() : 0);
    agree();
    // Reduced on the root, then broadcast: an all-reduce may add in another order on each rank, and
    // ranks with different sums could decide differently.
    in_runs(values.size(), [&](std::size_t begin, int count) {
        MPI_Reduce(values.data() + begin, all.data() + begin, count, MPI_DOUBLE, MPI_SUM, 0,
                   MPI_COMM_WORLD);
    });
    std::ranges::copy(all, values.begin());
    in_runs(values.size(), [&](std::size_t begin, int count) {
        MPI_Bcast(values.data() + begin, count, MPI_DOUBLE, 0, MPI_COMM_WORLD);
    });
}

void Ranks::sum(std::span<std::uint64_t> values) const {
    agree();
    in_runs(values.size(), [&](std::size_t first, int count) {
        MPI_Allreduce(MPI_IN_PLACE, values.data() + first, count, MPI_UINT64_T, MPI_SUM,
                      MPI_COMM_WORLD);
    });
}

std::uint64_t Ranks::sum(std::uint64_t value) const {
    sum(std::span(&value, 1));
    return value;
}

double Ranks::min(double value) const { return -max(-value); }

void Ranks::max(std::span<double> values) const {
    agree();
    in_runs(values.size(), [&](std::size_t begin, int count) {
        MPI_Allreduce(MPI_IN_PLACE, values.data() + begin, count, MPI_DOUBLE, MPI_MAX,
                      MPI_COMM_WORLD);
    });
}

double Ranks::max(double value) const {
    max(std::span(&value, 1));
    return value;
}

Box Ranks::box_union(const Box& box) const {
    // An empty box has its lower bounds at +infinity and its upper ones at -infinity, which change
    // no maximum.
    double bounds[6] = {-box.lower.x, -box.lower.y, -box.lower.z,
                        box.upper.x,  box.upper.y,  box.upper.z};
    max(bounds);
    return {{-bounds[0], -bounds[1], -bounds[2]}, {bounds[3], bounds[4], bounds[5]}};
}

std::vector<std::uint64_t> Ranks::gather(std::uint64_t value) const {
    std::vector<std::uint64_t> values(static_cast<std::size_t>(count_));
    agree();
    MPI_Allgather(&value, 1, MPI_UINT64_T, values.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD);
    return values;
}

std::vector<std::string> Ranks::gather(const std::string& text) const {
    std::vector<std::string> texts(static_cast<std::size_t>(count_));
    texts[static_cast<std::size_t>(rank_)] = text;
    agree();
    for (int n = 0; n < count_; ++n) broadcast(texts[static_cast<std::size_t>(n)], n, rank_);
    return texts;
}

std::string Ranks::from_root(std::string text) const {
    agree();
    broadcast(text, 0, rank_);
    return text;
}

template <class List>
std::vector<List> Ranks::exchanged(const std::vector<List>& to) const {
    const MPI_Datatype type = std::is_same_v<List, std::string> ? MPI_CHAR : MPI_FLOAT;
    const auto ranks = static_cast<std::size_t>(count_), self = static_cast<std::size_t>(rank_);
    std::vector<std::uint64_t> sent(ranks), received(ranks);
    std::ranges::transform(to, sent.begin(), [](const auto& one) { return one.size(); });
    agree();
    MPI_Alltoall(sent.data(), 1, MPI_UINT64_T, received.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD);
    // A rank without memory for this must not leave the others waiting.
    std::vector<List> from(ranks);
    Failure failure;
    try {
        for (std::size_t n = 0; n < ranks; ++n) from[n].resize(received[n]);
    } catch (const std::bad_alloc&) {
        failure = {1, "out of memory"};
    }
    agree(failure);
    std::vector<MPI_Request> requests;
    const auto start = [&](auto* values, std::size_t size, std::size_t other, auto begin) {
        in_runs(size, [&](std::size_t first, int count) {
            begin(values + first, count, type, static_cast<int>(other), 0, MPI_COMM_WORLD,
                  &requests.emplace_back());
        });
    };
    for (std::size_t n = 0; n < ranks; ++n) {
        if (n == self) continue;
        start(from[n].data(), from[n].size(), n, MPI_Irecv);
        start(to[n].data(), to[n].size(), n, MPI_Isend);
    }
    from[self] = to[self];
    MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
    return from;
}

std::vector<std::vector<float>> Ranks::exchange(const std::vector<std::vector<float>>& to) const {
    return exchanged(to);
}
std::vector<std::string> Ranks::exchange(const std::vector<std::string>& to) const {
    return exchanged(to);
}

void Ranks::sum_at_first(DepthImage& depth) const {
    // In double precision: floats would round once per rank. 8 MB at a time, so that a large image
    // is not copied whole.
    constexpr std::size_t kRun = std::size_t{1} << 20;
    std::vector<double> mine(std::min(kRun, depth.depth.size())), all(first() ? mine.size() : 0);
    agree();
    in_runs(depth.depth.size(), [&](std::size_t begin, int count) {
        std::copy_n(depth.depth.begin() + static_cast<std::ptrdiff_t>(begin), count, mine.begin());
        MPI_Reduce(mine.data(), all.data(), count, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
        if (!first()) return;
        for (int n = 0; n < count; ++n)
            depth.depth[begin + static_cast<std::size_t>(n)] =
                static_cast<float>(all[static_cast<std::size_t>(n)]);
    });
}

}  // namespace vog::mpi
