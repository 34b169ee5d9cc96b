// connection.h: a client's connection: heads of requests and responses within limits of time.
#pragma once

#include <atomic>
#include <chrono>
#include <string>
#include <string_view>

namespace vog::cli {

/// Load of a server, shared by its threads.
struct ServerState {
    std::atomic<bool> ending = false;  ///< every wait ends
    std::atomic<int> waiting = 0;      ///< connections that no thread serves yet
};

/// Limits of time.
struct TimeLimits {
    std::chrono::milliseconds idle{5000};    ///< for the next request of an open connection
    std::chrono::milliseconds head{5000};    ///< for a head, from its first byte or the connection
    std::chrono::milliseconds crowded{500};  ///< for both, while others wait
    std::chrono::milliseconds start{10000};  ///< for a response, and
    double bytes_per_second = 4096;  ///< for the rest of it: a client that takes less has stalled
};

class Connection {
  public:
    /// Takes the socket of a client, and closes it at the end.
    Connection(int socket, const ServerState& state, const TimeLimits& limits);
    ~Connection();
    Connection(const Connection&) = delete;
    Connection& operator=(const Connection&) = delete;

    int descriptor() const { return socket_; }

    enum class Arrival {
        whole,   ///< a head
        closed,  ///< by the client, idle for too long, or the server ends
        late,    ///< a head that is not whole in time
        large    ///< a head beyond kLargestRequestHead
    };
    /// Receives the next head. Bytes behind it stay for the next call.
    Arrival receive_head(std::string& head);

    /// Starts the time of a response.
    void begin_response();
    /// Sends bytes of a response.
    /// returns  whether the client took them in time
    bool send(std::string_view bytes);
    /// Says the end of a response after which nothing is read, and waits shortly for the client to
    /// receive it: a socket that is closed on unread bytes drops its answer.
    void finish();

  private:
    using Clock = std::chrono::steady_clock;

    /// Waits until the socket is readable or writable (POLLIN, POLLOUT), a slice at a time.
    /// end  time to give up, asked again after each slice
    template <class End>
    bool wait(short events, const End& end) const;

    int socket_;
    const ServerState& state_;
    const TimeLimits& limits_;
    std::string received_;
    bool first_ = true;
    Clock::time_point response_;
    std::size_t sent_ = 0;  ///< of the response, bytes
};

}  // namespace vog::cli
