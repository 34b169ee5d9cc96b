// connection.cpp: receiving and sending with poll(), so that no client holds a thread for long.
#include "serve/connection.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include "serve/request_head.h"

namespace vog::cli {

namespace {

using std::chrono::milliseconds;

constexpr int kSliceMs = 50;  // after which a wait looks whether the server ends

/// Whether a failed call is to be repeated after a wait.
bool try_again() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

Connection::Connection(int socket, const ServerState& state, const TimeLimits& limits)
    : socket_(socket), state_(state), limits_(limits) {}

Connection::~Connection() { (void)::close(socket_); }

template <class End>
bool Connection::wait(short events, const End& end) const {
    while (!state_.ending && Clock::now() < end()) {
        pollfd one{socket_, events, 0};
        const int ready = ::poll(&one, 1, kSliceMs);
        if (ready > 0) return true;
        if (ready < 0 && errno != EINTR) return false;
    }
    return false;
}

Connection::Arrival Connection::receive_head(std::string& head) {
    // A new connection has the time of a head to send it: nothing was answered yet.
    Clock::time_point begin = Clock::now();
    const bool first = std::exchange(first_, false);
    const auto end = [&] {
        const milliseconds limit = first || !received_.empty() ? limits_.head : limits_.idle;
        return begin + (state_.waiting > 0 ? std::min(limit, limits_.crowded) : limit);
    };
    while (true) {
        const std::size_t size = head_size(received_);
        if (size > kLargestRequestHead || (size == 0 && received_.size() > kLargestRequestHead))
            return Arrival::large;
        if (size > 0) {
            head = received_.substr(0, size);
            received_.erase(0, size);
            return Arrival::whole;
        }
        if (!wait(POLLIN, end))
            return received_.empty() || state_.ending ? Arrival::closed : Arrival::late;
        std::array<char, 4096> buffer;
        const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
        if (count < 0 && try_again()) continue;
        if (count <= 0) return Arrival::closed;
        if (received_.empty()) begin = Clock::now();
        received_.append(buffer.data(), static_cast<std::size_t>(count));
    }
}

void Connection::begin_response() {
    response_ = Clock::now();
    sent_ = 0;
}

bool Connection::send(std::string_view bytes) {
    const auto end = [&] {
        const std::chrono::duration<double> more(double(sent_) / limits_.bytes_per_second);
        return response_ + limits_.start + std::chrono::duration_cast<milliseconds>(more);
    };
    while (!bytes.empty()) {
        if (!wait(POLLOUT, end)) return false;
        const ssize_t count =
            ::send(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        if (count < 0 && try_again()) continue;
        if (count < 0) return false;
        sent_ += static_cast<std::size_t>(count);
        bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
}

void Connection::finish() {
    // Enough for what a client with a head beyond the limit has on its way; others are cut off.
    constexpr std::size_t kLargestRest = 1 << 20;
    const Clock::time_point until = Clock::now() + limits_.crowded;
    if (::shutdown(socket_, SHUT_WR) != 0) return;
    std::array<char, 4096> buffer;
    for (std::size_t rest = 0; rest < kLargestRest;) {
        if (!wait(POLLIN, [&] { return until; })) return;
        const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
        if (count < 0 && try_again()) continue;
        if (count <= 0) return;
        rest += static_cast<std::size_t>(count);
    }
}

}  // namespace vog::cli
