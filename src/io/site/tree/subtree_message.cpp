// subtree_message.cpp: numbers as they lie in memory: all processes are of one build.
#include "io/site/tree/subtree_message.h"

#include <cstring>
#include <span>
#include <type_traits>

#include "data/fields/field_arrays.h"
#include "vog/error.h"

namespace vog::site {

namespace {

class Packing {
  public:
    template <class T>
    void put(const T& value) {
        static_assert(std::is_trivially_copyable_v<T>);
        bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    template <class List>
    void put_list(const List& list) {
        put(std::uint64_t{list.size()});
        bytes_.append(reinterpret_cast<const char*>(list.data()),
                      list.size() * sizeof(*list.data()));
    }
    void put_arrays(const Gaussians& model) {
        put_list(model.mean), put_list(model.scale), put_list(model.rotation);
        put_list(model.density);
        each_array([&](const auto& array) { put_list(array); }, model.fields);
    }
    void put_row(const Row& row) {
        put_list(row.name), put(row.nodes), put(row.gaussians), put(row.error), put(row.box);
        put_list(row.bytes), put_list(row.table), put(row.table_bytes);
        put(std::uint64_t{row.parts.size()});
        for (const Row& part : row.parts) put_row(part);
    }
    std::string take() { return std::move(bytes_); }

  private:
    std::string bytes_;
};

class Unpacking {
  public:
    explicit Unpacking(std::span<const char> bytes) : bytes_(bytes) {}

    template <class T>
    void take(T& value) {
        copy(&value, sizeof value);
    }
    /// Appends a list.
    template <class List>
    void take_list(List& list) {
        const std::uint64_t count = take_count(), before = list.size();
        constexpr std::size_t kBytes = sizeof(*list.data());
        if (count > bytes_.size() / kBytes) fail();
        list.resize(before + count);
        copy(list.data() + before, count * kBytes);
    }
    void take_arrays(Gaussians& model) {
        take_list(model.mean), take_list(model.scale), take_list(model.rotation);
        take_list(model.density);
        each_array([&](auto& array) { take_list(array); }, model.fields);
    }
    void take_row(Row& row) {
        take_list(row.name), take(row.nodes), take(row.gaussians), take(row.error), take(row.box);
        take_list(row.bytes), take_list(row.table), take(row.table_bytes);
        row.parts.resize(take_count());
        for (Row& part : row.parts) take_row(part);
    }

  private:
    std::uint64_t take_count() {
        std::uint64_t count = 0;
        take(count);
        if (count > bytes_.size()) fail();
        return count;
    }
    void copy(void* to, std::size_t bytes) {
        if (bytes > bytes_.size()) fail();
        if (bytes > 0) std::memcpy(to, bytes_.data(), bytes);
        bytes_ = bytes_.subspan(bytes);
    }
    [[noreturn]] static void fail() {
        throw Error("a message between processes is cut short, expected one build of vog on all");
    }

    std::span<const char> bytes_;
};

}  // namespace

std::string message_of(const Gaussians& model) {
    Packing out;
    out.put_arrays(model);
    return out.take();
}

void append_message(Gaussians& model, const std::string& message) {
    if (!message.empty()) Unpacking(message).take_arrays(model);
}

std::string message_of(const Subtree& tree) {
    if (tree.row.gaussians == 0) return {};
    Packing out;
    out.put_row(tree.row);
    out.put_list(tree.levels);
    out.put_arrays(tree.chunk);
    return out.take();
}

Subtree subtree_of(const std::string& message, const Gaussians& like) {
    Subtree tree;
    if (message.empty()) return tree;
    tree.chunk.origin = like.origin;
    tree.chunk.cutoff = like.cutoff;
    tree.chunk.fields = empty_fields(like.fields);
    Unpacking in(message);
    in.take_row(tree.row);
    in.take_list(tree.levels);
    in.take_arrays(tree.chunk);
    return tree;
}

}  // namespace vog::site
